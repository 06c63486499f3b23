// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "author/backdrop/complete_depth.h"
#include "author/depth/sky.h"
#include "author/geometry/mean_frame.h"
#include "author/sweep/sgm.h"
#include "base/wide.h"
#include "base/wide_math.h"

namespace ibr {
namespace {

constexpr int kRadius = 2;  // px, of the correlation window
constexpr float kShare = 1.0f / float((2 * kRadius + 1) * (2 * kRadius + 1));
constexpr float kUnits = WarpedView::kUnits;
constexpr float kNoiseVariance = 2.0f * kUnits * kUnits;  // variance below which a window counts as noise
constexpr float kCostScale = 127.5f;                      // c = 1 in units of the cost volume
constexpr float kSingleSourceScale = 0.5f, kSingleSourceOffset = 0.35f, kNoSourceCost = 0.78f;
constexpr int kMaxAveragedSources = 5;  // max number of sources averaged
constexpr int kBlock = 16;              // levels computed before they are transposed to lie side by side for each pixel
constexpr double kMinLevels = 48, kMaxLevels = 160;
constexpr double kMaxMotionPx = 1.5;    // px per level; sources that move more are halved …
constexpr int kMinSidePx = 64;          // … down to this side, px
constexpr double kNearFactor = 1.3;     // near end of the range, times the nearest tracks' inverse depth
constexpr double kInfinityRatio = 0.3;  // the range starts at infinity if far / near of the tracks is below this
constexpr double kFarFactor = 0.7;      // else at this share of the farthest tracks' inverse depth

constexpr float kWorstCost = 3.0f;  // above any cost

// The kMaxAveragedSources smallest costs of a row's pixels, ascending.
struct BestCosts {
  float* row[kMaxAveragedSources];
};

// Movement of a source, px, per change of ρ by 1, at the middle of the range: median over the image.
double motionOf(const Camera& photograph, const Camera& source, double middle) {
  constexpr int kSamples = 12;
  const FrameToMember map = frameToMember(photograph, source);
  const double part = 0.02 * middle;
  std::vector<double> motion;
  for (int sy = 0; sy < kSamples; ++sy)
    for (int sx = 0; sx < kSamples; ++sx) {
      const glm::dvec2 pixel((sx + 0.5) * photograph.intrinsics.width / kSamples,
                             (sy + 0.5) * photograph.intrinsics.height / kSamples);
      const auto inside = [&](const glm::dvec2& at) {
        return at.x >= 0 && at.y >= 0 && at.x <= source.intrinsics.width && at.y <= source.intrinsics.height;
      };
      const auto a = map(pixel, middle), b = map(pixel, middle + part);
      if (a && b && inside(*a)) motion.push_back(glm::distance(*a, *b) / part);
    }
  if (motion.empty()) return 0;
  std::nth_element(motion.begin(), motion.begin() + std::ptrdiff_t(motion.size() / 2), motion.end());
  return motion[motion.size() / 2];
}

SweepView halved(const SweepView& view) {
  const int width = std::max(view.grey.width / 2, 1), height = std::max(view.grey.height / 2, 1);
  SweepView half{{resized(view.camera.intrinsics, width, height), view.camera.pose}, ImageF(width, height, 1), {}};
  if (!view.mask.empty()) half.mask = Image8(width, height, 1, 255);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int u = std::min(2 * x + 1, view.grey.width - 1), v = std::min(2 * y + 1, view.grey.height - 1);
      half.grey.pixel(x, y)[0] = 0.25f * (view.grey.pixel(2 * x, 2 * y)[0] + view.grey.pixel(u, 2 * y)[0] +
                                          view.grey.pixel(2 * x, v)[0] + view.grey.pixel(u, v)[0]);
      if (!view.mask.empty() && !(view.mask.pixel(2 * x, 2 * y)[0] && view.mask.pixel(u, 2 * y)[0] &&
                                  view.mask.pixel(2 * x, v)[0] && view.mask.pixel(u, v)[0]))
        half.mask.pixel(x, y)[0] = 0;
    }
  return half;
}

[[gnu::always_inline]] inline void windowSums(const float* __restrict c, float* __restrict out, int width) {
  for (int x = 0; x < width; ++x) out[x] = c[x - 2] + c[x - 1] + c[x] + c[x + 1] + c[x + 2];
}

// Column sums over the window's rows: b, b² and a·b, where a is the photograph and b a source.
struct ColumnSums {
  float *value, *square, *product;
};

// Adds the rows a, b; subtracts the rows c, d.
[[gnu::always_inline]] inline void moveRows(const float* __restrict a, const float* __restrict b,
                                            const float* __restrict c, const float* __restrict d, ColumnSums sums,
                                            int width) {
  float* __restrict const value = sums.value, * __restrict const square = sums.square, * __restrict const product = sums.product;
  for (int x = 0; x < width; ++x) {
    value[x] += b[x] - d[x];
    square[x] += b[x] * b[x] - d[x] * d[x];
    product[x] += a[x] * b[x] - c[x] * d[x];
  }
}

// Window sums of a row, and the photograph's window means and variances.
struct WindowRow {
  const float *value, *square, *product, *mean, *variance;
};

// Inserts the costs of pixels first to last into the smallest costs.
[[gnu::always_inline]] inline void putCosts(WindowRow row, const std::uint8_t* ignored, int first, int last,
                                            float* __restrict count, BestCosts least) {
  const float* __restrict const sa = row.value, * __restrict const sb = row.square, * __restrict const sc = row.product;
  const float* __restrict const mean = row.mean, * __restrict const variance = row.variance;
  float* __restrict const b0 = least.row[0], * __restrict const b1 = least.row[1], * __restrict const b2 = least.row[2],
                          * __restrict const b3 = least.row[3], * __restrict const b4 = least.row[4];
  for (int x = first; x <= last; ++x) {
    const float other = sa[x] * kShare;
    const float spread = larger(sb[x] * kShare - other * other, 0.0f) + kNoiseVariance;
    const float covariance = sc[x] * kShare - mean[x] * other;
    const float correlation = covariance / std::sqrt(variance[x] * spread);
    const bool seen = !ignored || !ignored[x];
    // Unseen pixels cost more than any seen one.
    float c = seen ? 1.0f - smaller(larger(correlation, -1.0f), 1.0f) : kWorstCost;
    count[x] += seen ? 1.0f : 0.0f;
    for (float* const place : {&b0[x], &b1[x], &b2[x], &b3[x], &b4[x]}) {
      const float before = *place;
      *place = smaller(before, c);
      c = larger(before, c);
    }
  }
}

// Mean of the better half, in units of the cost volume.
[[gnu::always_inline]] inline void meanCosts(const float* __restrict count, BestCosts least,
                                             std::uint8_t* __restrict out, int width) {
  for (int x = 0; x < width; ++x) {
    const float n = count[x], half = float(int(0.5f * n + 0.5f));
    const float taken = smaller(half, float(kMaxAveragedSources));
    float sum = least.row[0][x];
    for (int k = 1; k < kMaxAveragedSources; ++k) sum += taken > float(k) ? least.row[k][x] : 0.0f;
    float c = sum / larger(taken, 1.0f);
    c = n == 1.0f ? kSingleSourceScale * c + kSingleSourceOffset : c;
    c = n == 0.0f ? kNoSourceCost : c;
    out[x] = std::uint8_t(int(smaller(c * kCostScale + 0.5f, 255.0f)));
  }
}

// Column sums over the window's rows, padded by the window's radius on both sides.
class Columns {
 public:
  explicit Columns(int width) : width_(width), values_(std::size_t(width + 2 * kRadius), 0.0f) {}
  float* data() { return values_.data() + kRadius; }
  void clear() { std::fill(values_.begin(), values_.end(), 0.0f); }
  void sumHorizontally(float* __restrict out) {
    float* __restrict const c = data();
    for (int r = 1; r <= kRadius; ++r) c[-r] = c[0], c[width_ - 1 + r] = c[width_ - 1];
    runVectorised<windowSums>(static_cast<const float*>(c), out, width_);
  }

 private:
  int width_;
  std::vector<float> values_;
};

const float* rowOf(const ImageF& picture, int y) {
  return &picture.values[std::size_t(std::clamp(y, 0, picture.height - 1)) * std::size_t(picture.width)];
}

// Computes the costs of one plane at a time. Reuses its working memory.
class SourceCorrelation {
 public:
  SourceCorrelation(const SweepView& photograph, std::size_t sources)
      : width_(photograph.grey.width),
        height_(photograph.grey.height),
        own_(width_, height_, 1),
        mean_(own_),
        variance_(own_) {
    for (std::size_t p = 0; p < own_.values.size(); ++p)
      own_.values[p] = float(int(photograph.grey.values[p] * kUnits + 0.5f)) - 128.0f * kUnits;
    for (std::size_t s = 0; s < sources; ++s) {
      value_.emplace_back(width_);
      square_.emplace_back(width_);
      product_.emplace_back(width_);
    }
    for (auto* row : {&sumA_, &sumB_, &sumC_, &count_}) row->resize(std::size_t(width_));
    for (auto& row : best_) row.resize(std::size_t(width_));
    zero_.assign(std::size_t(width_), 0.0f);
    computeOwnSums();
  }

  /// `cost`: height × width.
  void run(std::span<const WarpedView> warped, std::uint8_t* cost) {
    for (std::size_t s = 0; s < warped.size(); ++s) {
      value_[s].clear();
      square_[s].clear();
      product_[s].clear();
      for (int y = -kRadius - 1; y < kRadius; ++y) move(warped[s], s, y, false);
    }
    for (int y = 0; y < height_; ++y) {
      for (auto& row : best_) std::fill(row.begin(), row.end(), kWorstCost);
      std::fill(count_.begin(), count_.end(), 0.0f);
      for (std::size_t s = 0; s < warped.size(); ++s) {
        move(warped[s], s, y + kRadius, true);
        correlate(warped[s], s, y);
      }
      costs(cost + std::size_t(y) * std::size_t(width_));
    }
  }

 private:
  void computeOwnSums() {
    Columns value(width_), square(width_);
    const auto add = [&](int y, float sign) {
      const float* const a = rowOf(own_, y);
      for (int x = 0; x < width_; ++x) value.data()[x] += sign * a[x], square.data()[x] += sign * a[x] * a[x];
    };
    for (int y = -kRadius - 1; y < kRadius; ++y) add(y, 1);
    for (int y = 0; y < height_; ++y) {
      add(y + kRadius, 1);
      add(y - kRadius - 1, -1);
      value.sumHorizontally(sumA_.data());
      square.sumHorizontally(sumB_.data());
      for (int x = 0; x < width_; ++x) {
        const float mean = sumA_[std::size_t(x)] * kShare;
        mean_.pixel(x, y)[0] = mean;
        variance_.pixel(x, y)[0] = larger(sumB_[std::size_t(x)] * kShare - mean * mean, 0.0f) + kNoiseVariance;
      }
    }
  }

  // Adds row `in` to the column sums; with `takes`, subtracts the row that leaves the window.
  void move(const WarpedView& view, std::size_t s, int in, bool takes) {
    const float* const none = zero_.data();
    const float *const a = rowOf(own_, in), *const b = rowOf(view.grey, in);
    const float* const c = takes ? rowOf(own_, in - 2 * kRadius - 1) : none;
    const float* const d = takes ? rowOf(view.grey, in - 2 * kRadius - 1) : none;
    const ColumnSums sums{value_[s].data(), square_[s].data(), product_[s].data()};
    runVectorised<moveRows>(a, b, c, d, sums, width_);
  }

  // Inserts the source's costs into the smallest costs of the row.
  void correlate(const WarpedView& view, std::size_t s, int y) {
    const int first = view.first[std::size_t(y)], last = view.last[std::size_t(y)];
    if (first > last) return;
    value_[s].sumHorizontally(sumA_.data());
    square_[s].sumHorizontally(sumB_.data());
    product_[s].sumHorizontally(sumC_.data());
    const WindowRow row{sumA_.data(), sumB_.data(), sumC_.data(), rowOf(mean_, y), rowOf(variance_, y)};
    const std::uint8_t* const ignored =
        view.ignored.empty() ? nullptr : &view.ignored[std::size_t(y) * std::size_t(width_)];
    runVectorised<putCosts>(row, ignored, first, last, count_.data(), least());
  }

  void costs(std::uint8_t* out) {
    runVectorised<meanCosts>(static_cast<const float*>(count_.data()), least(), out, width_);
  }

  BestCosts least() {
    BestCosts result;
    for (int k = 0; k < kMaxAveragedSources; ++k) result.row[k] = best_[std::size_t(k)].data();
    return result;
  }

  int width_, height_;
  ImageF own_, mean_, variance_;                   // of the photograph
  std::vector<Columns> value_, square_, product_;  // by source
  std::vector<float> sumA_, sumB_, sumC_, count_, zero_;
  std::array<std::vector<float>, kMaxAveragedSources> best_;  // the row's smallest costs, ascending
};

struct Levels {
  double first = 0, step = 0;
  int count = 0;
  double at(double level) const { return first + level * step; }
};

// 0.5 % and 99.5 % quantiles of inverse depths, robust against outliers.
struct DepthQuantiles {
  double far, near;
  bool reachInfinity() const { return far < kInfinityRatio * near; }
};

DepthQuantiles quantilesOf(std::vector<double> tracks) {
  std::sort(tracks.begin(), tracks.end());
  const auto quantile = [&](double share) { return tracks[std::size_t(share * double(tracks.size() - 1) + 0.5)]; };
  return {quantile(0.005), quantile(0.995)};
}

Levels levelsOf(const Camera& photograph, std::span<const Camera> sources, SweepRange range) {
  const auto [first, near] = range;
  std::vector<double> motion;
  for (const Camera& source : sources)
    if (const double m = motionOf(photograph, source, 0.5 * (first + near)); m > 0) motion.push_back(m);
  std::sort(motion.begin(), motion.end());
  const double px = motion.empty() ? kMinLevels : motion[motion.size() / 2] * (near - first);
  const int count = int(std::clamp(std::ceil(px), kMinLevels, kMaxLevels)) + 1;
  return {first, (near - first) / (count - 1), count};
}

CostVolume costsOf(const SweepView& photograph, std::span<const SweepView> sources, const Levels& levels) {
  const int width = photograph.grey.width, height = photograph.grey.height;
  const std::size_t pixels = photograph.grey.values.size();
  std::vector<SweepView> views(sources.begin(), sources.end());
  std::vector<FrameToMember> maps;
  for (SweepView& view : views) {
    double motion = motionOf(photograph.camera, view.camera, levels.at(0.5 * (levels.count - 1))) * levels.step;
    for (; motion > kMaxMotionPx && std::min(view.grey.width, view.grey.height) > kMinSidePx; motion /= 2)
      view = halved(view);
    maps.push_back(frameToMember(photograph.camera, view.camera));
  }
  std::vector<WarpedView> warped(views.size(), WarpedView(width, height));
  SourceCorrelation correlation(photograph, views.size());
  CostVolume volume{width, height, levels.count, {}, photograph.grey, {}};
  volume.cost.resize(pixels * std::size_t(levels.count));
  std::vector<std::uint8_t> block(pixels * kBlock);
  for (int base = 0; base < levels.count; base += kBlock) {
    const int count = std::min(kBlock, levels.count - base);
    for (int k = 0; k < count; ++k) {
      for (std::size_t s = 0; s < views.size(); ++s)
        warp(views[s], maps[s].a + glm::outerProduct(maps[s].b, glm::dvec3(0, 0, levels.at(base + k))), warped[s]);
      correlation.run(warped, &block[std::size_t(k) * pixels]);
    }
    for (std::size_t p = 0; p < pixels; ++p)
      for (int k = 0; k < count; ++k)
        volume.cost[p * std::size_t(levels.count) + std::size_t(base + k)] = block[std::size_t(k) * pixels + p];
  }
  return volume;
}

}  // namespace

bool mostReachInfinity(std::vector<std::vector<double>> trackInverseDepths) {
  std::size_t known = 0, reaching = 0;
  for (std::vector<double>& tracks : trackInverseDepths) {
    if (tracks.empty()) continue;
    ++known;
    reaching += quantilesOf(std::move(tracks)).reachInfinity();
  }
  return 2 * reaching > known;
}

SweepRange sweepRange(std::vector<double> trackInverseDepths, bool fromInfinity) {
  constexpr double kStepsPerOctave = 8;
  const DepthQuantiles tracks = quantilesOf(std::move(trackInverseDepths));
  const auto octaves = [](double x) { return kStepsPerOctave * std::log2(x); };
  const double near = std::exp2(std::ceil(octaves(kNearFactor * tracks.near)) / kStepsPerOctave);
  if (fromInfinity || tracks.reachInfinity()) return {0, near};
  return {std::exp2(std::floor(octaves(kFarFactor * tracks.far)) / kStepsPerOctave), near};
}

int sweepLevelCount(const Camera& photograph, std::span<const Camera> sources, SweepRange range) {
  return levelsOf(photograph, sources, range).count;
}

SweptDepth sweptDepth(const SweepView& photograph, std::span<const SweepView> sources, SweepRange range) {
  const int width = photograph.grey.width, height = photograph.grey.height;
  const std::size_t pixels = photograph.grey.values.size();
  std::vector<Camera> cameras;
  for (const SweepView& source : sources) cameras.push_back(source.camera);
  const Levels levels = levelsOf(photograph.camera, cameras, range);
  const CostVolume volume = costsOf(photograph, sources, levels);
  const SemiGlobalMatch match = semiGlobalMatch(volume);
  SweptDepth result{ImageF(width, height, 1), Image8(width, height, 1), float(levels.step)};
  Image8 cost(width, height, 1);
  for (std::size_t p = 0; p < pixels; ++p) {
    const double level = std::clamp(double(match.level.values[p]), 0.0, double(levels.count - 1));
    const bool masked = !photograph.mask.empty() && !photograph.mask.values[p];
    cost.values[p] = volume.cost[p * std::size_t(levels.count) + std::size_t(std::lround(level))];
    const bool known = !masked && cost.values[p] < std::uint8_t(kNoSourceCost * kCostScale);
    result.inverseDepth.values[p] = known ? float(levels.at(level)) : kUnknownDepth;
  }
  if (levels.first > 0) return result;
  result.sky = skyOf(match.firstExcess, cost);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (!photograph.mask.empty() && !photograph.mask.values[p]) result.sky.values[p] = 0;
    if (result.sky.values[p]) result.inverseDepth.values[p] = 0;
  }
  return result;
}

}  // namespace ibr
