// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/check.h"
#include "batch/command.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "shared/cli/options.h"
#include "shared/draw/image_operations.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Tolerance {
  int levels = 0;      // maximum difference that counts as equal, 8-bit levels
  double percent = 0;  // maximum share of pixels that differ by more
  int largest = 0;     // maximum difference of any pixel, 8-bit levels
};

struct Options {
  std::string a, b, output;
  std::optional<Tolerance> tolerance;
  int gain = 4;
};

ExitCode comparePictures(const Options& options, const Context& context) {
  const auto& tolerance = options.tolerance;
  const Image8 a = readImage(options.a), b = readImage(options.b);
  check(a.width == b.width && a.height == b.height, ErrorCode::invalidInput, "{} is {}×{} px, but {} is {}×{} px",
        options.a, a.width, a.height, options.b, b.width, b.height);
  const Difference found = difference(a, b, tolerance ? tolerance->levels : 0);
  const double decibels = psnr(a, b), similarity = ssim(a, b), seen = flip(a, b), scales = msSsim(a, b),
               percent = 100 * found.shareAbove;
  const bool within = !tolerance || (percent <= tolerance->percent && found.largest <= tolerance->largest);
  context.print("PSNR                {} dB\n", numberText(decibels, 3));
  context.print("SSIM                {}\n", numberText(similarity, 5));
  context.print("MS-SSIM             {}\n", numberText(scales, 5));
  context.print("FLIP                {}\n", numberText(seen, 5));
  context.print("largest difference  {} levels\n", found.largest);
  context.print("mean difference     {} levels\n", numberText(found.meanAbsolute, 4));
  context.print("pixels that differ  {} % by more than {} levels\n", numberText(percent, 4),
                tolerance ? tolerance->levels : 0);
  if (tolerance) context.print("{}\n", within ? "within the tolerance" : "exceeds the tolerance");
  if (!options.output.empty()) writeImage(options.output, absoluteDifference(a, b, options.gain));
  Json report{{"a", options.a},
              {"b", options.b},
              {"psnr", decibels},
              {"ssim", similarity},
              {"msSsim", scales},
              {"flip", seen},
              {"maxDifference", found.largest},
              {"meanDifference", found.meanAbsolute},
              {"percentAbove", percent},
              {"tolerance", nullptr},
              {"within", within}};
  if (tolerance) report["tolerance"] = {tolerance->levels, tolerance->percent, tolerance->largest};
  context.report(report);
  return within ? kExitOk : kExitComparison;
}

}  // namespace

const Command kCompareCommand{
    .name = "compare",
    .summary = "Measures the difference between two images",
    .examples = "ibr compare a.png b.png\nibr compare a.png b.png --tolerance 2 0.1 20 -o difference.png",
    .details =
        "The exit code is 6 if the images differ by more than the tolerance. Equal images have an\n"
        "infinite PSNR (null in JSON).",
    .afterInterrupt = "",
    .mainOptions = "tolerance output gain json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "A", options->a, "Image").required();
      addOption(app, "B", options->b, "Image of the same size").required();
      addParsedList(
          app, "--tolerance",
          [options](const std::vector<std::string>& words) {
            constexpr auto kName = "--tolerance";
            options->tolerance = {int(parsedInt(kName, words.at(0), 0, 255)), parsedDouble(kName, words.at(1), 0, 100),
                                  int(parsedInt(kName, words.at(2), 0, 255))};
          },
          "At most PERCENT of the pixels may differ by more than LEVELS, and none by more than LARGEST "
          "(levels of 0 to 255)")
          .expected(3)
          .type("LEVELS PERCENT LARGEST");
      addOption(app, "-o,--output", options->output, "Write the absolute difference as an image").type("FILE");
      addInt(app, "--gain", options->gain, 1, 255, "Factor on the difference image");
      return [options](const Context& context) { return comparePictures(*options, context); };
    }};

}  // namespace ibr::app
