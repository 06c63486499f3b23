// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/htm_view_settings.h"

#include <nlohmann/json.hpp>

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
  addDouble(app, "--gamma", settings.gamma, 1, 1000,
            "Preference for cameras that look in the view's direction; higher "
            "is stronger");
  addDouble(app, "--weight-cut", settings.weightCut, 0, 0.99,
            "Share of the weights below which the remaining cameras are left out");
}

void declareHtmPictureSettings(CLI::App& app, HtmSettings& settings, bool& sourceMesh) {
  addChoice<HtmMethod>(
      app, "--method", settings.method,
      {{"htm", HtmMethod::harmonised}, {"vdtbm", HtmMethod::blended}, {"vdvbm", HtmMethod::vertexColours}},
      "Source of colours: displaced photographs (htm), blended photographs (vdtbm), or vertex colours (vdvbm) [htm]");
  addChoice<bool>(app, "--mesh", sourceMesh, {{"optimised", false}, {"source", true}},
                  "Mesh to draw; the source mesh, before optimisation, has nothing to harmonise [optimised]");
  declareHtmSettings(app, settings);
  addDouble(app, "--smooth", settings.smoothingSeconds, 0, 60,
            "Along a path, time constant with which weights follow the "
            "view, in seconds");
}

nlohmann::ordered_json htmSettingsJson(const HtmSettings& settings, bool sourceMesh) {
  return {{"method", htmMethodName(settings.method)},
          {"gamma", settings.gamma},
          {"weightCut", settings.weightCut},
          {"smooth", settings.smoothingSeconds},
          {"mesh", sourceMesh ? "source" : "optimised"}};
}

}  // namespace ibr::app
