// SPDX-License-Identifier: Apache-2.0
// Edges of triangles over the picture ([T] fig. 4).
#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/metrics.h"
#include "reference/morph.h"
#include "reference/stage.h"
#include "shared/wireframe.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

Image8 wired(const Stage& stage, const FramePlan& plan) {
  const Intrinsics& k = plan.views[0].intrinsics;
  const VkExtent2D extent{std::uint32_t(k.width), std::uint32_t(k.height)};
  const Renderer renderer(testDevice(), stage.gpuScene(), {.largest = extent, .wireframe = true});
  Offscreen offscreen(testDevice(), extent);
  return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  return glm::distance(p, a + t * (b - a));
}

}  // namespace

TEST_CASE("edges have their cell's rank's colour, and between them the picture is as it was") {
  SyntheticOptions options = place(3);
  options.planes.resize(1);  // nothing hides an edge
  options.gridStep = 40;
  for (const Morph morph : {Morph::ours, Morph::paper}) {
    const Stage stage(testDevice(), makeScene(options));
    RenderSettings settings = withTiers();
    settings.morph = morph;
    const Camera view = cameraAt({0.45, 0.3, 0.1}, 0.05);
    const Image8 plain = stage.render(view, settings);
    settings.wireframe = true;
    const FramePlan plan = stage.plan(view, settings);
    const Image8 picture = wired(stage, plan);

    // Where the edges should be, from the twin of the morph.
    const Cell& cell = stage.scene().cells[0];
    std::vector<std::pair<glm::dvec2, glm::dvec2>> edges;
    for (const glm::uvec3& t : cell.mesh.triangles) {
      glm::dvec2 corner[3];
      for (int v = 0; v < 3; ++v)
        corner[v] = *project(
            view.intrinsics,
            glm::conjugate(view.pose.rotation) *
                reference::morph(stage.scene(), cell, t[v], plan.cells[0].view[0].position, morph, view.pose.position));
      for (int v = 0; v < 3; ++v) edges.emplace_back(corner[v], corner[(v + 1) % 3]);
    }
    const shader::vec3 yellow = shader::rankColour(0, 1);
    std::size_t on = 0, off = 0, wrongOn = 0, wrongOff = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        if (plain.pixel(x, y)[3] == 0) continue;
        wrongOff += picture.pixel(x, y)[3] != plain.pixel(x, y)[3];
        double nearest = 1e9;
        for (const auto& [a, b] : edges) nearest = std::min(nearest, distanceToSegment({x + 0.5, y + 0.5}, a, b));
        for (int c = 0; c < 3; ++c) {
          if (nearest < 0.2) {
            ++on;
            wrongOn += std::abs(picture.pixel(x, y)[c] - 255 * yellow[c]) > 2;
          } else if (nearest > 1.5) {
            ++off;
            wrongOff += picture.pixel(x, y)[c] != plain.pixel(x, y)[c];
          }
        }
      }
    INFO("morph " << int(morph));
    CHECK(on > 1000);
    CHECK(off > 10000);
    CHECK(double(wrongOn) < 0.01 * double(on));
    CHECK(double(wrongOff) < 0.001 * double(off));
  }
}

TEST_CASE("ranks go from light to cold, and the better cell's edges hide the others'") {
  const auto brightness = [](shader::vec3 c) { return c.x + c.y + c.z; };
  for (int ranks : {2, 5, 12})
    for (int r = 1; r < ranks; ++r)
      CHECK(brightness(shader::rankColour(float(r), float(ranks))) <
            brightness(shader::rankColour(float(r - 1), float(ranks))));
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  RenderSettings settings = withTiers();
  settings.wireframe = true;
  const FramePlan plan = stage.plan(cameraAt({0.6, 0.4, 0.2}, 0.1), settings);
  const Image8 ours = wired(stage, plan);
  FramePlan painted = plan;
  painted.settings.order = DrawOrder::paper;
  CHECK(difference(wired(stage, painted), ours, 2).shareAbove < 1e-3);
  std::size_t seen[2] = {};
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x)
      for (int r = 0; r < 2; ++r) {
        const shader::vec3 colour = 255.0f * shader::rankColour(float(r), 2);
        bool same = true;
        for (int c = 0; c < 3; ++c) same &= std::abs(ours.pixel(x, y)[c] - colour[c]) <= 2;
        seen[r] += same;
      }
  CHECK(seen[0] > 200);
  CHECK(seen[1] > 20);
}
