// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "batch/htm/htm_commands.h"
#include "batch/htm/htm_render_views.h"

namespace ibr::app {

const Command kHtmRenderCommand{
    .name = "render",
    .summary = "Renders new views of a harmonised model or of 3D video as PNG files",
    .examples =
        "ibr htm render model --path auto:90 -o pictures\n"
        "ibr htm render model --poses held-out/sparse -o pictures\n"
        "ibr htm render model --poses path.json --size 1024x768 --method vdtbm -o pictures\n"
        "ibr htm render sequence --poses path.json --smooth 0.2 -o pictures\n"
        "ibr htm render sequence --path auto:90 --time 1.5 -o pictures",
    .details =
        "--poses takes a COLMAP model's folder, transforms.json, a camera path or a picture that ibr has written\n"
        "(ibr render --help). Pictures are named after the poses and transparent where the object is not.\n"
        "Of 3D video a path's times say which frame is shown, again from the first after the last; poses that know no\n"
        "time show a frame each, in order. While a frame is drawn the next ones are loaded; one that is not there yet\n"
        "is waited for. With --smooth, weights go on from frame to frame; cameras are the same where their names are.\n"
        "Methods: htm, harmonised photographs; vdtbm, photographs blended as they are; vdvbm, colours of vertices.",
    .afterInterrupt = "The pictures that are there are whole; the same command makes all of them again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<HtmViewsOptions>();
      app.add_option("MODEL", options->model, "Folder of a model or of a sequence")->required();
      auto* poses =
          app.add_option("--poses", options->poses, "COLMAP model's folder, transforms.json, or a camera path")
              ->type_name("FILE|DIR");
      poses->excludes(addAutoPath(app, options->autoFrames));
      app.add_option("-o,--output", options->output, "Folder for the pictures; made where it is missing")
          ->required()
          ->type_name("DIR");
      addSize(app, "--size", options->size, "Size of the pictures [that of the poses; auto: of the photographs]");
      addFov(app, options->fovDegrees);
      addGraph(app, options->graph);
      declareHtmViews(app, *options);
      app.callback([options] {
        if (options->poses.empty() && options->autoFrames == 0) throw CLI::RequiredError("--poses or --path");
        checkHtmViews(*options, assetKind(options->model));
      });
      return [options](const Context& context) { return renderHtmViews(*options, context); };
    }};

}  // namespace ibr::app
