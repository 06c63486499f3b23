// SPDX-License-Identifier: Apache-2.0
// Computes the matching costs of a sweep plane from window sums.
// Works row by row so that window sums stay in the cache; whole-image passes take three times as long. Grey values
// relative to mid-grey, in quarters of levels, are integers. A window's sums of values and products stay below 2²⁴,
// exact in float: rows can be added and removed without drift.
#include "author/sweep/window_correlation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/wide.h"
#include "base/wide_math.h"

namespace ibr {
namespace {

constexpr int kRadius = 2;  // of the correlation window
constexpr int kWindow = 2 * kRadius + 1;
constexpr float kShare = 1.0f / float(kWindow * kWindow);
constexpr float kUnits = WarpedView::kUnits;
constexpr float kNoiseVariance = 9.0f * kUnits * kUnits;  // variance that is not texture: 9 grey²
constexpr float kNoCorrelation = float(kMaxSweepCost) / 2;
constexpr float kUnseenPairCost =
    132;  // cost of a pair that does not both see the pixel: slightly worse than no texture
// Without evidence for any depth the farthest is the best guess: a surface that is too far hides nothing. Costs of the
// nearest level are higher by this share; good matches have low costs and hardly change. …
constexpr float kFarther = 0.2f;
// … Windows without texture cost this much more at the nearest level: otherwise a cloudless sky attaches to the roofs
// below it. With higher values, plain walls become sky.
constexpr float kFartherTextureless = 0.4f * kNoCorrelation;

// Sums kWindow × kWindow values row by row: column sums over kWindow rows are kept, then summed sideways.
[[gnu::always_inline]] inline void sumHorizontally(const float* __restrict column, float* __restrict out, int width) {
  // `column` has kRadius valid entries before and after.
  for (int x = 0; x < width; ++x) out[x] = column[x - 2] + column[x - 1] + column[x] + column[x + 1] + column[x + 2];
}

// Adds 1 − ZNCC of the windows of a pair whose sums (of a, a², b, b², ab) are given.
[[gnu::always_inline]] inline void correlate(const float* __restrict sa, const float* __restrict saa,
                                             const float* __restrict sb, const float* __restrict sbb,
                                             const float* __restrict sab, float* __restrict total,
                                             float* __restrict count, int n) {
  for (int x = 0; x < n; ++x) {
    const float meanA = sa[x] * kShare, meanB = sb[x] * kShare;
    const float varianceA = larger(saa[x] * kShare - meanA * meanA, 0.0f) + kNoiseVariance;
    const float varianceB = larger(sbb[x] * kShare - meanB * meanB, 0.0f) + kNoiseVariance;
    const float covariance = sab[x] * kShare - meanA * meanB;
    const float correlation = covariance / std::sqrt(varianceA * varianceB);
    total[x] += 1.0f - smaller(larger(correlation, -1.0f), 1.0f);
    count[x] += 1.0f;
  }
}

// Homogeneous px of a source along a row.
struct Line {
  float x, y, z, dx, dy, dz;
};

[[gnu::always_inline]] inline void readLine(const float* __restrict source, int sourceWidth, float right, float bottom,
                                            Line line, int first, int last, int* __restrict corner,
                                            float* __restrict fu, float* __restrict fv, float* __restrict row) {
  for (int x = first; x <= last; ++x) {
    const float scale = 1.0f / (line.z + line.dz * float(x));
    const float u = smaller(larger((line.x + line.dx * float(x)) * scale - 0.5f, 0.0f), right);
    const float v = smaller(larger((line.y + line.dy * float(x)) * scale - 0.5f, 0.0f), bottom);
    const int iu = int(u), iv = int(v);
    corner[x] = iv * sourceWidth + iu;
    fu[x] = u - float(iu);
    fv[x] = v - float(iv);
  }
  for (int x = first; x <= last; ++x) {
    const int at = corner[x];
    const float top = source[at] + fu[x] * (source[at + 1] - source[at]);
    const float low = source[at + sourceWidth] + fu[x] * (source[at + sourceWidth + 1] - source[at + sourceWidth]);
    row[x] = top + fv[x] * (low - top);
  }
}

}  // namespace

WarpedView::WarpedView(int width, int height)
    : grey(width, height, 1),
      first(std::size_t(height)),
      last(std::size_t(height)),
      corner(std::size_t(width)),
      fu(std::size_t(width)),
      fv(std::size_t(width)) {}

void warp(const SweepView& view, const glm::dmat3& map, WarpedView& out) {
  if (!view.mask.empty()) out.ignored.assign(out.grey.values.size(), 0);
  const int width = out.grey.width, height = out.grey.height;
  const int sourceWidth = view.grey.width, sourceHeight = view.grey.height;
  const float right = float(sourceWidth) - 1.001f, bottom = float(sourceHeight) - 1.001f;
  for (int y = 0; y < height; ++y) {
    const glm::dvec3 start = map * glm::dvec3(0.5, y + 0.5, 1.0), step = map[0];
    // Inside means q.z > 0 and 0 <= q.x / q.z <= width and so on: half-lines in x, so a row has one interval.
    double low = 0,
           high = sourceWidth > 1 && sourceHeight > 1 ? width - 1 : -1;  // there are pixels to interpolate between
    auto clip = [&](double at0, double slope) {                          // at0 + slope·x >= 0
      if (slope > 0)
        low = std::max(low, -at0 / slope);
      else if (slope < 0)
        high = std::min(high, -at0 / slope);
      else if (at0 < 0)
        high = -1;
    };
    clip(start.z - 1e-9, step.z);
    clip(start.x, step.x);
    clip(sourceWidth * start.z - start.x, sourceWidth * step.z - step.x);
    clip(start.y, step.y);
    clip(sourceHeight * start.z - start.y, sourceHeight * step.z - step.y);
    int first = low > width ? width : int(std::ceil(low)), last = high < 0 ? -1 : int(std::floor(high));
    if (first > last) first = width, last = -1;
    out.first[std::size_t(y)] = first;
    out.last[std::size_t(y)] = last;
    float* const row = &out.grey.values[std::size_t(y) * std::size_t(width)];
    if (last < 0) {
      std::fill(row, row + width, 0.0f);  // mid-grey
      continue;
    }
    const Line line{float(start.x), float(start.y), float(start.z), float(step.x), float(step.y), float(step.z)};
    runVectorised<readLine>(view.grey.values.data(), sourceWidth, right, bottom, line, first, last, out.corner.data(),
                            out.fu.data(), out.fv.data(), row);
    for (int x = first; x <= last; ++x) row[x] = float(int(row[x] * kUnits + 0.5f)) - 128.0f * kUnits;
    if (!view.mask.empty()) {
      std::uint8_t* const ignored = &out.ignored[std::size_t(y) * std::size_t(width)];
      for (int x = first; x <= last; ++x)
        ignored[x] = !view.mask.values[std::size_t(out.corner[std::size_t(x)] + int(out.fu[std::size_t(x)] + 0.5f) +
                                                   int(out.fv[std::size_t(x)] + 0.5f) * sourceWidth)];
    }
    std::fill(row, row + first, row[first]);
    std::fill(row + last + 1, row + width, row[last]);
  }
}

WindowCorrelation::WindowCorrelation(int members, int width, int height) : d_(members), width_(width), height_(height) {
  const std::size_t quantities = std::size_t(d_ + d_ + d_ * (d_ - 1) / 2);
  column_.assign(quantities, std::vector<float>(std::size_t(width + 2 * kRadius)));
  sum_.assign(quantities, std::vector<float>(std::size_t(width)));
  total_.resize(std::size_t(width));
  count_.resize(std::size_t(width));
  variance_.resize(std::size_t(width));
  zero_.assign(std::size_t(width), 0.0f);
  pairs_.resize(std::size_t(width));
}

void WindowCorrelation::run(std::span<const WarpedView> warped, glm::dvec3 nearness, std::uint8_t* cost) {
  for (auto& column : column_) std::fill(column.begin(), column.end(), 0.0f);
  for (int y = -kRadius - 1; y < kRadius; ++y) move(warped, y, std::nullopt);
  for (int y = 0; y < height_; ++y) {
    move(warped, y + kRadius, y - kRadius - 1);
    for (std::size_t q = 0; q < column_.size(); ++q) {
      float* const c = column_[q].data() + kRadius;
      for (int r = 1; r <= kRadius; ++r) c[-r] = c[0], c[width_ - 1 + r] = c[width_ - 1];
      runVectorised<sumHorizontally>(static_cast<const float*>(c), sum_[q].data(), width_);
    }
    std::fill(total_.begin(), total_.end(), 0.0f);
    std::fill(count_.begin(), count_.end(), 0.0f);
    std::size_t q = std::size_t(2 * d_);
    for (int i = 0; i < d_; ++i)
      for (int j = i + 1; j < d_; ++j, ++q) addPair(warped, y, i, j, q);
    addVariances();
    countPairs(warped, y);
    costs(y, nearness, cost + std::size_t(y) * std::size_t(width_));
  }
}

void WindowCorrelation::costs(int y, glm::dvec3 nearness, std::uint8_t* __restrict out) const {
  const float* __restrict const total = total_.data(), * __restrict const count = count_.data();
  const float* __restrict const pairs = pairs_.data();
  const float* __restrict const variance = variance_.data();
  const float left = float(glm::dot(nearness, glm::dvec3(0.5, y + 0.5, 1.0))), across = float(nearness.x);
  const float noise = float(d_) * kNoiseVariance;
  for (int x = 0; x < width_; ++x) {
    const float near = smaller(larger(left + across * float(x), 0.0f), 1.0f);
    const float sum = kNoCorrelation * total[x] + kUnseenPairCost * (pairs[x] - count[x]);
    const bool none = pairs[x] == 0;
    const float textureless = noise / (noise + variance[x]);
    const float share = 1.0f + near * kFarther, farther = near * kFartherTextureless;
    const float cost = share * sum / larger(pairs[x], 1.0f) + farther * textureless * textureless;
    out[x] = std::uint8_t(int(smaller((none ? kUnseenPairCost : cost) + 0.5f, 255.0f)));
  }
}

// Counts the pairs without a masked member; with no pair left, all depths cost the same.
void WindowCorrelation::countPairs(std::span<const WarpedView> warped, int y) {
  std::fill(pairs_.begin(), pairs_.end(), float(d_ * (d_ - 1) / 2));
  if (std::ranges::all_of(warped, [](const WarpedView& w) { return w.ignored.empty(); })) return;
  for (int x = 0; x < width_; ++x) {
    const std::size_t at = std::size_t(y) * std::size_t(width_) + std::size_t(x);
    const auto left =
        std::ranges::count_if(warped, [&](const WarpedView& w) { return w.ignored.empty() || !w.ignored[at]; });
    pairs_[std::size_t(x)] = float(left * (left - 1) / 2);
  }
}

// Adds row `in` to the column sums and subtracts row `out`, both clamped to the image; without `out` only adds.
void WindowCorrelation::move(std::span<const WarpedView> warped, int in, std::optional<int> out) {
  const auto row = [&](int i, int y) {
    return &warped[std::size_t(i)].grey.values[std::size_t(std::clamp(y, 0, height_ - 1)) * std::size_t(width_)];
  };
  std::size_t q = 0;
  for (int i = 0; i < d_; ++i) {
    const float* __restrict const g = row(i, in);
    const float* __restrict const h = out ? row(i, *out) : zero_.data();
    float* __restrict const first = column_[q++].data() + kRadius;
    float* __restrict const square = column_[q++].data() + kRadius;
    for (int x = 0; x < width_; ++x) {
      first[x] += g[x] - h[x];
      square[x] += g[x] * g[x] - h[x] * h[x];
    }
  }
  for (int i = 0; i < d_; ++i)
    for (int j = i + 1; j < d_; ++j) {
      const float* __restrict const a = row(i, in), * __restrict const b = row(j, in);
      const float* __restrict const c = out ? row(i, *out) : zero_.data();
      const float* __restrict const e = out ? row(j, *out) : zero_.data();
      float* __restrict const product = column_[q++].data() + kRadius;
      for (int x = 0; x < width_; ++x) product[x] += a[x] * b[x] - c[x] * e[x];
    }
}

// Sums the variances of the members' windows around the pixels of the row.
void WindowCorrelation::addVariances() {
  std::fill(variance_.begin(), variance_.end(), 0.0f);
  float* __restrict const variance = variance_.data();
  for (int i = 0; i < d_; ++i) {
    const float* __restrict const value = sum_[std::size_t(2 * i)].data();
    const float* __restrict const square = sum_[std::size_t(2 * i + 1)].data();
    for (int x = 0; x < width_; ++x) {
      const float mean = value[x] * kShare;
      variance[x] += larger(square[x] * kShare - mean * mean, 0.0f);
    }
  }
}

void WindowCorrelation::addPair(std::span<const WarpedView> warped, int y, int i, int j, std::size_t product) {
  const WarpedView &a = warped[std::size_t(i)], &b = warped[std::size_t(j)];
  const int first = std::max(a.first[std::size_t(y)], b.first[std::size_t(y)]);
  const int last = std::min(a.last[std::size_t(y)], b.last[std::size_t(y)]);
  if (first > last) return;
  if (!a.ignored.empty() || !b.ignored.empty()) return addMaskedPair(a, b, y, i, j, product, first, last);
  const auto sum = [&](std::size_t q) { return &sum_[q][std::size_t(first)]; };
  runVectorised<correlate>(sum(std::size_t(2 * i)), sum(std::size_t(2 * i + 1)), sum(std::size_t(2 * j)),
                           sum(std::size_t(2 * j + 1)), sum(product), &total_[std::size_t(first)],
                           &count_[std::size_t(first)], last - first + 1);
}

void WindowCorrelation::addMaskedPair(const WarpedView& a, const WarpedView& b, int y, int i, int j,
                                      std::size_t product, int first, int last) {
  const std::size_t row = std::size_t(y) * std::size_t(width_);
  const auto used = [&](const WarpedView& w, int x) { return w.ignored.empty() || !w.ignored[row + std::size_t(x)]; };
  for (int x = first; x <= last; ++x) {
    if (!used(a, x) || !used(b, x)) continue;
    const auto sum = [&](int q) { return &sum_[std::size_t(q)][std::size_t(x)]; };
    correlate(sum(2 * i), sum(2 * i + 1), sum(2 * j), sum(2 * j + 1), sum(int(product)), &total_[std::size_t(x)],
              &count_[std::size_t(x)], 1);
  }
}

}  // namespace ibr
