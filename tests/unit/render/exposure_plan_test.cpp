// SPDX-License-Identifier: Apache-2.0
// Gains of photographs: the approximate transfer curve of shaders, and the adaptation of a frame.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/exponential.hpp>
#include <numbers>

#include "base/srgb.h"
#include "ibr/frame_plan.h"
#include "lab/generate/synthetic.h"
#include "shared/cell.h"

using namespace ibr;

namespace {

// Largest error over all levels and gains of 1/most to most, 8-bit levels.
double worstError(double most) {
  double worst = 0;
  for (int step = -200; step <= 200; ++step)
    for (int level = 0; level < 256; ++level) {
      const double gain = std::pow(most, step / 200.0), value = level / 255.0;
      const double right = linearToSrgb(gain * srgbToLinear(value));
      const double shown = shader::exposedValue(float(value), float(gain), float(std::pow(gain, 1 / 2.4)));
      worst = std::max(worst, 255 * std::abs(shown - right));
    }
  return worst;
}

// Three photographs about 1 unit apart in front of a wall, in one cell.
Scene exposedScene() {
  SyntheticOptions options;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0.5, 0.8, 0}})
    options.cameras.push_back({pinholeFromFov(96, 72, 1.2), {place, glm::dquat(1, 0, 0, 0)}});
  options.planes = {{{0, 0, -5}, {1, 0, 0}, {0, 1, 0}, 30, 30, 1, 0.8}};
  options.cells = {{0, 1, 2}};
  options.gridStep = 24;
  options.samplesPerAxis = 1;
  Scene scene = makeScene(options).scene;
  scene.nodes[0].gain = {2, 1, 0.5};
  scene.nodes[1].gain = {0.25, 1, 2};
  return scene;
}

FramePlan planAt(const Scene& scene, glm::dvec3 position, const RenderSettings& settings, double seconds = 0,
                 const PlanState& state = {}) {
  const Camera view{pinholeFromFov(64, 48, 1.0), {position, glm::dquat(1, 0, 0, 0)}};
  return planFrame(scene, sceneBounds(scene), {{view}, settings, seconds}, state);
}

bool near(glm::dvec3 a, glm::dvec3 b) {
  for (int c = 0; c < 3; ++c)
    if (!(std::abs(a[c] / b[c] - 1) < 1e-12)) return false;
  return true;
}

}  // namespace

TEST_CASE("a gain approximates scaling of linear light") {
  CHECK(worstError(1.25) < 0.04);
  CHECK(worstError(2) < 0.4);
  CHECK(worstError(4) < 1.9);
  CHECK(worstError(8) < 3.9);
}

TEST_CASE("a gain of 1 changes no bit, and every gain keeps black and the order of levels") {
  for (int i = 0; i <= 4096; ++i) {
    const float value = float(i) / 4096;
    CHECK(std::bit_cast<std::uint32_t>(shader::exposedValue(value, 1, 1)) == std::bit_cast<std::uint32_t>(value));
  }
  for (const float gain : {1 / 4096.0f, 0.125f, 0.9f, 1.1f, 8.0f, 4096.0f}) {
    const float slope = std::pow(gain, 1 / 2.4f);
    CHECK(shader::exposedValue(0, gain, slope) == 0.0f);
    for (int level = 1; level < 256; ++level)
      CHECK(shader::exposedValue(float(level) / 255, gain, slope) >
            shader::exposedValue(float(level - 1) / 255, gain, slope));
  }
}

TEST_CASE("clipped colours stay white, and other colours follow the gain curve") {
  using shader::vec3;
  const vec3 gain(0.3f, 0.5f, 0.9f), slope = glm::pow(gain, vec3(1 / 2.4f));
  CHECK(shader::exposedColour(vec3(1), gain, slope) == vec3(1));
  const vec3 lit(0.85f, 0.5f, 0.2f), shown = shader::exposedColour(lit, gain, slope);
  for (int c = 0; c < 3; ++c) CHECK(shown[c] == shader::exposedValue(lit[c], gain[c], slope[c]));
  for (int level = 1; level < 256; ++level)  // a lighter level never gets darker
    CHECK(shader::exposedColour(vec3(float(level) / 255), gain, slope).r >
          shader::exposedColour(vec3(float(level - 1) / 255), gain, slope).r);
  const vec3 brighter = shader::exposedColour(vec3(1, 0.5f, 0.5f), vec3(2), vec3(std::pow(2.0f, 1 / 2.4f)));
  CHECK(brighter.g == shader::exposedValue(0.5f, 2, std::pow(2.0f, 1 / 2.4f)));
}

TEST_CASE("exposure adapts to the photographs of the main cell by their weights") {
  const Scene scene = exposedScene();
  RenderSettings settings;
  settings.exposure = Exposure::adapted;
  CHECK(near(planAt(scene, {0, 0, 0}, settings).exposure, 1.0 / scene.nodes[0].gain));
  CHECK(near(planAt(scene, {1, 0, 0}, settings).exposure, 1.0 / scene.nodes[1].gain));
  const FramePlan between = planAt(scene, {0.5, 0, 0}, settings);
  CHECK(near(between.exposure, 1.0 / glm::sqrt(scene.nodes[0].gain * scene.nodes[1].gain)));
  for (const Exposure exposure : {Exposure::off, Exposure::scene}) {
    settings.exposure = exposure;
    CHECK(planAt(scene, {0, 0, 0}, settings).exposure == glm::dvec3(1.0));
  }
}

TEST_CASE("exposure adapts over time, and at once in the first frame") {
  const Scene scene = exposedScene();
  RenderSettings settings;
  settings.exposureSeconds = 0.5;
  const FramePlan first = planAt(scene, {0, 0, 0}, settings);
  const FramePlan soon = planAt(scene, {1, 0, 0}, settings, 0.05, first.next);
  const double left = std::exp(-0.1);
  CHECK(near(soon.exposure,
             glm::pow(first.exposure, glm::dvec3(left)) * glm::pow(1.0 / scene.nodes[1].gain, glm::dvec3(1 - left))));
  FramePlan plan = soon;
  for (int frame = 0; frame < 400; ++frame) plan = planAt(scene, {1, 0, 0}, settings, 0.1, plan.next);
  CHECK(near(plan.exposure, 1.0 / scene.nodes[1].gain));
  const FramePlan still = planAt(scene, {1, 0, 0}, settings, 0, first.next);  // no time, no change
  CHECK(near(still.exposure, first.exposure));
  settings.exposureSeconds = 0;
  CHECK(near(planAt(scene, {1, 0, 0}, settings, 0.05, first.next).exposure, 1.0 / scene.nodes[1].gain));
  // If nothing is drawn, the exposure stays.
  const FramePlan away = planAt(scene, {0, 0, 900}, settings, 0.05, first.next);
  REQUIRE(away.cells.empty());
  CHECK(near(away.exposure, first.exposure));
}

TEST_CASE("without a drawn cell exposure adapts to the gathered photographs") {
  Scene scene = exposedScene();
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    Cell backdrop;
    backdrop.members = {n};
    backdrop.mesh.match = {{{0, 0}}};
    backdrop.mesh.ratio = {{1}};
    backdrop.mesh.inverseDistance = {0.2f};
    backdrop.mesh.uncertainty = {0.01f};
    backdrop.mesh.confirmations = {3};
    backdrop.mesh.consensus = {0.9f};
    scene.backdrops.push_back(backdrop);
    scene.nodes[n].depthFile = scene.nodes[n].name + ".ktx2";
    scene.nodes[n].depthScale = 1;
  }
  REQUIRE(validate(scene).empty());
  Scene bare = scene;
  bare.cells.clear();
  const auto exposure = [](const Scene& of, glm::dvec3 position, Composition composition) {
    RenderSettings settings;
    settings.composition = composition;
    const FramePlan plan = planAt(of, position, settings);
    CHECK(plan.settings.composition == composition);
    return plan.exposure;
  };
  const glm::dvec3 between(0.4, 0.1, 0);
  CHECK(near(exposure(bare, between, Composition::hybrid), exposure(bare, between, Composition::gathered)));
  CHECK(near(exposure(scene, between, Composition::hybrid), exposure(scene, between, Composition::cells)));
  CHECK_FALSE(near(exposure(scene, between, Composition::gathered), exposure(scene, between, Composition::cells)));
  RenderSettings gathered;
  gathered.composition = Composition::gathered;
  const FramePlan plan = planAt(bare, between, gathered);
  REQUIRE(plan.photographs.size() == 3);
  glm::dvec3 sum(0);
  double weights = 0;
  for (const PlannedPhotograph& one : plan.photographs) {
    const double weight = std::sqrt(one.share) / std::pow(0.01 + std::pow(one.distance / plan.gather.spacing, 2), 2);
    sum += weight * glm::log(bare.nodes[one.node].gain);
    weights += weight;
  }
  CHECK(near(plan.exposure, glm::exp(-sum / weights)));
  for (const std::uint32_t n : {0u, 1u}) {
    const glm::dvec3 own = exposure(bare, scene.nodes[n].camera.pose.position, Composition::hybrid);
    for (int c = 0; c < 3; ++c) CHECK(own[c] * scene.nodes[n].gain[c] == Approx(1).epsilon(0.2));
  }
}
