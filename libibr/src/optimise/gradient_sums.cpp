// SPDX-License-Identifier: Apache-2.0
#include "optimise/gradient_sums.h"

#include <algorithm>
#include <array>
#include <glm/mat2x2.hpp>

namespace ibr {
namespace {

constexpr int kLanes = 8;       // pixels per step
constexpr int kMaxSteps = 256;  // between reductions of the lanes, to limit rounding of floats

using Lane = std::array<float, kLanes>;

struct Samples {  // of one channel at eight pixels
  Lane value, byX, byY;
};

// Sums of x, y, g per channel; products over all channels.
struct Lanes {
  struct Channel {
    Lane x{}, y{}, g0{}, g1{};
  };
  std::array<Channel, 3> channels;
  Lane xx{}, xy{}, yy{}, xg0{}, xg1{}, yg0{}, yg1{}, g00{}, g01{}, g11{};
  int steps = 0;
};

struct Totals {
  struct Channel {
    double x = 0, y = 0, g0 = 0, g1 = 0;
  };
  std::array<Channel, 3> channels;
  double n = 0, xx = 0, xy = 0, yy = 0, xg0 = 0, xg1 = 0, yg0 = 0, yg1 = 0, g00 = 0, g01 = 0, g11 = 0;
};

double sum(const Lane& lane) {
  double all = 0;
  for (const float v : lane) all += double(v);
  return all;
}

void empty(Totals& totals, Lanes& lanes) {
  for (std::size_t c = 0; c < 3; ++c) {
    totals.channels[c].x += sum(lanes.channels[c].x);
    totals.channels[c].y += sum(lanes.channels[c].y);
    totals.channels[c].g0 += sum(lanes.channels[c].g0);
    totals.channels[c].g1 += sum(lanes.channels[c].g1);
  }
  totals.xx += sum(lanes.xx), totals.xy += sum(lanes.xy), totals.yy += sum(lanes.yy);
  totals.xg0 += sum(lanes.xg0), totals.xg1 += sum(lanes.xg1);
  totals.yg0 += sum(lanes.yg0), totals.yg1 += sum(lanes.yg1);
  totals.g00 += sum(lanes.g00), totals.g01 += sum(lanes.g01), totals.g11 += sum(lanes.g11);
  lanes = {};
}

struct Texel4 {
  std::array<std::uint32_t, kLanes> t00, t10, t01, t11;
  Lane wx, wy;
};

void fetch(const RunSource& s, int first, int count, Texel4& texels) {
  constexpr float kUnit = 1.0f / float(1 << shader::kEccRunBits);
  constexpr int kMask = (1 << shader::kEccRunBits) - 1;
  for (int l = 0; l < kLanes; ++l) {
    const int i = first + std::min(l, count - 1);
    const std::int32_t x = s.x + i * s.stepX, y = s.y + i * s.stepY;
    const std::uint32_t* at =
        s.texel + std::ptrdiff_t(y >> shader::kEccRunBits) * s.stride + (x >> shader::kEccRunBits);
    const auto lane = std::size_t(l);
    texels.t00[lane] = at[0], texels.t10[lane] = at[1];
    texels.t01[lane] = at[s.stride], texels.t11[lane] = at[s.stride + 1];
    texels.wx[lane] = float(x & kMask) * kUnit, texels.wy[lane] = float(y & kMask) * kUnit;
  }
}

// Bilinear sample and its exact derivative.
void sample(const Texel4& texels, int channel, Samples& samples) {
  const int up = 24 - 8 * channel;
  const auto level = [&](std::uint32_t word) { return float(std::int32_t(word << up) >> 24); };
  for (std::size_t l = 0; l < kLanes; ++l) {
    const float t00 = level(texels.t00[l]), t01 = level(texels.t01[l]);
    const float upper = level(texels.t10[l]) - t00, lower = level(texels.t11[l]) - t01;
    const float above = t00 + upper * texels.wx[l], below = t01 + lower * texels.wx[l];
    samples.byX[l] = upper + (lower - upper) * texels.wy[l];
    samples.byY[l] = below - above;
    samples.value[l] = above + (below - above) * texels.wy[l];
  }
}

void addTo(Lane& lane, const Lane& a, const Lane& b) {
  for (std::size_t l = 0; l < kLanes; ++l) lane[l] += a[l] * b[l];
}

void addTo(Lane& lane, const Lane& a) {
  for (std::size_t l = 0; l < kLanes; ++l) lane[l] += a[l];
}

// A triangle's share in the weight of the star's point: value at the run's first pixel, slope, and displacement map.
struct Hat {
  float first, step;
  glm::mat2 apart;  // (I − J/2)ᵀ
};

void addStep(const Texel4& source, const Texel4& target, const Lane& hat, const Lane& counted, const Hat& maps,
             Lanes& lanes) {
  for (std::size_t c = 0; c < 3; ++c) {
    Samples a, b;
    sample(source, int(c), a);
    sample(target, int(c), b);
    Lane x, y, g0, g1;
    for (std::size_t l = 0; l < kLanes; ++l) {
      x[l] = a.value[l] * counted[l];
      y[l] = b.value[l] * counted[l];
      const float byX = hat[l] * (a.byX[l] + b.byX[l]), byY = hat[l] * (a.byY[l] + b.byY[l]);
      g0[l] = maps.apart[0][0] * byX + maps.apart[1][0] * byY;
      g1[l] = maps.apart[0][1] * byX + maps.apart[1][1] * byY;
    }
    Lanes::Channel& channel = lanes.channels[c];
    addTo(channel.x, x), addTo(channel.y, y), addTo(channel.g0, g0), addTo(channel.g1, g1);
    addTo(lanes.xx, x, x), addTo(lanes.xy, x, y), addTo(lanes.yy, y, y);
    addTo(lanes.xg0, x, g0), addTo(lanes.xg1, x, g1), addTo(lanes.yg0, y, g0), addTo(lanes.yg1, y, g1);
    addTo(lanes.g00, g0, g0), addTo(lanes.g01, g0, g1), addTo(lanes.g11, g1, g1);
  }
}

void addRun(const RunSource& source, const RunSource& target, int pixels, const Hat& hat, Totals& totals,
            Lanes& lanes) {
  for (int first = 0; first < pixels; first += kLanes) {
    const int count = std::min(pixels - first, kLanes);
    Texel4 a, b;
    fetch(source, first, count, a);
    fetch(target, first, count, b);
    Lane weight, counted;
    for (int l = 0; l < kLanes; ++l) {
      counted[std::size_t(l)] = l < count ? 1.0f : 0.0f;
      weight[std::size_t(l)] = counted[std::size_t(l)] * (hat.first + hat.step * float(first + l));
    }
    addStep(a, b, weight, counted, hat, lanes);
    if (++lanes.steps == kMaxSteps) empty(totals, lanes);
  }
  totals.n += pixels;
}

// φ = area(pixel, b, c) / area(a, b, c) in the mean.
class Weight {
 public:
  Weight(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c)
      : b_(b), along_(c - b), perArea_(1.0 / double(shader::eccArea(a, b, c))) {}
  double at(int column, int row) const {
    const glm::dvec2 p = glm::dvec2(column, row) * double(shader::kEccPixel) + double(shader::kEccPixel) / 2 - b_;
    return (along_.x * p.y - along_.y * p.x) * perArea_;
  }
  double step() const { return -along_.y * double(shader::kEccPixel) * perArea_; }

 private:
  glm::dvec2 b_, along_;
  double perArea_;
};

glm::mat2 apartOf(const shader::EccMap& source) {
  constexpr double kTwoTexels = 2.0 * double(std::int64_t(1) << shader::kEccCoordinateBits);
  const glm::dmat2 half(glm::dvec2(double(source.xByX), double(source.xByY)) / kTwoTexels,  // columns: rows of J/2
                        glm::dvec2(double(source.yByX), double(source.yByY)) / kTwoTexels);
  return glm::mat2(glm::dmat2(1.0) - half);
}

// Adds the sums of all three channels; centre() subtracts the means.
void addUncentred(GradientSums& sums, const Totals& t) {
  sums.samples += 3 * t.n;
  sums.xx += t.xx, sums.xy += t.xy, sums.yy += t.yy;
  sums.xg += glm::dvec2(t.xg0, t.xg1), sums.yg += glm::dvec2(t.yg0, t.yg1);
  sums.g00 += t.g00, sums.g01 += t.g01, sums.g11 += t.g11;
}

void centre(GradientSums& sums, const Totals::Channel& c, double n) {
  const glm::dvec2 g(c.g0, c.g1);
  sums.xx -= c.x * c.x / n, sums.xy -= c.x * c.y / n, sums.yy -= c.y * c.y / n;
  sums.xg -= g * (c.x / n), sums.yg -= g * (c.y / n);
  sums.g00 -= g.x * g.x / n, sums.g01 -= g.x * g.y / n, sums.g11 -= g.y * g.y / n;
}

// Adds one pair of images; returns false if a triangle cannot be judged.
bool addPair(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member, std::size_t k,
             glm::ivec2 offset, RowChoice rows, Totals& totals) {
  const auto corner = [&](std::uint32_t p) { return Corner{at[member][p], at[k][p]}; };
  const Texels &source = input.pictures[member], &target = input.pictures[k];
  Lanes lanes;
  for (const glm::uvec2& edge : input.mesh.star[point]) {
    Corner a = corner(point);
    a.source += offset;
    const Corner b = corner(edge.x), c = corner(edge.y);
    TriangleMaps maps;
    if (!maps.set(a, b, c)) return false;
    const Weight weight(a.mean(), b.mean(), c.mean());
    Hat hat{0, float(weight.step()), apartOf(maps.source)};
    forEachRun(a.mean(), b.mean(), c.mean(), rows, [&](int column, int row, int pixels) {
      hat.first = float(weight.at(column, row));
      addRun(runAt(maps.source, source, maps.origin, column, row), runAt(maps.target, target, maps.origin, column, row),
             pixels, hat, totals, lanes);
    });
  }
  empty(totals, lanes);
  return true;
}

}  // namespace

GradientSums gradientSums(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                          glm::ivec2 offset, EccDefinition definition, double varianceFloor, RowChoice rows) {
  GradientSums sums;
  Totals::Channel all;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (k == member) continue;
    Totals totals;
    if (!addPair(input, at, point, member, k, offset, rows, totals)) return {};
    if (totals.n == 0) continue;
    addUncentred(sums, totals);
    for (const Totals::Channel& c : totals.channels) {
      if (definition == EccDefinition::channels) centre(sums, c, totals.n);
      all.x += c.x, all.y += c.y, all.g0 += c.g0, all.g1 += c.g1;
    }
  }
  if (sums.samples == 0) return {};
  if (definition == EccDefinition::channels) {
    const double added = varianceFloor * sums.samples;
    sums.xx += added, sums.xy += added, sums.yy += added;
  } else {
    centre(sums, all, sums.samples);
  }
  return sums;
}

}  // namespace ibr
