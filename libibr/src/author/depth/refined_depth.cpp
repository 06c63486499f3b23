// SPDX-License-Identifier: Apache-2.0
#include "author/depth/refined_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "author/depth/patch_cost.h"

namespace ibr {
namespace {

constexpr std::size_t kMaxAgreeingSources = 5;
constexpr float kMaxAgreeingCost = 1;                     // cost from which a source counts as not agreeing
constexpr std::array kLevelOffsets{0.35f, 0.18f, 0.09f};  // of a level, by scan
constexpr float kMaxSlopeChange = 0.25f;      // max change of slope per fine px, relative to the scan's move
constexpr float kMaxSurfaceStep = 1.5f;       // max levels between neighbours of one surface
constexpr float kMinPlaneDifference = 0.02f;  // levels; planes that differ by less are treated as equal
constexpr float kMinGain = 0.004f, kMaxCost = 0.42f;
constexpr int kCostRadius = 2;

struct AgreeingSources {
  std::array<std::uint8_t, kMaxAgreeingSources> source{};
  std::uint8_t count = 0;
};

// Deterministic noise, −1 to 1.
float noise(std::size_t pixel, std::size_t scan, std::uint32_t axis) {
  std::uint32_t h = std::uint32_t(pixel) * 2654435761u + std::uint32_t(scan) * 40503u + axis * 2246822519u;
  h = (h ^ (h >> 15)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return float(h ^ (h >> 16)) * (2.0f / 4294967295.0f) - 1.0f;
}

class Refiner {
 public:
  Refiner(const SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources)
      : swept_(depth.inverseDepth),
        grey_(photograph.grey),
        level_(depth.level),
        scale_(float(grey_.width) / float(swept_.width), float(grey_.height) / float(swept_.height)),
        sources_(patchSources(photograph.camera, sources)),
        planes_(swept_.values.size()),
        cost_(swept_.values.size()),
        agreeing_(swept_.values.size()) {
    for (int y = 0; y < swept_.height; ++y)
      for (int x = 0; x < swept_.width; ++x) {
        const std::size_t p = at(x, y);
        planes_[p] = {swept_.values[p], glm::vec2(slope(x, y, {1, 0}), slope(x, y, {0, 1})) / scale_};
        if (swept_.values[p] >= 0 && !depth.sky.values[p]) chooseSources(x, y);
      }
  }

  ImageF run() {
    for (std::size_t scan = 0; scan < kLevelOffsets.size(); ++scan) {
      const bool forward = scan % 2 == 0;
      const int before = forward ? -1 : 1;
      for (int j = 0; j < swept_.height; ++j)
        for (int i = 0; i < swept_.width; ++i) {
          const int x = forward ? i : swept_.width - 1 - i, y = forward ? j : swept_.height - 1 - j;
          if (isRefined(x, y)) visit(x, y, scan, before);
        }
    }
    ImageF result = swept_;
    for (int y = 0; y < swept_.height; ++y)
      for (int x = 0; x < swept_.width; ++x)
        if (isRefined(x, y) && meanCost(x, y) <= kMaxCost) result.pixel(x, y)[0] = planes_[at(x, y)].inverseDepth;
    return result;
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(swept_.width) + std::size_t(x); }
  bool isInside(int x, int y) const { return x >= 0 && y >= 0 && x < swept_.width && y < swept_.height; }
  glm::vec2 middleOf(int x, int y) const { return (glm::vec2(x, y) + 0.5f) * scale_; }
  bool isRefined(int x, int y) const { return agreeing_[at(x, y)].count > 0; }

  // Slope of the swept depth per px, from neighbours on the same surface.
  float slope(int x, int y, glm::ivec2 along) const {
    const float here = swept_.values[at(x, y)];
    float sum = 0;
    int count = 0;
    for (const int side : {-1, 1}) {
      const int u = x + side * along.x, v = y + side * along.y;
      if (!isInside(u, v)) continue;
      const float there = swept_.values[at(u, v)];
      if (there < 0 || std::abs(there - here) > kMaxSurfaceStep * level_) continue;
      sum += float(side) * (there - here);
      ++count;
    }
    return count > 0 ? sum / float(count) : 0;
  }

  void chooseSources(int x, int y) {
    const std::size_t p = at(x, y);
    const Patch patch = patchAt(grey_, middleOf(x, y));
    std::vector<std::pair<float, std::uint8_t>> costs;
    for (std::size_t s = 0; s < sources_.size(); ++s)
      if (const float cost = patchCost(sources_[s], patch, planes_[p]); cost < kMaxAgreeingCost)
        costs.emplace_back(cost, s);
    std::sort(costs.begin(), costs.end());
    AgreeingSources& agreeing = agreeing_[p];
    agreeing.count = std::uint8_t(std::min(costs.size(), kMaxAgreeingSources));
    for (std::size_t k = 0; k < agreeing.count; ++k) agreeing.source[k] = costs[k].second;
    if (agreeing.count > 0) cost_[p] = costOf(agreeing, patch, planes_[p], std::numeric_limits<float>::infinity());
  }

  // Stops early once the cost certainly exceeds `most`, and then returns a lower bound above `most`.
  float costOf(const AgreeingSources& agreeing, const Patch& patch, const DepthPlane& plane, float most) const {
    const std::size_t better = (2 * std::size_t(agreeing.count) + 2) / 3, left = agreeing.count - better;
    std::array<float, kMaxAgreeingSources> ascending{};
    for (std::size_t k = 0; k < agreeing.count; ++k) {
      float cost = patchCost(sources_[agreeing.source[k]], patch, plane);
      for (std::size_t i = 0; i < k; ++i)
        if (cost < ascending[i]) std::swap(cost, ascending[i]);
      ascending[k] = cost;
      float least = 0;  // sum of costs that remain among the better ones in any case
      for (std::size_t i = 0; i + left <= k; ++i) least += ascending[i];
      if (least > most * float(better)) return least / float(better);
    }
    float sum = 0;
    for (std::size_t k = 0; k < better; ++k) sum += ascending[k];
    return sum / float(better);
  }

  void visit(int x, int y, std::size_t scan, int before) {
    const std::size_t p = at(x, y);
    const Patch patch = patchAt(grey_, middleOf(x, y));
    const auto attempt = [&](const DepthPlane& plane) {
      if (!(plane.inverseDepth >= 0)) return;
      const float most = cost_[p] - kMinGain, cost = costOf(agreeing_[p], patch, plane, most);
      if (!(cost < most)) return;
      cost_[p] = cost;
      planes_[p] = plane;
    };
    const auto continued = [&](int u, int v) {
      if (!isInside(u, v) || !isRefined(u, v)) return;
      DepthPlane plane = planes_[at(u, v)];
      plane.inverseDepth += glm::dot(plane.slope, scale_ * glm::vec2(x - u, y - v));
      if (!isSame(plane, planes_[p])) attempt(plane);
    };
    continued(x + before, y);
    continued(x, y + before);
    const float move = kLevelOffsets[scan] * level_;
    for (const float way : {-move, move}) attempt({planes_[p].inverseDepth + way, planes_[p].slope});
    attempt({planes_[p].inverseDepth,
             planes_[p].slope + kMaxSlopeChange * move * glm::vec2(noise(p, scan, 0), noise(p, scan, 1))});
  }

  bool isSame(const DepthPlane& a, const DepthPlane& b) const {
    const float turned = float(kPatchSpacing) * (std::abs(a.slope.x - b.slope.x) + std::abs(a.slope.y - b.slope.y));
    return std::abs(a.inverseDepth - b.inverseDepth) + turned < kMinPlaneDifference * level_;
  }

  float meanCost(int x, int y) const {
    float sum = 0;
    int count = 0;
    for (int v = y - kCostRadius; v <= y + kCostRadius; ++v)
      for (int u = x - kCostRadius; u <= x + kCostRadius; ++u) {
        if (!isInside(u, v) || !isRefined(u, v)) continue;
        sum += cost_[at(u, v)];
        ++count;
      }
    return sum / float(count);
  }

  const ImageF &swept_, &grey_;
  float level_;
  glm::vec2 scale_;  // px of the fine image per px of the depth map
  std::vector<PatchSource> sources_;
  std::vector<DepthPlane> planes_;
  std::vector<float> cost_;
  std::vector<AgreeingSources> agreeing_;
};

}  // namespace

void refineDepth(SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources) {
  depth.inverseDepth = Refiner(depth, photograph, sources).run();
}

}  // namespace ibr
