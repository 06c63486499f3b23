// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/synthetic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "base/check.h"
#include "lab/generate/wave_texture.h"

namespace ibr {
namespace {

struct Hit {
  std::size_t plane;
  double distance;  // in lengths of the direction
  glm::dvec2 at;    // in the plane, from its centre
};

std::optional<Hit> firstHit(const std::vector<TexturedPlane>& planes, glm::dvec3 from, glm::dvec3 direction) {
  std::optional<Hit> first;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const TexturedPlane& plane = planes[i];
    const glm::dvec3 normal = glm::cross(plane.u, plane.v), toCentre = plane.origin - from;
    const double approach = glm::dot(normal, direction);
    const double distance = approach != 0.0 ? glm::dot(normal, toCentre) / approach : 0.0;
    if (!(distance > 0.0) || !std::isfinite(distance) || (first && distance >= first->distance)) continue;
    const glm::dvec3 offset = distance * direction - toCentre;
    const glm::dvec2 at(glm::dot(offset, plane.u), glm::dot(offset, plane.v));
    if (2.0 * std::abs(at.x) <= plane.extentU && 2.0 * std::abs(at.y) <= plane.extentV) first = Hit{i, distance, at};
  }
  return first;
}

// Origin of a camera's rays: the same for all cameras of a scene at infinity.
glm::dvec3 rayOrigin(const SyntheticScene& scene, const Camera& camera) {
  return scene.centreOfInfinity.value_or(camera.pose.position);
}

glm::dvec3 worldRay(const Camera& camera, glm::dvec2 pixel) {
  return camera.pose.rotation * unproject(camera.intrinsics, pixel);
}

// Pixel of a point that lies in `direction` from the camera's ray origin; nullopt outside the image.
std::optional<glm::dvec2> pixelInside(const Camera& camera, glm::dvec3 direction) {
  const Intrinsics& k = camera.intrinsics;
  const auto pixel = project(k, glm::conjugate(camera.pose.rotation) * direction);
  constexpr double kRounding = 1e-6;
  if (!pixel || pixel->x < -kRounding || pixel->y < -kRounding || pixel->x > k.width + kRounding ||
      pixel->y > k.height + kRounding)
    return std::nullopt;
  return pixel;
}

// A point of a plane that all members see.
struct Common {
  std::size_t plane;
  std::vector<glm::dvec2> match;
  std::vector<double> distance;
};

std::optional<Common> commonPoint(const SyntheticScene& scene, const std::vector<std::uint32_t>& members,
                                  std::size_t index, glm::dvec2 at) {
  const TexturedPlane& plane = scene.planes[index];
  Common common{index, {}, {}};
  for (const std::uint32_t member : members) {
    const Camera& camera = scene.scene.nodes[member].camera;
    const glm::dvec3 origin = rayOrigin(scene, camera);
    const glm::dvec3 direction = (plane.origin - origin) + plane.u * at.x + plane.v * at.y;
    const auto match = pixelInside(camera, direction);
    if (!match) return std::nullopt;
    const auto seen = firstHit(scene.planes, origin, direction);
    constexpr double kRounding = 1e-9;  // where planes meet, either may come first
    if (seen && seen->distance < 1.0 - kRounding) return std::nullopt;
    common.match.push_back(*match);
    common.distance.push_back(glm::length(direction));
  }
  return common;
}

// Returns the point that the first member sees at `pixel`, if all others see the point, too.
std::optional<Common> commonPoint(const SyntheticScene& scene, const std::vector<std::uint32_t>& members,
                                  glm::dvec2 pixel) {
  const Camera& first = scene.scene.nodes[members[0]].camera;
  const auto hit = firstHit(scene.planes, rayOrigin(scene, first), worldRay(first, pixel));
  if (!hit) return std::nullopt;
  auto common = commonPoint(scene, members, hit->plane, hit->at);
  if (common) {
    common->match[0] = pixel;
    common->distance[0] = hit->distance;
  }
  return common;
}

void addVertex(MorphMesh& mesh, const Common& common, bool atInfinity) {
  const double mean =
      std::accumulate(common.distance.begin(), common.distance.end(), 0.0) / double(common.match.size());
  for (std::size_t i = 0; i < common.match.size(); ++i) {
    mesh.match[i].emplace_back(common.match[i]);
    mesh.ratio[i].push_back(atInfinity ? 1.0f : float(common.distance[i] / mean));
  }
  mesh.inverseDistance.push_back(atInfinity ? 0.0f : float(1.0 / mean));
  mesh.uncertainty.push_back(0.0f);
}

MorphMesh makePictureMesh(const SyntheticScene& scene, const std::vector<std::uint32_t>& members, int step) {
  const Intrinsics& k = scene.scene.nodes[members[0]].camera.intrinsics;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  Image<std::size_t> plane(k.width + 1, k.height + 1, 1, kNone);
  for (int y = 0; y <= k.height; ++y)
    for (int x = 0; x <= k.width; ++x)
      if (const auto common = commonPoint(scene, members, {x, y})) plane.pixel(x, y)[0] = common->plane;

  MorphMesh mesh;
  mesh.match.resize(members.size());
  mesh.ratio.resize(members.size());
  Image<std::uint32_t> vertex(k.width + 1, k.height + 1, 1, std::numeric_limits<std::uint32_t>::max());
  auto vertexAt = [&](int x, int y) {
    std::uint32_t& index = vertex.pixel(x, y)[0];
    if (index == std::numeric_limits<std::uint32_t>::max()) {
      index = std::uint32_t(mesh.vertexCount());
      addVertex(mesh, *commonPoint(scene, members, {x, y}), scene.centreOfInfinity.has_value());
    }
    return index;
  };
  auto uniform = [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        if (plane.pixel(x, y)[0] == kNone || plane.pixel(x, y)[0] != plane.pixel(x0, y0)[0]) return false;
    return true;
  };
  for (int y0 = 0; y0 < k.height; y0 += step)
    for (int x0 = 0; x0 < k.width; x0 += step) {
      const int x1 = std::min(x0 + step, k.width), y1 = std::min(y0 + step, k.height);
      if (!uniform(x0, y0, x1, y1)) continue;
      const std::uint32_t a = vertexAt(x0, y0), b = vertexAt(x1, y0), c = vertexAt(x0, y1), d = vertexAt(x1, y1);
      mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
    }
  return mesh;
}

MorphMesh makeSurfaceMesh(const SyntheticScene& scene, const std::vector<std::uint32_t>& members, double step) {
  MorphMesh mesh;
  mesh.match.resize(members.size());
  mesh.ratio.resize(members.size());
  // Meeting planes share vertices, whatever the rounding.
  std::map<std::array<std::int64_t, 3>, std::uint32_t> vertexAt;
  for (std::size_t index = 0; index < scene.planes.size(); ++index) {
    const TexturedPlane& plane = scene.planes[index];
    const double columns = std::max(1.0, std::ceil(plane.extentU / step * (1 - 1e-9)));
    const double rows = std::max(1.0, std::ceil(plane.extentV / step * (1 - 1e-9)));
    check(columns * rows <= 1e7, ErrorCode::invalidInput,
          "synthetic scene: surface step {} gives {} quads in a plane, more than 1e7", step, columns * rows);
    auto placeOf = [&](double i, double j) {
      return glm::dvec2(plane.extentU * (i / columns - 0.5), plane.extentV * (j / rows - 0.5));
    };
    auto vertex = [&](double i, double j) {
      const glm::dvec2 at = placeOf(i, j);
      const glm::dvec3 position = (plane.origin - scene.planes[0].origin) + plane.u * at.x + plane.v * at.y;
      std::array<std::int64_t, 3> key;
      constexpr double kOffGrid = 0.1234;  // places round numbers inside a bin
      for (std::size_t a = 0; a < 3; ++a) key[a] = std::llround(position[int(a)] / (1e-4 * step) + kOffGrid);
      const auto [found, fresh] = vertexAt.emplace(key, std::uint32_t(mesh.vertexCount()));
      if (fresh) addVertex(mesh, *commonPoint(scene, members, index, at), scene.centreOfInfinity.has_value());
      return found->second;
    };
    auto seen = [&](double i, double j) {
      for (int y = 0; y <= 4; ++y)
        for (int x = 0; x <= 4; ++x)
          if (!commonPoint(scene, members, index, placeOf(i + 0.25 * x, j + 0.25 * y))) return false;
      return true;
    };
    for (double j = 0; j < rows; ++j)
      for (double i = 0; i < columns; ++i) {
        if (!seen(i, j)) continue;
        const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1), d = vertex(i + 1, j + 1);
        mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
      }
  }
  return mesh;
}

MorphMesh makeMesh(const SyntheticScene& scene, const std::vector<std::uint32_t>& members,
                   const SyntheticOptions& options) {
  MorphMesh mesh = options.surfaceStep > 0 ? makeSurfaceMesh(scene, members, options.surfaceStep)
                                           : makePictureMesh(scene, members, options.gridStep);
  mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.assign(mesh.triangles.size(), 1.0f);
  return mesh;
}

constexpr double kMaxCoordinateMagnitude = 1e12;  // limit of validate() for scenes

bool within(glm::dvec3 v) {
  return std::abs(v.x) <= kMaxCoordinateMagnitude && std::abs(v.y) <= kMaxCoordinateMagnitude &&
         std::abs(v.z) <= kMaxCoordinateMagnitude;
}

void checkPlane(const TexturedPlane& plane, std::size_t index) {
  const auto demand = [&](bool fulfilled, const char* what) {
    check(fulfilled, ErrorCode::invalidInput, "synthetic scene: plane {}: {}", index, what);
  };
  constexpr double kRounding = 1e-6;
  const double largest = std::max(plane.extentU, plane.extentV);
  demand(within(plane.origin), "origin is not finite, or beyond 1e12");
  demand(std::abs(glm::length(plane.u) - 1) < kRounding && std::abs(glm::length(plane.v) - 1) < kRounding &&
             std::abs(glm::dot(plane.u, plane.v)) < kRounding,
         "u and v are not perpendicular unit vectors");
  demand(plane.extentU > 0 && plane.extentV > 0 && largest <= kMaxCoordinateMagnitude,
         "width or height is not within 0 to 1e12");
  demand(plane.wavelength >= 1e-9 * largest && plane.wavelength <= kMaxCoordinateMagnitude,
         "wavelength is below 1e-9 of the larger side, or beyond 1e12");
}

}  // namespace

std::optional<double> distanceAlong(const SyntheticScene& scene, glm::dvec3 from, glm::dvec3 direction) {
  const auto hit = firstHit(scene.planes, from, direction);
  return hit ? std::optional(hit->distance) : std::nullopt;
}

glm::dvec3 textureColour(const TexturedPlane& plane, glm::dvec2 at) {
  return WaveTexture(plane).colour(at);
}

SyntheticScene makeScene(const SyntheticOptions& options) {
  check(options.gridStep >= 1 && options.samplesPerAxis >= 1, ErrorCode::invalidInput,
        "synthetic scene: grid step {} or {} samples per axis is below 1", options.gridStep, options.samplesPerAxis);
  check(options.surfaceStep >= 0 && std::isfinite(options.surfaceStep), ErrorCode::invalidInput,
        "synthetic scene: surface step {} is negative or not finite", options.surfaceStep);
  for (std::size_t i = 0; i < options.planes.size(); ++i) checkPlane(options.planes[i], i);
  SyntheticScene result;
  result.planes = options.planes;
  result.scene.acquisition = "synthetic";
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < options.cameras.size(); ++i) {
    const std::string name = fmt::format("view{}", i);
    result.scene.nodes.push_back({name, options.cameras[i], "images/" + name + ".png", "textures/" + name + ".ktx2"});
    sum += options.cameras[i].pose.position;
  }
  if (options.atInfinity) result.centreOfInfinity = sum / double(std::max<std::size_t>(1, options.cameras.size()));

  std::vector<std::vector<std::uint32_t>> cells = options.cells;
  if (cells.empty()) {
    cells.emplace_back(options.cameras.size());
    std::iota(cells[0].begin(), cells[0].end(), 0u);
  }
  for (const auto& members : cells) {
    check(members.size() >= 2 && members.size() <= 4, ErrorCode::invalidInput,
          "synthetic scene: a cell has {} members, not 2 to 4", members.size());
    for (std::uint32_t member : members)
      check(member < options.cameras.size(), ErrorCode::invalidInput,
            "synthetic scene: member {} is beyond the {} cameras", member, options.cameras.size());
    Cell cell;
    cell.members = members;
    cell.mesh = makeMesh(result, members, options);
    result.scene.cells.push_back(std::move(cell));
  }
  for (const Camera& camera : options.cameras)
    result.photographs.push_back(renderTruth(result, camera, options.samplesPerAxis));
  return result;
}

std::vector<TexturedPlane> roomPlanes(glm::dvec3 low, glm::dvec3 high, double wavelength, std::uint64_t seed) {
  const glm::dvec3 centre = 0.5 * (low + high), size = high - low;
  std::vector<TexturedPlane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const glm::dvec3& corner : {low, high}) {
      TexturedPlane plane;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      plane.origin = centre;
      plane.origin[axis] = corner[axis];
      plane.u = plane.v = glm::dvec3(0.0);
      plane.u[a] = plane.v[b] = 1.0;
      plane.extentU = size[a];
      plane.extentV = size[b];
      plane.seed = seed + planes.size();
      plane.wavelength = wavelength;
      planes.push_back(plane);
    }
  return planes;
}

Image8 renderTruth(const SyntheticScene& scene, const Camera& camera, int samplesPerAxis) {
  const std::vector<WaveTexture> textures(scene.planes.begin(), scene.planes.end());
  const glm::dvec3 from = rayOrigin(scene, camera);
  Image8 image(camera.intrinsics.width, camera.intrinsics.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      glm::dvec3 sum(0.0);
      for (int j = 0; j < samplesPerAxis; ++j)
        for (int i = 0; i < samplesPerAxis; ++i) {
          const glm::dvec2 pixel(x + (i + 0.5) / samplesPerAxis, y + (j + 0.5) / samplesPerAxis);
          const auto hit = firstHit(scene.planes, from, worldRay(camera, pixel));
          if (hit) sum += textures[hit->plane].colour(hit->at);
        }
      const glm::dvec3 mean = sum / double(samplesPerAxis * samplesPerAxis);
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[std::size_t(c)] = std::uint8_t(std::lround(mean[c]));
    }
  return image;
}

ImageF renderDepth(const SyntheticScene& scene, const Camera& camera) {
  ImageF depth(camera.intrinsics.width, camera.intrinsics.height, 1, std::numeric_limits<float>::infinity());
  if (scene.centreOfInfinity) return depth;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const glm::dvec3 ray = worldRay(camera, {x + 0.5, y + 0.5});
      const double along = camera.intrinsics.model == CameraModel::pinhole ? glm::dot(ray, viewAxis(camera.pose)) : 1.0;
      if (const auto hit = firstHit(scene.planes, camera.pose.position, ray))
        depth.pixel(x, y)[0] = float(hit->distance * along);
    }
  return depth;
}

}  // namespace ibr
