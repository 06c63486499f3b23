// SPDX-License-Identifier: Apache-2.0
// LDR-FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020.
//
//   colour:   YCxCz filtered by the contrast sensitivity of the eye → clamped RGB → Hunt-adjusted Lab → HyAB distance
//             → its power 0.7, spread over 0 … 1
//   features: edges and points of the unfiltered luminance; the larger difference of their strengths
//   pixel:    colour^(1 − feature)
//
// All filters are separable; images continue beyond their borders with the border's values.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/check.h"
#include "base/srgb.h"
#include "ibr/metrics.h"

namespace ibr {
namespace {

using Plane = std::vector<float>;   // one value per pixel, row by row
using Kernel = std::vector<float>;  // of odd length

constexpr double kColourPower = 0.7, kKnee = 0.4, kAtKnee = 0.95, kFeaturePower = 0.5;  // q_c, p_c, p_t, q_f
constexpr double kFeatureWidth = 0.082;                                                 // w, degrees

// Columns are R, G, B (IEC 61966-2-1); their sum is the white point.
const glm::dmat3 kXyzOfRgb{0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522,
                           0.1191920, 0.1804375, 0.0721750, 0.9503041};
const glm::dvec3 kWhite = kXyzOfRgb * glm::dvec3(1.0);

glm::dvec3 yccOf(const glm::dvec3& rgb) {
  const glm::dvec3 n = kXyzOfRgb * rgb / kWhite;
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

glm::dvec3 rgbOf(const glm::dvec3& ycc) {
  static const glm::dmat3 kRgbOfXyz = glm::inverse(kXyzOfRgb);
  const double y = (ycc.x + 16) / 116;
  return kRgbOfXyz * (glm::dvec3(y + ycc.y / 500, y, y - ycc.z / 200) * kWhite);
}

// CIE 15, with less chroma in dark colours (Hunt effect).
glm::dvec3 huntLabOf(const glm::dvec3& rgb) {
  const glm::dvec3 n = kXyzOfRgb * rgb / kWhite;
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double l = 116 * f(n.y) - 16;
  return {l, 0.01 * l * 500 * (f(n.x) - f(n.y)), 0.01 * l * 200 * (f(n.y) - f(n.z))};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

// Maps a HyAB distance to 0 … 1; green and blue have the largest distance.
double spread(double distance) {
  static const double kMaxDistance = std::pow(hyab(huntLabOf({0, 1, 0}), huntLabOf({0, 0, 1})), kColourPower);  // c_max
  const double c = std::pow(distance, kColourPower), knee = kKnee * kMaxDistance;
  if (c < knee) return kAtKnee / knee * c;
  return std::min(1.0, kAtKnee + (c - knee) / (kMaxDistance - knee) * (1 - kAtKnee));
}

template <class F>
std::vector<double> sampled(int radius, F&& value) {
  std::vector<double> weights;
  for (int x = -radius; x <= radius; ++x) weights.push_back(value(double(x)));
  return weights;
}

// Scales positive weights to the sum 1 and negative ones to −1.
Kernel balanced(const std::vector<double>& weights) {
  double above = 0, below = 0;
  for (const double w : weights) (w > 0 ? above : below) += std::abs(w);
  Kernel result;
  for (const double w : weights) result.push_back(float(w / (w > 0 || below == 0 ? above : below)));
  return result;
}

Plane convolved(const Plane& in, int width, int height, const Kernel& alongX, const Kernel& alongY) {
  const int rx = int(alongX.size() / 2), ry = int(alongY.size() / 2);
  Plane rows(in.size()), out(in.size(), 0.0f);
  std::vector<float> padded(std::size_t(width + 2 * rx));
  for (int y = 0; y < height; ++y) {
    const float* const row = &in[std::size_t(y) * std::size_t(width)];
    for (int x = -rx; x < width + rx; ++x) padded[std::size_t(x + rx)] = row[std::clamp(x, 0, width - 1)];
    float* const to = &rows[std::size_t(y) * std::size_t(width)];
    std::fill_n(to, width, 0.0f);
    for (std::size_t k = 0; k < alongX.size(); ++k)
      for (int x = 0; x < width; ++x) to[x] += alongX[k] * padded[std::size_t(x) + k];
  }
  for (int y = 0; y < height; ++y) {
    float* const to = &out[std::size_t(y) * std::size_t(width)];
    for (int k = -ry; k <= ry; ++k) {
      const float* const from = &rows[std::size_t(std::clamp(y + k, 0, height - 1)) * std::size_t(width)];
      const float weight = alongY[std::size_t(k + ry)];
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
  return out;
}

// a · √(π/b) · exp(−π² x² / b), x in degrees: the inverse Fourier transform of a contrast sensitivity a · exp(−b f²).
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr std::array kBlueYellow{Sensitivity{34.1, 0.04}, Sensitivity{13.5, 0.025}};

class Eye {
 public:
  explicit Eye(double pixelsPerDegree)
      : pixelsPerDegree_(pixelsPerDegree),
        radius_(int(std::ceil(3 * std::sqrt(kBlueYellow[0].b / 2) / std::numbers::pi * pixelsPerDegree))) {
    const double deviation = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int radius = int(std::ceil(3 * deviation));
    const auto gauss = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    smooth_ = balanced(sampled(radius, gauss));
    edge_ = balanced(sampled(radius, [&](double x) { return -x * gauss(x); }));
    point_ = balanced(sampled(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * gauss(x); }));
  }

  // Filters the three planes in place by the eye's contrast sensitivity.
  void filter(std::array<Plane, 3>& ycc, int width, int height) const {
    for (const auto& [plane, sensitivity] : {std::pair{&ycc[0], kAchromatic}, std::pair{&ycc[1], kRedGreen}}) {
      const Kernel weights = balanced(sampledOf(sensitivity));
      *plane = convolved(*plane, width, height, weights, weights);
    }
    // The sum of the two is not separable; each of them is.
    Plane sum(ycc[2].size(), 0.0f);
    double weightSum = 0;
    for (const Sensitivity& s : kBlueYellow) {
      const std::vector<double> raw = sampledOf(s);
      const Kernel weights = balanced(raw);
      const double total = std::accumulate(raw.begin(), raw.end(), 0.0);
      const double weight = s.a * std::sqrt(std::numbers::pi / s.b) * total * total;
      const Plane part = convolved(ycc[2], width, height, weights, weights);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += float(weight) * part[i];
      weightSum += weight;
    }
    for (float& value : sum) value = float(value / weightSum);
    ycc[2] = std::move(sum);
  }

  struct Features {
    Plane edges, points;  // strengths
  };
  Features features(const Plane& luminance, int width, int height) const {
    const auto strength = [&](const Kernel& across) {
      Plane x = convolved(luminance, width, height, across, smooth_);
      const Plane y = convolved(luminance, width, height, smooth_, across);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
      return x;
    };
    return {strength(edge_), strength(point_)};
  }

 private:
  std::vector<double> sampledOf(const Sensitivity& s) const {
    return sampled(radius_, [&](double x) {
      const double degrees = x / pixelsPerDegree_;
      return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / s.b);
    });
  }

  double pixelsPerDegree_;
  int radius_;
  Kernel smooth_, edge_, point_;
};

struct Seen {
  std::vector<glm::vec3> lab;  // Hunt-adjusted
  Eye::Features features;
};

Seen seen(const Image8& picture, const Eye& eye) {
  static const std::array<double, 256> kLinear = [] {
    std::array<double, 256> table;
    for (std::size_t v = 0; v < table.size(); ++v) table[v] = srgbToLinear(double(v) / 255);
    return table;
  }();
  const std::size_t count = std::size_t(picture.width) * std::size_t(picture.height);
  const auto channels = std::size_t(picture.channels);
  std::array<Plane, 3> ycc{Plane(count), Plane(count), Plane(count)};
  Plane luminance(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* const p = &picture.values[i * channels];
    const glm::dvec3 value = yccOf({kLinear[p[0]], kLinear[p[1]], kLinear[p[2]]});
    for (std::size_t c = 0; c < 3; ++c) ycc[c][i] = float(value[int(c)]);
    luminance[i] = float((value.x + 16) / 116);
  }
  Seen result{std::vector<glm::vec3>(count), eye.features(luminance, picture.width, picture.height)};
  eye.filter(ycc, picture.width, picture.height);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 rgb = rgbOf({ycc[0][i], ycc[1][i], ycc[2][i]});
    result.lab[i] = huntLabOf(glm::clamp(rgb, glm::dvec3(0.0), glm::dvec3(1.0)));
  }
  return result;
}

}  // namespace

ImageF flipMap(const Image8& a, const Image8& b, double pixelsPerDegree) {
  check(a.width == b.width && a.height == b.height && !a.empty(), ErrorCode::invalidInput,
        "images of {}x{} and {}x{} are empty or differ in size", a.width, a.height, b.width, b.height);
  check(a.channels >= 3 && b.channels >= 3, ErrorCode::invalidInput,
        "images of {} and {} channels: at least 3 are needed", a.channels, b.channels);
  check(pixelsPerDegree >= 1 && pixelsPerDegree <= 1000, ErrorCode::invalidInput,
        "{} pixels per degree is not within 1 to 1000", pixelsPerDegree);
  const Eye eye(pixelsPerDegree);
  const Seen p = seen(a, eye), q = seen(b, eye);
  ImageF map(a.width, a.height, 1);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double colour = spread(hyab(p.lab[i], q.lab[i]));
    const double edges = std::abs(p.features.edges[i] - q.features.edges[i]),
                 points = std::abs(p.features.points[i] - q.features.points[i]);
    const double feature = std::pow(std::max(edges, points) / std::numbers::sqrt2, kFeaturePower);
    map.values[i] = float(std::pow(colour, 1 - std::min(feature, 1.0)));
  }
  return map;
}

double flip(const Image8& a, const Image8& b, double pixelsPerDegree) {
  const ImageF map = flipMap(a, b, pixelsPerDegree);
  return std::accumulate(map.values.begin(), map.values.end(), 0.0) / double(map.values.size());
}

}  // namespace ibr
