// SPDX-License-Identifier: Apache-2.0
#include "render/plan/backdrop_choice.h"

#include <algorithm>
#include <bitset>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace ibr {
namespace {

constexpr std::size_t kColumns = 12, kRows = 9, kDistances = 2, kMostViews = 2;
constexpr std::size_t kMostJudged = 128;  // candidates; those beyond are too far away to be worth the time

using Shown = std::bitset<kColumns * kRows * kDistances * kMostViews>;

Shown shownBy(const Node& node, const CellBounds& bounds, std::span<const Camera> views) {
  Shown shown;
  const Camera& camera = node.camera;
  const Intrinsics& k = camera.intrinsics;
  std::size_t bit = 0;
  for (const Camera& view : views) {
    const glm::dmat3 turn = glm::mat3_cast(glm::conjugate(camera.pose.rotation) * view.pose.rotation);
    const glm::dvec3 shift = glm::conjugate(camera.pose.rotation) * (view.pose.position - camera.pose.position);
    const Intrinsics& v = view.intrinsics;
    for (std::size_t row = 0; row < kRows; ++row)
      for (std::size_t column = 0; column < kColumns; ++column) {
        const double x = v.width * double(column) / double(kColumns - 1),
                     y = v.height * double(row) / double(kRows - 1);
        const glm::dvec3 ray = turn * glm::dvec3((x - v.cx) / v.fx, (v.cy - y) / v.fy, -1);
        for (const float inverseDistance : {bounds.farInverseDistance, bounds.nearInverseDistance}) {
          const auto pixel = project(k, ray + double(inverseDistance) * shift);
          shown[bit++] = pixel && pixel->x >= 0 && pixel->y >= 0 && pixel->x <= k.width && pixel->y <= k.height;
        }
      }
  }
  return shown;
}

}  // namespace

std::vector<std::uint32_t> chooseBackdrops(const Scene& scene, const SceneBounds& bounds, std::span<const Camera> views,
                                           std::span<const BackdropCandidate> candidates, std::size_t most) {
  std::vector<bool> chosen(candidates.size(), false);
  std::size_t count = std::min(candidates.size(), candidates.size() > most ? (most + 1) / 2 : most);
  std::fill_n(chosen.begin(), count, true);
  if (count < most && count < candidates.size()) {
    std::vector<Shown> shown;
    for (const BackdropCandidate& candidate :
         candidates.first(std::min(candidates.size(), std::max(kMostJudged, count))))
      shown.push_back(shownBy(scene.nodes[scene.backdrops[candidate.backdrop].members[0]],
                              bounds.backdrops[candidate.backdrop], views));
    Shown open;
    for (std::size_t c = 0; c < count; ++c) open |= shown[c];
    open.flip();
    for (; count < most; ++count) {
      std::size_t best = shown.size(), gain = 0;
      for (std::size_t c = 0; c < shown.size(); ++c)
        if (const std::size_t adds = (shown[c] & open).count(); !chosen[c] && adds > gain) best = c, gain = adds;
      if (best == shown.size()) break;
      chosen[best] = true;
      open &= ~shown[best];
    }
  }
  for (std::size_t c = 0; c < candidates.size() && count < most; ++c)
    if (!chosen[c]) chosen[c] = true, ++count;
  std::vector<std::uint32_t> result;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    if (chosen[c]) result.push_back(candidates[c].backdrop);
  return result;
}

}  // namespace ibr
