// SPDX-License-Identifier: Apache-2.0
#include "batch/htm.h"

#include <array>

#include "batch/options.h"

namespace ibr::app {
namespace {

constexpr std::array kCommands{&kHtmBuildCommand, &kHtmSequenceCommand, &kHtmRenderCommand, &kHtmEvalCommand};

}  // namespace

const char* htmMethodName(HtmMethod method) {
  switch (method) {
    case HtmMethod::harmonised:
      return "htm";
    case HtmMethod::blended:
      return "vdtbm";
    case HtmMethod::vertexColours:
      return "vdvbm";
  }
  return "";
}

void declareHtmSettings(CLI::App& app, HtmSettings& settings) {
  addDouble(app, "--gamma", settings.gamma, 1, 1000, "How much cameras that look as the view does are preferred");
  addDouble(app, "--weight-cut", settings.weightCut, 0, 0.99,
            "Cameras that together weigh less than this share are left out");
}

const Command kHtmCommand{.name = "htm",
                          .summary = "An object as a mesh with photographs that are bent until they agree",
                          .examples =
                              "ibr htm build --mesh object.ply --model sparse --images images --masks masks -o model\n"
                              "ibr htm sequence frames -o video --fps 25\n"
                              "ibr htm render model --path auto:90 -o pictures\n"
                              "ibr htm eval model --leave-one-out -o comparison",
                          .details = "",
                          .afterInterrupt = "",
                          .declare = nullptr,
                          .commands = kCommands};

}  // namespace ibr::app
