// SPDX-License-Identifier: Apache-2.0
#include "author/depth/refined_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "author/geometry/mean_frame.h"

namespace ibr {
namespace {

constexpr int kSide = 5, kApart = 2;  // samples of a patch: along a side, and px from one to the next
constexpr std::size_t kSamples = std::size_t(kSide) * kSide;
constexpr float kColour = 25;  // grey levels over which a sample's weight falls to 1/e
constexpr float kNoise = 4;    // variance that is not texture
constexpr std::size_t kAgreeing = 5;
constexpr float kUnlike = 1;                       // cost from which on a source does not agree
constexpr std::array kMoves{0.35f, 0.18f, 0.09f};  // of a level, by scan
constexpr float kTurn = 0.25f;                     // change of slope a fine px, of a scan's move
constexpr float kSurface = 1.5f;                   // levels between neighbours of one surface
constexpr float kSame = 0.02f;                     // levels by which planes differ that are not told apart
constexpr float kLeastGain = 0.004f, kMostCost = 0.42f;
constexpr int kCostRadius = 2;

// Where the samples of a patch are, in its spacing from its middle.
constexpr std::array<float, kSamples> offsets(bool down) {
  std::array<float, kSamples> result{};
  for (std::size_t k = 0; k < kSamples; ++k) result[k] = float(int(down ? k / kSide : k % kSide) - kSide / 2);
  return result;
}
constexpr std::array<float, kSamples> kAcross = offsets(false), kDown = offsets(true);

struct Plane {
  float inverseDepth;  // in the middle of the pixel
  glm::vec2 slope;     // its change a px of the fine picture
};

// A fine picture's samples around the middle of a pixel, which the sources' are compared with.
struct Patch {
  glm::vec2 middle;                          // px of the fine picture
  glm::vec2 off;                             // from the middle of the depth's pixel
  std::array<float, kSamples> weight, from;  // sum 1; weight · difference from the mean
  float variance;
};

struct Source {
  glm::mat3 a;  // as FrameToMember
  glm::vec3 b;
  const SweepView* view;
};

struct Agreeing {
  std::array<std::uint8_t, kAgreeing> who{};
  std::uint8_t count = 0;
};

// −1 to 1.
float noise(std::size_t pixel, std::size_t scan, std::uint32_t axis) {
  std::uint32_t h = std::uint32_t(pixel) * 2654435761u + std::uint32_t(scan) * 40503u + axis * 2246822519u;
  h = (h ^ (h >> 15)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return float(h ^ (h >> 16)) * (2.0f / 4294967295.0f) - 1.0f;
}

// 1 − ZNCC of a patch and what the source shows of its plane; 2 where it does not see it in full.
float costIn(const Source& source, const Patch& patch, const Plane& plane) {
  const float inverseDepth = plane.inverseDepth + glm::dot(plane.slope, patch.off);
  const glm::vec3 middle = source.a * glm::vec3(patch.middle, 1) + inverseDepth * source.b,
                  right = float(kApart) * (source.a[0] + plane.slope.x * source.b),
                  down = float(kApart) * (source.a[1] + plane.slope.y * source.b);
  constexpr float kHalf = kSide / 2;
  if (!(middle.z > kHalf * (std::abs(right.z) + std::abs(down.z)))) return 2;
  std::array<float, kSamples> u, v, value;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const float z = 1 / (middle.z + kAcross[k] * right.z + kDown[k] * down.z);
    u[k] = (middle.x + kAcross[k] * right.x + kDown[k] * down.x) * z - 0.5f;
    v[k] = (middle.y + kAcross[k] * right.y + kDown[k] * down.y) * z - 0.5f;
  }
  const ImageF& grey = source.view->grey;
  const float wide = float(grey.width - 1), high = float(grey.height - 1);
  for (const std::size_t corner : {std::size_t(0), std::size_t(kSide - 1), kSamples - kSide, kSamples - 1})
    if (!(u[corner] >= 0 && v[corner] >= 0 && u[corner] < wide && v[corner] < high)) return 2;
  const Image8& mask = source.view->mask;
  if (!mask.empty() && !mask.pixel(int(u[kSamples / 2] + 0.5f), int(v[kSamples / 2] + 0.5f))[0]) return 2;
  const std::ptrdiff_t row = grey.width;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const int x = int(u[k]), y = int(v[k]);
    const float right_ = u[k] - float(x), down_ = v[k] - float(y);
    const float* const p = grey.values.data() + y * row + x;
    const float top = p[0] + right_ * (p[1] - p[0]), bottom = p[row] + right_ * (p[row + 1] - p[row]);
    value[k] = top + down_ * (bottom - top);
  }
  float mean = 0, square = 0, product = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    mean += patch.weight[k] * value[k];
    square += patch.weight[k] * value[k] * value[k];
    product += patch.from[k] * value[k];
  }
  return 1 - product / std::sqrt(patch.variance * (std::max(square - mean * mean, 0.0f) + kNoise));
}

class Refiner {
 public:
  Refiner(const SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources)
      : swept_(depth.inverseDepth),
        grey_(photograph.grey),
        level_(depth.level),
        scale_(float(grey_.width) / float(swept_.width), float(grey_.height) / float(swept_.height)),
        planes_(swept_.values.size()),
        cost_(swept_.values.size()),
        agreeing_(swept_.values.size()) {
    for (const SweepView& source : sources) {
      const FrameToMember map = frameToMember(photograph.camera, source.camera);
      sources_.push_back({glm::mat3(map.a), glm::vec3(map.b), &source});
    }
    for (int y = 0; y < swept_.height; ++y)
      for (int x = 0; x < swept_.width; ++x) {
        const std::size_t p = at(x, y);
        planes_[p] = {swept_.values[p], glm::vec2(slope(x, y, {1, 0}), slope(x, y, {0, 1})) / scale_};
        if (swept_.values[p] >= 0 && !depth.sky.values[p]) chooseSources(x, y);
      }
  }

  ImageF run() {
    for (std::size_t scan = 0; scan < kMoves.size(); ++scan) {
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
        if (isRefined(x, y) && meanCost(x, y) <= kMostCost) result.pixel(x, y)[0] = planes_[at(x, y)].inverseDepth;
    return result;
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(swept_.width) + std::size_t(x); }
  bool isInside(int x, int y) const { return x >= 0 && y >= 0 && x < swept_.width && y < swept_.height; }
  bool isRefined(int x, int y) const { return agreeing_[at(x, y)].count > 0; }

  // Change of the swept depth a px, from the neighbours on the same surface.
  float slope(int x, int y, glm::ivec2 along) const {
    const float here = swept_.values[at(x, y)];
    float sum = 0;
    int count = 0;
    for (const int side : {-1, 1}) {
      const int u = x + side * along.x, v = y + side * along.y;
      if (!isInside(u, v)) continue;
      const float there = swept_.values[at(u, v)];
      if (there < 0 || std::abs(there - here) > kSurface * level_) continue;
      sum += float(side) * (there - here);
      ++count;
    }
    return count > 0 ? sum / float(count) : 0;
  }

  Patch patchAt(int x, int y) const {
    const glm::vec2 pixel = (glm::vec2(x, y) + 0.5f) * scale_;
    const glm::ivec2 nearest = glm::min(glm::ivec2(pixel), glm::ivec2(grey_.width, grey_.height) - 1);
    Patch patch;
    patch.middle = glm::vec2(nearest) + 0.5f;
    patch.off = patch.middle - pixel;
    std::array<float, kSamples> value;
    float sum = 0, mean = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const int u = nearest.x + kApart * (int(k % kSide) - kSide / 2),
                v = nearest.y + kApart * (int(k / kSide) - kSide / 2);
      value[k] = grey_.pixel(std::clamp(u, 0, grey_.width - 1), std::clamp(v, 0, grey_.height - 1))[0];
    }
    for (std::size_t k = 0; k < kSamples; ++k) {
      patch.weight[k] = std::exp(-std::abs(value[k] - value[kSamples / 2]) / kColour);
      sum += patch.weight[k];
      mean += patch.weight[k] * value[k];
    }
    mean /= sum;
    patch.variance = kNoise;
    for (std::size_t k = 0; k < kSamples; ++k) {
      patch.weight[k] /= sum;
      patch.from[k] = patch.weight[k] * (value[k] - mean);
      patch.variance += patch.from[k] * (value[k] - mean);
    }
    return patch;
  }

  void chooseSources(int x, int y) {
    const std::size_t p = at(x, y);
    const Patch patch = patchAt(x, y);
    std::vector<std::pair<float, std::uint8_t>> costs;
    for (std::size_t s = 0; s < sources_.size(); ++s)
      if (const float cost = costIn(sources_[s], patch, planes_[p]); cost < kUnlike) costs.emplace_back(cost, s);
    std::sort(costs.begin(), costs.end());
    Agreeing& agreeing = agreeing_[p];
    agreeing.count = std::uint8_t(std::min(costs.size(), kAgreeing));
    for (std::size_t k = 0; k < agreeing.count; ++k) agreeing.who[k] = costs[k].second;
    if (agreeing.count > 0) cost_[p] = costOf(agreeing, patch, planes_[p], std::numeric_limits<float>::infinity());
  }

  // `most`: where the cost is certainly more, something above it is enough.
  float costOf(const Agreeing& agreeing, const Patch& patch, const Plane& plane, float most) const {
    const std::size_t better = (2 * std::size_t(agreeing.count) + 2) / 3, left = agreeing.count - better;
    std::array<float, kAgreeing> ascending{};
    for (std::size_t k = 0; k < agreeing.count; ++k) {
      float cost = costIn(sources_[agreeing.who[k]], patch, plane);
      for (std::size_t i = 0; i < k; ++i)
        if (cost < ascending[i]) std::swap(cost, ascending[i]);
      ascending[k] = cost;
      float least = 0;  // of what is among the better whatever follows
      for (std::size_t i = 0; i + left <= k; ++i) least += ascending[i];
      if (least > most * float(better)) return least / float(better);
    }
    float sum = 0;
    for (std::size_t k = 0; k < better; ++k) sum += ascending[k];
    return sum / float(better);
  }

  void visit(int x, int y, std::size_t scan, int before) {
    const std::size_t p = at(x, y);
    const Patch patch = patchAt(x, y);
    const auto attempt = [&](const Plane& plane) {
      if (!(plane.inverseDepth >= 0)) return;
      const float most = cost_[p] - kLeastGain, cost = costOf(agreeing_[p], patch, plane, most);
      if (!(cost < most)) return;
      cost_[p] = cost;
      planes_[p] = plane;
    };
    const auto continued = [&](int u, int v) {
      if (!isInside(u, v) || !isRefined(u, v)) return;
      Plane plane = planes_[at(u, v)];
      plane.inverseDepth += glm::dot(plane.slope, scale_ * glm::vec2(x - u, y - v));
      if (!isSame(plane, planes_[p])) attempt(plane);
    };
    continued(x + before, y);
    continued(x, y + before);
    const float move = kMoves[scan] * level_;
    for (const float way : {-move, move}) attempt({planes_[p].inverseDepth + way, planes_[p].slope});
    attempt(
        {planes_[p].inverseDepth, planes_[p].slope + kTurn * move * glm::vec2(noise(p, scan, 0), noise(p, scan, 1))});
  }

  bool isSame(const Plane& a, const Plane& b) const {
    const float turned = float(kApart) * (std::abs(a.slope.x - b.slope.x) + std::abs(a.slope.y - b.slope.y));
    return std::abs(a.inverseDepth - b.inverseDepth) + turned < kSame * level_;
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
  glm::vec2 scale_;  // px of the fine picture a px of the depth
  std::vector<Source> sources_;
  std::vector<Plane> planes_;
  std::vector<float> cost_;
  std::vector<Agreeing> agreeing_;
};

}  // namespace

void refineDepth(SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources) {
  depth.inverseDepth = Refiner(depth, photograph, sources).run();
}

}  // namespace ibr
