// SPDX-License-Identifier: Apache-2.0
// Streaming under a byte budget: on a walk through a generated graph, colours identify the resident textures.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "reference/grid_walk.h"
#include "reference/stage.h"
#include "render/resident/gpu_scene_state.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

/// Frames that do not depend on timing.
struct SyncWalker : Walker {
  SyncWalker(const Scene& scene, GpuSceneOptions options, VkExtent2D size)
      : Walker(scene, synchronous(std::move(options)), size) {}
  static GpuSceneOptions synchronous(GpuSceneOptions options) {
    options.readerThreads = 0;
    return options;
  }
};

// Walks along the grid's diagonal, with stops at photographs; at a stop the photograph must be shown. Ends with a jump
// back to the start.
void walk(int side, TextureFormat format, std::uint64_t budget, int frames, int every) {
  const Scene scene = gridScene(side, 512, 512);
  const Colours colours{format};
  Messages messages;
  SyncWalker walker(scene,
                    {.source = colours, .budgetBytes = budget, .blocks = BlockTextureMode::keep, .log = messages.log()},
                    {256, 256});
  REQUIRE(walker.gpuScene.needsStreaming());
  std::uint32_t overBudget = 0;
  const auto show = [&](double along) {
    const Image8 picture = walker.frame(walker.planAt({along, 0, along}));
    REQUIRE(walker.gpuScene.memory().sum() <= budget);
    REQUIRE(emptyPixels(picture) == 0);
    overBudget = std::max(overBudget, walker.streamed.overBudget);
    return picture;
  };
  const auto standAt = [&](int node) {
    Image8 picture;
    do picture = show(node);
    while (walker.streamed.waiting > 0);
    INFO("photograph " << node);
    CHECK(sharesOf(picture, std::size_t(node * side + node)).own > 0.99);
  };
  for (int f = 0; f < frames; ++f) {
    const double along = double(f) / (frames - 1) * (side - 1);
    show(along);
    if (f % every == every - 1) standAt(int(std::lround(along)));
  }
  const Shares jumped = sharesOf(show(0), 0);
  CHECK(jumped.own + jumped.standIn > 0.99);
  standAt(0);
  CHECK(overBudget == 0);
  CHECK(walker.most <= budget);
  CHECK(walker.most > budget * 3 / 4);  // the budget is used
  CHECK(walker.uploaded > budget / 2);
  CAPTURE(messages.warnings);
  if (format != TextureFormat::rgba8 && !testDevice().supportsBlockCompression()) {
    // Textures take eight times as many bytes. Both warnings appear once, and the resident textures are shown.
    REQUIRE(!messages.warnings.empty());
    CHECK_THAT(messages.warnings[0], Catch::Contains("RGBA8"));
    if (messages.warnings.size() > 1) CHECK_THAT(messages.warnings[1], Catch::Contains("stand-ins"));
    CHECK(messages.warnings.size() <= 2);
  } else {
    CHECK(messages.warnings.empty());
  }
  CHECK(messages.errors.empty());
}

}  // namespace

TEST_CASE("a walk through ten thousand photographs of 1.7 GB stays within 128 MiB") {
  walk(100, TextureFormat::bc1, 128 * kMiB, 60, 20);
}

TEST_CASE("photographs of cells that fade out are streamed") {
  const Scene scene = gridScene(12, 256, 256);
  SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = 12 * kMiB}, {128, 128});
  REQUIRE(walker.gpuScene.needsStreaming());
  FramePlan plan = walker.planAt({11, 0, 11});
  do walker.frame(plan);
  while (walker.streamed.waiting > 0);
  plan.fadingOut.push_back({walker.planAt({0, 0, 0}).cells[0], 0});  // far away: none of its photographs is resident
  Image8 picture;
  do picture = walker.frame(plan);
  while (walker.streamed.waiting > 0);
  CHECK(sharesOf(picture, 0).own > 0.9);
}

// Hidden test, run by name: needs 1 GiB of memory for 14 GB of textures.
TEST_CASE("a walk through ten thousand photographs of 14 GB stays within 1 GiB", "[.large]") {
  walk(100, TextureFormat::rgba8, 1024 * kMiB, 300, 50);
}

TEST_CASE("photographs that fit into the budget are not streamed") {
  const Scene scene = gridScene(3, 256, 256);
  GpuScene all(testDevice(), scene, {.source = Colours{}});
  CHECK_FALSE(all.needsStreaming());
  const std::uint64_t bytes = all.memory().sum();
  SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = bytes}, {64, 64});
  CHECK_FALSE(walker.gpuScene.needsStreaming());
  walker.frame(walker.planAt({1, 0, 1}));
  CHECK(walker.streamed.needed == 0);
  CHECK(walker.gpuScene.memory().sum() == bytes);
  CHECK(GpuScene(testDevice(), scene, {.source = Colours{}, .budgetBytes = bytes - 1}).needsStreaming());
}

TEST_CASE("a stand-in is shown while a photograph loads, and the main cell's members load first") {
  const Scene scene = gridScene(6, 512, 512);
  SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = 20 * kMiB, .stagingBytes = 3 * kMiB}, {256, 256});
  // Staging of 3 MiB allows two photographs of 1.33 MiB a frame.
  const FramePlan plan = walker.planAt({2, 0, 2});
  const std::size_t node = 2 * 6 + 2;
  std::vector<std::uint32_t> missing;
  Image8 picture;
  for (int frame = 0; frame < 40; ++frame) {
    picture = walker.frame(plan);
    const GpuScene::State& state = stateOf(walker.gpuScene);
    missing.push_back(walker.streamed.waiting + walker.streamed.overBudget);
    const Shares shares = sharesOf(picture, node);
    const bool there = state.textures->at(std::uint32_t(node)).view != VK_NULL_HANDLE && shares.own > 0.99;
    CHECK((there || shares.standIn > 0.99));
    if (missing.size() > 3) CHECK(there);  // a member of the main cell
    CHECK(walker.streamed.uploadedBytes <= 3 * kMiB);
  }
  CHECK(missing.front() > missing.back());
  CHECK(std::is_sorted(missing.rbegin(), missing.rend()));
}

TEST_CASE("the image is the same with and without streaming of photographs") {
  SyntheticOptions options = test::place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  for (Camera& camera : options.cameras)
    camera.intrinsics = resized(camera.intrinsics, camera.intrinsics.width * 2, camera.intrinsics.height * 2);
  const Stage stage(testDevice(), makeScene(options));
  const std::uint64_t all = GpuScene(testDevice(), stage.scene(), {.source = stage.source()}).memory().sum();
  SyncWalker walker(stage.scene(), {.source = stage.source(), .budgetBytes = all * 9 / 10}, {320, 240});
  REQUIRE(walker.gpuScene.needsStreaming());
  for (const glm::dvec3 at : {glm::dvec3(0.4, 0.25, 0.1), glm::dvec3(0.1, 0, 0.1), glm::dvec3(0.9, 0.3, 0.3)}) {
    const FramePlan plan = walker.planAt(at);
    Image8 picture;
    do picture = walker.frame(plan);
    while (walker.streamed.waiting > 0);
    if (walker.streamed.overBudget == 0) CHECK(picture == stage.render(plan));
    CHECK(walker.most <= all * 9 / 10);
  }
}

TEST_CASE("photographs of a frame that was never submitted are streamed again") {
  const Scene scene = gridScene(4, 512, 512);
  SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = 12 * kMiB, .stagingBytes = 3 * kMiB}, {128, 128});
  const FramePlan plan = walker.planAt({1, 0, 1});
  const std::size_t node = 1 * 4 + 1;
  for (int frame = 0; frame < 30; ++frame) {
    // Commands recorded and dropped, several times.
    for (int again = frame % 3; again > 0; --again) try {
        submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
          walker.gpuScene.stream(commands, plan, walker.number + 1, walker.number);
          throw 1;
        });
      } catch (int) {
      }
    const Shares shares = sharesOf(walker.frame(plan), node);
    CHECK(shares.own + shares.standIn > 0.99);
  }
  CHECK(walker.streamed.waiting == 0);
  CHECK(sharesOf(walker.frame(plan), node).own > 0.99);
}

TEST_CASE("a small budget reduces the size of photographs with a warning") {
  const Scene scene = gridScene(6, 512, 512);
  {
    Messages messages;
    SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = 10 * kMiB, .log = messages.log()}, {128, 128});
    REQUIRE(messages.warnings.size() == 1);
    CHECK_THAT(messages.warnings[0], Catch::Contains("512x512") && Catch::Contains("1/2"));
    const FramePlan plan = walker.planAt({2, 0, 2});
    do walker.frame(plan);
    while (walker.streamed.waiting > 0);
    CHECK(walker.streamed.overBudget == 0);
    CHECK(sharesOf(walker.frame(plan), 2 * 6 + 2).own > 0.99);
    CHECK(walker.most <= 10 * kMiB);
  }
  {
    // Room for 16 photographs, but the view needs more.
    Messages messages;
    SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = 24 * kMiB, .log = messages.log()}, {128, 128});
    FramePlan plan = walker.planAt({2, 0, 2});
    plan.cells.clear();
    for (std::uint32_t c = 0; c < scene.cells.size(); ++c) plan.cells.push_back({.cell = c});
    do walker.frame(plan);
    while (walker.streamed.waiting > 0);
    CHECK(walker.streamed.needed == 36);
    CHECK(walker.streamed.overBudget > 15);
    REQUIRE(messages.warnings.size() == 1);
    CHECK_THAT(messages.warnings[0], Catch::Contains("stand-ins") && Catch::Contains("36"));
    walker.frame(plan);
    CHECK(messages.warnings.size() == 1);  // reported once
    CHECK(walker.most <= 24 * kMiB);
  }
  {
    Messages messages;
    const GpuScene tiny(testDevice(), scene, {.source = Colours{}, .budgetBytes = 512 * 1024, .log = messages.log()});
    REQUIRE(messages.warnings.size() == 2);
    CHECK_THAT(messages.warnings[0], Catch::Contains("stand-ins") && Catch::Contains("64"));
    CHECK(tiny.memory().sum() <= 512 * 1024);
  }
}

TEST_CASE("the error names the smallest budget, which suffices for an image") {
  const Scene scene = gridScene(3, 512, 512);
  std::uint64_t smallest = 0;
  try {
    const GpuScene none(testDevice(), scene, {.source = Colours{}, .budgetBytes = 1});
    FAIL("one byte was enough");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::outOfMemory);
    const std::string text = e.what(), budget = "1 bytes";  // the smallest budget is the next number
    CHECK_THAT(text, Catch::Contains("budget") && Catch::Contains(budget));
    const std::size_t number = text.find_first_of("0123456789", text.find(budget) + budget.size());
    REQUIRE(number != std::string::npos);
    smallest = std::stoull(text.substr(number));
  }
  CHECK_THROWS_WITH(GpuScene(testDevice(), scene, {.source = Colours{}, .budgetBytes = smallest - 1}),
                    Catch::Contains(std::to_string(smallest)));
  // A budget below the size of one of the nine photographs.
  REQUIRE(smallest < 512 * 512 * 4);
  for (const std::uint64_t budget : {smallest, std::uint64_t(512 * 512 * 4)}) {
    SyncWalker walker(scene, {.source = Colours{}, .budgetBytes = budget}, {128, 128});
    const FramePlan plan = walker.planAt({1, 0, 1});
    Image8 picture;
    do picture = walker.frame(plan);
    while (walker.streamed.waiting > 0);
    const Shares shares = sharesOf(picture, 4);
    CHECK((budget == smallest ? shares.standIn : shares.own) > 0.99);
    CHECK(walker.most <= budget);
  }
}

TEST_CASE("a photograph that cannot be read keeps its stand-in") {
  const Scene scene = gridScene(6, 512, 512);
  const std::size_t broken = 1 * 6 + 1;
  const auto source = [&](const Scene& of, std::size_t node, int firstLevel) {
    if (node == broken && firstLevel == 0) throw Error(ErrorCode::io, "1-1.ktx2: gone");
    return Colours{}(of, node, firstLevel);
  };
  Messages messages;
  SyncWalker walker(scene, {.source = source, .budgetBytes = 24 * kMiB, .log = messages.log()}, {128, 128});
  const FramePlan plan = walker.planAt({1, 0, 1});
  for (int frame = 0; frame < 10; ++frame) CHECK(sharesOf(walker.frame(plan), broken).standIn > 0.99);
  CHECK(walker.streamed.failed == 1);
  CHECK(walker.streamed.waiting == 0);
  REQUIRE(messages.errors.size() == 1);
  CHECK_THAT(messages.errors[0], Catch::Contains("1-1.ktx2: gone"));
}

TEST_CASE("photographs without a mesh take no memory") {
  Scene scene = gridScene(3, 64, 64);
  const std::uint64_t all = GpuScene(testDevice(), scene, {.source = Colours{}}).memory().textures;
  scene.cells.resize(1);  // three of the nine photographs
  CHECK(GpuScene(testDevice(), scene, {.source = Colours{}}).memory().textures * 3 == all);
}

TEST_CASE("photographs are requested in the plan's order, then from neighbouring cells") {
  const Scene scene = gridScene(5, 512, 512);
  FramePlan plan;
  plan.cells = {{.cell = 8}, {.cell = 0}};
  plan.previous = {{.cell = 31}};
  WantedItems wanted(scene, std::vector<bool>(StreamItems(scene).count(), false));
  wanted.update(plan, 100);
  const auto& members = [&](std::size_t cell) -> const std::vector<std::uint32_t>& {
    return scene.cells[cell].members;
  };
  // Cells 8 and 0 share a photograph.
  REQUIRE(wanted.needed() == 8);
  CHECK(std::vector(wanted.items().begin(), wanted.items().begin() + 8) ==
        std::vector<std::uint32_t>{5, 6, 10, 0, 1, 19, 24, 23});
  REQUIRE(wanted.items().size() == 25);
  // Nodes of cells that touch the main cell come before all others.
  std::vector<bool> near(scene.nodes.size(), false);
  for (const Cell& cell : scene.cells)
    if (std::ranges::any_of(cell.members, [&](auto m) { return std::ranges::find(members(8), m) != members(8).end(); }))
      for (const std::uint32_t m : cell.members) near[m] = true;
  bool left = false;
  for (std::size_t i = 8; i < wanted.items().size(); ++i) {
    CHECK_FALSE((left && near[wanted.items()[i]]));
    left |= !near[wanted.items()[i]];
  }
  CHECK(left);
  wanted.update(plan, 0);
  CHECK(wanted.items().size() == 8);
}
