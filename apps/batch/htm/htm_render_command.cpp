// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "batch/htm/htm_commands.h"
#include "batch/htm/htm_render_views.h"
#include "shared/cli/options.h"

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
        "--poses takes poses in any format of ibr build --model, a camera path, or an image that\n"
        "ibr has written (see ibr render --help). Images are named after the poses, and\n"
        "transparent outside the object.\n"
        "For 3D video, the times of a path select the frames; after the last frame, the video\n"
        "starts again. Poses without times show one frame each, in order. While a frame is drawn,\n"
        "the next frames are loaded, and drawing waits for a frame that is not loaded. With\n"
        "--smooth, weights continue from frame to frame; cameras correspond by name.\n"
        "Methods: htm, harmonised photographs; vdtbm, photographs blended without displacement;\n"
        "vdvbm, vertex colours.",
    .afterInterrupt = "written images are complete; the same command writes all images again",
    .mainOptions = "poses path output size fov method smooth time json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<HtmViewsOptions>();
      addOption(app, "MODEL", options->model, "Folder of a model or of 3D video").required();
      declareRenderedViews(app, *options);
      declareHtmViews(app, *options);
      afterParsing(app, [options] {
        requireViews(*options);
        checkHtmViews(*options, assetKind(options->model));
      });
      return [options](const Context& context) { return renderHtmViews(*options, context); };
    }};

}  // namespace ibr::app
