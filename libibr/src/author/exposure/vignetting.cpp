// SPDX-License-Identifier: Apache-2.0
#include "author/exposure/vignetting.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>
#include <utility>

#include "shared/cell.h"

namespace ibr {
namespace {

constexpr double kMaxNegligibleChange = 0.01;
constexpr double kMinTransmission = 1.0 / 8;  // min share of light; down to it the gain curve holds (shared/cell.h)
constexpr std::size_t kSteps = 4096;          // of r²; so fine that a step changes no 8-bit level

// Gains, and gains to the power of 1/2.4, for kSteps + 1 values of r² from 0 to 1.
std::vector<std::pair<float, float>> gainsByRadius(glm::dvec2 vignetting) {
  std::vector<std::pair<float, float>> gains;
  for (std::size_t step = 0; step <= kSteps; ++step) {
    const double radius = std::sqrt(double(step) / double(kSteps));
    const double gain =
        1 / std::clamp(std::exp(logVignetting(vignetting, radius)), kMinTransmission, 1 / kMinTransmission);
    gains.emplace_back(float(gain), float(std::pow(gain, 1 / 2.4)));
  }
  return gains;
}

}  // namespace

double vignettingRadius(const Intrinsics& k, glm::dvec2 pixel) {
  if (k.model != CameraModel::pinhole) return 0;
  return 2 * glm::distance(pixel, glm::dvec2(k.cx, k.cy)) / std::hypot(k.width, k.height);
}

std::vector<std::uint32_t> lensIndices(const std::vector<Photograph>& photographs) {
  using Key = std::tuple<std::string, std::string, std::string, double, double, int, int, long>;
  std::map<Key, std::uint32_t> numbers;
  std::vector<std::uint32_t> lenses;
  for (const Photograph& photo : photographs) {
    const CaptureMetadata& facts = photo.capture;
    const Intrinsics& k = photo.whole;
    const long focal = k.fx > 0 ? std::lround(10 * std::log(k.fx / std::max(k.width, k.height))) : 0;
    const Key key{facts.maker, facts.model, facts.lens, facts.fNumber, facts.focalLength, k.width, k.height, focal};
    lenses.push_back(numbers.emplace(key, std::uint32_t(numbers.size())).first->second);
  }
  return lenses;
}

bool isNegligible(glm::dvec2 vignetting) {
  for (double radius = 0; radius <= 1; radius += 0.0625)
    if (std::abs(logVignetting(vignetting, radius)) > kMaxNegligibleChange) return false;
  return true;
}

Image8 unvignetted(const Image8& picture, const Intrinsics& k, glm::dvec2 vignetting) {
  const std::vector<std::pair<float, float>> gains = gainsByRadius(vignetting);
  Image8 result = picture;
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      const double radius = vignettingRadius(k, {x + 0.5, y + 0.5});
      const auto& [gain, slope] = gains[std::min(std::size_t(std::lround(double(kSteps) * radius * radius)), kSteps)];
      const auto pixel = result.pixel(x, y);
      shader::vec3 colour(pixel[0], pixel[1], pixel[2]);
      colour = 255.0f * shader::exposedColour(colour / 255.0f, shader::vec3(gain), shader::vec3(slope));
      for (int c = 0; c < 3; ++c)
        pixel[std::size_t(c)] = std::uint8_t(std::lround(std::clamp(colour[c], 0.0f, 255.0f)));
    }
  return result;
}

std::string describeVignetting(const std::vector<glm::dvec2>& vignetting, const std::vector<std::uint32_t>& lenses) {
  std::map<std::uint32_t, std::pair<std::size_t, glm::dvec2>> found;
  for (std::size_t n = 0; n < lenses.size(); ++n) {
    ++found[lenses[n]].first;
    found[lenses[n]].second = vignetting[n];
  }
  std::string text = "vignetting:";
  for (const auto& [lens, of] : found) {
    text += fmt::format("{} {} of {} photographs of one lens: ", lens == found.begin()->first ? "" : ";", of.first,
                        lenses.size());
    text += isNegligible(of.second) ? "negligible"
                                    : fmt::format("corners have {:.0f} % of the centre's brightness",
                                                  100 * std::exp(logVignetting(of.second, 1)));
  }
  return text;
}

}  // namespace ibr
