// SPDX-License-Identifier: Apache-2.0
#include "render/photographs/photograph_choice.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "render/photographs/photograph_set.h"
#include "render/photographs/photograph_values.h"
#include "support/plan_scenes.h"

using namespace ibr;

namespace {

constexpr std::size_t kCount = 12;
constexpr double kSpacing = 0.5;

// Photographs on a jittered grid, each with a backdrop that has evidence.
Scene photographed(int columns, int rows, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  Scene scene;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      Node node;
      node.name = std::to_string(j) + "_" + std::to_string(i);
      node.camera.intrinsics = pinholeFromFov(640, 480, 1.0);
      node.camera.pose.position = kSpacing * glm::dvec3(i + jitter(random), j + jitter(random), jitter(random));
      node.camera.pose.rotation = glm::angleAxis(jitter(random), glm::dvec3(0, 1, 0));
      node.depthFile = "depth/" + node.name + ".ktx2";
      node.depthScale = 1;
      Cell backdrop;
      backdrop.members = {std::uint32_t(scene.nodes.size())};
      backdrop.mesh.match = {{{0, 0}}};
      backdrop.mesh.ratio = {{1}};
      backdrop.mesh.inverseDistance = {0.25f};
      backdrop.mesh.uncertainty = {0.01f};
      backdrop.mesh.confirmations = {3};
      backdrop.mesh.consensus = {0.9f};
      scene.nodes.push_back(node);
      scene.backdrops.push_back(backdrop);
    }
  return scene;
}

Camera viewAt(glm::dvec3 position, double yaw = 0) {
  Camera view;
  view.intrinsics = pinholeFromFov(320, 240, 1.0);
  view.pose = {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))};
  return view;
}

std::vector<PlannedPhotograph> planned(const Scene& scene, const std::vector<Camera>& views, const Pose& middle,
                                       std::size_t count) {
  std::vector<PlannedPhotograph> chosen(3);  // is overwritten
  choosePhotographs(scene, makePhotographIndex(scene), gatherStatistics(scene), views, middle, count,
                    std::pmr::get_default_resource(), chosen);
  return chosen;
}

std::map<std::string, double> chosen(const Scene& scene, const Camera& view, std::size_t count = kCount) {
  std::map<std::string, double> weights;
  for (const PlannedPhotograph& one : planned(scene, {view}, view.pose, count))
    CHECK(weights.emplace(scene.nodes[one.node].name, one.weight).second);
  return weights;
}

double largestChange(const std::map<std::string, double>& a, const std::map<std::string, double>& b) {
  double largest = 0;
  for (const auto* all : {&a, &b})
    for (const auto& [name, ignored] : *all) {
      const auto weight = [&](const std::map<std::string, double>& of) {
        const auto found = of.find(name);
        return found == of.end() ? 0.0 : found->second;
      };
      largest = std::max(largest, std::abs(weight(a) - weight(b)));
    }
  return largest;
}

}  // namespace

TEST_CASE("the requested number of photographs is chosen, each once, with weights from 0 to 1") {
  const Scene scene = photographed(6, 5);
  for (const std::size_t count : {1u, 4u, 12u, 16u}) {
    const auto weights = chosen(scene, viewAt({1.2, 1.1, 0.1}, 0.1), count);
    CHECK(weights.size() == count);
    for (const auto& [name, weight] : weights) CHECK((weight >= 0 && weight <= 1));
  }
}

TEST_CASE("all photographs are chosen with weight 1 if there are no more than requested") {
  const Scene scene = photographed(3, 2);
  const auto weights = chosen(scene, viewAt({0.5, 0.3, 0}));
  REQUIRE(weights.size() == 6);
  for (const auto& [name, weight] : weights) CHECK(weight == 1);
}

TEST_CASE("a photograph is chosen with weight 1 at its own pose") {
  const Scene scene = photographed(6, 5);
  for (const Node& node : scene.nodes) {
    Camera view = node.camera;
    view.intrinsics = pinholeFromFov(320, 240, 1.0);
    CHECK(chosen(scene, view)[node.name] == 1);
  }
}

TEST_CASE("a camera step of a thousandth of the spacing changes weights by less than a tenth") {
  const Scene scene = photographed(7, 5);
  const double step = 0.001 * kSpacing;
  double largest = 0;
  std::set<std::string> seen;
  auto before = chosen(scene, viewAt({0.3, 0.4, 0.05}));
  for (int i = 1; i <= 1500; ++i) {
    const auto now = chosen(scene, viewAt({0.3 + step * i, 0.4 + 0.7 * step * i, 0.05}, 1e-4 * i));
    largest = std::max(largest, largestChange(before, now));
    for (const auto& [name, weight] : now) seen.insert(name);
    before = now;
  }
  CHECK(seen.size() > kCount);  // photographs enter and leave the choice
  CHECK(largest < 0.1);
}

TEST_CASE("the order of a scene's photographs does not change the choice") {
  const Scene scene = photographed(6, 5);
  Scene shuffled = scene;
  std::vector<std::uint32_t> order(scene.nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  for (std::uint32_t n = 0; n < order.size(); ++n) shuffled.nodes[n] = scene.nodes[order[n]];
  for (const double x : {0.2, 0.9, 2.1}) {
    const Camera view = viewAt({x, 0.8, 0.1}, 0.05);
    CHECK(largestChange(chosen(scene, view), chosen(shuffled, view)) < 1e-4);
  }
}

TEST_CASE("moving, turning and scaling the world does not change the choice") {
  const Scene scene = photographed(6, 5);
  const glm::dquat turn = glm::normalize(glm::dquat(0.8, 0.1, -0.4, 0.3));
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const auto moved = [&](const Pose& pose) {
      return Pose{scale * (turn * pose.position + glm::dvec3(3, -7, 11)), turn * pose.rotation};
    };
    Scene other = scene;
    for (Node& node : other.nodes) node.camera.pose = moved(node.camera.pose);
    for (Cell& backdrop : other.backdrops) backdrop.mesh.inverseDistance = {float(0.25 / scale)};
    Camera view = viewAt({1.3, 0.6, 0.2}, 0.1);
    const auto before = chosen(scene, view);
    view.pose = moved(view.pose);
    CHECK(largestChange(before, chosen(other, view)) < 1e-3);
  }
}

TEST_CASE("both eyes share photographs chosen for either eye's view") {
  const Scene scene = photographed(6, 5);
  const Camera left = viewAt({1.0, 0.8, 0}, 0.2), right = viewAt({1.1, 0.8, 0}, -0.2);
  const Pose middle{{1.05, 0.8, 0}, glm::dquat(1, 0, 0, 0)};
  CHECK(planned(scene, {left, right}, middle, kCount).size() == kCount);
}

TEST_CASE("the chosen set covers a dense capture's views almost as well as the best set of all photographs") {
  double least = 1;
  for (const unsigned seed : {1u, 2u}) {
    const test::PlanSceneShape shape{14, 14, 8, 0, true, seed};
    const Scene scene = test::makePlanScene(shape);
    REQUIRE(scene.backdrops.size() > 10 * kMaxPromising);
    const PhotographIndex index = makePhotographIndex(scene);
    const GatherStatistics statistics = gatherStatistics(scene);
    for (int frame = 0; frame < 24; ++frame) {
      const Camera view = test::planWalk(shape, 31 * frame, 640, 480);
      const std::vector<Camera> views{view};
      const SampleRays rays = sampleRays(views, view.pose);
      std::vector<SampleValues> values;  // by node
      std::vector<const SampleValues*> all;
      for (const Node& node : scene.nodes)
        values.push_back(photographValues(node.camera, view.pose, rays, statistics.medianInverseDepth));
      for (const SampleValues& one : values) all.push_back(&one);
      std::vector<PlannedPhotograph> chosen;
      choosePhotographs(scene, index, statistics, views, view.pose, kCount, std::pmr::get_default_resource(), chosen);
      SampleValues sum, best;
      for (const PlannedPhotograph& one : chosen) add(sum, values[one.node]);
      for (const SetMember& member : bestSet(all, kCount, std::pmr::get_default_resource()))
        add(best, *all[member.photograph]);
      least = std::min(least, double(coverage(sum) / coverage(best)));
    }
  }
  CHECK(least >= 0.995);
}

TEST_CASE("photographs without evidence or without a depth texture are not chosen") {
  Scene scene = photographed(3, 2);
  scene.nodes[0].depthFile.clear();
  scene.backdrops[1].mesh.confirmations.clear();
  const auto weights = chosen(scene, viewAt({0.5, 0.3, 0}));
  CHECK(weights.size() == 4);
  CHECK(!weights.contains("0_0"));
  CHECK(!weights.contains("0_1"));
}

TEST_CASE("no photograph is chosen if none looks in the view's direction") {
  const Scene scene = photographed(3, 2);
  CHECK(chosen(scene, viewAt({0.5, 0.3, 0}, 3.1)).empty());
}

TEST_CASE("surfaces at infinity and a far view leave finite weights") {
  Scene scene = photographed(4, 4);
  for (Cell& backdrop : scene.backdrops) backdrop.mesh.inverseDistance = {0.0f};
  for (const double far : {0.0, 1e3, 1e9})
    for (const auto& [name, weight] : chosen(scene, viewAt({1, 1, far}))) CHECK(std::isfinite(weight));
}

TEST_CASE("bounds of the gather are the median spacing, depth and residual") {
  Scene scene = photographed(6, 5);
  Cell cell;
  cell.quality.residualPx = 0.7;
  scene.cells = {cell};
  scene.backdrops[0].mesh.confirmations = {0};  // unconfirmed depth does not count
  scene.backdrops[0].mesh.inverseDistance = {1e6f};
  const GatherStatistics bounds = gatherStatistics(scene);
  CHECK(bounds.spacing == Approx(kSpacing).epsilon(0.2));
  CHECK(bounds.medianInverseDepth == Approx(0.25));
  CHECK(bounds.residualPx == Approx(0.7));
}
