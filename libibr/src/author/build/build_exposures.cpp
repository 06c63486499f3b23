// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_exposures.h"

#include <utility>

#include "author/build/stored_photographs.h"
#include "author/exposure/exposure.h"
#include "author/exposure/vignetting.h"

namespace ibr {
namespace {

// Fits vignetting to `matches` and removes it from the stored photographs. Returns a description for people.
std::string removeVignetting(BuildInput& input, std::vector<ExposureMatch>& matches, const BuildOptions& options,
                             const BuildJobs& jobs) {
  const std::vector<std::uint32_t> lenses = lensIndices(input.photographs);
  const std::vector<glm::dvec2> vignetting = solveVignetting(input.photographs.size(), matches, lenses);
  jobs.runAll("removing vignetting", vignetting.size(), bytesToStoreOne(input), [&](std::size_t n) {
    if (isNegligible(vignetting[n])) return;
    Photograph& photo = input.photographs[n];
    replaceStored(photo, unvignetted(loadPhotograph(photo), photo.camera.intrinsics, vignetting[n]), options.output,
                  options.texture);
  });
  matches = withoutVignetting(std::move(matches), vignetting);
  return describeVignetting(vignetting, lenses);
}

}  // namespace

BuildReport::ExposureSummary measureExposures(BuildInput& input, std::vector<Node>& nodes,
                                              const std::vector<PhotographDepth>& depths, const BuildOptions& options,
                                              const BuildJobs& jobs) {
  BuildReport::ExposureSummary summary;
  if (!options.matchExposures && !options.fitVignetting) return summary;
  std::vector<ExposureMatch> matches = exposureMatches(input.photographs, input.model, depths, jobs);
  if (options.fitVignetting) summary.vignetting = removeVignetting(input, matches, options, jobs);
  if (!options.matchExposures) return summary;
  std::vector<CaptureMetadata> exif;
  for (const Photograph& photo : input.photographs) exif.push_back(photo.capture);
  jobs.step("solving exposures", 0, 1);
  const Exposures exposures = solveExposures(input.photographs.size(), matches, exif);
  for (std::size_t n = 0; n < exposures.gains.size(); ++n) nodes[n].gain = exposures.gains[n];
  summary.measured = exposures.measured;
  summary.parts = exposures.parts;
  summary.alike = exposures.alike;
  summary.text = describeExposures(exposures);
  return summary;
}

}  // namespace ibr
