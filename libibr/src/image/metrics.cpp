// SPDX-License-Identifier: Apache-2.0
#include "ibr/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "base/check.h"
#include "image/srgb.h"

namespace ibr {
namespace {

using Limits = std::numeric_limits<double>;

void checkPictures(const Image8& a, const Image8& b, const Image8* mask) {
  check(a.width == b.width && a.height == b.height, ErrorCode::invalidInput,
        "pictures of {}x{} and {}x{} differ in size", a.width, a.height, b.width, b.height);
  check(a.channels >= 3 && b.channels >= 3, ErrorCode::invalidInput, "pictures of {} and {} channels have no colour",
        a.channels, b.channels);
  if (mask)
    check(mask->width == a.width && mask->height == a.height && mask->channels == 1, ErrorCode::invalidInput,
          "mask of {}x{} with {} channels for pictures of {}x{}", mask->width, mask->height, mask->channels, a.width,
          a.height);
}

double psnrOf(const Image8& a, const Image8& b, const Image8* mask) {
  checkPictures(a, b, mask);
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

constexpr int kWindow = 11, kRadius = kWindow / 2;

std::array<double, kWindow> gaussian() {
  std::array<double, kWindow> weights;
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) sum += weights[std::size_t(i)] = std::exp(-0.5 * std::pow((i - kRadius) / 1.5, 2));
  for (double& w : weights) w /= sum;
  return weights;
}

double luma(std::span<const std::uint8_t> p) {
  return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

// Weighted means of a, b, a², b², ab over the window around each pixel of one row.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double weight, const Moments& m) {
    a += weight * m.a, b += weight * m.b, aa += weight * m.aa, bb += weight * m.bb, ab += weight * m.ab;
  }
};

double similarity(const Moments& m) {
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);
  const double varianceA = m.aa - m.a * m.a, varianceB = m.bb - m.b * m.b, covariance = m.ab - m.a * m.b;
  return (2 * m.a * m.b + kC1) * (2 * covariance + kC2) /
         ((m.a * m.a + m.b * m.b + kC1) * (varianceA + varianceB + kC2));
}

// Whether every pixel of the window around each pixel counts: two passes of a running count.
std::vector<std::uint8_t> wholeWindows(const Image8& mask) {
  const int width = mask.width, height = mask.height;
  std::vector<int> rows(std::size_t(width), 0);  // counted pixels of the last kWindow rows, by column
  std::vector<std::uint8_t> whole(std::size_t(width) * std::size_t(height), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      rows[std::size_t(x)] += mask.pixel(x, y)[0] != 0;
      if (y >= kWindow) rows[std::size_t(x)] -= mask.pixel(x, y - kWindow)[0] != 0;
    }
    if (y < kWindow - 1) continue;
    int count = 0;
    for (int x = 0; x < width; ++x) {
      count += rows[std::size_t(x)];
      if (x >= kWindow) count -= rows[std::size_t(x - kWindow)];
      if (count == kWindow * kWindow)
        whole[std::size_t(y - kRadius) * std::size_t(width) + std::size_t(x - kRadius)] = 1;
    }
  }
  return whole;
}

double ssimOf(const Image8& a, const Image8& b, const Image8* mask) {
  checkPictures(a, b, mask);
  const int width = a.width, height = a.height;
  const std::array<double, kWindow> weights = gaussian();
  const std::vector<std::uint8_t> whole = mask ? wholeWindows(*mask) : std::vector<std::uint8_t>();
  std::vector<Moments> rows(std::size_t(width) * kWindow);  // the last kWindow rows, each where y % kWindow says
  std::vector<Moments> column(std::size_t(width), Moments{});
  double sum = 0;
  std::uint64_t count = 0;
  for (int last = 0; last < height; ++last) {
    for (int x = 0; x < width; ++x) {
      const double p = luma(a.pixel(x, last)), q = luma(b.pixel(x, last));
      rows[std::size_t(last % kWindow) * std::size_t(width) + std::size_t(x)] = {p, q, p * p, q * q, p * q};
    }
    const int y = last - kRadius;
    if (y < kRadius) continue;
    std::fill(column.begin(), column.end(), Moments{});
    for (int k = 0; k < kWindow; ++k) {
      const Moments* row = &rows[std::size_t((y - kRadius + k) % kWindow) * std::size_t(width)];
      for (int x = 0; x < width; ++x) column[std::size_t(x)].add(weights[std::size_t(k)], row[x]);
    }
    for (int x = kRadius; x + kRadius < width; ++x) {
      if (mask && !whole[std::size_t(y) * std::size_t(width) + std::size_t(x)]) continue;
      Moments window;
      for (int k = 0; k < kWindow; ++k) window.add(weights[std::size_t(k)], column[std::size_t(x - kRadius + k)]);
      sum += similarity(window);
      ++count;
    }
  }
  return count ? sum / double(count) : Limits::quiet_NaN();
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

}  // namespace

double psnr(const Image8& a, const Image8& b) {
  return psnrOf(a, b, nullptr);
}
double psnr(const Image8& a, const Image8& b, const Image8& mask) {
  return psnrOf(a, b, &mask);
}
double ssim(const Image8& a, const Image8& b) {
  return ssimOf(a, b, nullptr);
}
double ssim(const Image8& a, const Image8& b, const Image8& mask) {
  return ssimOf(a, b, &mask);
}

double deltaE(const Image8& a, const Image8& b, const Image8& mask) {
  checkPictures(a, b, &mask);
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (!mask.pixel(x, y)[0]) continue;
      const Lab p = labOf(a.pixel(x, y)), q = labOf(b.pixel(x, y));
      sum += std::hypot(p.l - q.l, p.a - q.a, p.b - q.b);
      ++count;
    }
  return count > 0 ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
}

Difference difference(const Image8& a, const Image8& b, int threshold) {
  checkPictures(a, b, nullptr);
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
