// SPDX-License-Identifier: Apache-2.0
#include "support/bumpy_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace ibr::test {
namespace {

using std::numbers::pi;

TriangleMesh body(const BumpyOptions& options) {
  TriangleMesh mesh;
  const auto point = [&](double longitude, double latitude) {
    const double fold = std::pow(std::cos(latitude), 3) * std::cos(5 * longitude);
    const double radius = 0.5 * (1 + 0.22 * fold + 0.1 * std::sin(2 * latitude + longitude));
    return options.middle + radius * glm::dvec3(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                                std::cos(latitude) * std::cos(longitude));
  };
  const int columns = options.longitudes, rows = options.latitudes;
  mesh.positions.push_back(point(0, -pi / 2));
  for (int row = 1; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      mesh.positions.push_back(point(2 * pi * column / columns, pi * row / rows - pi / 2));
  mesh.positions.push_back(point(0, pi / 2));
  const auto at = [&](int row, int column) {
    if (row == 0) return 0u;
    if (row == rows) return std::uint32_t(mesh.positions.size() - 1);
    return std::uint32_t(1 + (row - 1) * columns + column % columns);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (row > 0) mesh.triangles.emplace_back(at(row, column), at(row, column + 1), at(row + 1, column));
      if (row + 1 < rows)
        mesh.triangles.emplace_back(at(row, column + 1), at(row + 1, column + 1), at(row + 1, column));
    }
  return mesh;
}

glm::dvec3 toCamera(const Pose& pose, const glm::dvec3& point) {
  return glm::conjugate(pose.rotation) * (point - pose.position);
}

HtmImage photograph(const BumpyModel& bumpy, std::size_t camera, const std::vector<SurfaceHit>& hits) {
  const Intrinsics& k = bumpy.model.cameras[camera].camera.intrinsics;
  HtmImage picture{Image8(k.width, k.height, 3), Image8(k.width, k.height, 1)};
  const auto hitAt = [&](int x, int y) -> const SurfaceHit& {
    return hits[std::size_t(y) * std::size_t(k.width) + std::size_t(x)];
  };
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const SurfaceHit& hit = hitAt(x, y);
      glm::dvec3 colour(0.05, 0.05, 1.0);
      if (hit.triangle >= 0)
        colour = solidColour(pointOf(bumpy.model.surface.mesh, hit) - bumpy.options.middle + bumpy.offsets[camera]);
      for (int c = 0; c < 3; ++c)
        picture.photograph.pixel(x, y)[std::size_t(c)] = std::uint8_t(std::lround(255 * colour[c]));
      // A sample is trusted if no neighbour is background or lies at another depth.
      bool whole = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const SurfaceHit& beside = hitAt(std::clamp(x + dx, 0, k.width - 1), std::clamp(y + dy, 0, k.height - 1));
          whole = whole && beside.triangle >= 0 && std::abs(1 / beside.inverseDepth - 1 / hit.inverseDepth) < 0.08;
        }
      picture.visibility.pixel(x, y)[0] = whole ? 255 : 0;
    }
  return picture;
}

std::vector<glm::dvec3> normalsOf(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.positions.size(), glm::dvec3(0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 normal =
        glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    for (int c = 0; c < 3; ++c) normals[t[c]] += normal;
  }
  return normals;
}

void addMembers(HtmModel& model, std::size_t camera, const std::vector<SurfaceHit>& hits,
                const std::vector<glm::dvec3>& normals) {
  const Camera& c = model.cameras[camera].camera;
  const TriangleMesh& mesh = model.surface.mesh;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 ray = toCamera(c.pose, mesh.positions[v]);
    const std::optional<glm::dvec2> pixel = project(c.intrinsics, ray);
    if (!pixel || glm::dot(glm::normalize(normals[v]), glm::normalize(c.pose.position - mesh.positions[v])) < 0.1)
      continue;
    const int x = int(std::floor(pixel->x)), y = int(std::floor(pixel->y));
    if (x < 0 || y < 0 || x >= c.intrinsics.width || y >= c.intrinsics.height) continue;
    const SurfaceHit& hit = hits[std::size_t(y) * std::size_t(c.intrinsics.width) + std::size_t(x)];
    if (hit.triangle >= 0 && -ray.z < 1 / hit.inverseDepth + 0.05) model.surface.members[v] |= CameraSet(1) << camera;
  }
}

void plantComplements(BumpyModel& bumpy) {
  HtmModel& model = bumpy.model;
  model.complements.assign(model.cameras.size() * model.cameras.size() * model.vertexCount(), glm::vec2(0));
  for (std::size_t i = 0; i < model.cameras.size(); ++i)
    for (std::size_t j = 0; j < model.cameras.size(); ++j)
      for (std::size_t v = 0; v < model.vertexCount(); ++v) {
        const Camera& c = model.cameras[i].camera;
        const glm::dvec3 at = model.surface.mesh.positions[v];
        const auto there = project(c.intrinsics, toCamera(c.pose, at + bumpy.offsets[j] - bumpy.offsets[i]));
        const auto here = project(c.intrinsics, toCamera(c.pose, at));
        model.complements[model.complementIndex(i, j, v)] = glm::vec2(*there - *here);
      }
}

}  // namespace

glm::dvec3 solidColour(glm::dvec3 at) {
  glm::dvec3 colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = 0.5 + 0.2 * std::sin(62 * at.x + 34 * at.y + 5 * c) + 0.2 * std::sin(46 * at.y - 58 * at.z + 3 * c);
  return colour;
}

Camera ringCamera(const BumpyOptions& options, double angle, double elevation) {
  Camera camera;
  camera.intrinsics = pinholeFromFov(options.width, options.height, 2 * std::atan(0.68 / options.distance));
  camera.pose.rotation = glm::angleAxis(angle, glm::dvec3(0, 1, 0)) * glm::angleAxis(-elevation, glm::dvec3(1, 0, 0));
  camera.pose.position = options.middle - options.distance * viewAxis(camera.pose);
  return camera;
}

std::vector<SurfaceHit> surfaceHits(const TriangleMesh& mesh, const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  std::vector<SurfaceHit> hits(std::size_t(k.width) * std::size_t(k.height));
  std::vector<glm::dvec3> projected;  // px, inverse depth
  for (const glm::dvec3& position : mesh.positions) {
    const glm::dvec3 q = toCamera(camera.pose, position);
    const auto pixel = project(k, q);
    projected.push_back(pixel ? glm::dvec3(*pixel, -1 / q.z) : glm::dvec3(0));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3 a = projected[mesh.triangles[t].x], b = projected[mesh.triangles[t].y],
                     c = projected[mesh.triangles[t].z];
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0 || a.z <= 0 || b.z <= 0 || c.z <= 0) continue;  // no triangle of the scene crosses a camera's plane
    const int left = std::max(0, int(std::floor(std::min({a.x, b.x, c.x})))),
              top = std::max(0, int(std::floor(std::min({a.y, b.y, c.y}))));
    const int right = std::min(k.width - 1, int(std::max({a.x, b.x, c.x}))),
              bottom = std::min(k.height - 1, int(std::max({a.y, b.y, c.y})));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
        const double atB = (px * (c.y - a.y) - py * (c.x - a.x)) / area,
                     atC = ((b.x - a.x) * py - (b.y - a.y) * px) / area;
        if (atB < 0 || atC < 0 || atB + atC > 1) continue;
        const glm::dvec3 weighted((1 - atB - atC) * a.z, atB * b.z, atC * c.z);
        const double inverseDepth = weighted.x + weighted.y + weighted.z;
        SurfaceHit& hit = hits[std::size_t(y) * std::size_t(k.width) + std::size_t(x)];
        if (inverseDepth > hit.inverseDepth) hit = {std::int64_t(t), weighted / inverseDepth, inverseDepth};
      }
  }
  return hits;
}

glm::dvec3 pointOf(const TriangleMesh& mesh, const SurfaceHit& hit) {
  const glm::uvec3 t = mesh.triangles[std::size_t(hit.triangle)];
  return hit.share.x * mesh.positions[t.x] + hit.share.y * mesh.positions[t.y] + hit.share.z * mesh.positions[t.z];
}

BumpyModel bumpyModel(const BumpyOptions& options) {
  BumpyModel bumpy;
  bumpy.options = options;
  bumpy.model.surface.mesh = body(options);
  bumpy.model.surface.members.assign(bumpy.model.surface.mesh.positions.size(), 0);
  for (int i = 0; i < options.cameras; ++i) {
    const double angle = 2 * pi * i / options.cameras;
    HtmCamera camera;
    camera.name = fmt::format("camera{}", i);
    camera.camera = ringCamera(options, angle, i % 2 ? -0.15 : 0.35);
    bumpy.model.cameras.push_back(camera);
    bumpy.offsets.push_back(options.disagreement *
                            glm::dvec3(std::sin(7.0 * i), std::sin(5.0 * i + 1), std::sin(3.0 * i + 2)));
  }
  const std::vector<glm::dvec3> normals = normalsOf(bumpy.model.surface.mesh);
  for (std::size_t i = 0; i < bumpy.model.cameras.size(); ++i) {
    const std::vector<SurfaceHit> hits = surfaceHits(bumpy.model.surface.mesh, bumpy.model.cameras[i].camera);
    bumpy.pictures.push_back(photograph(bumpy, i, hits));
    addMembers(bumpy.model, i, hits, normals);
  }
  plantComplements(bumpy);
  return bumpy;
}

}  // namespace ibr::test
