// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/bench_scene.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <string>

using namespace ibr;

namespace {

// Returns true if a cell's mesh covers a direction from the centre, judged by the grid of the cell's first member.
bool covers(const Scene& scene, const Cell& cell, glm::dvec3 direction) {
  const Camera& camera = scene.nodes[cell.members[0]].camera;
  const Intrinsics& k = camera.intrinsics;
  if (k.model != CameraModel::pinhole) return true;
  const glm::dvec3 ray = 8.0 * direction - camera.pose.position;
  const auto pixel = project(k, glm::conjugate(camera.pose.rotation) * ray);
  return pixel && std::abs(pixel->x / k.width - 0.5) < 0.43 && std::abs(pixel->y / k.height - 0.5) < 0.43;
}

struct Layers {
  double mean = 0;       // cells per pixel
  double uncovered = 0;  // share of pixels
};

Layers layersOf(const BenchShape& shape) {
  const Scene scene = makeBenchScene(shape, 0.1);
  const Camera view = benchViews(shape, 1, 64, 36)[0];
  Layers layers;
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 direction = view.pose.rotation * unproject(view.intrinsics, {x + 0.5, y + 0.5});
      int count = 0;
      for (const Cell& cell : scene.cells) count += covers(scene, cell, direction);
      layers.mean += count / (64.0 * 36);
      layers.uncovered += (count == 0) / (64.0 * 36);
    }
  return layers;
}

}  // namespace

TEST_CASE("bench scenes have the shapes of [T] table 2 and are valid") {
  const std::map<std::string, std::pair<std::size_t, std::size_t>> table{
      {"stitched-5", {5, 27862}}, {"stitched-12", {12, 161199}}, {"stitched-30", {30, 156560}},
      {"stacked-5", {5, 27862}},  {"stacked-12", {12, 161199}},  {"stacked-30", {30, 156560}},
      {"panorama-1", {1, 26094}}, {"panorama-3", {3, 57741}}};
  REQUIRE(benchShapes().size() == table.size());
  for (const BenchShape& shape : benchShapes()) {
    INFO(shape.name);
    CHECK(findBenchShape(shape.name) == &shape);
    const Scene scene = makeBenchScene(shape, 0.1);
    std::size_t triangles = 0;
    for (const Cell& cell : scene.cells) {
      triangles += cell.mesh.triangles.size();
      CHECK(cell.members.size() == 3);
    }
    const auto [cells, wanted] = table.at(shape.name);
    CHECK(scene.cells.size() == cells);
    CHECK(std::abs(double(triangles) / double(wanted) - 1) < 0.015);
    for (const Fault& fault : validate(scene)) FAIL_CHECK(fault.field << ": " << fault.message);
  }
  CHECK(findBenchShape("stitched-6") == nullptr);
}

TEST_CASE("stitched cells overlap as in the paper's frames, stacked cells all fill the view") {
  for (const auto& [name, mean] : std::map<std::string, double>{{"stitched-5", 1.76},
                                                                {"stitched-12", 3.57},
                                                                {"stitched-30", 8.66},
                                                                {"stacked-5", 5},
                                                                {"stacked-12", 12},
                                                                {"stacked-30", 30}}) {
    const Layers layers = layersOf(*findBenchShape(name));
    INFO(name << ": " << layers.mean << " layers, " << layers.uncovered << " uncovered");
    CHECK(std::abs(layers.mean / mean - 1) < 0.1);
    CHECK(layers.uncovered < 0.15);
  }
}

TEST_CASE("photographs of a bench scene agree at matches, and are not flat") {
  const Scene scene = makeBenchScene(*findBenchShape("stitched-5"), 0.25);
  const std::vector<Image8> first = benchPhotograph(scene, 0), second = benchPhotograph(scene, 1);
  REQUIRE(first.size() == 9);
  CHECK((first[0].width == 320 && first[0].height == 240 && first[0].channels == 4));
  CHECK((first[8].width == 1 && first[8].height == 1));
  CHECK(benchPhotograph(scene, 0)[0] == first[0]);
  const MorphMesh& mesh = scene.cells[0].mesh;
  const auto at = [&](const Image8& image, glm::vec2 pixel) { return int(image.pixel(int(pixel.x), int(pixel.y))[1]); };
  double difference = 0, variation = 0;
  const std::size_t count = mesh.vertexCount();
  for (std::size_t p = 0; p < count; ++p) {
    difference += std::abs(at(first[0], mesh.match[0][p]) - at(second[0], mesh.match[1][p]));
    variation += std::abs(at(first[0], mesh.match[0][p]) - at(first[0], mesh.match[0][(p + count / 3) % count]));
  }
  CHECK(variation / double(count) > 20);
  CHECK(difference < 0.35 * variation);
}
