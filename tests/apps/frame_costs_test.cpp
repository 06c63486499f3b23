// SPDX-License-Identifier: Apache-2.0
// Frames of ibr-viewer and ibr-vr, from the plan to the last recorded command: after the first frames they neither
// allocate heap memory by operator new nor read files.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "reference/grid_walk.h"
#include "robustness/example_model.h"
#include "support/allocation_count.h"
#include "support/reads.h"
#include "support/temporary_folder.h"
#include "viewer/open/item_on_device.h"
#include "vr/show/stereo_scene.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

constexpr VkExtent2D kExtent{64, 48};
constexpr int kSide = 8;  // photographs along a side of the grid

struct Costs {
  std::size_t allocations = 0;
  long reads = 0;
};

/// Adds the costs of a call.
class Meter {
 public:
  explicit Meter(Costs& costs) : costs_(costs), reads_(readCount()), allocations_(allocationCount()) {}
  ~Meter() {
    costs_.allocations += allocationCount() - allocations_;
    costs_.reads += readCount() - reads_ - kOwnReads;
  }

 private:
  static inline const long kOwnReads = [] {
    const long before = readCount();
    return readCount() - before;
  }();
  Costs& costs_;
  long reads_;
  std::size_t allocations_;
};

/// Without validation, whose layer allocates.
Device& device() {
  static Device made = Device::create();
  return made;
}

/// The same device for an object that owns one.
Device shared() {
  return Device::adopt({.instance = device().instance(),
                        .physicalDevice = device().physicalDevice(),
                        .device = device().handle(),
                        .queue = device().queue(),
                        .queueFamily = device().queueFamily(),
                        .optionalFeatures = Device::featuresFor(device().physicalDevice())});
}

/// Draws the frames of a walk twice and returns the costs of the second time. `draw` gets the frame's number, from 1,
/// and the share of the walk, 0 to 1, and returns true if streaming goes on, which extends the walk at its ends.
Costs costsOf(const std::function<bool(VkCommandBuffer, std::uint64_t frame, double share, Costs& costs)>& draw) {
  constexpr int kFrames = 60;
  static std::uint64_t number = 0;  // over all walks
  Costs costs;
  for (int pass = 0; pass < 2; ++pass) {
    costs = {};
    for (int f = 0; f < 2 * kFrames; ++f) {
      const double share = 1 - std::abs(f - kFrames) / double(kFrames);
      bool waits = true;
      while (waits) {
        ++number;
        submitAndWait(device(), [&](VkCommandBuffer commands) { waits = draw(commands, number, share, costs); });
        waits = waits && f % kFrames == 0;
      }
    }
  }
  return costs;
}

glm::dvec3 positionAt(double share) {
  return {share * (kSide - 1), 0, share * (kSide - 1)};
}

GpuSceneOptions streaming() {
  return {.source = Colours{}, .budgetBytes = 2 * kMiB, .stagingBytes = 1 * kMiB};
}

Costs costsOfViewer(const RenderSettings& settings, bool showGraph) {
  const auto owned = std::make_shared<OpenItem>();
  OpenItem& item = *owned;
  item.scene = gridScene(kSide, 128, 128);
  item.sceneBounds = sceneBounds(*item.scene);
  item.settings = settings;
  item.showGraph = showGraph;
  const auto drawn = sceneOnDevice(device(), owned, uploadScene(shared(), *item.scene, streaming()));
  Offscreen picture(device(), kExtent);
  ScopeTimer timer(device(), 64);
  std::uint64_t uploaded = 0;
  const Costs costs = costsOf([&](VkCommandBuffer commands, std::uint64_t frame, double share, Costs& sum) {
    item.navigation.pose.position = positionAt(share);
    timer.reset(commands);
    const Meter meter(sum);
    drawn->record({commands, frame, frame - 1, 1.0 / 60}, picture.target(), &timer);
    uploaded += drawn->streamed()->uploadedBytes;
    return drawn->streamed()->waiting > 0;
  });
  CHECK(uploaded > 0);
  return costs;
}

}  // namespace

TEST_CASE("frames of a scene in the viewer allocate nothing and read nothing") {
  std::vector<RenderSettings> looks(4);
  looks[1].colourMapping = ColourMapping::ours;
  looks[2].composition = Composition::hybrid;
  looks[3].overlay = Overlay::confidence;
  for (const RenderSettings& settings : looks) {
    CAPTURE(&settings - looks.data());
    const Costs costs = costsOfViewer(settings, &settings == looks.data());
    CHECK(costs.allocations == 0);
    CHECK(costs.reads == 0);
  }
}

TEST_CASE("frames of a harmonised model in the viewer allocate nothing and read nothing") {
  const TemporaryFolder folder;
  writeExampleModel(folder.path());
  const auto owned = std::make_shared<OpenItem>(openItem(folder.path()));
  OpenItem& item = *owned;
  item.showGraph = true;
  const auto drawn = modelOnDevice(device(), owned);
  Offscreen picture(device(), kExtent);
  const glm::dvec3 start = item.navigation.pose.position;
  const Costs costs = costsOf([&](VkCommandBuffer commands, std::uint64_t frame, double share, Costs& sum) {
    item.navigation.pose.position = start + glm::dvec3(share, 0, 0);
    const Meter meter(sum);
    drawn->record({commands, frame, frame - 1, 1.0 / 60}, picture.target(), nullptr);
    return false;
  });
  CHECK(costs.allocations == 0);
  CHECK(costs.reads == 0);
}

TEST_CASE("frames of a scene in a headset allocate nothing and read nothing") {
  auto files = std::make_shared<LoadedScene>();
  files->scene = gridScene(kSide, 128, 128);
  files->bounds = sceneBounds(files->scene);
  std::vector<RenderSettings> levels(2);
  levels[1].colourMapping = ColourMapping::ours;
  StereoScene scene(shared(), files, levels, false, {.extent = kExtent, .format = VK_FORMAT_R8G8B8A8_UNORM},
                    streaming());
  std::array<Offscreen, 2> pictures{Offscreen(device(), kExtent), Offscreen(device(), kExtent)};
  const GpuImage depth(device(),
                       {.format = VK_FORMAT_D32_SFLOAT,
                        .extent = kExtent,
                        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                        .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
                       "eyes' depth");
  std::array<Target, 2> targets{pictures[0].target(), pictures[1].target()};
  for (Target& target : targets) target.depth = DepthTarget{.image = depth.get(), .view = depth.view()};
  ScopeTimer timer(device(), 64);
  std::uint64_t uploaded = 0;
  for (const RenderSettings& settings : levels) {
    CAPTURE(&settings - levels.data());
    const Costs costs = costsOf([&](VkCommandBuffer commands, std::uint64_t frame, double share, Costs& sum) {
      std::array<Camera, 2> eyes;
      for (std::size_t eye = 0; eye < 2; ++eye)
        eyes[eye] = cameraAt(positionAt(share) + glm::dvec3(0.06 * double(eye), 0, 0), 0, 0, 64, 48, 1.2);
      timer.reset(commands);
      const Meter meter(sum);
      scene.record({commands, 0, frame, frame - 1, &timer}, 1.0 / 60, eyes, settings, targets);
      uploaded += scene.streamed().uploadedBytes;
      return scene.streamed().waiting > 0;
    });
    CHECK(costs.allocations == 0);
    CHECK(costs.reads == 0);
  }
  CHECK(uploaded > 0);
}

TEST_CASE("allocations and reads are counted") {
  Costs costs;
  { const Meter meter(costs); }
  CHECK((costs.allocations == 0 && costs.reads == 0));
  {
    const Meter meter(costs);
    std::vector<int>(1, 0).push_back(1);
    std::ifstream("/proc/version").get();
  }
  CHECK(costs.allocations >= 2);
  CHECK(costs.reads >= 1);
}
