// SPDX-License-Identifier: Apache-2.0
#include "support/planted.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace ibr::test {
namespace {

// Sum of waves, some of them short. Defined everywhere, so pictures can be shifted by fractions of a pixel.
struct Texture {
  struct Wave {
    glm::dvec2 frequency;
    double phase[3], height;
  };
  std::vector<Wave> waves;

  explicit Texture(std::mt19937& random) {
    std::uniform_real_distribution<double> angle(0, 6.28318), length(5, 40);
    for (int w = 0; w < 48; ++w) {
      const double direction = angle(random), period = length(random);
      waves.push_back({6.28318 / period * glm::dvec2(std::cos(direction), std::sin(direction)),
                       {angle(random), angle(random), angle(random)},
                       11.0});
    }
  }
  double at(glm::dvec2 p, int channel) const {
    double value = 128;
    for (const Wave& w : waves) value += w.height * std::sin(glm::dot(w.frequency, p) + w.phase[channel]);
    return std::min(std::max(value, 0.0), 255.0);
  }
};

bool inner(int index, int cells) {
  const int x = index % (cells + 1), y = index / (cells + 1);
  return x > 0 && y > 0 && x < cells && y < cells;
}

}  // namespace

Planted planted(int members, int side, int cells, double offPx, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Texture texture(random);
  Planted result;
  std::uniform_real_distribution<double> shift(-3, 3), off(-offPx, offPx);
  for (int i = 0; i < members; ++i) {
    result.shift.push_back(i == 0 ? glm::dvec2(0) : glm::dvec2(shift(random), shift(random)));
    Image8 picture(side, side, 3);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        for (int c = 0; c < 3; ++c)
          picture.pixel(x, y)[std::size_t(c)] =
              std::uint8_t(std::lround(texture.at(glm::dvec2(x + 0.5, y + 0.5) - result.shift.back(), c)));
    result.pictures.push_back(std::move(picture));
  }
  Alignment& a = result.alignment;
  const double margin = 8, step = (side - 2 * margin) / cells;
  for (int i = 0; i < members; ++i) {
    a.pictures.push_back(&result.pictures[std::size_t(i)]);
    auto& at = a.position.emplace_back();
    for (int p = 0; p < (cells + 1) * (cells + 1); ++p) {
      glm::dvec2 px(margin + step * (p % (cells + 1)), margin + step * (p / (cells + 1)));
      px += result.shift[std::size_t(i)];
      if (i > 0 && inner(p, cells)) px += glm::dvec2(off(random), off(random));
      at.push_back(glm::ivec2(glm::round(px * double(kAlignmentUnitsPerPixel))));
    }
  }
  const auto index = [&](int x, int y) { return std::uint32_t(y * (cells + 1) + x); };
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      a.triangles.push_back({index(x, y), index(x + 1, y), index(x, y + 1)});
      a.triangles.push_back({index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)});
    }
  return result;
}

MatchError matchError(const Planted& planted) {
  const auto& at = planted.alignment.position;
  const int cells = int(std::lround(std::sqrt(double(at[0].size())))) - 1;
  MatchError error;
  int count = 0;
  for (std::size_t i = 1; i < at.size(); ++i)
    for (std::size_t p = 0; p < at[i].size(); ++p) {
      if (!inner(int(p), cells)) continue;
      const glm::dvec2 off = glm::dvec2(at[i][p] - at[0][p]) / double(kAlignmentUnitsPerPixel) - planted.shift[i];
      error.mean += glm::length(off);
      error.largest = std::max(error.largest, glm::length(off));
      ++count;
    }
  error.mean /= count;
  return error;
}

}  // namespace ibr::test
