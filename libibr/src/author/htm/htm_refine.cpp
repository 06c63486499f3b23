// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>

namespace ibr {
namespace {

// Linearised difference between template and image at one displacement.
struct Normal {
  glm::dvec3 structure{0.0};  // Σ ∇I ∇Iᵀ: xx, xy, yy
  glm::dvec2 side{0.0};       // Σ ∇I r
  double squares = 0;         // Σ r²
};

// A template and the image around it, displaced by a fraction of a pixel. The fraction is the same for all samples: the
// displaced image is made once, by rows, and gradients are differences of neighbours.
class Patch {
  static constexpr std::size_t kLanes = 12;  // red, green, blue of four neighbours of a row
  using Lanes = std::array<float, kLanes>;

 public:
  Patch(const Image8& picture, std::span<const TemplateSample> samples) : picture_(picture), count_(samples.size()) {
    glm::ivec2 low(std::numeric_limits<int>::max()), high(std::numeric_limits<int>::min());
    for (const TemplateSample& s : samples) {
      low = glm::min(low, glm::ivec2(s.x, s.y));
      high = glm::max(high, glm::ivec2(s.x, s.y));
    }
    corner_ = low - 1;
    size_ = high - low + 3;
    stride_ = 3 * std::size_t(size_.x) + kLanes;
    sampled_.assign(stride_ * std::size_t(size_.y), 0.0f);
    glm::ivec2 next(0);
    std::size_t used = kLanes;
    for (const TemplateSample& s : samples) {
      const glm::ivec2 pixel(s.x, s.y);
      if (used == kLanes || pixel != next) {
        const glm::ivec2 at = pixel - corner_;
        blocks_.push_back({std::size_t(at.y) * stride_ + 3 * std::size_t(at.x), {}, {}});
        used = 0;
      }
      for (const std::uint8_t level : {s.red, s.green, s.blue}) {
        blocks_.back().wanted[used] = level;
        blocks_.back().counts[used++] = 1;
      }
      next = pixel + glm::ivec2(1, 0);
    }
  }

  Normal normalAt(glm::dvec2 displacement) {
    using cv::v_float32x4, cv::v_load;
    sampleAt(displacement);
    std::array<v_float32x4, 3> sum, mean;
    sum.fill(cv::v_setzero_f32());
    for (const Block& block : blocks_)
      for (std::size_t part = 0; part < 3; ++part) {
        const std::size_t k = 4 * part;
        const v_float32x4 r = v_load(&block.wanted[k]) - v_load(&sampled_[block.at + k]);
        sum[part] += v_load(&block.counts[k]) * r;
      }
    Lanes lanes;
    for (std::size_t part = 0; part < 3; ++part) cv::v_store(&lanes[4 * part], sum[part]);
    for (std::size_t c = 0; c < 3; ++c)
      lanes[c] = (lanes[c] + lanes[c + 3] + lanes[c + 6] + lanes[c + 9]) / float(count_);
    for (std::size_t k = 3; k < kLanes; ++k) lanes[k] = lanes[k - 3];
    for (std::size_t part = 0; part < 3; ++part) mean[part] = v_load(&lanes[4 * part]);

    v_float32x4 xx = cv::v_setzero_f32(), xy = xx, yy = xx, xr = xx, yr = xx, rr = xx;
    const v_float32x4 half = cv::v_setall_f32(0.5f);
    for (const Block& block : blocks_)
      for (std::size_t part = 0; part < 3; ++part) {
        const std::size_t k = 4 * part;
        const float* here = &sampled_[block.at + k];
        const v_float32x4 counts = v_load(&block.counts[k]);
        const v_float32x4 r = counts * (v_load(&block.wanted[k]) - v_load(here) - mean[part]);
        const v_float32x4 gx = half * counts * (v_load(here + 3) - v_load(here - 3));
        const v_float32x4 gy = half * counts * (v_load(here + stride_) - v_load(here - stride_));
        xx += gx * gx;
        xy += gx * gy;
        yy += gy * gy;
        xr += gx * r;
        yr += gy * r;
        rr += r * r;
      }
    const auto total = [](const v_float32x4& four) { return double(cv::v_reduce_sum(four)); };
    return {{total(xx), total(xy), total(yy)}, {total(xr), total(yr)}, total(rr)};
  }

 private:
  struct Block {
    std::size_t at;  // index of the block's first value in sampled_
    Lanes wanted, counts;
  };

  // Samples bilinearly; beyond the border the border pixels are repeated.
  void sampleAt(glm::dvec2 displacement) {
    const glm::dvec2 whole = glm::floor(displacement), part = displacement - whole;
    const glm::ivec2 corner = corner_ + glm::ivec2(whole);
    const float s = float(part.x), t = float(part.y);
    const float a = (1 - s) * (1 - t), b = s * (1 - t), c = (1 - s) * t, d = s * t;
    const std::size_t values = 3 * std::size_t(size_.x);
    for (int y = 0; y < size_.y; ++y) {
      const std::uint8_t *upper = row(corner.x, corner.y + y, buffers_[0]),
                         *lower = row(corner.x, corner.y + y + 1, buffers_[1]);
      float* __restrict out = &sampled_[std::size_t(y) * stride_];
      for (std::size_t k = 0; k < values; ++k)
        out[k] = a * float(upper[k]) + b * float(upper[k + 3]) + c * float(lower[k]) + d * float(lower[k + 3]);
    }
  }

  // Returns a row from column x on, one pixel longer than sampled_ is wide.
  const std::uint8_t* row(int x, int y, std::vector<std::uint8_t>& room) const {
    const int at = std::clamp(y, 0, picture_.height - 1), pixels = size_.x + 1;
    if (x >= 0 && x + pixels <= picture_.width) return &picture_.pixel(x, at)[0];
    room.clear();
    for (int k = 0; k < pixels; ++k) {
      const auto pixel = picture_.pixel(std::clamp(x + k, 0, picture_.width - 1), at);
      room.insert(room.end(), pixel.begin(), pixel.end());
    }
    return room.data();
  }

  const Image8& picture_;
  std::size_t count_;
  glm::ivec2 corner_, size_;  // of the undisplaced area, which exceeds the samples by a pixel on each side
  std::size_t stride_;
  std::vector<float> sampled_;
  std::vector<Block> blocks_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
};

// Eigenvalues, and the unit eigenvector of the larger one.
struct Eigen {
  double large, small;
  glm::dvec2 direction;
};
Eigen eigenOf(const glm::dvec3& m) {
  const double mean = 0.5 * (m.x + m.z), half = 0.5 * (m.x - m.z), radius = std::hypot(half, m.y);
  const double angle = 0.5 * std::atan2(m.y, half);
  return {mean + radius, std::max(0.0, mean - radius), {std::cos(angle), std::sin(angle)}};
}

}  // namespace

VertexMatch refinedMatch(const Image8& picture, std::span<const TemplateSample> samples, glm::dvec2 start,
                         double minTexture) {
  constexpr int kSteps = 6;
  constexpr double kMaxShiftPx = 1.0;       // px from the start
  constexpr double kMinNoise = 2;           // 8-bit levels, one standard deviation
  constexpr double kMinDeviationPx = 0.15;  // px, one standard deviation
  if (samples.empty()) return {};
  const double n = double(samples.size());
  const double gate = std::max(minTexture * minTexture, 1e-6) * n;  // never 0: flat templates must not divide by 0
  Patch patch(picture, samples);
  glm::dvec2 at = start;
  Normal normal = patch.normalAt(at);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen eigen = eigenOf(normal.structure);
    if (!(eigen.large >= gate)) break;
    const glm::dvec2 across(-eigen.direction.y, eigen.direction.x);
    glm::dvec2 move = eigen.direction * (glm::dot(eigen.direction, normal.side) / eigen.large);
    if (eigen.small >= gate) move += across * (glm::dot(across, normal.side) / eigen.small);
    const glm::dvec2 next = glm::clamp(at + move, start - kMaxShiftPx, start + kMaxShiftPx);
    const Normal there = patch.normalAt(next);
    if (!(there.squares < normal.squares)) break;
    const double moved = glm::distance(next, at);
    at = next;
    normal = there;
    if (moved < 1e-3) break;
  }
  const Eigen eigen = eigenOf(normal.structure);
  if (!(eigen.large >= gate)) return {};
  const double noise = std::max(normal.squares / (3 * n), kMinNoise * kMinNoise);
  const double most = 1 / (kMinDeviationPx * kMinDeviationPx);
  const double along = std::min(eigen.large / noise, most);
  const double across = eigen.small >= gate ? std::min(eigen.small / noise, most) : 0.0;
  const glm::dvec2 d = eigen.direction, e(-d.y, d.x);
  if (across == 0) at = d * glm::dot(d, at);  // unmeasured directions are not displaced
  const glm::dvec3 information =
      along * glm::dvec3(d.x * d.x, d.x * d.y, d.y * d.y) + across * glm::dvec3(e.x * e.x, e.x * e.y, e.y * e.y);
  return {glm::vec2(at), glm::vec3(information), 0};
}

}  // namespace ibr
