// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_depths.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "author/backdrop/backdrop.h"
#include "author/build/backdrop_maker.h"
#include "author/build/depth_matcher.h"
#include "author/build/sweep_plan.h"
#include "author/geometry/posed_model.h"

namespace ibr {

double storedResidualPx(const BuildInput& input) {
  if (input.photographs.empty()) return 0;
  const double scale =
      double(input.photographs[0].camera.intrinsics.width) / double(input.model.images[0].camera.intrinsics.width);
  return scale * reprojectionError(input.model);
}

std::vector<PhotographDepth> confirmDepths(const BuildInput& input, DepthSearch search, const MatchedViews& matched,
                                           const BuildJobs& jobs) {
  constexpr double kFaceShare = 0.5;  // share of a panorama's pixels: one face and its part of the whole
  double pixels = 0;
  for (const Photograph& photo : input.photographs) {
    const glm::ivec2 size = backdropSize(photo.camera.intrinsics);
    pixels = std::max(pixels, (isPanorama(photo) ? kFaceShare : 1) * finePixelFactor(search) * size.x * size.y);
  }
  std::size_t run = 0;
  std::vector<Camera> cameras;
  for (const Photograph& photo : input.photographs) cameras.push_back(photo.camera);
  return depthOfPhotographs(
      cameras,
      {.matches = matched.matches,
       .points = matched.points,
       .residualPx = matched.residualPx,
       .depths =
           [&](std::size_t count, const auto& job) {
             jobs.runAll("finding depth", count, matched.bytesToMatch, job, kDepthBytesPerPixel * pixels);
           },
       .evidence =
           [&](std::size_t count, const auto& job) {
             constexpr std::array kStages{"choosing depth sources", "confirming depth", "finding contradictions"};
             static_assert(kStages.size() == kEvidenceRuns);
             jobs.runAll(kStages[run++], count, 1, job);
           }});
}

std::vector<PhotographDepth> findDepths(const BuildInput& input, DepthSearch search, const BuildOptions& options,
                                        const BuildJobs& jobs) {
  const SweepPlan plan(input);
  DepthMatcher matcher(
      input, [&](std::size_t view) { return plan.sweep(view); }, search, buildCacheFolder(options));
  std::vector<std::uint32_t> all(input.photographs.size());
  std::iota(all.begin(), all.end(), 0u);
  matcher.read(all, jobs);
  return confirmDepths(input, search,
                       {.matches = [&](std::size_t view) { return matcher.match(view); },
                        .points = [&](std::uint32_t photograph) { return pointsSeenBy(input, photograph); },
                        .residualPx = storedResidualPx(input),
                        .bytesToMatch = matcher.bytesToMatch()},
                       jobs);
}

}  // namespace ibr
