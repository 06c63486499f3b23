// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/bench_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <string>

#include "base/check.h"

namespace ibr {
namespace {

// Shapes of [T] table 2: farmland, drone, path; living room, bistro.
constexpr std::array<BenchShape, 8> kShapes{{{"stitched-5", 5, 60, 47, false, false, 0.82},
                                             {"stitched-12", 12, 95, 71, false, false, 0.74},
                                             {"stitched-30", 30, 58, 45, false, false, 0.72},
                                             {"stacked-5", 5, 60, 47, true, false, 1.12},
                                             {"stacked-12", 12, 95, 71, true, false, 1.12},
                                             {"stacked-30", 30, 58, 45, true, false, 1.12},
                                             {"panorama-1", 1, 160, 82, false, true, 0},
                                             {"panorama-3", 3, 140, 70, false, true, 0}}};

constexpr double kRadius = 8;  // of the sphere, m
constexpr std::array<glm::dvec3, 3> kSpots{{{-0.25, -0.12, 0.1}, {0.25, -0.12, 0.1}, {0, 0.3, -0.2}}};
constexpr double kMargin = 0.07;  // border share of a photograph without mesh, which another member may not see

// Low-discrepancy points in the unit square about its middle.
glm::dvec2 spread(int i) {
  constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;  // powers of the plastic number
  return {std::fmod(0.5 + kA * i, 1.0) - 0.5, std::fmod(0.5 + kB * i, 1.0) - 0.5};
}

glm::dquat turned(glm::dvec2 yawPitch) {
  return glm::angleAxis(-yawPitch.x, glm::dvec3(0, 1, 0)) * glm::angleAxis(yawPitch.y, glm::dvec3(1, 0, 0));
}

// Direction from the sphere's centre to the point on the sphere that a pixel shows.
glm::dvec3 seenAt(const Camera& camera, glm::dvec2 pixel) {
  const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, pixel), c = camera.pose.position;
  const double along = glm::dot(c, ray);
  return (c + ray * (std::sqrt(along * along + kRadius * kRadius - glm::dot(c, c)) - along)) / kRadius;
}

// A tile of the pattern and its mip levels: noise of all wavelengths, with edges.
class Pattern {
 public:
  static constexpr int kSize = 1024, kLevels = 11;

  Pattern() {
    std::vector<float> height(kSize * kSize);
    for (int octave = 2; octave <= 9; ++octave) addNoise(height, octave);
    std::vector<glm::u8vec4>& finest = level_[0];
    finest.resize(height.size());
    for (std::size_t i = 0; i < height.size(); ++i) {
      const float h = height[i], band = h - std::floor(h);  // contours have sharp edges
      const auto byte = [](float v) { return std::uint8_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 255)); };
      finest[i] = {byte(0.15f + 0.6f * band), byte(0.5f + 0.25f * std::sin(9 * h)), byte(0.7f - 0.5f * band), 255};
    }
    for (int l = 1; l < kLevels; ++l) {
      const int size = kSize >> l;
      level_[std::size_t(l)].resize(std::size_t(size * size));
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          glm::uvec4 sum(2);
          for (int k = 0; k < 4; ++k) sum += glm::uvec4(texel(l - 1, 2 * x + k % 2, 2 * y + k / 2));
          level_[std::size_t(l)][std::size_t(y * size + x)] = glm::u8vec4(sum / 4u);
        }
    }
  }

  const glm::u8vec4& texel(int level, int x, int y) const {
    const int size = kSize >> level, mask = size - 1;
    return level_[std::size_t(level)][std::size_t((y & mask) * size + (x & mask))];
  }

 private:
  // Adds smoothly interpolated noise with cells of kSize / 2^octave.
  static void addNoise(std::vector<float>& height, int octave) {
    const int count = 1 << octave, step = kSize >> octave;
    const auto corner = [&](int x, int y) {
      std::uint32_t h = std::uint32_t(x & (count - 1)) * 0x9E3779B1u ^ std::uint32_t(y & (count - 1)) * 0x85EBCA77u ^
                        std::uint32_t(octave) * 0xC2B2AE3Du;
      h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
      h = (h ^ (h >> 12)) * 0x297A2D39u;
      return float((h ^ (h >> 15)) >> 8) * 0x1p-24f;
    };
    const float amplitude = 6.0f / float(count);
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x) {
        const float a = corner(x, y), b = corner(x + 1, y), c = corner(x, y + 1), d = corner(x + 1, y + 1);
        for (int j = 0; j < step; ++j)
          for (int i = 0; i < step; ++i) {
            const float u = float(i) / float(step), v = float(j) / float(step);
            const float s = u * u * (3 - 2 * u), t = v * v * (3 - 2 * v);
            height[std::size_t((y * step + j) * kSize + x * step + i)] +=
                amplitude * ((a + (b - a) * s) * (1 - t) + (c + (d - c) * s) * t);
          }
      }
  }

  std::array<std::vector<glm::u8vec4>, kLevels> level_;
};

const Pattern& pattern() {
  static const Pattern kPattern;
  return kPattern;
}

// The pattern lies on the faces of a cube around the origin; `texels`: number per half an edge.
glm::u8vec4 patternIn(glm::vec3 d, int level, float texels) {
  const glm::vec3 size = glm::abs(d);
  const float largest = std::max({size.x, size.y, size.z});
  const glm::vec2 at =
      size.x == largest ? glm::vec2(d.y, d.z) : (size.y == largest ? glm::vec2(d.x, d.z) : glm::vec2(d.x, d.y));
  const float scale = texels / largest;
  // Adds a multiple of the tile, so that truncation rounds down.
  constexpr float kPositive = 8 * Pattern::kSize;
  return pattern().texel(level, int(at.x * scale + kPositive), int(at.y * scale + kPositive));
}

Image8 photographed(const Camera& camera, int level, const std::array<std::uint8_t, 256>& exposed) {
  const Intrinsics& k = camera.intrinsics;
  const int width = std::max(1, k.width >> level), height = std::max(1, k.height >> level);
  Image8 image(width, height, 4);
  // Uses as many texels of the pattern's level as pixels.
  const double focal = k.model == CameraModel::pinhole ? k.fx : k.width / (2 * std::numbers::pi);
  const int patternLevel = std::min(level, Pattern::kLevels - 1);
  const auto texels = float(std::ldexp(focal, -patternLevel));
  const glm::dvec2 scale(double(k.width) / width, double(k.height) / height);
  constexpr int kBlock = 16;  // px; the sphere counts as flat within a block
  for (int y0 = 0; y0 < height; y0 += kBlock)
    for (int x0 = 0; x0 < width; x0 += kBlock) {
      const int across = std::min(kBlock, width - x0), down = std::min(kBlock, height - y0);
      const auto corner = [&](int i, int j) {
        return glm::vec3(seenAt(camera, scale * glm::dvec2(x0 + i * across, y0 + j * down)));
      };
      const glm::vec3 a = corner(0, 0), b = corner(1, 0), c = corner(0, 1), d = corner(1, 1);
      for (int y = 0; y < down; ++y) {
        const float t = (float(y) + 0.5f) / float(down);
        const glm::vec3 left = a + (c - a) * t, step = ((b + (d - b) * t) - left) / float(across);
        std::uint8_t* out = image.pixel(x0, y0 + y).data();
        for (int x = 0; x < across; ++x, out += 4) {
          const glm::u8vec4 texel = patternIn(left + step * (float(x) + 0.5f), patternLevel, texels);
          for (int i = 0; i < 3; ++i) out[i] = exposed[texel[i]];
          out[3] = 255;
        }
      }
    }
  return image;
}

void addVertex(const Scene& scene, Cell& cell, glm::dvec3 direction) {
  std::array<double, kSpots.size()> distance;
  double sum = 0;
  for (std::size_t i = 0; i < kSpots.size(); ++i) {
    const Camera& camera = scene.nodes[cell.members[i]].camera;
    const glm::dvec3 ray = kRadius * direction - camera.pose.position;
    const auto match = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * ray);
    check(match.has_value(), ErrorCode::invalidInput, "bench scene: a vertex is not visible in a member");
    cell.mesh.match[i].emplace_back(*match);
    sum += distance[i] = glm::length(ray);
  }
  const double mean = sum / double(kSpots.size());
  for (std::size_t i = 0; i < kSpots.size(); ++i) cell.mesh.ratio[i].push_back(float(distance[i] / mean));
  cell.mesh.inverseDistance.push_back(float(1 / mean));
}

void makeMesh(const BenchShape& shape, const Scene& scene, Cell& cell) {
  MorphMesh& mesh = cell.mesh;
  mesh.match.resize(kSpots.size());
  mesh.ratio.resize(kSpots.size());
  const Camera& first = scene.nodes[cell.members[0]].camera;
  const double pi = std::numbers::pi;
  const int columns = shape.panoramas ? shape.columns : shape.columns + 1;  // vertices; a panorama's close around it
  for (int y = 0; y <= shape.rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const glm::dvec2 at(double(x) / shape.columns, double(y) / shape.rows);
      const glm::dvec2 pixel = kMargin + (1 - 2 * kMargin) * at;
      const double latitude = pi * (0.5 - at.y), longitude = 2 * pi * at.x;
      addVertex(scene, cell,
                shape.panoramas ? glm::dvec3(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                             -std::cos(latitude) * std::cos(longitude))
                                : seenAt(first, pixel * glm::dvec2(first.intrinsics.width, first.intrinsics.height)));
    }
  for (int y = 0; y < shape.rows; ++y)
    for (int x = 0; x < shape.columns; ++x) {
      const auto vertex = [&](int i, int j) { return std::uint32_t((y + j) * columns + (x + i) % columns); };
      const bool north = shape.panoramas && y == 0, south = shape.panoramas && y == shape.rows - 1;
      if (!north) mesh.triangles.emplace_back(vertex(0, 0), vertex(0, 1), vertex(1, 0));
      if (!south) mesh.triangles.emplace_back(vertex(1, 0), vertex(0, 1), vertex(1, 1));
    }
  mesh.uncertainty.assign(mesh.vertexCount(), 0.0f);
  mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.assign(mesh.triangles.size(), 1.0f);
}

}  // namespace

std::span<const BenchShape> benchShapes() {
  return kShapes;
}

const BenchShape* findBenchShape(std::string_view name) {
  const auto found = std::ranges::find_if(kShapes, [&](const BenchShape& shape) { return shape.name == name; });
  return found == kShapes.end() ? nullptr : &*found;
}

Scene makeBenchScene(const BenchShape& shape, double detail) {
  const auto scaled = [&](int size) { return std::max(16, int(std::lround(size * detail))); };
  const Intrinsics intrinsics = shape.panoramas ? Intrinsics{CameraModel::equirectangular, scaled(2048), scaled(1024)}
                                                : pinholeFromFov(scaled(1280), scaled(960), shape.fovY);
  // Range of the cells' viewing directions, in widths of the view.
  glm::dvec2 range = shape.stacked ? glm::dvec2(0.1, 0.1) : glm::dvec2(1.15, 0.62);
  if (shape.panoramas) range = {2 * std::numbers::pi, 0.3};
  Scene scene;
  scene.acquisition = "synthetic";
  for (int c = 0; c < shape.cells; ++c) {
    Cell& cell = scene.cells.emplace_back();
    for (std::size_t i = 0; i < kSpots.size(); ++i) {
      const glm::dvec2 own = 0.012 * spread(17 * c + int(i) + 1);
      const std::string name = "cell" + std::to_string(c) + "-" + std::to_string(i);
      cell.members.push_back(std::uint32_t(scene.nodes.size()));
      scene.nodes.push_back({name, {intrinsics, {kSpots[i], turned(range * spread(c) + own)}}, name + ".png", ""});
    }
    makeMesh(shape, scene, cell);
  }
  return scene;
}

std::vector<Image8> benchPhotograph(const Scene& scene, std::size_t node) {
  const double gain = 1.0 + 0.35 * spread(int(node / kSpots.size())).x;
  std::array<std::uint8_t, 256> exposed;
  for (std::size_t i = 0; i < exposed.size(); ++i)
    exposed[i] = std::uint8_t(std::lround(std::min(255.0, gain * double(i))));
  const Camera& camera = scene.nodes[node].camera;
  std::vector<Image8> levels;
  do levels.push_back(photographed(camera, int(levels.size()), exposed));
  while (levels.back().width > 1 || levels.back().height > 1);
  return levels;
}

std::vector<Camera> benchViews(const BenchShape& shape, int count, int width, int height) {
  std::vector<Camera> views;
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 place = spread(i);
    views.push_back({pinholeFromFov(width, height, shape.stacked ? 0.6 : 1.0),
                     {{0.1 * place.x, 0.02 + 0.1 * place.y, 0.0}, turned(0.06 * place)}});
  }
  return views;
}

}  // namespace ibr
