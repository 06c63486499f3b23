// SPDX-License-Identifier: Apache-2.0
// Builds an image graph in code, without files: three generated photographs of a wall, joined by one cell ([T] §2.4).
//
//   08_graph_in_code PICTURE.ppm
#include <ibr/ibr.h>

#include <cmath>
#include <cstdio>

#include "vulkan_helpers.h"

namespace {

constexpr double kWallZ = -4;  // the wall is the plane z = −4, world units

glm::dvec3 wallColour(double x, double y) {  // display-encoded, 0 to 1
  return {0.5 + 0.3 * std::sin(5 * x) * std::cos(4 * y), 0.5 + 0.3 * std::sin(3 * x + 6 * y),
          0.4 + 0.2 * std::cos(7 * y)};
}

ibr::Image8 photograph(const ibr::Camera& camera) {
  ibr::Image8 image(camera.intrinsics.width, camera.intrinsics.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 ray = camera.pose.rotation * ibr::unproject(camera.intrinsics, {x + 0.5, y + 0.5});
      const glm::dvec3 at = camera.pose.position + ray * ((kWallZ - camera.pose.position.z) / ray.z);
      const glm::dvec3 colour = wallColour(at.x, at.y);
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[std::size_t(c)] = std::uint8_t(std::lround(255 * colour[c]));
    }
  return image;
}

// A vertex: where each member sees the point, and how far away.
void addVertex(const ibr::Scene& scene, ibr::Cell& cell, glm::dvec3 point) {
  std::vector<double> distances;
  double mean = 0;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const ibr::Camera& camera = scene.nodes[cell.members[i]].camera;
    const glm::dvec3 ray = glm::conjugate(camera.pose.rotation) * (point - camera.pose.position);
    cell.mesh.match[i].emplace_back(ibr::project(camera.intrinsics, ray).value());
    distances.push_back(glm::length(ray));
    mean += distances[i] / double(cell.members.size());
  }
  for (std::size_t i = 0; i < cell.members.size(); ++i) cell.mesh.ratio[i].push_back(float(distances[i] / mean));
  cell.mesh.inverseDistance.push_back(float(1 / mean));
  cell.mesh.uncertainty.push_back(0);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: 08_graph_in_code PICTURE.ppm\n", stderr);
    return 1;
  }
  // Nodes: photographs with their poses. The textures stay in memory.
  ibr::Scene scene;
  std::vector<ibr::Texture> textures;
  for (const glm::dvec3 position : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0.5, 0.8, 0}}) {
    const ibr::Camera camera{ibr::pinholeFromFov(512, 384, 1.0), {position, {1, 0, 0, 0}}};
    scene.nodes.push_back({.name = "photograph " + std::to_string(scene.nodes.size()), .camera = camera});
    textures.emplace_back(ibr::buildMips(photograph(camera)));
  }

  // A cell of three: a grid of vertices on the part of the wall that all three see, two triangles a quad.
  ibr::Cell cell{.members = {0, 1, 2}};
  cell.mesh.match.resize(3);
  cell.mesh.ratio.resize(3);
  constexpr std::uint32_t kColumns = 12, kRows = 9;
  for (std::uint32_t row = 0; row <= kRows; ++row)
    for (std::uint32_t column = 0; column <= kColumns; ++column)
      addVertex(scene, cell, {-1.8 + 4.6 * column / kColumns, 2.1 - 3.4 * row / kRows, kWallZ});
  for (std::uint32_t row = 0; row < kRows; ++row)
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      const std::uint32_t a = row * (kColumns + 1) + column, b = a + 1, c = a + kColumns + 1, d = c + 1;
      cell.mesh.triangles.insert(cell.mesh.triangles.end(), {{a, c, b}, {b, c, d}});  // counter-clockwise as seen
    }
  cell.mesh.tier.assign(cell.mesh.triangles.size(), ibr::kTierConsistent);
  cell.mesh.ecc.assign(cell.mesh.triangles.size(), 1);
  scene.cells.push_back(cell);
  for (const ibr::Fault& fault : ibr::validate(scene))
    throw ibr::Error(ibr::ErrorCode::invalidInput, fault.field + " " + fault.message);

  constexpr VkExtent2D kSize{640, 480};
  ibr::Device device = ibr::Device::create();
  const ibr::GpuScene gpuScene(device, scene, {.source = [&](const ibr::Scene&, std::size_t node, int firstLevel) {
                                 return ibr::withoutLargestLevels(textures[node], firstLevel);
                               }});
  const ibr::RenderSettings settings;
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, kSize));
  ibr::Offscreen offscreen(device, kSize);
  const ibr::Camera view{ibr::pinholeFromFov(int(kSize.width), int(kSize.height), 0.6),
                         {{0.5, 0.3, 0.2}, glm::angleAxis(0.05, glm::dvec3(0, 1, 0))}};
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  const ibr::Image8 picture =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  helpers::writePpm(argv[1], picture.values.data(), kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "08_graph_in_code: %s\n", error.what());
  return 2;
}
