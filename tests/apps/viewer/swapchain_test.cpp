// SPDX-License-Identifier: Apache-2.0
// Swapchain images with and without vertical sync. Other properties of windows are tested with the viewer.
#include "window/swapchain.h"

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "apps/support/virtual_display.h"
#include "apps/support/x11_window.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

struct Shown {
  explicit Shown(Pace pace)
      : window("swapchain ibr", 200, 150),
        device(Device::create({.validation = true,
                               .instanceExtensions = Window::instanceExtensions(),
                               .deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME},
                               .log = testLog()})),
        swapchain(device, window, {.pace = pace}) {
    window.handleEvents(0.1);
  }
  Window window;
  Device device;
  Swapchain swapchain;
};

void recordColour(const Swapchain::Frame& frame, const std::array<float, 3>& colour) {
  const VkClearColorValue value{.float32 = {colour[0], colour[1], colour[2], 1}};
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  transition(frame.commands, frame.image, Swapchain::kInitialUse, use::kTransferDestination);
  vkCmdClearColorImage(frame.commands, frame.image, use::kTransferDestination.layout, &value, 1, &all);
  transition(frame.commands, frame.image, use::kTransferDestination, Swapchain::kFinalUse);
}

// Functions that libibr does not load.
PFN_vkCreateEvent vkCreateEvent;
PFN_vkDestroyEvent vkDestroyEvent;
PFN_vkSetEvent vkSetEvent;
PFN_vkCmdWaitEvents vkCmdWaitEvents;

template <class Function>
void load(const Device& device, Function& function, const char* name) {
  function = reinterpret_cast<Function>(vkGetDeviceProcAddr(device.handle(), name));
}

using EventHandle = Handle<VkEvent, &vkDestroyEvent>;

// Blocks the device's queue for all later submissions during its lifetime, but for at most twenty seconds, so that a
// waiting test fails instead of hanging.
class Blocked {
 public:
  explicit Blocked(const Device& device) : device_(device) {
    load(device, vkCreateEvent, "vkCreateEvent");
    load(device, vkDestroyEvent, "vkDestroyEvent");
    load(device, vkSetEvent, "vkSetEvent");
    load(device, vkCmdWaitEvents, "vkCmdWaitEvents");
    event_ = make<EventHandle>(device, vkCreateEvent, VkEventCreateInfo{.sType = VK_STRUCTURE_TYPE_EVENT_CREATE_INFO},
                               "vkCreateEvent");
    pool_ = make<CommandPoolHandle>(device, vkCreateCommandPool,
                                    VkCommandPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                            .queueFamilyIndex = device.queueFamily()},
                                    "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool_.get(),
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    vk(vkAllocateCommandBuffers(device.handle(), &allocate, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vk(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    const VkEvent event = event_.get();
    vkCmdWaitEvents(commands, 1, &event, VK_PIPELINE_STAGE_HOST_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, nullptr, 0,
                    nullptr, 0, nullptr);
    vk(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                         .commandBuffer = commands};
    const VkSubmitInfo2 submission{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &info};
    vk(vkQueueSubmit2(device.queue(), 1, &submission, VK_NULL_HANDLE), "vkQueueSubmit2");
  }

  ~Blocked() {
    watch_.request_stop();
    watch_.join();
    {
      // Newer validation layers forbid setting an event that a submitted command waits for; devices do it.
      const ExpectedMessages expected;
      vkSetEvent(device_.handle(), event_.get());
      for (const std::string& text : expected.texts) CHECK_THAT(text, Catch::Contains("VUID-vkSetEvent-event-09543"));
    }
    vkDeviceWaitIdle(device_.handle());
  }

 private:
  const Device& device_;
  EventHandle event_;
  CommandPoolHandle pool_;
  std::jthread watch_{[this](std::stop_token stop) {
    for (int i = 0; i < 200 && !stop.stop_requested(); ++i) sleepFor(0.1);
    if (!stop.stop_requested()) vkSetEvent(device_.handle(), event_.get());
  }};
};

std::string numberOf(const char* name) {
  const std::string found = xdotool({"search", "--sync", "--onlyvisible", "--name", name});
  return found.substr(0, found.find('\n'));
}

}  // namespace

TEST_CASE("a swapchain that never waits gives no frame while the device is busy") {
  if (!displayIsThere()) return;
  Shown shown(Pace::immediate);
  Swapchain& swapchain = shown.swapchain;
  // Creating the images waits for the device.
  const auto first = swapchain.begin();
  REQUIRE(first);
  swapchain.abandon(*first);
  {
    Blocked blocked(shown.device);
    for (std::uint32_t i = 0; i < kFramesInFlight; ++i) {
      const auto frame = swapchain.begin();
      REQUIRE(frame);
      CHECK(frame->slot == i);
      recordColour(*frame, {1, 0, 0});
      // Software devices wait for the image when it is presented.
      swapchain.simulateNoImage();
      CHECK_FALSE(swapchain.end(*frame));
    }
    CHECK_FALSE(swapchain.begin());
    CHECK_FALSE(swapchain.begin());
  }
  const auto frame = swapchain.begin();
  REQUIRE(frame);
  CHECK(frame->slot == 0);
  swapchain.abandon(*frame);
}

TEST_CASE("a swapchain that never waits is resized when the window's size has settled") {
  if (!displayIsThere()) return;
  Shown shown(Pace::immediate);
  const auto first = shown.swapchain.begin();
  REQUIRE(first);
  shown.swapchain.abandon(*first);
  const std::uint64_t generation = shown.swapchain.generation();
  const auto resize = [&](const char* width, const char* height) {
    xdotool({"windowsize", "--sync", numberOf("swapchain ibr"), width, height});
  };
  for (int step = 0; step < 4; ++step) {
    resize(step % 2 ? "260" : "280", "180");
    for (int i = 0; i < 5; ++i) CHECK_FALSE(shown.swapchain.begin());
  }
  CHECK(shown.swapchain.generation() == generation);
  resize("300", "160");
  int calls = 0;
  std::optional<Swapchain::Frame> frame;
  for (; !frame && calls < 100; ++calls) frame = shown.swapchain.begin();
  REQUIRE(frame);
  CHECK(calls > 10);
  CHECK((frame->extent.width == 300 && frame->extent.height == 160));
  shown.swapchain.abandon(*frame);
}

TEST_CASE("a swapchain waits for the queue's mutex") {
  if (!displayIsThere()) return;
  Shown shown(Pace::refresh);
  std::mutex mutex;
  const Device device = Device::adopt({.instance = shown.device.instance(),
                                       .physicalDevice = shown.device.physicalDevice(),
                                       .device = shown.device.handle(),
                                       .queue = shown.device.queue(),
                                       .queueFamily = shown.device.queueFamily(),
                                       .queueMutex = &mutex});
  Window window("another window ibr", 100, 100);
  Swapchain swapchain(device, window);
  const auto waits = [&](const std::function<void()>& act) {
    std::atomic<bool> done = false;
    std::unique_lock lock(mutex);
    std::jthread other([&] {
      act();
      done = true;
    });
    sleepFor(0.1);
    const bool waited = !done;
    lock.unlock();
    other.join();
    CHECK(done);
    return waited;
  };
  std::optional<Swapchain::Frame> frame;
  CHECK(waits([&] { frame = swapchain.begin(); }));  // creates images
  REQUIRE(frame);
  recordColour(*frame, {0, 1, 0});
  CHECK(waits([&] { swapchain.end(*frame); }));
}

TEST_CASE("a window shows the last accepted frame in every pacing mode") {
  if (!displayIsThere()) return;
  for (const Pace pace : {Pace::refresh, Pace::immediate}) {
    Shown shown(pace);
    const std::array<float, 3> last{0.2f, 0.4f, 0.6f};
    // Without waiting, frames may be dropped, but not all of them.
    int taken = 0;
    for (int tries = 0; taken < 20 && tries < 2000; ++tries) {
      shown.window.handleEvents(0.001);
      const auto frame = shown.swapchain.begin();
      if (!frame) continue;
      recordColour(*frame, taken % 2 ? last : std::array<float, 3>{1, 0, 0});
      if (shown.swapchain.end(*frame)) ++taken;
    }
    CHECK(taken == 20);
    vkDeviceWaitIdle(shown.device.handle());
    Image8 pixels;
    for (int tries = 0; tries < 100; ++tries) {
      pixels = pixelsOf(numberOf("swapchain ibr"));
      if (pixels.width > 0 && pixels.pixel(100, 75)[0] == 51) break;
      sleepFor(0.05);
    }
    REQUIRE((pixels.width == 200 && pixels.height == 150));
    const auto middle = pixels.pixel(100, 75);
    CHECK((middle[0] == 51 && middle[1] == 102 && middle[2] == 153));
  }
}
