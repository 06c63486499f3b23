// SPDX-License-Identifier: Apache-2.0
#include "io/colour_code.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "base/check.h"
#include "base/srgb.h"

namespace ibr::io {
namespace {

constexpr double kDiffuseWhite = 203, kPeak = 1000;  // cd/m²
constexpr double kKnee = 0.7;                        // light above it is compressed, of diffuse white

struct Chromaticities {
  glm::dvec2 red, green, blue, white;
};

constexpr glm::dvec2 kD65{0.3127, 0.3290};
constexpr Chromaticities kBt709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65};

Chromaticities chromaticitiesOf(int primaries) {
  switch (primaries) {
    case 1:
    case 2:  // unspecified
      return kBt709;
    case 5:
      return {{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, kD65};  // BT.470 B, G
    case 6:
    case 7:
      return {{0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, kD65};  // BT.601 525, SMPTE 240M
    case 9:
      return {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65};  // BT.2020
    case 12:
      return {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65};  // P3, D65
    default:
      fail(ErrorCode::unsupported, "colour primaries {} of ITU-T H.273 are not supported; convert the file to sRGB",
           primaries);
  }
}

// XYZ of light of the primaries; white has Y = 1.
glm::dmat3 toXyz(const Chromaticities& c) {
  const auto xyz = [](glm::dvec2 p) { return glm::dvec3(p.x / p.y, 1, (1 - p.x - p.y) / p.y); };
  glm::dmat3 m(xyz(c.red), xyz(c.green), xyz(c.blue));
  const glm::dvec3 scale = glm::inverse(m) * xyz(c.white);
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  return m;
}

// Light of an encoded value of 0 to 1, relative to (diffuse) white.
double lightOf(double v, int transfer) {
  switch (transfer) {
    case 4:
      return std::pow(v, 2.2);
    case 5:
      return std::pow(v, 2.8);
    case 8:
      return v;
    case 16: {  // SMPTE ST 2084: 10000 cd/m² at 1
      constexpr double m1 = 0.1593017578125, m2 = 78.84375, c1 = 0.8359375, c2 = 18.8515625, c3 = 18.6875;
      const double p = std::pow(v, 1 / m2);
      return 10000 / kDiffuseWhite * std::pow(std::max(0.0, p - c1) / (c2 - c3 * p), 1 / m1);
    }
    default:
      return srgbToLinear(v);
  }
}

// HLG (Recommendation ITU-R BT.2100, table 5): scene light of 0 to 1.
double hlgSceneLight(double v) {
  constexpr double a = 0.17883277, b = 0.28466892, c = 0.55991073;
  return v <= 0.5 ? v * v / 3 : (std::exp((v - c) / a) + b) / 12;
}

bool isHdr(int transfer) {
  return transfer == 16 || transfer == 18;
}

// Compresses light above the knee, with slope 1 there; kPeak becomes 1.
double compressed(double light) {
  constexpr double range = kPeak / kDiffuseWhite - kKnee, room = 1 - kKnee;
  constexpr double bend = (range - room) / (room * range);
  const double above = light - kKnee;
  return above <= 0 ? light : kKnee + above / (1 + bend * above);
}

}  // namespace

bool isSrgb(ColourCode code) {
  constexpr std::array kShown{1, 2, 6, 13, 14, 15};  // BT.709, unspecified, BT.601, sRGB, BT.2020
  return (code.primaries == 1 || code.primaries == 2) && std::ranges::find(kShown, code.transfer) != kShown.end();
}

Image8 toSrgb(const Image<std::uint16_t>& picture, ColourCode code) {
  constexpr std::array kTransfers{1, 2, 4, 5, 6, 8, 13, 14, 15, 16, 18};
  constexpr std::size_t kCodes = 65536;
  check(std::ranges::find(kTransfers, code.transfer) != kTransfers.end(), ErrorCode::unsupported,
        "transfer characteristics {} of ITU-T H.273 are not supported; convert the file to sRGB", code.transfer);
  const glm::dmat3 toBt709 = glm::inverse(toXyz(kBt709)) * toXyz(chromaticitiesOf(code.primaries));
  const glm::dmat3 xyz = toXyz(chromaticitiesOf(code.primaries));
  const glm::dvec3 luminance(xyz[0].y, xyz[1].y, xyz[2].y);
  const bool same = code.primaries == 1 || code.primaries == 2, hdr = isHdr(code.transfer), hlg = code.transfer == 18;
  std::vector<double> light(kCodes);
  for (std::size_t v = 0; v < kCodes; ++v) {
    const double value = double(v) / double(kCodes - 1);
    light[v] = hlg ? hlgSceneLight(value) : lightOf(value, code.transfer);
  }
  std::vector<std::uint8_t> encoded(kCodes);
  for (std::size_t v = 0; v < kCodes; ++v)
    encoded[v] = std::uint8_t(std::lround(255 * linearToSrgb(double(v) / double(kCodes - 1))));
  Image8 result(picture.width, picture.height, 3);
  for (std::size_t i = 0; i + 2 < picture.values.size(); i += 3) {
    glm::dvec3 rgb;
    for (int c = 0; c < 3; ++c) rgb[c] = light[picture.values[i + std::size_t(c)]];
    // BT.2100: a display of 1000 cd/m² shows scene light with a gamma of 1.2 on its luminance.
    if (hlg) rgb *= kPeak / kDiffuseWhite * std::pow(std::max(1e-9, glm::dot(luminance, rgb)), 0.2);
    if (!same) rgb = toBt709 * rgb;
    if (hdr) {
      const double most = std::max({rgb.r, rgb.g, rgb.b});  // one factor for all channels keeps the hue
      if (most > kKnee) rgb *= compressed(most) / most;
    }
    for (int c = 0; c < 3; ++c)
      result.values[i + std::size_t(c)] =
          encoded[std::size_t(std::lround(std::clamp(rgb[c], 0.0, 1.0) * double(kCodes - 1)))];
  }
  return result;
}

}  // namespace ibr::io
