// SPDX-License-Identifier: Apache-2.0
#include "render/photographs/photograph_values.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "base/wide.h"
#include "base/wide_math.h"
#include "shared/gather.h"

namespace ibr {
namespace {

constexpr std::size_t kLanes = 8;  // partial sums, whatever the processor
static_assert(kSampleRays % kLanes == 0);
constexpr std::size_t kColours = 4;  // photographs that the gather blends
constexpr double kFarthest = 1e6;    // median depths: farther away, directions do not change
constexpr double kWidest = 1e4;      // tangent of a ray

// Returns the angle of a vector (x, y) with x, y >= 0, radians.
[[gnu::always_inline]] inline float angleOf(float x, float y) {
  const float angle = arctangent(smaller(x, y) / larger(larger(x, y), std::numeric_limits<float>::min()));
  return y > x ? 1.5707963268f - angle : angle;
}

// A photograph in the axes of the middle pose.
struct Placed {
  float turn[3][3];                     // rows: the photograph's axes
  float shift[3];                       // from the photograph to the middle, in the photograph's axes, median depths
  float cx, cy, fx, fy, width, height;  // px
  float perBorder;                      // inverse of the border's width, 1 / px
  float everywhere;                     // 1: a panorama, which shows every direction; 0: a pinhole
};

[[gnu::always_inline]] inline void evaluate(const Placed* photograph, const SampleRays* rays, float depth,
                                            float* __restrict out) {
  const Placed p = *photograph;
  const float* const across = rays->x.data();
  const float* const up = rays->y.data();
  const float sx = depth * p.shift[0], sy = depth * p.shift[1], sz = depth * p.shift[2];
  for (std::size_t r = 0; r < kSampleRays; ++r) {
    const float x = across[r], y = up[r];
    const float ax = p.turn[0][0] * x + p.turn[0][1] * y - p.turn[0][2];
    const float ay = p.turn[1][0] * x + p.turn[1][1] * y - p.turn[1][2];
    const float az = p.turn[2][0] * x + p.turn[2][1] * y - p.turn[2][2];
    const float bx = ax + sx, by = ay + sy, bz = az + sz;
    const float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
    const float dot = ax * bx + ay * by + az * bz, cross = std::sqrt(nx * nx + ny * ny + nz * nz);
    const float sharp = angleOf(std::abs(dot), cross), angle = dot < 0 ? 3.1415926536f - sharp : sharp;
    const float scale = 1 / larger(-bz, std::numeric_limits<float>::min());
    const float u = p.cx + p.fx * (bx * scale), v = p.cy - p.fy * (by * scale);
    const float inside = smaller(smaller(u, p.width - u), smaller(v, p.height - v));
    const float within = smaller(larger(inside * p.perBorder, 0.0f), 1.0f), front = bz < 0 ? within : 0.0f;
    out[r] = larger(front, p.everywhere) / (float(shader::kGatherAngleFloor) + angle);
  }
}

[[gnu::always_inline]] inline float total(const float* lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

[[gnu::always_inline]] inline float rootSum(const float* __restrict a) {
  float lanes[kLanes] = {};
  for (std::size_t p = 0; p < kSamplePoints; p += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += std::sqrt(a[p + l]);
  return total(lanes);
}

[[gnu::always_inline]] inline float rootSumOfTwo(const float* __restrict a, const float* __restrict b) {
  float lanes[kLanes] = {};
  for (std::size_t p = 0; p < kSamplePoints; p += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += std::sqrt(a[p + l] + b[p + l]);
  return total(lanes);
}

[[gnu::always_inline]] inline void addValues(float* __restrict a, const float* __restrict b) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) a[p] += b[p];
}

[[gnu::always_inline]] inline void slopesAt(const float* __restrict a, float* __restrict slope,
                                            float* __restrict root) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) {
    const float half = 0.5f / std::sqrt(larger(a[p], std::numeric_limits<float>::min()));
    slope[p] = a[p] > 0 ? half : 0.0f;
    root[p] = a[p] > 0 ? 0.0f : 1.0f;
  }
}

[[gnu::always_inline]] inline float linearSum(const float* __restrict slope, const float* __restrict root,
                                              const float* __restrict b) {
  float lanes[kLanes] = {};
  for (std::size_t p = 0; p < kSamplePoints; p += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += slope[p + l] * b[p + l] + root[p + l] * std::sqrt(b[p + l]);
  return total(lanes);
}

[[gnu::always_inline]] inline void weigh(float* __restrict values, float cost, float fade) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) {
    const float value = values[p];
    const float beyond = 1 / larger(value, std::numeric_limits<float>::min()) + cost;
    const float t = smaller(larger(beyond / float(shader::kGatherOwnPoseCost), 0.0f), 1.0f);
    values[p] = value > 0 ? fade * value / larger(t * t * (3 - 2 * t), shader::kGatherMinApart) : 0.0f;
  }
}

// Inserts weights into the largest so far, which are sorted at each sample.
[[gnu::always_inline]] inline void insert(float* __restrict best, const float* __restrict weights) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) {
    float next = weights[p];
    for (std::size_t rank = 0; rank <= kColours; ++rank) {
      float& here = best[rank * kSamplePoints + p];
      const float low = smaller(here, next);
      here = larger(here, next);
      next = low;
    }
  }
}

// Weights above the fifth, times the inverse of their sum.
[[gnu::always_inline]] inline void invertSums(float* __restrict best) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) {
    const float least = best[kColours * kSamplePoints + p];
    float sum = 0;
    for (std::size_t rank = 0; rank < kColours; ++rank) sum += best[rank * kSamplePoints + p] - least;
    best[p] = sum > 0 ? 1 / larger(sum, std::numeric_limits<float>::min()) : 0.0f;
  }
}

[[gnu::always_inline]] inline float shareOf(const float* __restrict best, const float* __restrict weights) {
  float lanes[kLanes] = {};
  for (std::size_t p = 0; p < kSamplePoints; p += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l)
      lanes[l] += larger(weights[p + l] - best[kColours * kSamplePoints + p + l], 0.0f) * best[p + l];
  return total(lanes);
}

}  // namespace

SampleRays sampleRays(std::span<const Camera> views, const Pose& middle) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Camera& view : views) {
    const glm::dquat turn = glm::conjugate(middle.rotation) * view.pose.rotation;
    const Intrinsics& k = view.intrinsics;
    for (const double x : {0.0, double(k.width)})
      for (const double y : {0.0, double(k.height)}) {
        const glm::dvec3 ray = turn * glm::dvec3((x - k.cx) / k.fx, (k.cy - y) / k.fy, -1.0);
        const double depth = std::max(-ray.z, 0.1);  // lower bound for views that look in different directions
        low = glm::min(low, glm::dvec2(ray) / depth);
        high = glm::max(high, glm::dvec2(ray) / depth);
      }
  }
  low = glm::max(low, -kWidest);
  high = glm::min(high, kWidest);
  SampleRays rays;
  for (std::size_t row = 0; row < kSampleRows; ++row)
    for (std::size_t column = 0; column < kSampleColumns; ++column) {
      const std::size_t r = row * kSampleColumns + column;
      rays.x[r] = float(glm::mix(low.x, high.x, (double(column) + 0.5) / kSampleColumns));
      rays.y[r] = float(glm::mix(low.y, high.y, (double(row) + 0.5) / kSampleRows));
    }
  return rays;
}

SampleValues photographValues(const Camera& photograph, const Pose& middle, const SampleRays& rays,
                              double medianInverseDepth) {
  const Intrinsics& k = photograph.intrinsics;
  const glm::dquat toPhotograph = glm::conjugate(photograph.pose.rotation);
  const glm::dmat3 turn = glm::mat3_cast(toPhotograph * middle.rotation);
  glm::dvec3 shift = medianInverseDepth * (toPhotograph * (middle.position - photograph.pose.position));
  if (const double length = glm::length(shift); length > kFarthest) shift *= kFarthest / length;
  Placed placed;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) placed.turn[row][column] = float(turn[column][row]);
    placed.shift[row] = float(shift[row]);
  }
  placed.everywhere = k.model == CameraModel::equirectangular ? 1.0f : 0.0f;
  placed.cx = float(k.cx), placed.cy = float(k.cy), placed.fx = float(k.fx), placed.fy = float(k.fy);
  placed.width = float(k.width), placed.height = float(k.height);
  placed.perBorder = float(1 / (double(shader::kGatherBorder) * k.width));
  SampleValues values;
  for (std::size_t d = 0; d < kSampleDepths.size(); ++d)
    runVectorised<evaluate>(&placed, &rays, float(kSampleDepths[d]), values.at.data() + d * kSampleRays);
  return values;
}

float coverage(const SampleValues& a) {
  return runVectorised<rootSum>(a.at.data());
}

float coverage(const SampleValues& a, const SampleValues& b) {
  return runVectorised<rootSumOfTwo>(a.at.data(), b.at.data());
}

void add(SampleValues& a, const SampleValues& b) {
  runVectorised<addValues>(a.at.data(), b.at.data());
}

CoverageSlopes coverageSlopes(const SampleValues& a) {
  CoverageSlopes slopes;
  runVectorised<slopesAt>(a.at.data(), slopes.slope.at.data(), slopes.root.at.data());
  return slopes;
}

float linear(const CoverageSlopes& slopes, const SampleValues& b) {
  return runVectorised<linearSum>(slopes.slope.at.data(), slopes.root.at.data(), b.at.data());
}

void toGatherWeights(SampleValues& values, double distance, float fade) {
  const auto cost = float(double(shader::kGatherDistanceCost) * distance - double(shader::kGatherAngleFloor));
  runVectorised<weigh>(values.at.data(), cost, fade);
}

void gatherShares(std::span<const SampleValues> weights, std::span<double> shares) {
  std::array<float, (kColours + 1) * kSamplePoints> best{};
  for (const SampleValues& one : weights) runVectorised<insert>(best.data(), one.at.data());
  runVectorised<invertSums>(best.data());
  for (std::size_t m = 0; m < weights.size(); ++m)
    shares[m] = double(runVectorised<shareOf>(static_cast<const float*>(best.data()), weights[m].at.data()));
}

}  // namespace ibr
