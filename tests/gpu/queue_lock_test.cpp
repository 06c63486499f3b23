// SPDX-License-Identifier: Apache-2.0
// The lock of an adopted device's queue, and the functions that must not change while a device exists.
#include <catch2/catch.hpp>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "support/error_of.h"
#include "support/gpu.h"
#include "support/handmade_device.h"
#include "support/vulkan_faults.h"
#include "test_picture.h"

using namespace ibr;
using Catch::Contains;
using test::errorOf;
using test::testDevice;

namespace {

/// Callbacks that count, and a watch of the queue's uses. All calls must come from the thread that made the object.
class CountedLock {
 public:
  CountedLock() {
    test::watchQueue([this](const char*) {
      ++uses;
      if (!held) ++unlockedUses;
    });
  }
  CountedLock(const CountedLock&) = delete;
  CountedLock& operator=(const CountedLock&) = delete;
  ~CountedLock() { test::watchQueue({}); }

  DeviceHandles on(DeviceHandles handles) {
    handles.lockQueue = [this] { set(true); };
    handles.unlockQueue = [this] { set(false); };
    return handles;
  }

  bool held = false;
  int locks = 0, uses = 0, unlockedUses = 0;
  int faults = 0;  // locked twice, unlocked twice, or called from another thread

 private:
  void set(bool wanted) {
    if (held == wanted || thread_ != std::this_thread::get_id()) ++faults;
    held = wanted;
    locks += wanted;
  }
  std::thread::id thread_ = std::this_thread::get_id();
};

}  // namespace

TEST_CASE("callbacks lock the queue around each submission and each wait, on the calling thread") {
  const test::HandmadeDevice handmade;
  CountedLock lock;
  const Device device = Device::adopt(lock.on(handmade.handles()));
  CHECK(lock.locks == 0);
  CHECK(test::samplePicture(device) == test::expectedPicture());
  CHECK(lock.uses > 0);
  const int before = lock.uses;
  CHECK(waitIdle(device) == VK_SUCCESS);
  CHECK(lock.uses == before + 1);
  submitAndWait(device, [&](VkCommandBuffer) { CHECK_FALSE(lock.held); });
  CHECK(lock.uses == before + 2);
  CHECK(lock.unlockedUses == 0);
  CHECK(lock.locks == lock.uses);
  CHECK_FALSE(lock.held);
  CHECK(lock.faults == 0);
  CHECK(device.validationMessages() == 0);
}

TEST_CASE("the queue is unlocked after a failed submission or wait") {
  const test::HandmadeDevice handmade;
  CountedLock lock;
  const DeviceHandles handles = lock.on(handmade.handles());
  {
    const Device device = Device::adopt(handles);
    const int failures = test::failEachCall(VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory, [&] {
                           CHECK_FALSE(lock.held);
                           submitAndWait(device, [](VkCommandBuffer) {});
                         }).failures;
    CHECK(failures > 5);
    const auto record = [](VkCommandBuffer) { throw std::runtime_error("the caller's error"); };
    CHECK_THROWS_WITH(submitAndWait(device, record), "the caller's error");
  }
  for (int n = 0; n < 2; ++n) {  // the submission, then the wait
    const Device device = Device::adopt(handles);
    test::loseDevice(n);
    CHECK(errorOf([&] { submitAndWait(device, [](VkCommandBuffer) {}); }).code() == ErrorCode::deviceLost);
    test::failNothing();
    CHECK(device.isLost());
  }
  CHECK(lock.unlockedUses == 0);
  CHECK_FALSE(lock.held);
  CHECK(lock.faults == 0);
}

TEST_CASE("the caller locks the queue by the device") {
  const test::HandmadeDevice handmade;
  DeviceHandles handles = handmade.handles();
  SECTION("with callbacks") {
    CountedLock lock;
    const Device device = Device::adopt(lock.on(handles));
    device.lockQueue();
    CHECK(lock.held);
    device.unlockQueue();
    CHECK_FALSE(lock.held);
    CHECK(lock.faults == 0);
  }
  SECTION("with a mutex") {
    std::mutex mutex;
    handles.queueMutex = &mutex;
    const Device device = Device::adopt(handles);
    const auto isFree = [&] {
      bool free = false;
      std::thread([&] {
        free = mutex.try_lock();
        if (free) mutex.unlock();
      }).join();
      return free;
    };
    device.lockQueue();
    CHECK_FALSE(isFree());
    device.unlockQueue();
    CHECK(isFree());
  }
  SECTION("without a lock") {
    const Device device = Device::adopt(handles);
    device.lockQueue();
    device.lockQueue();
    device.unlockQueue();
  }
}

TEST_CASE("half a pair of callbacks, or a mutex beside callbacks, is refused") {
  const test::HandmadeDevice handmade;
  DeviceHandles handles = handmade.handles();
  std::mutex mutex;
  std::string named = "unlockQueue";
  SECTION("lockQueue alone") {
    handles.lockQueue = [] {};
  }
  SECTION("unlockQueue alone") {
    handles.unlockQueue = [] {};
  }
  SECTION("a mutex as well") {
    handles.lockQueue = handles.unlockQueue = [] {};
    handles.queueMutex = &mutex;
    named = "queueMutex";
  }
  const Error error = errorOf([&] { Device::adopt(handles); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains(named));
}

TEST_CASE("Vulkan's functions cannot change while a device exists") {
  const auto draw = vkCmdDraw;
  const Error error = errorOf([] { Device::loadFunctions(vkGetInstanceProcAddr, testDevice().instance()); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains("device exists"));
  CHECK(vkCmdDraw == draw);
}
