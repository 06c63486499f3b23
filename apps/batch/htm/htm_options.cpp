// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_options.h"

#include "ibr/template_search_pass.h"
#include "shared/cli/options.h"

namespace ibr::app {

namespace {

void declareHtmOptions(CLI::App& app, HtmOptions& o) {
  addCount<std::size_t>(app, "--faces", o.faces, 0, 100000000,
                        "Number of faces to which the mesh is reduced by shape; "
                        "0: no reduction by shape");
  addInt(app, "--adjust", o.adjustRounds, 0, 16,
         "Rounds that adjust cameras and shape to the matches; 0: both stay as given, as in the paper");
  addFlagCallback(
      app, "--keep-shape", [&o] { o.reshape = false; }, "Keep vertices fixed in the rounds of --adjust");
  addChoice<TemplateMeasure>(
      app, "--measure", o.measure,
      {{"sad", TemplateMeasure::absoluteDifferences}, {"ncc", TemplateMeasure::correlation}},
      "Measure for comparing textures: mean absolute differences (sad), or correlation (ncc), which light does not "
      "change [sad]");
  addDouble(app, "--radius", o.radius, 1, 2 * kMaxTemplateRadius, "Search radius around each vertex at first, px");
  addDouble(app, "--later-radius", o.laterRadius, 1, 2 * kMaxTemplateRadius,
            "Search radius once cameras are adjusted, "
            "or after the first round, px");
  addDouble(app, "--min-texture", o.minTexture, 0, 255,
            "Minimum gradient, levels per px: directions with a smaller gradient are not matched");
  addDouble(app, "--smoothness", o.smoothness, 0, 1e6,
            "Smoothness of complements between neighbouring vertices, 1/px^2; 0: complements as matched, as in the "
            "paper");
  addDouble(
      app, "--complement-px", o.complementPx, 0, 1e6,
      "Expected length of complements, px, unless matches say more; 0: any length. No effect with --smoothness 0");
  addDouble(app, "--inconsistent-size", o.inconsistentSize, 0, 1e6,
            "Area up to which inconsistent faces are merged, in mean faces; 0: no merging");
  addDouble(app, "--inconsistent-difference", o.inconsistentDifference, 0, 255,
            "D_f above which a face is inconsistent, levels");
  addDouble(app, "--inconsistent-share", o.inconsistentShare, 0, 1, "Maximum share of faces that are merged");
  addInt(app, "--rounds", o.rounds, 1, 16, "Rounds of matching; faces are divided before each round but the first");
  addDouble(app, "--mean-difference", o.meanDifference, 0, 255,
            "Mean D_f at which faces are no longer divided, levels");
  addDouble(app, "--face-difference", o.faceDifference, 0, 255, "D_f above which a face is divided, levels");
  addDouble(app, "--min-face", o.minFacePx, 0, 1e12, "Minimum area of faces to divide, px^2 in the best camera");
  addCount<std::size_t>(app, "--max-faces", o.maxFaces, 1, 100000000,
                        "Number of faces beyond which no further round "
                        "begins");
  addFlagCallback(
      app, "--no-self-occluded", [&o] { o.selfOccluded = false; }, "Do not divide faces for being partly hidden");
  addFlagCallback(
      app, "--no-reject", [&o] { o.reject = false; }, "Keep cameras that disagree at a vertex");
  addDouble(app, "--reject-difference", o.rejectDifference, 0, 255,
            "Difference above which two cameras disagree at a vertex, levels; see --reject-correlation");
  addDouble(app, "--reject-correlation", o.rejectCorrelation, -1, 1,
            "Colour correlation from which two cameras agree "
            "at a vertex at any difference");
  addDouble(app, "--alpha", o.alpha, 0, 1, "Equation 2: weight of facing a face, against its size");
  addDouble(app, "--gamma1", o.gamma1, 1e-6, 1e6,
            "Equation 3: exponent of facing a face; higher prefers cameras that "
            "face the surface");
  addDouble(app, "--soft", o.softPx, 1e-3, 1e3, "Width of the fade of a photograph at edges of the object, px");
}

}  // namespace

void declareHtmBuildOptions(CLI::App& app, HtmBuildChoices& choices) {
  addOption(app, "--exclude", choices.build.exclude, "Photographs to leave out, by name in the model").type("NAME");
  addInt(app, "--max-size", choices.build.maxSize, 0, 65536,
         "Longest side of the stored photographs, px; 0: unchanged");
  addChoice<bool>(app, "--match", choices.matchOnDevice, {{"processor", false}, {"device", true}},
                  "Hardware that matches photographs at vertices, with the same result: CPU or Vulkan device "
                  "[processor]");
  declareHtmOptions(app, choices.build.optimise);
}

std::unique_ptr<Device> prepare(HtmBuildOptions& build, const HtmBuildChoices& choices, const Context& context) {
  build.optimise = withThreads(build.optimise, context);
  if (!choices.matchOnDevice) return nullptr;
  auto device = std::make_unique<Device>(Device::create({.device = context.options().device, .log = context.log()}));
  build.optimise.search = deviceTemplateSearch(*device);
  return device;
}

HtmOptions withThreads(HtmOptions options, const Context& context) {
  options.threads = context.options().threads;
  return options;
}

}  // namespace ibr::app
