// SPDX-License-Identifier: Apache-2.0
// SSIM: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural similarity",
// IEEE Trans. Image Processing 13(4), 2004.
// MS-SSIM: Wang, Simoncelli, Bovik, "Multi-scale structural similarity for image quality assessment", Asilomar 2003.
//
// The similarity of a window is l · cs: of its means (luminance) and its deviations (contrast and structure). Over five
// scales, each half of the previous: cs_1^β1 · … · cs_4^β4 · (l·cs)_5^β5. Each factor is the mean over all windows of
// its scale.
#include <algorithm>
#include <array>
#include <cmath>

#include "ibr/metrics.h"
#include "image/comparable.h"
#include "image/luma.h"

namespace ibr {
namespace {

constexpr int kWindow = 11, kRadius = kWindow / 2;
constexpr std::array kScaleWeights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};  // β

std::array<double, kWindow> gaussian() {
  std::array<double, kWindow> weights;
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) sum += weights[std::size_t(i)] = std::exp(-0.5 * std::pow((i - kRadius) / 1.5, 2));
  for (double& w : weights) w /= sum;
  return weights;
}

// Weighted means of a, b, a², b², ab over the window around each pixel of one row.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double weight, const Moments& m) {
    a += weight * m.a, b += weight * m.b, aa += weight * m.aa, bb += weight * m.bb, ab += weight * m.ab;
  }
};

constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);

double luminance(const Moments& m) {
  return (2 * m.a * m.b + kC1) / (m.a * m.a + m.b * m.b + kC1);
}

double contrastStructure(const Moments& m) {
  const double varianceA = m.aa - m.a * m.a, varianceB = m.bb - m.b * m.b, covariance = m.ab - m.a * m.b;
  return (2 * covariance + kC2) / (varianceA + varianceB + kC2);
}

// Marks each pixel whose whole window is inside the mask, by two passes of a running count.
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

struct Similarity {
  double ssim = std::numeric_limits<double>::quiet_NaN();               // mean of l · cs
  double contrastStructure = std::numeric_limits<double>::quiet_NaN();  // mean of cs
};

// Averages over the windows that lie inside the image and, with a mask, inside the mask.
Similarity similarityOf(const Luma& a, const Luma& b, const Image8* mask) {
  const int width = a.width, height = a.height;
  const std::array<double, kWindow> weights = gaussian();
  const std::vector<std::uint8_t> whole = mask ? wholeWindows(*mask) : std::vector<std::uint8_t>();
  std::vector<Moments> rows(std::size_t(width) * kWindow);  // the last kWindow rows; row y at y % kWindow
  std::vector<Moments> column(std::size_t(width), Moments{});
  double sum = 0, sumOfStructure = 0;
  std::uint64_t count = 0;
  for (int last = 0; last < height; ++last) {
    for (int x = 0; x < width; ++x) {
      const double p = a.at(x, last), q = b.at(x, last);
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
      const double structure = contrastStructure(window);
      sum += luminance(window) * structure;
      sumOfStructure += structure;
      ++count;
    }
  }
  if (count == 0) return {};
  return {sum / double(count), sumOfStructure / double(count)};
}

// Means of 2×2 pixels; drops an odd last row or column.
Luma halved(const Luma& in) {
  Luma out{in.width / 2, in.height / 2, {}};
  out.values.reserve(std::size_t(out.width) * std::size_t(out.height));
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.values.push_back(
          (in.at(2 * x, 2 * y) + in.at(2 * x + 1, 2 * y) + in.at(2 * x, 2 * y + 1) + in.at(2 * x + 1, 2 * y + 1)) / 4);
  return out;
}

}  // namespace

double ssim(const Image8& a, const Image8& b) {
  checkComparable(a, b, nullptr);
  return similarityOf(lumaOf(a), lumaOf(b), nullptr).ssim;
}

double ssim(const Image8& a, const Image8& b, const Image8& mask) {
  checkComparable(a, b, &mask);
  return similarityOf(lumaOf(a), lumaOf(b), &mask).ssim;
}

double msSsim(const Image8& a, const Image8& b) {
  checkComparable(a, b, nullptr);
  Luma p = lumaOf(a), q = lumaOf(b);
  double product = 1;
  for (std::size_t scale = 0; scale < kScaleWeights.size(); ++scale) {
    if (scale > 0) {
      p = halved(p);
      q = halved(q);
    }
    const Similarity similarity = similarityOf(p, q, nullptr);
    const bool coarsest = scale + 1 == kScaleWeights.size();
    const double factor = coarsest ? similarity.ssim : similarity.contrastStructure;
    if (std::isnan(factor)) return factor;  // image smaller than a window
    product *= std::pow(std::max(factor, 0.0), kScaleWeights[scale]);
  }
  return product;
}

}  // namespace ibr
