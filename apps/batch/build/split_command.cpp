// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/command.h"
#include "ibr/author/panorama.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  SplitOptions split;
  std::string input, model, output;
};

ExitCode split(Options options, const Context& context) {
  SplitOptions& split = options.split;
  split.input = options.input;
  split.model = options.model;
  split.output = options.output;
  split.threads = context.options().threads;
  SplitReport report;
  {
    ProgressLine progress(context);
    report = splitPanoramas(split, progress.callback(), context.log());
  }
  for (const std::string& name : report.skipped) context.print("{}: is not a panorama, skipped\n", name);
  context.print("{}: {} images of {}x{} px, {} degrees wide, from {} panoramas; {} observations of points\n",
                options.output, report.pictures, report.size, report.size, split.fovDegrees, report.panoramas,
                report.observations);
  context.print("{:.2f} s in total; CPU time: reading {:.2f} s, sampling {:.2f} s, writing {:.2f} s\n", report.seconds,
                report.readSeconds, report.sampleSeconds, report.writeSeconds);
  context.report(Json{{"panoramas", report.panoramas},
                      {"pictures", report.pictures},
                      {"size", report.size},
                      {"fovDegrees", split.fovDegrees},
                      {"observations", report.observations},
                      {"skipped", report.skipped},
                      {"readSeconds", report.readSeconds},
                      {"sampleSeconds", report.sampleSeconds},
                      {"writeSeconds", report.writeSeconds},
                      {"seconds", report.seconds},
                      {"output", options.output}});
  return kExitOk;
}

}  // namespace

const Command kSplitCommand{
    .name = "split",
    .summary = "Splits panoramas into pinhole images and writes their cameras as a COLMAP model",
    .examples =
        "ibr split panorama.jpg -o faces\n"
        "ibr split panorama.jpg -o faces --views 8 --poles --fov 90 --size 1024\n"
        "ibr split hall --panoramas hall/panoramas.json -o faces",
    .details =
        "PANORAMA is an equirectangular image, whose camera is placed at the origin. With --model,\n"
        "PANORAMA is the folder that the names of posed panoramas are relative to. Then all\n"
        "panoramas are split, and their shared points are kept. The images are\n"
        "images/NAME_FACE below DIR, in JPEG for JPEG panoramas. The model is in sparse/, so that\n"
        "`ibr build DIR/images` finds the model.\n"
        "Above 90 degrees, the faces of a cube overlap. By default, faces are as sharp as the\n"
        "panorama's horizon; smaller faces are averaged, without aliasing.",
    .afterInterrupt = "written images are complete, but the model is missing; run the same command again",
    .mainOptions = "output views poles fov size format model json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "PANORAMA", options->input, "Panorama, or folder of posed panoramas").required();
      addOption(app, "-o,--output", options->output, "Folder for images/ and sparse/; created if missing")
          .required()
          .type("DIR");
      addParsed(
          app, "--views",
          [options](const std::string& text) {
            options->split.views = text == "cube" ? 0 : int(parsedInt("--views", text, 1, 360));
          },
          "Faces of a cube, or N views around the horizon [cube]")
          .type("cube|N");
      addFlag(app, "--poles", options->split.poles, "Add views up and down to the views around the horizon");
      addParsed(
          app, "--fov",
          [options](const std::string& text) {
            const double degrees = parsedDouble("--fov", text, 0, 180);
            if (!(degrees > 0 && degrees < 180))
              refuseOption("--fov", "'" + text + "' is not between 0 and 180 degrees");
            options->split.fovDegrees = degrees;
          },
          "Horizontal and vertical field of view of an image, degrees [105]")
          .type("DEGREES");
      addInt(app, "--size", options->split.size, 0, 16384,
             "Width and height of an image, px; 0 = centre as sharp as the panorama's horizon");
      addChoice<ImageFileFormat>(
          app, "--format", options->split.format,
          {{"source", ImageFileFormat::asSource}, {"jpg", ImageFileFormat::jpeg}, {"png", ImageFileFormat::png}},
          "File format of the images; source: that of the panorama, PNG unless it is a JPEG [source]");
      addOption(
          app, "--model,--panoramas", options->model,
          "Poses of panoramas, in any format of ibr build --model: a COLMAP model with EQUIRECTANGULAR cameras, …")
          .type("FILE|DIR");
      return [options](const Context& context) { return split(*options, context); };
    }};

}  // namespace ibr::app
