// SPDX-License-Identifier: Apache-2.0
#include "reference/texture_sampling.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "shared/panorama.h"

namespace ibr::reference {
namespace {

int wrapped(int x, int width) {
  return (x % width + width) % width;
}

Texel bilinear(const Image8& image, glm::dvec2 at, bool around) {  // at: 0 to 1; x wraps for panoramas
  const double x = at.x * image.width - 0.5, y = at.y * image.height - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  Texel result;
  glm::dvec3 low(255), high(0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int column = around ? wrapped(x0 + i, image.width) : std::clamp(x0 + i, 0, image.width - 1);
      const auto p = image.pixel(column, std::clamp(y0 + j, 0, image.height - 1));
      const glm::dvec3 value(p[0], p[1], p[2]);
      const double weight = (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0));
      result.colour += weight * value / 255.0;
      result.alpha += weight * p[3] / 255.0;
      low = glm::min(low, value);
      high = glm::max(high, value);
    }
  result.range = largest(high - low);
  return result;
}

// Keys 1981, eq. 4 with a = −1/2: weight of a sample at distance x.
double keys(double x) {
  x = std::abs(x);
  if (x < 1) return 1.5 * x * x * x - 2.5 * x * x + 1;
  return x < 2 ? -0.5 * x * x * x + 2.5 * x * x - 4 * x + 2 : 0;
}

Texel bicubic(const Image8& image, glm::dvec2 at, bool around) {
  const double x = at.x * image.width - 0.5, y = at.y * image.height - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  Texel result;
  glm::dvec3 low(255), high(0);
  for (int j = y0 - 1; j <= y0 + 2; ++j)
    for (int i = x0 - 1; i <= x0 + 2; ++i) {
      const int column = around ? wrapped(i, image.width) : std::clamp(i, 0, image.width - 1);
      const auto p = image.pixel(column, std::clamp(j, 0, image.height - 1));
      const glm::dvec3 value(p[0], p[1], p[2]);
      result.colour += keys(x - i) * keys(y - j) * value / 255.0;
      low = glm::min(low, value);
      high = glm::max(high, value);
    }
  result.colour = glm::clamp(result.colour, 0.0, 1.0);
  result.range = largest(high - low);
  return result;
}

}  // namespace

glm::dvec3 exposedColour(glm::dvec3 colour, glm::dvec3 gain) {
  const double clipped = std::clamp((largest(colour) - 0.9) / 0.09, 0.0, 1.0);  // share
  glm::dvec3 result;
  for (int c = 0; c < 3; ++c) {
    const double slope = std::pow(gain[c], 1 / 2.4), before = colour[c];
    const double curved = slope * (before + 0.055) - 0.055, straight = gain[c] * before;
    const double after = gain[c] < 1 ? std::max(curved, straight) : std::min(curved, straight);
    result[c] = after < before ? after + clipped * (before - after) : after;
  }
  return result;
}

Texel trilinear(const std::vector<Image8>& levels, glm::dvec2 at, double footprint, bool around, bool cubic) {
  const double lod = std::clamp(std::log2(std::max(footprint, 1e-30)), 0.0, double(levels.size() - 1));
  const auto fine = std::size_t(lod);
  Texel a = bilinear(levels[fine], at, around);
  if (cubic && fine == 0) {
    const double alpha = a.alpha;  // a mask's edge must not overshoot
    a = bicubic(levels[0], at, around);
    a.alpha = alpha;
  }
  if (fine + 1 >= levels.size() || lod == double(fine)) return a;
  const Texel b = bilinear(levels[fine + 1], at, around);
  const double t = lod - double(fine);
  Texel result = mixed(a, 1 - t, b, t);
  result.levelRange = 255 * largest(glm::abs(a.colour - b.colour));
  return result;
}

Texel samplePanorama(const std::vector<Image8>& levels, const Intrinsics& k, glm::dvec3 here, glm::dvec3 dx,
                     glm::dvec3 dy, bool cubic) {
  const glm::dvec3 ray = glm::normalize(here);
  const double longitude = std::atan2(ray.x, -ray.z), cosine = std::hypot(ray.x, ray.z);
  const glm::dvec3 east(std::cos(longitude), 0, std::sin(longitude));
  const glm::dvec3 north = glm::cross(east, ray);
  const glm::dvec2 texelsPerRadian(k.width / (2 * std::numbers::pi), k.height / std::numbers::pi);
  const glm::dvec2 x = texelsPerRadian * glm::dvec2(glm::dot(dx, east), glm::dot(dx, north));
  const glm::dvec2 y = texelsPerRadian * glm::dvec2(glm::dot(dy, east), glm::dot(dy, north));
  const double footprint = std::max(glm::length(x), glm::length(y));
  const double apart = std::max(footprint, 1.0);
  const double width = std::min(std::hypot(x.x, y.x) / std::max(cosine, 1e-6), double(k.width));
  const double wanted = 0.5 * std::max(width / apart - 1.5, 0.0), most = double(shader::kMaxPanoramaReach);
  const double reach = std::min(wanted, most), spacing = apart / k.width * std::max(wanted / most, 1.0);
  const glm::dvec2 at = *project(k, ray) / glm::dvec2(k.width, k.height);
  Texel sum = trilinear(levels, at, footprint, true, cubic);
  double total = 1;
  for (int tap = 1; tap < reach + 1; ++tap)
    for (const double side : {-1.0, 1.0}) {
      const double weight = std::min(reach + 1 - tap, 1.0);
      sum = mixed(sum, 1, trilinear(levels, at + glm::dvec2(side * tap * spacing, 0), footprint, true, cubic), weight);
      total += weight;
    }
  sum.colour /= total;
  sum.alpha /= total;
  return sum;
}

}  // namespace ibr::reference
