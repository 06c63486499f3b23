// SPDX-License-Identifier: Apache-2.0
// Finds each sample's triangle by a depth buffer, then samples its texture at the ray's intersection with its plane.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "lab/generate/moving_figure.h"
#include "lab/generate/wave_texture.h"

namespace ibr {
namespace {

constexpr std::uint32_t kNone = ~0u;

struct Samples {
  int width, height;
  std::vector<std::uint32_t> face;
  std::vector<double> depth;
};

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

// `corner`: sample pixels, and the inverse distance along the axis, which is linear in screen space.
void draw(const std::array<glm::dvec3, 3>& corner, std::uint32_t face, Samples& samples) {
  const glm::dvec2 a(corner[0]), b(corner[1]), c(corner[2]);
  const double area = cross(b - a, c - a);
  if (area == 0) return;
  const glm::dvec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  const int x0 = std::max(0, int(std::floor(std::max(low.x, 0.0)))),
            y0 = std::max(0, int(std::floor(std::max(low.y, 0.0))));
  const int x1 = int(std::min(high.x, samples.width - 1.0)), y1 = int(std::min(high.y, samples.height - 1.0));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const glm::dvec2 p(x + 0.5, y + 0.5);
      const double u = cross(b - p, c - p) / area, v = cross(c - p, a - p) / area, w = 1 - u - v;
      if (u < 0 || v < 0 || w < 0) continue;
      const double inverse = u * corner[0].z + v * corner[1].z + w * corner[2].z;
      const std::size_t at = std::size_t(y) * std::size_t(samples.width) + std::size_t(x);
      if (!(inverse > samples.depth[at])) continue;
      samples.depth[at] = inverse;
      samples.face[at] = face;
    }
}

Samples drawAll(const TexturedMesh& mesh, const Camera& camera, int samplesPerAxis) {
  const Intrinsics& k = camera.intrinsics;
  Samples samples{k.width * samplesPerAxis, k.height * samplesPerAxis, {}, {}};
  const std::size_t count = std::size_t(samples.width) * std::size_t(samples.height);
  samples.face.assign(count, kNone);
  samples.depth.assign(count, 0.0);  // inverse: infinitely far
  std::vector<glm::dvec3> projected;
  for (const glm::dvec3& position : mesh.mesh.positions) {
    const glm::dvec3 p = glm::conjugate(camera.pose.rotation) * (position - camera.pose.position);
    const auto pixel = project(k, p);
    projected.push_back(pixel ? glm::dvec3(*pixel * double(samplesPerAxis), -1.0 / p.z) : glm::dvec3(0.0));
  }
  for (std::uint32_t f = 0; f < mesh.mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.mesh.triangles[f];
    const std::array corner{projected[t.x], projected[t.y], projected[t.z]};
    if (corner[0].z > 0 && corner[1].z > 0 && corner[2].z > 0) draw(corner, f, samples);
  }
  return samples;
}

// Texture coordinates of a ray's intersection with a triangle's plane.
glm::dvec2 textureAt(const TexturedMesh& mesh, std::uint32_t face, glm::dvec3 from, glm::dvec3 ray) {
  const glm::uvec3& t = mesh.mesh.triangles[face];
  const glm::dvec3 a = mesh.mesh.positions[t.x];
  const glm::dvec3 e1 = mesh.mesh.positions[t.y] - a, e2 = mesh.mesh.positions[t.z] - a;
  const glm::dvec3 q = glm::cross(ray, e2), s = from - a, r = glm::cross(s, e1);
  const double determinant = glm::dot(e1, q);
  const double v = glm::dot(s, q) / determinant, w = glm::dot(ray, r) / determinant;
  const auto& at = mesh.textureAt[face];
  return at[0] + v * (at[1] - at[0]) + w * (at[2] - at[0]);
}

}  // namespace

MeshPhotograph photograph(const TexturedMesh& mesh, const Camera& camera, int samplesPerAxis) {
  constexpr double kBehind = 60, kMiddle = 127.5;
  const Intrinsics& k = camera.intrinsics;
  const Samples samples = drawAll(mesh, camera, samplesPerAxis);
  const std::vector<WaveTexture> textures(mesh.textures.begin(), mesh.textures.end());
  MeshPhotograph result{Image8(k.width, k.height, 3), Image8(k.width, k.height, 1)};
  const double count = double(samplesPerAxis) * samplesPerAxis;
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      glm::dvec3 sum(0.0);
      double covered = 0;
      for (int j = 0; j < samplesPerAxis; ++j)
        for (int i = 0; i < samplesPerAxis; ++i) {
          const std::size_t at =
              std::size_t(y * samplesPerAxis + j) * std::size_t(samples.width) + std::size_t(x * samplesPerAxis + i);
          const std::uint32_t face = samples.face[at];
          if (face == kNone) {
            sum += glm::dvec3(kBehind);
            continue;
          }
          const glm::dvec2 pixel(x + (i + 0.5) / samplesPerAxis, y + (j + 0.5) / samplesPerAxis);
          const glm::dvec3 ray = camera.pose.rotation * unproject(k, pixel);
          const glm::dvec2 place = textureAt(mesh, face, camera.pose.position, ray);
          glm::dvec3 colour(0.0);
          for (std::uint32_t layer = 0; layer < mesh.layers; ++layer)
            colour += textures[mesh.textureOf[face] + layer].colour(place) - kMiddle;
          sum += kMiddle + colour / std::sqrt(double(mesh.layers));
          ++covered;
        }
      for (int c = 0; c < 3; ++c)
        result.colours.pixel(x, y)[std::size_t(c)] = std::uint8_t(std::lround(std::clamp(sum[c] / count, 0.0, 255.0)));
      result.mask.pixel(x, y)[0] = std::uint8_t(std::lround(255 * covered / count));
    }
  return result;
}

}  // namespace ibr
