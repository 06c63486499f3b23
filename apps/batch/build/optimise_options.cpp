// SPDX-License-Identifier: Apache-2.0
#include "batch/build/optimise_options.h"

#include <array>

#include "ibr/device.h"
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

const char* optionValue(AlignmentMethod method) {
  return wordIn(kMethods, method);
}
const char* optionValue(EccDefinition definition) {
  return wordIn(kDefinitions, definition);
}

AlignmentMethod parsedMethod(const std::string& option, const std::string& word) {
  for (const auto& [known, method] : kMethods)
    if (word == known) return method;
  refuseOption(option, "'" + word + "' is not one of gradient|cpu|compute|raster");
}

void declareAlignment(CLI::App& app, AlignmentOptions& options) {
  options.method = AlignmentMethod::gradient;
  addParsed(
      app, "--method", [&options](const std::string& word) { options.method = parsedMethod("--method", word); },
      "Search for positions: computed steps [gradient], or random candidates on the CPU (cpu), on the device in "
      "parallel (compute), or as in the paper (raster)")
      .type("gradient|cpu|compute|raster");
  addInt(app, "--instances", options.instances, kInstancesLimits.first, kInstancesLimits.second,
         "cpu, compute, raster: number of candidates per point, including the current position");
  addDouble(app, "--radius", options.radiusPx, kRadiusLimits.first, kRadiusLimits.second,
            "Maximum displacement of a candidate in the first cycle, px");
  addDouble(app, "--decay", options.decay, kDecayLimits.first, kDecayLimits.second,
            "Factor on the radius from one cycle to the next");
  addDouble(app, "--threshold", options.threshold, kThresholdLimits.first, kThresholdLimits.second,
            "Relative gain of a cycle at or below which the optimiser stops");
  addChoice<EccDefinition>(app, "--definition", options.definition, {kDefinitions.begin(), kDefinitions.end()},
                           "Correlation (ECC) with one mean per channel and target (channels), or with one mean for "
                           "all as in the paper [channels]");
  addDouble(app, "--rigidity", options.rigidity, kRigidityLimits.first, kRigidityLimits.second,
            "Penalty for a match that is 1 px from its initial position, grey^2 per sample and channel");
  addDouble(app, "--epipolar", options.epipolarWeight, 0, 10000,
            "gradient: penalty for a match that is 1 px from its epipolar line, grey^2 per sample and channel");
  addInt(app, "--levels", options.levels, 1, 8,
         "gradient: number of scale levels, from blurred images to the photographs");
  addInt(app, "--escape", options.escape, 0, 256, "gradient: number of random candidates before each computed step");
  addFlag(app, "--flip-edges", options.flipEdges,
          "Flip edges of triangles where the photographs then agree better; not in cells of panoramas");
  addDouble(app, "--flip-gain", options.flipGain, 0, 1, "Minimum gain in ECC of the two triangles at a flipped edge");
  addFlag(app, "--insert-points", options.insertPoints,
          "Insert points where bad agreement of photographs improves; not in cells of panoramas");
  addDouble(app, "--insert-below", options.insertBelow, -1, 1, "ECC of a triangle below which a point may be inserted");
  addDouble(app, "--insert-gain", options.insertGain, 0, 1,
            "Minimum gain in ECC of the triangles around an inserted point");
  addFlag(app, "--prune", options.prune,
          "cpu, compute: evaluate all candidates on every 8th row first, then only the best in full");
}

void declareCellsOnly(CLI::App& app, std::vector<std::size_t>& cells, const char* description) {
  addParsedList(
      app, "--cells-only",
      [&cells](const std::vector<std::string>& numbers) {
        for (const std::string& text : numbers)
          cells.push_back(std::size_t(parsedInt("--cells-only", text, 0, 1000000)));
      },
      description)
      .type("N...");
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
