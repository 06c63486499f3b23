// SPDX-License-Identifier: Apache-2.0
#include "reference/alignment/alignment_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>

namespace ibr::reference {
namespace {

using Corners = std::array<glm::ivec2, 3>;

// Cross product (b − a) × (p − a), positive where p lies on the inner side of the edge.
std::int64_t side(glm::ivec2 a, glm::ivec2 b, glm::ivec2 p) {
  return std::int64_t(b.x - a.x) * (p.y - a.y) - std::int64_t(b.y - a.y) * (p.x - a.x);
}

// y points down: the inner side is below an edge that runs right, and right of an edge that runs up.
bool isTopOrLeft(glm::ivec2 a, glm::ivec2 b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

bool covers(const Corners& t, glm::ivec2 p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::ivec2 a = t[k], b = t[(k + 1) % 3];
    const std::int64_t s = side(a, b, p);
    if (s < 0 || (s == 0 && !isTopOrLeft(a, b))) return false;
  }
  return true;
}

glm::ivec2 centre(glm::ivec2 pixel) {
  return 256 * pixel + 128;
}

glm::dvec3 texel(const Image8& picture, int x, int y) {
  const auto p = picture.pixel(std::clamp(x, 0, picture.width - 1), std::clamp(y, 0, picture.height - 1));
  return {p[0], p[1], p[2]};
}

// Bilinear sample. `at`: px from the top-left corner of the image.
glm::dvec3 bilinear(const Image8& picture, glm::dvec2 at) {
  const double x = std::floor(at.x - 0.5), y = std::floor(at.y - 0.5);
  const double fx = at.x - 0.5 - x, fy = at.y - 0.5 - y;
  const int i = int(x), j = int(y);
  return (1 - fy) * ((1 - fx) * texel(picture, i, j) + fx * texel(picture, i + 1, j)) +
         fy * ((1 - fx) * texel(picture, i, j + 1) + fx * texel(picture, i + 1, j + 1));
}

struct Samples {
  std::vector<glm::dvec3> x, y;
};

// Appends the colours of both photographs at one pixel of the mean triangle.
void sample(const Corners& mean, const Corners& source, const Corners& target, glm::ivec2 pixel, const Image8& sourceOf,
            const Image8& targetOf, Samples& samples) {
  const glm::ivec2 p = centre(pixel);
  const double area = double(side(mean[0], mean[1], mean[2]));
  glm::dvec2 s(0.0), t(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = double(side(mean[(k + 1) % 3], mean[(k + 2) % 3], p)) / area;
    s += weight * glm::dvec2(source[k]) / 128.0;
    t += weight * glm::dvec2(target[k]) / 128.0;
  }
  samples.x.push_back(bilinear(sourceOf, s));
  samples.y.push_back(bilinear(targetOf, t));
}

StarTarget sumsOf(const Samples& samples, std::size_t member) {
  StarTarget target{member, std::int64_t(samples.x.size())};
  for (std::size_t i = 0; i < samples.x.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double x = samples.x[i][c], y = samples.y[i][c];
      target.x[c] += x, target.y[c] += y, target.xx[c] += x * x, target.yy[c] += y * y, target.xy[c] += x * y;
    }
  return target;
}

// Two-pass sums of centred products. Each added list has its own mean.
class Correlation {
 public:
  void add(const std::vector<double>& x, const std::vector<double>& y) {
    double meanX = 0, meanY = 0;
    for (std::size_t i = 0; i < x.size(); ++i) meanX += x[i], meanY += y[i];
    meanX /= double(x.size());
    meanY /= double(y.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      covariance_ += (x[i] - meanX) * (y[i] - meanY);
      varianceX_ += (x[i] - meanX) * (x[i] - meanX);
      varianceY_ += (y[i] - meanY) * (y[i] - meanY);
    }
    count_ += double(x.size());
  }
  Ecc result(double floor) const {
    const double x = varianceX_ / count_ + floor, y = varianceY_ / count_ + floor;
    if (!(x > 1e-9) || !(y > 1e-9)) return {};
    return {std::clamp((covariance_ / count_ + floor) / std::sqrt(x * y), -1.0, 1.0), true};
  }

 private:
  double covariance_ = 0, varianceX_ = 0, varianceY_ = 0, count_ = 0;
};

Ecc byChannels(const std::vector<Samples>& targets, double floor) {
  Correlation correlation;
  for (const Samples& samples : targets)
    for (int c = 0; c < 3; ++c) {
      std::vector<double> x, y;
      for (std::size_t i = 0; i < samples.x.size(); ++i) x.push_back(samples.x[i][c]), y.push_back(samples.y[i][c]);
      if (!x.empty()) correlation.add(x, y);
    }
  return correlation.result(floor);
}

Ecc inOne(const std::vector<Samples>& targets) {
  std::vector<double> x, y;
  for (const Samples& samples : targets)
    for (std::size_t i = 0; i < samples.x.size(); ++i)
      for (int c = 0; c < 3; ++c) x.push_back(samples.x[i][c]), y.push_back(samples.y[i][c]);
  Correlation correlation;
  if (!x.empty()) correlation.add(x, y);
  return correlation.result(0);
}

}  // namespace

std::vector<glm::ivec2> coveredPixels(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c) {
  std::vector<glm::ivec2> pixels;
  const auto pixelOf = [](int v) { return int(std::floor(double(v) / 256.0)); };
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  for (int j = pixelOf(top); j <= pixelOf(bottom); ++j)
    for (int i = pixelOf(left); i <= pixelOf(right); ++i)
      if (covers({a, b, c}, centre({i, j}))) pixels.push_back({i, j});
  return pixels;
}

StarEcc starEcc(const AlignedPictures& mesh, std::uint32_t point, std::size_t member, glm::ivec2 offset,
                double varianceFloor) {
  std::vector<std::vector<glm::ivec2>> position = mesh.position;
  position[member][point] += offset;
  StarEcc star;
  std::vector<Samples> all;
  for (std::size_t other = 0; other < mesh.pictures.size(); ++other) {
    if (other == member) continue;
    Samples samples;
    for (const glm::uvec3& t : mesh.triangles) {
      if (t.x != point && t.y != point && t.z != point) continue;
      const Corners source{position[member][t.x], position[member][t.y], position[member][t.z]};
      const Corners target{position[other][t.x], position[other][t.y], position[other][t.z]};
      const Corners mean{source[0] + target[0], source[1] + target[1], source[2] + target[2]};
      for (const glm::ivec2& pixel : coveredPixels(mean[0], mean[1], mean[2]))
        sample(mean, source, target, pixel, *mesh.pictures[member], *mesh.pictures[other], samples);
    }
    star.targets.push_back(sumsOf(samples, other));
    all.push_back(std::move(samples));
  }
  const bool enough = std::any_of(all.begin(), all.end(), [](const Samples& s) { return s.x.size() > 1; });
  if (!enough) return star;
  star.channels = byChannels(all, varianceFloor);
  star.concatenated = inOne(all);
  return star;
}

}  // namespace ibr::reference
