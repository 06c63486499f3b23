// SPDX-License-Identifier: Apache-2.0
// Streaming of meshes under a byte budget: a walk through a generated field of photographs with a mesh for each cell.
#include <catch2/catch.hpp>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "lab/generate/photograph_field.h"
#include "reference/grid_walk.h"
#include "render/resident/gpu_scene_state.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kSide = 6;
constexpr std::uint64_t kMeshBytes = 52 * 52 * 40 + 5202 * 12;  // of a cell: vertices of three members, triangles

Scene field(int side = kSide) {
  Scene scene = photographField(side, 128, {});
  for (Cell& cell : scene.cells)
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) cell.mesh.uncertainty[p] = 0.01f * float(p % 7);
  return scene;
}

std::uint64_t wholeBytes(const Scene& scene) {
  return GpuScene(testDevice(), scene, {.source = Colours{}}).memory().sum();
}

Image8 settled(Walker& walker, const FramePlan& plan) {
  Image8 image;
  do image = walker.frame(plan);
  while (walker.streamed.waiting > 0);
  return image;
}

bool drawsStandIns(const GpuScene& scene, const FramePlan& plan) {
  return std::ranges::any_of(plan.cells,
                             [&](const PlannedCell& cell) { return stateOf(scene).cells[cell.cell].place.isStandIn; });
}

}  // namespace

TEST_CASE("a walk with streamed meshes stays within the budget, and at a standstill images equal those without it") {
  const Scene scene = field();
  const std::uint64_t budget = wholeBytes(scene) / 2;
  const std::uint32_t threads = GENERATE(0u, 2u);
  REQUIRE(budget < scene.cells.size() * kMeshBytes);
  Walker all(scene, {.source = Colours{}}, {128, 96});
  Walker walker(scene, {.source = Colours{}, .budgetBytes = budget, .readerThreads = threads}, {128, 96});
  REQUIRE(stateOf(walker.gpuScene).meshes.streams());
  CHECK_FALSE(all.gpuScene.needsStreaming());
  int standIns = 0;
  for (int f = 0; f <= 40; ++f) {
    const double along = f * (kSide - 1) / 40.0;
    const FramePlan plan = walker.planAt({along, 0, along});
    Image8 image = walker.frame(plan);
    CHECK(walker.gpuScene.memory().sum() <= budget);
    standIns += drawsStandIns(walker.gpuScene, plan);
    if (f % 10 != 0) continue;
    image = settled(walker, plan);
    CHECK(walker.streamed.overBudget == 0);
    CHECK_FALSE(drawsStandIns(walker.gpuScene, plan));
    CHECK(image == all.frame(plan));
  }
  CHECK((standIns > 0) == (threads > 0));  // the first frame of a place, while jobs load
  CHECK(walker.most <= budget);
  CHECK(walker.uploaded > scene.cells.size() * kMeshBytes / 4);
}

TEST_CASE("a stand-in of a mesh covers what the mesh covers") {
  const Scene scene = field();
  Walker all(scene, {.source = Colours{}}, {128, 96});
  const FramePlan plan = all.planAt({2, 0, 2});
  const Image8 expected = all.frame(plan);
  GpuSceneOptions options{.source = Colours{}, .budgetBytes = wholeBytes(scene) / 2, .readerThreads = 1};
  options.executor = [](std::function<void()>) {};  // nothing is ever loaded
  Walker without(scene, options, {128, 96});
  const Image8 image = without.frame(plan);
  CHECK(drawsStandIns(without.gpuScene, plan));
  CHECK(without.streamed.waiting == without.streamed.needed);
  int missing = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) missing += image.pixel(x, y)[1] < 48 && expected.pixel(x, y)[1] >= 48;
  CHECK(missing < image.width * image.height / 50);
}

TEST_CASE("overlays of streamed meshes equal those without a budget, also of uncertainties") {
  const Scene scene = field();
  const auto overlay = GENERATE(Overlay::confidence, Overlay::wireframe, Overlay::tiers);
  const GpuScene all(testDevice(), scene, {.source = Colours{}});
  GpuScene streamed(testDevice(), scene, {.source = Colours{}, .budgetBytes = all.memory().sum() * 2 / 3});
  REQUIRE(stateOf(streamed).meshes.streams());
  RenderSettings settings;
  settings.overlay = overlay;
  const FramePlan plan = planFrame(scene, sceneBounds(scene), {{cameraAt({1, 0, 1}, 0, 0, 128, 96, 1.2)}, settings});
  const auto render = [&](const GpuScene& from) {
    RendererOptions options = optionsFor(settings, {128, 96});
    options.uncertaintyScene = &scene;
    const Renderer renderer(testDevice(), from, options);
    Offscreen offscreen(testDevice(), {128, 96});
    return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  };
  render(streamed);  // stand-ins
  std::uint64_t frame = 0;
  streamAll(testDevice(), streamed, plan, frame);
  CHECK_FALSE(drawsStandIns(streamed, plan));
  CHECK(render(streamed) == render(all));
}

TEST_CASE("the place of a mesh is not overwritten while a frame in flight reads it") {
  const Scene scene = field();
  GpuScene streamed(testDevice(), scene,
                    {.source = Colours{}, .budgetBytes = wholeBytes(scene) / 3, .readerThreads = 0});
  const SceneBounds bounds = sceneBounds(scene);
  struct Use {
    std::uint64_t frame;
    std::uint32_t cell;
  };
  std::multimap<VkDeviceSize, Use> uses;
  int moved = 0;
  for (std::uint64_t frame = 1; frame <= 120; ++frame) {
    const std::uint64_t completed = frame < 5 ? 0 : (frame - 1) / 4 * 4;  // the device finishes four frames at a time
    const double along = double(frame % 40) / 39 * (kSide - 1);
    const FramePlan plan =
        planFrame(scene, bounds, {{cameraAt({along, 0, along}, 0, 0, 64, 64, 1.2)}, {.switchSeconds = 0}});
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) { streamed.stream(commands, plan, frame, completed); });
    for (const PlannedCell& planned : plan.cells) {
      const MeshPlace& place = stateOf(streamed).cells[planned.cell].place;
      if (place.isStandIn) continue;
      const auto [first, last] = uses.equal_range(place.vertexOffset);
      for (auto use = first; use != last; ++use) {
        if (use->second.cell == planned.cell) continue;
        CHECK(use->second.frame <= completed);
        ++moved;
      }
      uses.emplace(place.vertexOffset, Use{frame, planned.cell});
    }
  }
  CHECK(moved > 0);
}

TEST_CASE("meshes that take an eighth of the budget are resident beside streamed photographs") {
  Scene scene = photographField(5, 512, {});
  scene.cells.resize(4);
  for (std::uint32_t n = 0; n + 2 < scene.nodes.size(); n += 3) {  // all photographs are shown by small cells
    Cell cell = gridScene(2, 512, 512).cells[0];
    cell.members = {n, n + 1, n + 2};
    scene.cells.push_back(cell);
  }
  GpuScene streamed(testDevice(), scene, {.source = Colours{}, .budgetBytes = wholeBytes(scene) * 3 / 4});
  CHECK(streamed.needsStreaming());
  CHECK_FALSE(stateOf(streamed).meshes.streams());
  CHECK(stateOf(streamed).textures->streams());
}

TEST_CASE("meshes of at most 64 triangles are always resident") {
  Scene scene = field(4);
  const Cell& tiny = scene.cells.emplace_back(gridScene(2, 128, 128).cells[0]);
  const auto last = std::uint32_t(scene.cells.size() - 1);
  REQUIRE(tiny.mesh.triangles.size() == 2);
  GpuScene streamed(testDevice(), scene, {.source = Colours{}, .budgetBytes = wholeBytes(scene) / 2});
  const GpuScene::State& state = stateOf(streamed);
  REQUIRE(state.meshes.streams());
  CHECK(state.cells[0].place.isStandIn);
  CHECK(state.cells[0].place.indices.count <= 3 * kMaxStandInTriangles);
  CHECK_FALSE(state.cells[last].place.isStandIn);
  CHECK(state.cells[last].place.indices.count == 6);
  CHECK_FALSE(state.streamer->isStreamed(StreamItems(scene).cell(last)));
}

TEST_CASE("the error names the smallest budget for stand-ins and one mesh, which suffices for an image") {
  const Scene scene = field(4);
  const std::string text =
      errorOf([&] { GpuScene(testDevice(), scene, {.source = Colours{}, .budgetBytes = 1}); }).what();
  CHECK_THAT(text, Catch::Contains("largest mesh") && Catch::Contains("1 bytes"));
  const std::size_t number = text.find_first_of("0123456789", text.find("1 bytes") + 7);
  const std::uint64_t smallest = std::stoull(text.substr(number));
  CHECK(smallest < wholeBytes(scene) / 4);
  CHECK_THROWS_WITH(GpuScene(testDevice(), scene, {.source = Colours{}, .budgetBytes = smallest - 1}),
                    Catch::Contains(std::to_string(smallest)));
  Walker walker(scene, {.source = Colours{}, .budgetBytes = smallest, .readerThreads = 0}, {64, 64});
  const FramePlan plan = walker.planAt({1, 0, 1});
  CHECK(emptyPixels(settled(walker, plan)) < 64 * 64 / 2);
  CHECK(walker.streamed.overBudget > 0);
  CHECK_FALSE(stateOf(walker.gpuScene).cells[plan.cells[0].cell].place.isStandIn);  // the main cell
  CHECK(walker.most <= smallest);
}

TEST_CASE("a mesh of the main cell is requested before its photographs, and those before the next mesh") {
  const Scene scene = field(4);
  const StreamItems items(scene);
  WantedItems wanted(scene, std::vector<bool>(items.count(), true));
  FramePlan plan;
  plan.cells = {{.cell = 4}, {.cell = 0}};
  wanted.update(plan, 100);
  std::vector<std::uint32_t> expected{items.cell(4)};
  for (const std::uint32_t member : scene.cells[4].members) expected.push_back(member);
  expected.push_back(items.cell(0));
  REQUIRE(wanted.needed() >= expected.size());
  CHECK(std::vector(wanted.items().begin(), wanted.items().begin() + std::ptrdiff_t(expected.size())) == expected);
}
