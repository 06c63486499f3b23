// SPDX-License-Identifier: Apache-2.0
#include "author/match/matcher_choice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"
#include "author/match/match_flow.h"
#include "author/match/match_homographic.h"
#include "author/match/ranges.h"

namespace ibr {

double cellReprojectionError(const PosedModel& model, std::span<const std::uint32_t> members,
                             std::span<const Camera> cameras, std::span<const std::uint32_t> tracks) {
  std::vector<double> errors;
  for (const std::uint32_t t : tracks) {
    const Track& track = model.tracks[t];
    std::vector<Camera> seeing;
    std::vector<glm::dvec2> pixels;
    for (const TrackObservation& o : track.observations) {
      const auto member = std::ranges::find(members, o.image);
      if (member == members.end()) continue;
      seeing.push_back(cameras[std::size_t(member - members.begin())]);
      const Intrinsics &k = seeing.back().intrinsics, &own = model.images[o.image].camera.intrinsics;
      pixels.push_back(o.pixel * glm::dvec2(double(k.width) / own.width, double(k.height) / own.height));
    }
    if (seeing.size() < 2) continue;
    const double start = inverseDepth(seeing[0], track.position);
    if (!(start > 0) || !std::isfinite(start)) continue;
    errors.push_back(triangulate(seeing[0], seeing, pixels, {start, start}, 1.0).residualPx);
  }
  return errors.empty() ? std::numeric_limits<double>::infinity() : median(errors);
}

MatchMethod resolveMatcher(MatchMethod wanted, double reprojectionPx) {
  if (wanted != MatchMethod::automatic) return wanted;
  return reprojectionPx <= kMaxSweepErrorPx ? MatchMethod::sweep : MatchMethod::flow;
}

DenseMatch matchCell(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                     const CellMatchOptions& options) {
  switch (options.matcher) {
    case MatchMethod::flow:
      return matchByFlow(views);
    case MatchMethod::homographic:
      return matchByHomographies(views, {options.posesUsable, options.posesUsable && !options.refine, options.seed});
    default:
      return matchViews(views, points, {options.refine, options.depths});
  }
}

}  // namespace ibr
