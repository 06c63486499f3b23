// SPDX-License-Identifier: Apache-2.0
//
// Written row by row so that the window sums stay in the cache: the plain way through whole pictures takes three times
// as long. Levels go in blocks of kBlock, which are then turned to lie side by side at each pixel.
#include "author/plane_sweep.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

namespace ibr {
namespace {

constexpr int kRadius = 2;  // of the correlation window
constexpr int kWindow = 2 * kRadius + 1;
constexpr float kUnits = 4.0f;                    // a grey level in the units of the sums, see Correlation
constexpr float kNoise = 9.0f * kUnits * kUnits;  // variance that is not texture: 9 grey²
constexpr int kBlock = 16;                        // levels
constexpr float kNoCorrelation = float(kCostLargest) / 2;
constexpr float kUnseen = 132;  // cost of a pair that does not both see the pixel: a little worse than no texture
// Where nothing speaks for any depth the farthest is the best guess: what is too far hides nothing. Costs of the
// nearest level are higher by this share; good matches, being low, are hardly touched. …
constexpr float kFarther = 0.2f;
// … Windows without texture cost this much more there: else a sky without clouds ends on the roofs below it. With more,
// plain walls become sky.
constexpr float kFartherTextureless = 0.4f * kNoCorrelation;
constexpr double kLeastLevels = 64, kMostLevels = 256;  // among the tracks
constexpr double kBehind = 0.7, kBefore = 2.0;  // how far the range reaches beyond the tracks' inverse depths …
constexpr double kBeforeCompact = 1.4;          // … and where these are alike, as over flat ground or along a wall:
constexpr double kCompact = 0.5;                // the farthest is more than this share of the nearest
constexpr double kGrowth = 1.3;                 // of steps from there to infinity
// Cost below which a slanted plane is believed (a correlation of 0.25): where nothing has texture, as in the sky, planes
// would go on for ever.
constexpr std::uint8_t kBelieved = 90;
constexpr double kLeastSlant = 0.3;             // of planes, levels a pixel

// By value: through the references of std::max the loops below would not be vectorised.
float larger(float a, float b) {
  return a < b ? b : a;
}
float smaller(float a, float b) {
  return b < a ? b : a;
}

// Where a member sees what lies on a plane of inverse depth n·(x, y, 1): as in PlaneMaps.
glm::dmat3 through(const FrameToMember& map, glm::dvec3 n) {
  return map.a + glm::outerProduct(map.b, n);
}

// The member's picture as the frame would see it if everything lay on one plane. Beyond the picture's border
// its edge is repeated; `first` and `last` bound the pixels of each row that are inside.
struct Warped {
  ImageF grey;
  std::vector<int> first, last;
  std::vector<int> corner;    // of the row at hand: where each pixel's four neighbours begin
  std::vector<float> fu, fv;  // and its place between them

  Warped(int width, int height)
      : grey(width, height, 1),
        first(std::size_t(height)),
        last(std::size_t(height)),
        corner(std::size_t(width)),
        fu(std::size_t(width)),
        fv(std::size_t(width)) {}
};

void warp(const SweepView& view, const glm::dmat3& map, Warped& out) {
  const int width = out.grey.width, height = out.grey.height;
  const int sourceWidth = view.grey.width, sourceHeight = view.grey.height;
  const float right = float(sourceWidth) - 1.001f, bottom = float(sourceHeight) - 1.001f;
  for (int y = 0; y < height; ++y) {
    const glm::dvec3 start = map * glm::dvec3(0.5, y + 0.5, 1.0), step = map[0];
    // Inside means q.z > 0 and 0 <= q.x / q.z <= width and so on: half-lines in x, so a row has one interval.
    double low = 0, high = width - 1;
    auto clip = [&](double at0, double slope) {  // at0 + slope·x >= 0
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
    const float* const source = view.grey.values.data();
    const auto hx0 = float(start.x), hy0 = float(start.y), hz0 = float(start.z);
    const auto dx = float(step.x), dy = float(step.y), dz = float(step.z);
    int* __restrict const corner = out.corner.data();
    float* __restrict const fu = out.fu.data(), * __restrict const fv = out.fv.data();
    for (int x = first; x <= last; ++x) {
      const float scale = 1.0f / (hz0 + dz * float(x));
      const float u = smaller(larger((hx0 + dx * float(x)) * scale - 0.5f, 0.0f), right);
      const float v = smaller(larger((hy0 + dy * float(x)) * scale - 0.5f, 0.0f), bottom);
      const int iu = int(u), iv = int(v);
      corner[x] = iv * sourceWidth + iu;
      fu[x] = u - float(iu);
      fv[x] = v - float(iv);
    }
    for (int x = first; x <= last; ++x) {
      const float* const p = source + corner[x];
      const float top = p[0] + fu[x] * (p[1] - p[0]);
      const float low2 = p[sourceWidth] + fu[x] * (p[sourceWidth + 1] - p[sourceWidth]);
      row[x] = top + fv[x] * (low2 - top);
    }
    for (int x = first; x <= last; ++x) row[x] = float(int(row[x] * kUnits + 0.5f)) - 128.0f * kUnits;
    std::fill(row, row + first, row[first]);
    std::fill(row + last + 1, row + width, row[last]);
  }
}

// Sums over kWindow × kWindow of one quantity, row by row: columns over kWindow rows are kept, then summed sideways.
void sumSideways(const float* column, float* out, int width) {
  // `column` has kRadius valid entries before and after.
  for (int x = 0; x < width; ++x) out[x] = column[x - 2] + column[x - 1] + column[x] + column[x + 1] + column[x + 2];
}

constexpr float kShare = 1.0f / float(kWindow * kWindow);

// Adds 1 − ZNCC of the windows of a pair whose sums (of a, a², b, b², ab) are given.
void correlate(const float* __restrict sa, const float* __restrict saa, const float* __restrict sb,
               const float* __restrict sbb, const float* __restrict sab, float* __restrict total,
               float* __restrict count, int n) {
  for (int x = 0; x < n; ++x) {
    const float meanA = sa[x] * kShare, meanB = sb[x] * kShare;
    const float varianceA = larger(saa[x] * kShare - meanA * meanA, 0.0f) + kNoise;
    const float varianceB = larger(sbb[x] * kShare - meanB * meanB, 0.0f) + kNoise;
    const float covariance = sab[x] * kShare - meanA * meanB;
    const float correlation = covariance / std::sqrt(varianceA * varianceB);
    total[x] += 1.0f - smaller(larger(correlation, -1.0f), 1.0f);
    count[x] += 1.0f;
  }
}

// Quarters of grey levels about mid-grey are whole numbers; a window's sums of them and of their products stay below
// 2²⁴ and are exact in float, so that rows can be added and taken away again without drift.
class Correlation {
 public:
  Correlation(int members, int width, int height) : d_(members), width_(width), height_(height) {
    const std::size_t quantities = std::size_t(d_ + d_ + d_ * (d_ - 1) / 2);
    column_.assign(quantities, std::vector<float>(std::size_t(width + 2 * kRadius)));
    sum_.assign(quantities, std::vector<float>(std::size_t(width)));
    total_.resize(std::size_t(width));
    count_.resize(std::size_t(width));
    variance_.resize(std::size_t(width));
    zero_.assign(std::size_t(width), 0.0f);
  }

  /// Costs of one plane into `cost` (height × width). `nearness`, linear in the picture as the plane's inverse depth,
  /// n·(x, y, 1), is 0 at the farthest level and 1 at the nearest.
  void run(std::span<const Warped> warped, glm::dvec3 nearness, std::uint8_t* cost) {
    for (auto& column : column_) std::fill(column.begin(), column.end(), 0.0f);
    for (int y = -kRadius - 1; y < kRadius; ++y) move(warped, y, std::nullopt);
    for (int y = 0; y < height_; ++y) {
      move(warped, y + kRadius, y - kRadius - 1);
      for (std::size_t q = 0; q < column_.size(); ++q) {
        float* const c = column_[q].data() + kRadius;
        for (int r = 1; r <= kRadius; ++r) c[-r] = c[0], c[width_ - 1 + r] = c[width_ - 1];
        sumSideways(c, sum_[q].data(), width_);
      }
      std::fill(total_.begin(), total_.end(), 0.0f);
      std::fill(count_.begin(), count_.end(), 0.0f);
      std::size_t q = std::size_t(2 * d_);
      for (int i = 0; i < d_; ++i)
        for (int j = i + 1; j < d_; ++j, ++q) addPair(warped, y, i, j, q);
      std::uint8_t* __restrict const out = cost + std::size_t(y) * std::size_t(width_);
      const float* __restrict const total = total_.data(), * __restrict const count = count_.data();
      const float pairs = float(d_ * (d_ - 1) / 2);
      addVariances();
      const float* __restrict const variance = variance_.data();
      const float left = float(glm::dot(nearness, glm::dvec3(0.5, y + 0.5, 1.0))), across = float(nearness.x);
      const float noise = float(d_) * kNoise;
      for (int x = 0; x < width_; ++x) {
        const float near = smaller(larger(left + across * float(x), 0.0f), 1.0f);
        const float sum = kNoCorrelation * total[x] + kUnseen * (pairs - count[x]);
        const float textureless = noise / (noise + variance[x]);
        const float share = 1.0f + near * kFarther, farther = near * kFartherTextureless;
        out[x] = std::uint8_t(int(smaller(share * sum / pairs + farther * textureless * textureless + 0.5f, 255.0f)));
      }
    }
  }

 private:
  // Adds row `in` to the columns and takes row `out` away, both brought into the picture; without `out` only adds.
  void move(std::span<const Warped> warped, int in, std::optional<int> out) {
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

  // Of the members' windows about the pixels of the row.
  void addVariances() {
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

  void addPair(std::span<const Warped> warped, int y, int i, int j, std::size_t product) {
    const Warped &a = warped[std::size_t(i)], &b = warped[std::size_t(j)];
    const int first = std::max(a.first[std::size_t(y)], b.first[std::size_t(y)]);
    const int last = std::min(a.last[std::size_t(y)], b.last[std::size_t(y)]);
    if (first > last) return;
    const auto sum = [&](std::size_t q) { return &sum_[q][std::size_t(first)]; };
    correlate(sum(std::size_t(2 * i)), sum(std::size_t(2 * i + 1)), sum(std::size_t(2 * j)),
              sum(std::size_t(2 * j + 1)), sum(product), &total_[std::size_t(first)], &count_[std::size_t(first)],
              last - first + 1);
  }

  int d_, width_, height_;
  std::vector<std::vector<float>> column_, sum_;  // of each member: value, square; then of each pair: product
  std::vector<float> total_, count_, variance_, zero_;
};

class Sweep {
 public:
  Sweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range)
      : views_(views),
        range_(range),
        width_(frame.intrinsics.width),
        height_(frame.intrinsics.height),
        levels_(range.count()),
        pixels_(std::size_t(width_) * std::size_t(height_)),
        warped_(views.size(), Warped(width_, height_)),
        correlation_(int(views.size()), width_, height_),
        best_(pixels_, 255),
        volume_{width_, height_, levels_, {}, ImageF(width_, height_, 1), {}} {
    volume_.cost.resize(pixels_ * std::size_t(levels_));
    for (const SweepView& view : views) maps_.push_back(frameToMember(frame, view.camera));
  }

  /// Planes that face the frame: one a level.
  void facing() {
    std::vector<std::uint8_t> block(pixels_ * kBlock);
    for (int base = 0; base < levels_; base += kBlock) {
      const int count = std::min(kBlock, levels_ - base);
      for (int k = 0; k < count; ++k) {
        std::uint8_t* const cost = &block[std::size_t(k) * pixels_];
        match({0, 0, range_.inverseDepth[std::size_t(base + k)]}, {0, 0, double(base + k) / (levels_ - 1)}, cost);
        for (std::size_t p = 0; p < pixels_; ++p) remember(p, cost[p]);
      }
      for (std::size_t p = 0; p < pixels_; ++p)
        for (int k = 0; k < count; ++k) at(p, base + k) = block[std::size_t(k) * pixels_ + p];
    }
  }

  /// A slanted plane and others beside it, each a step of inverse depth nearer everywhere. A level lies between two
  /// neighbours of them, and takes what they cost there if that is less than what it has.
  void along(glm::dvec3 plane) {
    std::vector<std::int16_t>& on = volume_.planes.emplace_back(pixels_, kNoLevel);
    std::vector<std::uint8_t> cost(pixels_), before(pixels_), least(pixels_, 255);
    const double nearest = range_.inverseDepth.back(), range = (levels_ - 1) * range_.step;
    for (int k = -kPlaneReach; k <= kPlaneReach; ++k) {
      const glm::dvec3 n = plane + glm::dvec3(0, 0, k * range_.step);
      match(n, n / range + glm::dvec3(0, 0, 1.0 - nearest / range), cost.data());
      for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
          const double inverseDepth = glm::dot(n, glm::dvec3(x + 0.5, y + 0.5, 1.0));
          if (!(inverseDepth >= range_.evenFrom && inverseDepth < nearest)) continue;
          const double level = levels_ - 1 - (nearest - inverseDepth) / range_.step;
          if (level < 1) continue;
          const std::size_t p = std::size_t(y) * std::size_t(width_) + std::size_t(x);
          remember(p, cost[p]);
          least[p] = std::min(least[p], cost[p]);
          if (k == 0) on[p] = std::int16_t(std::lround(level));
          if (k == -kPlaneReach) continue;
          const int below = int(level);  // between this plane and the one before
          const float part = float(level - below);
          const float between = float(cost[p]) + part * (float(before[p]) - float(cost[p]));
          if (between < float(kBelieved)) at(p, below) = std::min(at(p, below), std::uint8_t(between + 0.5f));
        }
      std::swap(cost, before);
    }
    for (std::size_t p = 0; p < pixels_; ++p)
      if (least[p] >= kBelieved) on[p] = kNoLevel;
  }

  CostVolume take() { return std::move(volume_); }

 private:
  std::uint8_t& at(std::size_t pixel, int level) {
    return volume_.cost[pixel * std::size_t(levels_) + std::size_t(level)];
  }

  void match(glm::dvec3 plane, glm::dvec3 nearness, std::uint8_t* cost) {
    for (std::size_t i = 0; i < views_.size(); ++i) warp(views_[i], through(maps_[i], plane), warped_[i]);
    correlation_.run(warped_, nearness, cost);
  }

  void remember(std::size_t p, std::uint8_t cost) {
    if (cost >= best_[p]) return;
    best_[p] = cost;
    float sum = 0;
    for (const Warped& w : warped_) sum += w.grey.values[p];
    volume_.guide.values[p] = sum / (kUnits * float(warped_.size())) + 128.0f;
  }

  std::span<const SweepView> views_;
  const SweepLevels& range_;
  int width_, height_, levels_;
  std::size_t pixels_;
  std::vector<FrameToMember> maps_;
  std::vector<Warped> warped_;
  Correlation correlation_;
  std::vector<std::uint8_t> best_;  // cost of what the guide shows
  CostVolume volume_;
};

}  // namespace

double SweepLevels::at(double level) const {
  const std::size_t below = std::min(std::size_t(level), inverseDepth.size() - 2);
  const double part = level - double(below);
  return inverseDepth[below] + part * (inverseDepth[below + 1] - inverseDepth[below]);
}

SweepLevels sweepLevels(const Camera& frame, std::span<const Camera> members, std::vector<double> w) {
  std::sort(w.begin(), w.end());
  auto percentile = [&](double share) { return w[std::size_t(share * double(w.size() - 1) + 0.5)]; };
  const double far = percentile(0.005), near = percentile(0.995);
  // Tracks miss what has no texture: the sky, and under wide lenses the nearest part of the ground.
  const double highest = (far > kCompact * near ? kBeforeCompact : kBefore) * near, lowest = kBehind * far;

  std::vector<FrameToMember> maps;
  for (const Camera& member : members) maps.push_back(frameToMember(frame, member));
  std::vector<double> motion;  // px of members against each other, over the whole range
  constexpr int kSamples = 16;
  for (int sy = 0; sy < kSamples; ++sy)
    for (int sx = 0; sx < kSamples; ++sx) {
      const glm::dvec2 pixel((sx + 0.5) * frame.intrinsics.width / kSamples,
                             (sy + 0.5) * frame.intrinsics.height / kSamples);
      double largest = 0;
      for (std::size_t i = 0; i < maps.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          // Measured in the middle of the range: at its near end pictures are wide apart.
          constexpr double kPart = 0.02;
          const double middle = 0.5 * (lowest + highest), next = middle + kPart * (highest - lowest);
          const auto i0 = maps[i](pixel, middle), i1 = maps[i](pixel, next);
          const auto j0 = maps[j](pixel, middle), j1 = maps[j](pixel, next);
          if (i0 && i1 && j0 && j1) largest = std::max(largest, glm::distance(*i1 - *i0, *j1 - *j0) / kPart);
        }
      motion.push_back(largest);
    }
  std::nth_element(motion.begin(), motion.begin() + std::ptrdiff_t(motion.size() * 9 / 10), motion.end());
  const double pixels = std::clamp(motion[motion.size() * 9 / 10], kLeastLevels, kMostLevels);

  SweepLevels levels{{}, (highest - lowest) / std::ceil(pixels), lowest};
  for (double v = highest, step = levels.step; v > 0.5 * step; v -= step) {
    levels.inverseDepth.push_back(v);
    if (v <= lowest) step *= kGrowth;
  }
  levels.inverseDepth.push_back(0.0);
  std::reverse(levels.inverseDepth.begin(), levels.inverseDepth.end());
  return levels;
}

CostVolume planeSweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& levels,
                      std::span<const glm::dvec3> planes) {
  Sweep sweep(frame, views, levels);
  sweep.facing();
  for (const glm::dvec3& plane : planes)
    if (glm::length(glm::dvec2(plane)) >= kLeastSlant * levels.step) sweep.along(plane);
  return sweep.take();
}

}  // namespace ibr
