// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/moving_figure.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <random>

namespace ibr {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Part {
  glm::dvec3 low, high;  // at rest
  glm::dvec3 joint;      // pivot of the swing
  double swing;          // rad, about x
};

const std::array kParts{Part{{-0.22, 0.0, -0.12}, {0.22, 1.4, 0.12}, {0, 0, 0}, 0},
                        Part{{-0.11, 1.38, -0.1}, {0.11, 1.68, 0.1}, {0, 1.4, 0}, 0.15},
                        Part{{-0.4, 0.65, -0.08}, {-0.2, 1.35, 0.08}, {-0.3, 1.3, 0}, 0.9},
                        Part{{0.2, 0.65, -0.08}, {0.4, 1.35, 0.08}, {0.3, 1.3, 0}, -0.9}};

glm::dvec3 rotatedAbout(glm::dvec3 p, glm::dvec3 joint, glm::dvec3 axis, double angle) {
  return joint + glm::angleAxis(angle, axis) * (p - joint);
}

glm::dvec3 moved(glm::dvec3 p, const Part& part, double phase) {
  const double wave = std::sin(kTurn * phase);
  p = rotatedAbout(p, part.joint, {1, 0, 0}, part.swing * wave);
  const double height = p.y / 1.4;
  p = rotatedAbout(p, {0, p.y, 0}, {0, 1, 0}, 0.5 * wave * height);                   // twisted
  p.x += 0.15 * std::sin(kTurn * phase + 0.7) * height * height;                      // bent
  return rotatedAbout(p, {0, 0, 0}, {0, 1, 0}, 0.4 * std::sin(kTurn * phase + 1.5));  // turned
}

// Makes six grids on one lattice, so that they share the vertices of their borders.
void addPart(TexturedMesh& figure, const Part& part, double phase, int divisions, std::uint64_t seed) {
  const glm::dvec3 size = part.high - part.low;
  const double step = std::max({size.x, size.y, size.z}) / divisions;
  glm::ivec3 count;
  for (int k = 0; k < 3; ++k) count[k] = std::max(1, int(std::lround(size[k] / step)));
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  const auto vertex = [&](glm::ivec3 at) {
    const auto [found, isNew] =
        vertices.emplace(std::array{at.x, at.y, at.z}, std::uint32_t(figure.mesh.positions.size()));
    if (isNew) {
      const glm::dvec3 rest = part.low + size * glm::dvec3(at) / glm::dvec3(count);
      figure.mesh.positions.push_back(moved(rest, part, phase));
    }
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const auto texture = std::uint32_t(figure.textures.size());
      // Several wavelengths, so that no two regions look alike.
      for (std::uint32_t layer = 0; layer < figure.layers; ++layer)
        figure.textures.push_back({.seed = seed + texture + layer, .wavelength = 0.03 * std::pow(2.3, layer)});
      for (int j = 0; j < count[b]; ++j)
        for (int i = 0; i < count[a]; ++i) {
          std::array<std::uint32_t, 4> corner;
          std::array<glm::dvec2, 4> at;
          for (int k = 0; k < 4; ++k) {
            glm::ivec3 lattice(0);
            lattice[axis] = side * count[axis];
            lattice[a] = i + (k == 1 || k == 2);
            lattice[b] = j + (k >= 2);
            corner[std::size_t(k)] = vertex(lattice);
            at[std::size_t(k)] = {size[a] * lattice[a] / count[a], size[b] * lattice[b] / count[b]};
          }
          for (std::array<std::size_t, 3> t : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}}) {
            if (side == 0) std::swap(t[1], t[2]);
            figure.mesh.triangles.emplace_back(corner[t[0]], corner[t[1]], corner[t[2]]);
            figure.textureAt.push_back({at[t[0]], at[t[1]], at[t[2]]});
            figure.textureOf.push_back(texture);
          }
        }
    }
}

}  // namespace

TexturedMesh movingFigure(double phase, std::uint64_t seed, int divisions) {
  TexturedMesh figure;
  figure.layers = 3;
  for (const Part& part : kParts) addPart(figure, part, phase - std::floor(phase), divisions, seed);
  return figure;
}

TriangleMesh inexactMesh(const TriangleMesh& mesh, double deviation, double phase, std::uint64_t seed) {
  std::vector<glm::dvec3> normals(mesh.positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x];
    const glm::dvec3 product = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    for (int k = 0; k < 3; ++k) normals[t[k]] += product;
  }
  // A sum of waves in space, each with variance 1/2.
  struct Wave {
    glm::dvec3 k;
    double phase;
  };
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  std::array<Wave, 8> waves;
  for (Wave& wave : waves) {
    const double z = 2 * uniform() - 1, around = kTurn * uniform(), length = 0.15 * std::pow(3.0, uniform());
    const double across = std::sqrt(1 - z * z);
    wave.k = kTurn / length * glm::dvec3(across * std::cos(around), across * std::sin(around), z);
    wave.phase = kTurn * (uniform() + phase);
  }
  TriangleMesh result = mesh;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double length = glm::length(normals[v]);
    if (!(length > 0)) continue;
    double sum = 0;
    for (const Wave& wave : waves) sum += std::sin(glm::dot(wave.k, mesh.positions[v]) + wave.phase);
    result.positions[v] += deviation * sum / std::sqrt(0.5 * double(waves.size())) / length * normals[v];
  }
  return result;
}

}  // namespace ibr
