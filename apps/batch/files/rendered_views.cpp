// SPDX-License-Identifier: Apache-2.0
#include "batch/files/rendered_views.h"

namespace ibr::app {

void declareRenderedViews(CLI::App& app, RenderedViews& views) {
  const Option poses =
      addOption(app, "--poses", views.poses, "Poses in any format of ibr build --model, camera path or image")
          .type("FILE|DIR");
  poses.excludes(addAutoPath(app, views.autoFrames));
  addOption(app, "-o,--output", views.output, "Folder for the images; created if missing").required().type("DIR");
  addSize(app, "--size", views.size, "Size of the images [that of the poses; auto: of the photographs]");
  addFov(app, views.fovDegrees);
  addGraph(app, views.graph);
}

void requireViews(const RenderedViews& views) {
  if (views.poses.empty() && views.autoFrames == 0) requireOption("--poses or --path");
}

}  // namespace ibr::app
