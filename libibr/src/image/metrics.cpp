// SPDX-License-Identifier: Apache-2.0
#include "ibr/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/srgb.h"
#include "image/comparable.h"
#include "image/luma.h"

namespace ibr {
namespace {

using Limits = std::numeric_limits<double>;

double psnrOf(const Image8& a, const Image8& b, const Image8* mask) {
  checkComparable(a, b, mask);
  std::uint64_t squares = 0, count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (mask && !mask->pixel(x, y)[0]) continue;
      const auto p = a.pixel(x, y), q = b.pixel(x, y);
      for (std::size_t c = 0; c < 3; ++c) squares += std::uint64_t((p[c] - q[c]) * (p[c] - q[c]));
      count += 3;
    }
  if (count == 0) return Limits::quiet_NaN();
  if (squares == 0) return Limits::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * double(count) / double(squares));
}

struct Lab {
  double l, a, b;
};

// IEC 61966-2-1 to XYZ; CIE 15 to Lab.
Lab labOf(std::span<const std::uint8_t> pixel) {
  double linear[3];
  for (std::size_t c = 0; c < 3; ++c) {
    linear[c] = srgbToLinear(pixel[c] / 255.0);
  }
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = f((0.4124564 * linear[0] + 0.3575761 * linear[1] + 0.1804375 * linear[2]) / 0.95047);
  const double y = f(0.2126729 * linear[0] + 0.7151522 * linear[1] + 0.0721750 * linear[2]);
  const double z = f((0.0193339 * linear[0] + 0.1191920 * linear[1] + 0.9503041 * linear[2]) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

template <class Visit>
void forTiles(const Image8& picture, const Visit& visit) {
  for (int y = 0; y < picture.height; y += kTileSidePx)
    for (int x = 0; x < picture.width; x += kTileSidePx)
      visit(x, y, std::min(x + kTileSidePx, picture.width), std::min(y + kTileSidePx, picture.height));
}

}  // namespace

double psnr(const Image8& a, const Image8& b) {
  return psnrOf(a, b, nullptr);
}
double psnr(const Image8& a, const Image8& b, const Image8& mask) {
  return psnrOf(a, b, &mask);
}
double deltaE(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  const Lab p = labOf(a), q = labOf(b);
  return std::hypot(p.l - q.l, p.a - q.a, p.b - q.b);
}

double deltaE(const Image8& a, const Image8& b, const Image8& mask) {
  checkComparable(a, b, &mask);
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (!mask.pixel(x, y)[0]) continue;
      sum += deltaE(a.pixel(x, y), b.pixel(x, y));
      ++count;
    }
  return count > 0 ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
}

Detail detail(const Image8& picture, const Image8& truth, const Image8& mask) {
  checkComparable(picture, truth, &mask);
  const Luma p = lumaOf(picture), q = lumaOf(truth);
  double pp = 0, qq = 0, pq = 0;
  const auto add = [&](int x, int y, int u, int v) {
    if (u >= p.width || v >= p.height || !mask.pixel(u, v)[0]) return;
    const double ofPicture = p.at(u, v) - p.at(x, y), ofTruth = q.at(u, v) - q.at(x, y);
    pp += ofPicture * ofPicture;
    qq += ofTruth * ofTruth;
    pq += ofPicture * ofTruth;
  };
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      if (!mask.pixel(x, y)[0]) continue;
      add(x, y, x + 1, y);
      add(x, y, x, y + 1);
    }
  if (qq == 0) return {Limits::quiet_NaN(), Limits::quiet_NaN()};
  return {pp / qq, pp > 0 ? std::clamp(pq / std::sqrt(pp * qq), -1.0, 1.0) : 0.0};
}

double sampledDetail(const Image8& picture) {
  constexpr int kPlaces = 4;
  const Luma luma = lumaOf(picture);
  const auto differences = [&](double fx, double fy) {  // squared gradients of the image shifted by (fx, fy) px
    const auto read = [&](int x, int y) {
      const double above = (1 - fx) * luma.at(x, y) + fx * luma.at(x + 1, y);
      return (1 - fy) * above + fy * ((1 - fx) * luma.at(x, y + 1) + fx * luma.at(x + 1, y + 1));
    };
    double sum = 0;
    for (int y = 0; y + 2 < luma.height; ++y)
      for (int x = 0; x + 2 < luma.width; ++x) {
        const double here = read(x, y), right = read(x + 1, y) - here, below = read(x, y + 1) - here;
        sum += right * right + below * below;
      }
    return sum;
  };
  double sum = 0;
  for (int i = 0; i < kPlaces * kPlaces; ++i) {
    const int column = i % kPlaces, row = i / kPlaces;
    sum += differences((column + 0.5) / kPlaces, (row + 0.5) / kPlaces) / (kPlaces * kPlaces);
  }
  const double whole = differences(0, 0);
  return whole > 0 ? sum / whole : Limits::quiet_NaN();
}

double tornTiles(const Image8& picture, const Image8& truth) {
  constexpr double kTimes = 3, kLevels = 4;  // factor on the truth's energy, and levels² added
  checkComparable(picture, truth, nullptr);
  const Luma p = lumaOf(picture), q = lumaOf(truth);
  std::size_t torn = 0, tiles = 0;
  forTiles(picture, [&](int left, int top, int right, int bottom) {
    const auto energy = [&](const Luma& luma) {
      double sum = 0;
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
          const double toRight = x + 1 < luma.width ? luma.at(x + 1, y) - luma.at(x, y) : 0.0;
          const double below = y + 1 < luma.height ? luma.at(x, y + 1) - luma.at(x, y) : 0.0;
          sum += toRight * toRight + below * below;
        }
      return sum / double((right - left) * (bottom - top));
    };
    torn += energy(p) > kTimes * energy(q) + kLevels;
    ++tiles;
  });
  return tiles > 0 ? double(torn) / double(tiles) : Limits::quiet_NaN();
}

WorstTile worstTile(const Image8& picture, const Image8& truth) {
  checkComparable(picture, truth, nullptr);
  WorstTile worst{0, 0, -1};
  forTiles(picture, [&](int left, int top, int right, int bottom) {
    double sum = 0;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const double off = double(picture.pixel(x, y)[c]) - double(truth.pixel(x, y)[c]);
          sum += off * off;
        }
    const double mean = sum / (3.0 * (right - left) * (bottom - top));
    if (mean > worst.meanSquared) worst = {left, top, mean};
  });
  return worst;
}

Difference difference(const Image8& a, const Image8& b, int threshold) {
  checkComparable(a, b, nullptr);
  Difference result;
  std::uint64_t sum = 0, above = 0;
  const std::size_t pixels = std::size_t(a.width) * std::size_t(a.height);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      int largest = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const int d = std::abs(a.pixel(x, y)[c] - b.pixel(x, y)[c]);
        largest = std::max(largest, d);
        sum += std::uint64_t(d);
      }
      above += largest > threshold;
      result.largest = std::max(result.largest, largest);
    }
  if (pixels > 0) {
    result.meanAbsolute = double(sum) / double(3 * pixels);
    result.shareAbove = double(above) / double(pixels);
  }
  return result;
}

}  // namespace ibr
