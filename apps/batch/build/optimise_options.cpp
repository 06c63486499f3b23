// SPDX-License-Identifier: Apache-2.0
#include "batch/build/optimise_options.h"

#include <array>

#include "shared/cli/options.h"

namespace ibr::app {
namespace {

constexpr std::array kMethods{std::pair{"cpu", AlignmentMethod::cpu}, std::pair{"compute", AlignmentMethod::compute},
                              std::pair{"raster", AlignmentMethod::raster},
                              std::pair{"gradient", AlignmentMethod::gradient}};
constexpr std::array kDefinitions{std::pair{"channels", EccDefinition::channels},
                                  std::pair{"concatenated", EccDefinition::concatenated}};

template <class T>
const char* wordIn(const T& words, auto value) {
  for (const auto& [word, meaning] : words)
    if (meaning == value) return word;
  return "";
}

}  // namespace

const char* wordOf(AlignmentMethod method) {
  return wordIn(kMethods, method);
}
const char* wordOf(EccDefinition definition) {
  return wordIn(kDefinitions, definition);
}

AlignmentMethod parsedMethod(const std::string& option, const std::string& word) {
  for (const auto& [known, method] : kMethods)
    if (word == known) return method;
  throw CLI::ValidationError(option, "'" + word + "' is none of gradient|cpu|compute|raster");
}

void declareAlignment(CLI::App& app, AlignmentOptions& options) {
  options.method = AlignmentMethod::gradient;
  app.add_option_function<std::string>(
         "--method", [&options](const std::string& word) { options.method = parsedMethod("--method", word); },
         "gradient: places are computed [gradient]. Else they are drawn at random and judged: on the processor, on the "
         "device all at once, or as the paper draws them")
      ->type_name("gradient|cpu|compute|raster");
  addInt(app, "--instances", options.instances, kInstancesLimits.first, kInstancesLimits.second,
         "Not gradient: candidates of a point, the first where it stands");
  addDouble(app, "--radius", options.radiusPx, kRadiusLimits.first, kRadiusLimits.second,
            "Largest way of a candidate in the first cycle, px");
  addDouble(app, "--decay", options.decay, kDecayLimits.first, kDecayLimits.second,
            "Factor on the radius from cycle to cycle");
  addDouble(app, "--threshold", options.threshold, kThresholdLimits.first, kThresholdLimits.second,
            "Relative gain of a cycle below which it was the last");
  addChoice<EccDefinition>(app, "--definition", options.definition, {kDefinitions.begin(), kDefinitions.end()},
                           "Correlation with a mean for each channel and target, or with one for all as in the paper "
                           "[channels]");
  addDouble(app, "--rigidity", options.rigidity, kRigidityLimits.first, kRigidityLimits.second,
            "What a match that goes a pixel from where it began must explain, grey^2 a sample and channel");
  addDouble(app, "--epipolar", options.epipolarWeight, 0, 10000,
            "gradient: the same for each pixel off the line on which exact poses would have the match");
  addInt(app, "--levels", options.levels, 1, 8,
         "gradient: blurred pictures that are aligned before the photographs, and these");
  addInt(app, "--escape", options.escape, 0, 256, "gradient: candidates at random before a step is computed");
  app.add_flag("--flip-edges", options.flipEdges,
               "Join points anew where their photographs then agree better; not in cells of panoramas");
  addDouble(app, "--flip-gain", options.flipGain, 0, 1,
            "ECC by which the two triangles beside a flipped edge must rise");
  app.add_flag("--insert-points", options.insertPoints,
               "Add points where photographs agree badly and then agree better; not in cells of panoramas");
  addDouble(app, "--insert-below", options.insertBelow, -1, 1, "ECC of a triangle below which it may get a point");
  addDouble(app, "--insert-gain", options.insertGain, 0, 1,
            "ECC by which the triangles around an inserted point must rise");
  app.add_flag("--prune", options.prune,
               "cpu, compute: judge all candidates on every 8th row first, and only the best whole");
}

void declareCellsOnly(CLI::App& app, std::vector<std::size_t>& cells, const char* description) {
  app.add_option_function<std::vector<std::string>>(
         "--cells-only",
         [&cells](const std::vector<std::string>& numbers) {
           for (const std::string& text : numbers)
             cells.push_back(std::size_t(parsedInt("--cells-only", text, 0, 1000000)));
         },
         description)
      ->type_name("N...");
}

Aligner makeAligner(AlignmentMethod method, const Context& context) {
  std::shared_ptr<Device> device;
  if (method == AlignmentMethod::compute || method == AlignmentMethod::raster)
    device = std::make_shared<Device>(Device::create({.device = context.options().device, .log = context.log()}));
  return [device](Alignment& alignment, const AlignmentOptions& options, const ProgressCallback& progress) {
    return align(alignment, options, device.get(), progress);
  };
}

}  // namespace ibr::app
