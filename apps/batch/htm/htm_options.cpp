// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_options.h"

#include "ibr/template_search_pass.h"
#include "shared/cli/options.h"

namespace ibr::app {

namespace {

void declareHtmOptions(CLI::App& app, HtmOptions& o) {
  addCount<std::size_t>(app, "--faces", o.faces, 0, 100000000, "The mesh is reduced to so many faces; 0: not by shape");
  addInt(app, "--adjust", o.adjustRounds, 0, 16,
         "Rounds in which cameras and shape settle on what pictures agree on; 0: as they are given, the paper's way");
  app.add_flag_callback(
      "--keep-shape", [&o] { o.reshape = false; }, "Vertices stay where they are in these rounds");
  addChoice<TemplateMeasure>(
      app, "--measure", o.measure,
      {{"sad", TemplateMeasure::absoluteDifferences}, {"ncc", TemplateMeasure::correlation}},
      "How textures are compared: mean absolute differences, or correlation, which light does not change [sad]");
  addDouble(app, "--radius", o.radius, 1, 2 * kLargestTemplateRadius,
            "px that are searched around each vertex at first");
  addDouble(app, "--later-radius", o.laterRadius, 1, 2 * kLargestTemplateRadius, "px that are searched from then on");
  addDouble(app, "--least-texture", o.leastTexture, 0, 255,
            "Levels per px: directions in which colours change less are not matched");
  addDouble(app, "--smoothness", o.smoothness, 0, 1e6,
            "1/px^2: how alike neighbours' complements are; 0: as matched, the paper's way");
  addDouble(
      app, "--complement-px", o.complementPx, 0, 1e6,
      "px that complements are expected to be long, unless matches say more; 0: anything. None with --smoothness 0");
  addDouble(app, "--inconsistent-size", o.inconsistentSize, 0, 1e6,
            "Inconsistent faces are merged until they are so many mean faces large; 0: not");
  addDouble(app, "--inconsistent-difference", o.inconsistentDifference, 0, 255,
            "Levels of D_f from which a face is inconsistent");
  addDouble(app, "--inconsistent-share", o.inconsistentShare, 0, 1, "Of the faces: most that are merged");
  addInt(app, "--rounds", o.rounds, 1, 16, "Rounds of matching; before each but the first, faces are divided");
  addDouble(app, "--mean-difference", o.meanDifference, 0, 255, "Levels of D_f on average at which dividing ends");
  addDouble(app, "--face-difference", o.faceDifference, 0, 255, "Levels of D_f from which a face is divided");
  addDouble(app, "--least-face", o.leastFacePx, 0, 1e12, "px^2 in its best camera: smaller faces are not divided");
  addCount<std::size_t>(app, "--most-faces", o.mostFaces, 1, 100000000, "No further round begins beyond so many faces");
  app.add_flag_callback(
      "--no-self-occluded", [&o] { o.selfOccluded = false; }, "Faces that are partly hidden are not divided for that");
  app.add_flag_callback(
      "--no-reject", [&o] { o.reject = false; }, "Cameras that do not agree take part all the same");
  addDouble(app, "--reject-difference", o.rejectDifference, 0, 255,
            "Levels beyond which two cameras do not agree on a vertex, unless …");
  addDouble(app, "--reject-correlation", o.rejectCorrelation, -1, 1, "… their colours are correlated by so much");
  addDouble(app, "--alpha", o.alpha, 0, 1, "Eq. 2: what facing a face counts against its size");
  addDouble(app, "--gamma1", o.gamma1, 1e-6, 1e6, "Eq. 3: how much facing counts");
  addDouble(app, "--soft", o.softPx, 1e-3, 1e3, "px over which a picture fades at edges of the object");
}

}  // namespace

void declareHtmBuildOptions(CLI::App& app, HtmBuildChoices& choices) {
  app.add_option("--exclude", choices.build.exclude, "Photographs to leave out, by their names in the model")
      ->type_name("NAME");
  addInt(app, "--max-size", choices.build.maxSize, 0, 65536, "Longest side of the stored photographs; 0: as they are");
  addChoice<bool>(app, "--match", choices.matchOnDevice, {{"processor", false}, {"device", true}},
                  "Who searches for what photographs show at a vertex; both find the same [processor]");
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
