// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/label.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "author/photographs/masks.h"
#include "image/ecc_sums.h"

namespace ibr {
namespace {

// Thresholds of the best filter against ground truth (precision .97, recall .96 to .98 by area), relaxed: a rejected
// triangle leaves a hole or one member's image, which is worse than slight blur.
constexpr float kMinEcc = 0.6f;
constexpr float kMaxTexturelessRms = 16.0f;  // RMS below which a triangle may lack texture to correlate
constexpr float kMaxRms = 24.0f;
constexpr float kMaxOffShare = 0.3f;
constexpr float kOffPx = 1.5f;
constexpr float kFarOffPx = 3.0f;  // off however similar: from outside the cell such errors show, as a roof in the sky
constexpr double kMaxHiddenDifference =
    16.0;                                // mean over channels, 8-bit levels: a smaller difference hides a wrong match
constexpr double kNoiseVariance = 25.0;  // grey², added to variances and covariance

constexpr std::size_t kMaxPairs = kMaxMembers * (kMaxMembers - 1) / 2;
constexpr std::size_t kMinSamples = 6;  // triangles with fewer pixel centres inside use a lattice of samples

// Maps v ↦ gain·v + offset per channel, to the mean of all members.
struct Exposure {
  glm::vec3 gain{1.0f}, offset{0.0f};
};

glm::vec3 sampled(const Image8& picture, glm::vec2 at) {
  const float x = std::clamp(at.x - 0.5f, 0.0f, float(picture.width - 1));
  const float y = std::clamp(at.y - 0.5f, 0.0f, float(picture.height - 1));
  const int ix = std::min(int(x), std::max(picture.width - 2, 0)),
            iy = std::min(int(y), std::max(picture.height - 2, 0));
  const int jx = std::min(ix + 1, picture.width - 1), jy = std::min(iy + 1, picture.height - 1);
  const float fx = x - float(ix), fy = y - float(iy);
  const auto texel = [&](int u, int v) {
    const std::uint8_t* const p = &picture.values[3 * (std::size_t(v) * std::size_t(picture.width) + std::size_t(u))];
    return glm::vec3(p[0], p[1], p[2]);
  };
  return glm::mix(glm::mix(texel(ix, iy), texel(jx, iy), fx), glm::mix(texel(ix, jy), texel(jx, jy), fx), fy);
}

// Means and spreads of each member's colours at the same points.
class ExposureSums {
 public:
  explicit ExposureSums(std::size_t members) : mean_(members, glm::dvec3(0.0)), square_(mean_) {}

  void add(std::span<const glm::dvec3> colours) {
    ++count_;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      mean_[i] += colours[i];
      square_[i] += colours[i] * colours[i];
    }
  }
  std::vector<Exposure> result() const {
    constexpr double kMinSamplesForExposure = 100;
    const std::size_t d = mean_.size();
    std::vector<Exposure> result(d);
    if (count_ < kMinSamplesForExposure) return result;
    std::vector<glm::dvec3> mean, spread;
    glm::dvec3 commonMean(0.0), commonSpread(0.0);
    for (std::size_t i = 0; i < d; ++i) {
      mean.push_back(mean_[i] / count_);
      spread.push_back(glm::sqrt(glm::max(square_[i] / count_ - mean[i] * mean[i], glm::dvec3(1.0))));
      commonMean += mean[i] / double(d);
      commonSpread += spread[i] / double(d);
    }
    for (std::size_t i = 0; i < d; ++i) {
      result[i].gain = glm::clamp(commonSpread / spread[i], 0.25, 4.0);
      result[i].offset = glm::vec3(commonMean) - result[i].gain * glm::vec3(mean[i]);
    }
    return result;
  }

 private:
  double count_ = 0;
  std::vector<glm::dvec3> mean_, square_;  // sums
};

std::vector<Exposure> exposures(std::span<const MatchView> views, const DenseMatch& match) {
  ExposureSums sums(views.size());
  std::array<glm::dvec3, kMaxMembers> colour;
  constexpr int kStride = 3;
  for (int y = 0; y < match.good.height; y += kStride)
    for (int x = 0; x < match.good.width; x += kStride) {
      const std::size_t at = std::size_t(y) * std::size_t(match.good.width) + std::size_t(x);
      if (!match.good.values[at]) continue;
      bool masked = false;
      for (std::size_t i = 0; i < views.size(); ++i) {
        const glm::vec2 here(match.position[i].values[2 * at], match.position[i].values[2 * at + 1]);
        colour[i] = sampled(views[i].picture, here);
        masked = masked || isIgnored(views[i].mask, here);
      }
      if (masked) continue;
      sums.add({colour.data(), views.size()});
    }
  return sums.result();
}

// Calls `visit` with barycentric coordinates of the samples of a triangle: pixel centres inside, or a lattice.
template <class Visit>
void forSamples(const std::array<glm::vec2, 3>& corner, int width, int height, std::vector<glm::vec3>& list,
                Visit&& visit) {
  list.clear();
  const glm::vec2 low = glm::min(glm::min(corner[0], corner[1]), corner[2]);
  const glm::vec2 high = glm::max(glm::max(corner[0], corner[1]), corner[2]);
  const auto cross = [](glm::vec2 a, glm::vec2 b) { return a.x * b.y - a.y * b.x; };
  const float area = cross(corner[1] - corner[0], corner[2] - corner[0]);
  if (area != 0.0f)
    for (int y = std::max(int(low.y), 0); y <= std::min(int(high.y), height - 1); ++y)
      for (int x = std::max(int(low.x), 0); x <= std::min(int(high.x), width - 1); ++x) {
        const glm::vec2 p(float(x) + 0.5f, float(y) + 0.5f);
        const float b = cross(p - corner[0], corner[2] - corner[0]) / area;
        const float c = cross(corner[1] - corner[0], p - corner[0]) / area;
        if (b >= 0 && c >= 0 && b + c <= 1) list.emplace_back(1 - b - c, b, c);
      }
  if (list.size() < kMinSamples) {
    list.clear();
    for (int i = 0; i <= 4; ++i)
      for (int j = 0; i + j <= 4; ++j) list.push_back(glm::vec3(4 - i - j, i, j) / 4.0f);
  }
  for (const glm::vec3& weights : list) visit(weights);
}

// Maximum over pairs of members of the difference, averaged over channels.
double largestDifference(std::span<const glm::dvec3> colours, std::span<const bool> used) {
  double largest = 0;
  for (std::size_t i = 0; i < colours.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (!used[i] || !used[j]) continue;
      const glm::dvec3 difference = glm::abs(colours[i] - colours[j]);
      largest = std::max(largest, (difference.x + difference.y + difference.z) / 3.0);
    }
  return largest;
}

}  // namespace

bool TriangleLabel::agrees() const {
  return off <= kMaxOffShare && (ecc > kMinEcc || rms < kMaxTexturelessRms) && rms < kMaxRms;
}

std::vector<TriangleLabel> labelTriangles(std::span<const MatchView> views, const DenseMatch& match,
                                          std::span<const glm::vec2> frame,
                                          std::span<const std::vector<glm::vec2>> member,
                                          std::span<const glm::uvec3> triangles) {
  const std::size_t d = views.size();
  const int width = match.good.width, height = match.good.height;
  const std::vector<Exposure> exposure = exposures(views, match);
  std::vector<TriangleLabel> labels;
  labels.reserve(triangles.size());
  std::vector<glm::vec3> list;
  for (const glm::uvec3& t : triangles) {
    std::array<EccSums, kMaxPairs> sums;
    std::array<double, kMaxPairs> square{}, count{};
    double off = 0;
    forSamples({frame[t.x], frame[t.y], frame[t.z]}, width, height, list, [&](const glm::vec3& w) {
      const glm::vec2 at = w.x * frame[t.x] + w.y * frame[t.y] + w.z * frame[t.z];
      const int px = std::clamp(int(at.x), 0, width - 1), py = std::clamp(int(at.y), 0, height - 1);
      const std::size_t pixel = std::size_t(py) * std::size_t(width) + std::size_t(px);
      bool elsewhere = !match.good.values[pixel], farOff = false;
      std::array<glm::dvec3, kMaxMembers> colour;
      std::array<bool, kMaxMembers> used;
      for (std::size_t i = 0; i < d; ++i) {
        const std::vector<glm::vec2>& m = member[i];
        const glm::vec2 here = w.x * m[t.x] + w.y * m[t.y] + w.z * m[t.z];
        const glm::vec2 dense(match.position[i].values[2 * pixel], match.position[i].values[2 * pixel + 1]);
        const float apart = glm::distance(here, dense);
        elsewhere = elsewhere || !(apart <= kOffPx);
        farOff = farOff || !(apart <= kFarOffPx);
        colour[i] = exposure[i].gain * sampled(views[i].picture, here) + exposure[i].offset;
        used[i] = !isIgnored(views[i].mask, here);
      }
      const bool alone = std::count(used.begin(), used.begin() + std::ptrdiff_t(d), true) < 2;
      off += alone || farOff ||
             (elsewhere && largestDifference({colour.data(), d}, std::span(used).first(d)) > kMaxHiddenDifference);
      for (std::size_t i = 0, pair = 0; i < d; ++i)
        for (std::size_t j = 0; j < i; ++j, ++pair) {
          if (!used[i] || !used[j]) continue;
          ++count[pair];
          sums[pair].add(colour[i], colour[j]);
          const glm::dvec3 difference = colour[i] - colour[j];
          square[pair] += glm::dot(difference, difference) / 3.0;
        }
    });
    TriangleLabel label{1.0f, 0.0f, float(off / double(list.size()))};
    for (std::size_t pair = 0; pair < d * (d - 1) / 2; ++pair) {
      if (count[pair] == 0) continue;  // masked: the others decide
      label.ecc = std::min(label.ecc, float(sums[pair].result(kNoiseVariance).value));
      label.rms = std::max(label.rms, float(std::sqrt(square[pair] / count[pair])));
    }
    labels.push_back(label);
  }
  return labels;
}

std::vector<float> worstPairEcc(std::span<const Image8* const> pictures, std::span<const std::vector<glm::vec2>> member,
                                std::span<const glm::uvec3> triangles) {
  const std::size_t d = pictures.size();
  std::vector<glm::vec3> list;
  const auto forColours = [&](const glm::uvec3& t, auto&& visit) {
    std::array<glm::vec2, 3> mean{};
    for (std::size_t i = 0; i < d; ++i)
      for (int k = 0; k < 3; ++k) mean[std::size_t(k)] += member[i][t[k]] / float(d);
    forSamples(mean, pictures[0]->width, pictures[0]->height, list, [&](const glm::vec3& w) {
      std::array<glm::dvec3, kMaxMembers> colour;
      for (std::size_t i = 0; i < d; ++i)
        colour[i] = sampled(*pictures[i], w.x * member[i][t.x] + w.y * member[i][t.y] + w.z * member[i][t.z]);
      visit(colour);
    });
  };
  ExposureSums exposureSums(d);
  for (const glm::uvec3& t : triangles)
    forColours(t, [&](const auto& colour) { exposureSums.add({colour.data(), d}); });
  const std::vector<Exposure> exposure = exposureSums.result();
  std::vector<float> worst;
  for (const glm::uvec3& t : triangles) {
    std::array<EccSums, kMaxPairs> sums;
    forColours(t, [&](auto& colour) {
      for (std::size_t i = 0; i < d; ++i)
        colour[i] = glm::dvec3(exposure[i].gain) * colour[i] + glm::dvec3(exposure[i].offset);
      for (std::size_t i = 0, pair = 0; i < d; ++i)
        for (std::size_t j = 0; j < i; ++j, ++pair) sums[pair].add(colour[i], colour[j]);
    });
    worst.push_back(1.0f);
    for (std::size_t pair = 0; pair < d * (d - 1) / 2; ++pair)
      worst.back() = std::min(worst.back(), float(sums[pair].result(kNoiseVariance).value));
  }
  return worst;
}

}  // namespace ibr
