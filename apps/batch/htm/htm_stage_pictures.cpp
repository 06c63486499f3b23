// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_stage_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>

#include "author/htm/htm_views.h"
#include "author/surface/triangle_mesh_file.h"
#include "base/file.h"
#include "io/image_file.h"
#include "shared/draw/pictures.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

Image8 pictureOf(const HtmResult::Stage& stage, const Camera& camera, double most) {
  const MeshRaster raster = rasterised(stage.mesh, camera);
  Image8 picture(raster.face.width, raster.face.height, 3, 255);
  const glm::dvec3 axis = viewAxis(camera.pose);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::uint32_t face = raster.face.pixel(x, y)[0];
      if (face == MeshRaster::kNone) continue;
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
