// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_stage_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_precision.hpp>
#include <optional>
#include <vector>

#include "base/file.h"
#include "base/raster.h"
#include "io/image_file.h"
#include "shared/draw/image_operations.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t(0);

// Index of the nearest face at each pixel's centre. Faces with a corner that is not in front of the camera are left
// out.
Image<std::uint32_t> nearestFaces(const TriangleMesh& mesh, const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  struct Corner {
    std::optional<glm::dvec2> pixel;
    double inverseDepth;
  };
  std::vector<Corner> corners;
  for (const glm::dvec3& position : mesh.positions) {
    const glm::dvec3 at = glm::conjugate(camera.pose.rotation) * (position - camera.pose.position);
    corners.push_back({project(k, at), -1 / at.z});
  }
  Image<std::uint32_t> faces(k.width, k.height, 1, kNone);
  ImageF nearest(k.width, k.height, 1, 0.0f);  // inverse depth
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    const Corner &a = corners[t.x], &b = corners[t.y], &c = corners[t.z];
    if (!a.pixel || !b.pixel || !c.pixel) continue;
    forTrianglePixels(*a.pixel, *b.pixel, *c.pixel, k.width, k.height, [&](int x, int y, const glm::dvec3& share) {
      const auto inverse = float(glm::dot(share, glm::dvec3(a.inverseDepth, b.inverseDepth, c.inverseDepth)));
      if (!(inverse > nearest.pixel(x, y)[0])) return;
      nearest.pixel(x, y)[0] = inverse;
      faces.pixel(x, y)[0] = std::uint32_t(f);
    });
  }
  return faces;
}

Image8 pictureOf(const HtmResult::Stage& stage, const Camera& camera, double most) {
  const Image<std::uint32_t> faces = nearestFaces(stage.mesh, camera);
  Image8 picture(faces.width, faces.height, 3, 255);
  const glm::dvec3 axis = viewAxis(camera.pose);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::uint32_t face = faces.pixel(x, y)[0];
      if (face == kNone) continue;
      const glm::uvec3 t = stage.mesh.triangles[face];
      const glm::dvec3& a = stage.mesh.positions[t.x];
      const glm::dvec3 normal = glm::cross(stage.mesh.positions[t.y] - a, stage.mesh.positions[t.z] - a);
      const double light = 0.45 + 0.55 * std::abs(glm::dot(normal, axis)) / std::max(glm::length(normal), 1e-300);
      const glm::u8vec3 colour = differenceColour(stage.difference[face], most);
      for (int c = 0; c < 3; ++c) picture.pixel(x, y)[std::size_t(c)] = std::uint8_t(light * colour[c]);
    }
  return picture;
}

std::string fileName(std::string name) {
  std::ranges::replace(name, ' ', '-');
  return name;
}

}  // namespace

glm::u8vec3 differenceColour(double difference, double most) {
  const std::array<glm::dvec3, 4> ramp{{{40, 70, 200}, {40, 190, 120}, {245, 220, 60}, {215, 40, 30}}};
  const double at = 3 * std::clamp(most > 0 ? difference / most : 0.0, 0.0, 1.0);
  const int step = std::min(int(at), 2);
  return glm::u8vec3(glm::mix(ramp[std::size_t(step)], ramp[std::size_t(step + 1)], at - step) + 0.5);
}

void writeStages(const std::filesystem::path& folder, const std::vector<HtmResult::Stage>& stages,
                 const Camera& camera) {
  makeFolders(folder);
  const double most = quantile(stages.front().difference, 0.99);
  std::vector<Image8> pictures;
  for (const HtmResult::Stage& stage : stages) {
    MeshColours colours;
    for (const double difference : stage.difference) colours.faces.push_back(differenceColour(difference, most));
    writePly(folder / (fileName(stage.name) + ".ply"), stage.mesh, colours);
    pictures.push_back(pictureOf(stage, camera, most));
  }
  writeImage(folder / "stages.png", sideBySide(pictures));
}

}  // namespace ibr::app
