// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/htm_view_settings.h"

#include "shared/cli/options.h"

namespace ibr::app {

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

void declareHtmPictureSettings(CLI::App& app, HtmSettings& settings, bool& onSource) {
  addChoice<HtmMethod>(
      app, "--method", settings.method,
      {{"htm", HtmMethod::harmonised}, {"vdtbm", HtmMethod::blended}, {"vdvbm", HtmMethod::vertexColours}},
      "How colours come from photographs [htm]");
  addChoice<bool>(app, "--mesh", onSource, {{"optimised", false}, {"source", true}},
                  "Which mesh is drawn; the one of before has nothing to harmonise [optimised]");
  declareHtmSettings(app, settings);
  addDouble(app, "--smooth", settings.smoothSeconds, 0, 60, "Along a path, seconds in which weights follow the view");
}

nlohmann::ordered_json htmSettingsJson(const HtmSettings& settings, bool onSource) {
  return {{"method", htmMethodName(settings.method)},
          {"gamma", settings.gamma},
          {"weightCut", settings.weightCut},
          {"smooth", settings.smoothSeconds},
          {"mesh", onSource ? "source" : "optimised"}};
}

}  // namespace ibr::app
