// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_commands.h"

#include <array>

namespace ibr::app {
namespace {

constexpr std::array kCommands{&kHtmBuildCommand, &kHtmSequenceCommand, &kHtmRenderCommand, &kHtmEvalCommand};

}  // namespace

const Command kHtmCommand{.name = "htm",
                          .summary =
                              "Builds and renders harmonised models: a mesh with photographs that are warped "
                              "until they agree",
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
