// SPDX-License-Identifier: Apache-2.0
#include "ibr/device.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "gpu/device/device_choice.h"
#include "ibr/error.h"
#include "support/gpu.h"
#include "support/handmade_device.h"
#include "support/temporary_folder.h"
#include "test_picture.h"

using namespace ibr;
using Catch::Contains;
using test::testDevice;
using test::testLog;

namespace {

/// Sets an environment variable for its lifetime.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    had_ = std::getenv(name) != nullptr;
    ::setenv(name, value.c_str(), 1);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { had_ ? ::setenv(name_, old_.c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::string old_;
  bool had_;
};

/// Returns the message of the Error{code} that `call` must throw.
template <class Call>
std::string errorOf(ErrorCode code, Call call) {
  try {
    call();
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.what();
  }
  FAIL("no error");
  return {};
}

}  // namespace

TEST_CASE("a device is created without options") {
  const Environment none("IBR_DEVICE", "");
  const Device device = Device::create();
  CHECK(device.handle() != VK_NULL_HANDLE);
  CHECK(device.queue() != VK_NULL_HANDLE);
  CHECK(device.properties().apiVersion >= VK_API_VERSION_1_3);
  CHECK(device.memoryProperties().memoryHeapCount > 0);
  CHECK_THAT(device.name(), Contains(device.properties().deviceName));
  CHECK(device.validationMessages() == 0);
}

TEST_CASE("the software device is chosen only without another device") {
  const Environment none("IBR_DEVICE", "");
  bool gpu = false, software = false;
  for (const DeviceDescription& description : Device::list()) {
    if (!description.missing.empty()) continue;
    (description.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? software : gpu) = true;
  }
  const bool onSoftware = Device::create().properties().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  CHECK(onSoftware == (software && !gpu));
}

TEST_CASE("the device list describes the devices that can be created") {
  const auto list = Device::list();
  REQUIRE_FALSE(list.empty());
  int same = 0;
  for (const DeviceDescription& description : list) {
    INFO(description.name);
    CHECK_FALSE(description.driver.empty());
    CHECK(description.apiVersion >= VK_API_VERSION_1_0);
    if (description.name != testDevice().properties().deviceName) continue;
    ++same;
    CHECK(description.missing.empty());
    CHECK(description.memoryBytes > 0);
    CHECK(testDevice().name() == description.name + ", " + description.driver);
  }
  CHECK(same >= 1);
}

TEST_CASE("a device is chosen by index or part of its name, and the option overrides the environment") {
  const std::string name = testDevice().properties().deviceName;
  const auto list = Device::list();
  std::size_t index = 0;
  while (list[index].name != name) ++index;
  std::string upper = name.substr(0, 4);
  for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
  const Environment wrong("IBR_DEVICE", "no such device");
  CHECK(Device::create({.device = name}).properties().deviceName == name);
  REQUIRE(Device::preferred(name));
  CHECK(Device::preferred(name)->name == name);
  CHECK(deviceKindOf(Device::preferred(name)->type) == testDevice().kind());
  CHECK_FALSE(Device::preferred());  // IBR_DEVICE decides
  CHECK(Device::create({.device = std::to_string(index)}).properties().deviceName == name);
  CHECK_THAT(Device::create({.device = upper}).name(), Contains(name.substr(0, 4)));
  const Environment right("IBR_DEVICE", name);
  CHECK(Device::create().properties().deviceName == name);
}

TEST_CASE("a rejection names every device and the reason") {
  const std::string name = testDevice().properties().deviceName;
  const Environment none("IBR_DEVICE", "");
  SECTION("no name matches") {
    const auto message = errorOf(ErrorCode::unsupported, [] { Device::create({.device = "Voodoo 5"}); });
    CHECK_THAT(message, Contains("Voodoo 5") && Contains(name));
    CHECK_THAT(message, !Contains("IBR_DEVICE"));
  }
  SECTION("an index beyond the list") {
    CHECK_THAT(errorOf(ErrorCode::unsupported, [] { Device::create({.device = "4711"}); }), Contains("4711"));
  }
  SECTION("a device name from the environment") {
    const Environment wish("IBR_DEVICE", "Voodoo 5");
    CHECK_THAT(errorOf(ErrorCode::unsupported, [] { Device::create(); }), Contains("IBR_DEVICE"));
  }
  SECTION("a missing device extension") {
    const auto message = errorOf(ErrorCode::unsupported, [] {
      Device::create({.deviceExtensions = {"VK_IBR_none", "VK_IBR_nil"}});
    });
    CHECK_THAT(message, Contains(name) && Contains("VK_IBR_none") && Contains("VK_IBR_nil"));
  }
  SECTION("a missing instance extension") {
    CHECK_THAT(errorOf(ErrorCode::unsupported, [] { Device::create({.instanceExtensions = {"VK_IBR_none"}}); }),
               Contains("VK_IBR_none"));
  }
}

TEST_CASE("discrete, integrated, virtual and software devices are preferred in this order") {
  const Environment none("IBR_DEVICE", "");
  std::vector<DeviceDescription> devices{{.name = "unknown", .type = VK_PHYSICAL_DEVICE_TYPE_OTHER},
                                         {.name = "software", .type = VK_PHYSICAL_DEVICE_TYPE_CPU},
                                         {.name = "cloud", .type = VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU},
                                         {.name = "laptop", .type = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU},
                                         {.name = "card A", .type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU},
                                         {.name = "card B", .type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU}};
  if (GENERATE(false, true)) std::reverse(devices.begin(), devices.end());
  const auto chosen = [&](const std::string& option) { return devices[choose(devices, option)].name; };
  CHECK(chosen("") == (devices[0].name == "unknown" ? "card A" : "card B"));  // the first of equal devices
  for (DeviceDescription& device : devices)
    if (device.type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU) device.missing = {"depthClamp", "scalarBlockLayout"};
  CHECK(chosen("") == "laptop");
  CHECK(chosen("soft") == "software");
  CHECK(chosen("3") == devices[3].name);
  devices[2].name = "17";  // a name, not an index
  CHECK(chosen("17") == "17");
  CHECK_THAT(errorOf(ErrorCode::unsupported, [&] { chosen("CARD"); }),
             Contains("card A") && Contains("card B") && Contains("depthClamp") && Contains("scalarBlockLayout") &&
                 Contains("software"));
}

TEST_CASE("without a driver the message says what to install and the device list is empty") {
  const test::TemporaryFolder empty;
  const Environment a("VK_DRIVER_FILES", (empty / "none.json").string());
  const Environment b("VK_ICD_FILENAMES", (empty / "none.json").string());
  CHECK_THAT(errorOf(ErrorCode::unsupported, [] { Device::create(); }), Contains("mesa-vulkan-drivers"));
  CHECK(Device::list().empty());
}

TEST_CASE("a missing validation layer is named") {
  const test::TemporaryFolder empty;
  const Environment path("VK_LAYER_PATH", empty.path().string());
  CHECK_THAT(errorOf(ErrorCode::unsupported, [] { Device::create({.validation = true}); }),
             Contains("VK_LAYER_KHRONOS_validation"));
  CHECK(Device::create({.validation = false}).handle() != VK_NULL_HANDLE);
}

TEST_CASE("the chosen device is logged") {
  std::string text;
  const Device device = Device::create({.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::info) text += message;
  }});
  CHECK_THAT(text, Contains(device.name()));
}

TEST_CASE("feature structures of the requirements form one pNext chain") {
  DeviceRequirements requirements = Device::requirements();
  CHECK(requirements.apiVersion == VK_API_VERSION_1_3);
  int extra = 0;
  const VkPhysicalDeviceFeatures2* head = requirements.features.link(&extra);
  CHECK(head->pNext == &requirements.features.vulkan11);
  CHECK(requirements.features.vulkan11.pNext == &requirements.features.vulkan12);
  CHECK(requirements.features.vulkan12.pNext == &requirements.features.vulkan13);
  CHECK(requirements.features.vulkan13.pNext == &extra);
}

TEST_CASE("disabled features are neither enabled nor used, and other features stay enabled", "[mask]") {
  const Environment none("IBR_DISABLE_FEATURES", "");
  const auto uses = [](const Device& d) {
    return std::array{d.supportsInt64(), d.supportsInt64Atomics(), d.supportsBlockCompression(), d.supportsMultiview()};
  };
  const auto names = Device::optionalFeatureNames();
  REQUIRE(names == std::vector<std::string>{"int64", "int64-atomics", "bc", "multiview"});
  const Device whole = Device::create({.validation = true, .log = testLog()});
  for (std::size_t i = 0; i < names.size(); ++i) {
    auto expected = uses(whole);
    expected[i] = false;
    if (i == 0) expected[1] = false;  // 64-bit atomics require 64-bit integers
    INFO(names[i]);
    CHECK(uses(Device::create({.validation = true, .log = testLog(), .disabledFeatures = names[i]})) == expected);
    const Environment masked("IBR_DISABLE_FEATURES", names[i]);
    CHECK(uses(Device::create({.validation = true, .log = testLog()})) == expected);
    const Device one = Device::create({.validation = true, .log = testLog(), .disabledFeatures = "bc"});
    CHECK(uses(one) == std::array{uses(whole)[0], uses(whole)[1], false, uses(whole)[3]});  // the option has priority
    test::HandmadeDevice handmade;
    DeviceHandles handles = handmade.handles();
    handles.optionalFeatures = Device::requirements().optionalFeatures;  // reports all features as enabled
    auto adopted = std::array{true, true, true, true};
    adopted[i] = false;
    if (i == 0) adopted[1] = false;
    CHECK(uses(Device::adopt(handles)) == adopted);
  }
  DeviceFeatures features;
  addOptionalFeatures(whole.physicalDevice(), features, "int64,int64-atomics,bc,multiview");
  CHECK_FALSE((features.core.features.shaderInt64 || features.vulkan12.shaderBufferInt64Atomics ||
               features.core.features.textureCompressionBC || features.vulkan11.multiview));
  CHECK_THAT(errorOf(ErrorCode::invalidInput, [] { Device::create({.disabledFeatures = "bc,bc8"}); }),
             Contains("bc8") && Contains("int64-atomics"));
  const Environment wrong("IBR_DISABLE_FEATURES", "int65");
  CHECK_THAT(errorOf(ErrorCode::invalidInput, [] { Device::create(); }),
             Contains("IBR_DISABLE_FEATURES") && Contains("int65"));
}

TEST_CASE("an adopted device draws the same image as a created device") {
  const Image8 created = test::samplePicture(testDevice());
  CHECK(created == test::expectedPicture());
  const test::HandmadeDevice handmade;
  const Device adopted = Device::adopt(handmade.handles());
  CHECK(test::samplePicture(adopted) == created);
  CHECK(adopted.name() == testDevice().name());
  CHECK(adopted.properties().apiVersion == testDevice().properties().apiVersion);
  CHECK(adopted.handle() == handmade.handles().device);
  CHECK(adopted.queueFamily() == handmade.handles().queueFamily);
}

TEST_CASE("an adopted device is not destroyed by its adopter") {
  const test::HandmadeDevice handmade;
  for (int i = 0; i < 2; ++i) {
    const Device adopted = Device::adopt(handmade.handles());
    CHECK(adopted.validationMessages() == 0);
  }
  CHECK(vkDeviceWaitIdle(handmade.handles().device) == VK_SUCCESS);
  CHECK(test::samplePicture(Device::adopt(handmade.handles())) == test::expectedPicture());
}

TEST_CASE("an adopted device counts validation messages with its creator's counter") {
  const test::HandmadeDevice handmade;
  const Device adopted = Device::adopt(handmade.handles());
  const auto copyTooSoon = [&] {
    const Buffer a(adopted, 64, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::device, "a");
    const Buffer b(adopted, 64, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device, "b");
    submitAndWait(adopted, [&](VkCommandBuffer commands) {
      vkCmdFillBuffer(commands, b.get(), 0, VK_WHOLE_SIZE, 1);
      const VkBufferCopy region{0, 0, a.size()};
      vkCmdCopyBuffer(commands, a.get(), b.get(), 1, &region);  // without a barrier
    });
  };
  const test::ExpectedMessages messages;
  copyTooSoon();
  CHECK(messages.texts.size() >= 1);
  CHECK(adopted.validationMessages() == messages.texts.size());
  DeviceHandles uncounted = handmade.handles();
  uncounted.validationMessages = nullptr;
  CHECK(Device::adopt(uncounted).validationMessages() == 0);
}

TEST_CASE("two threads share a queue, and the queue mutex is free during recording and waiting") {
  const test::HandmadeDevice handmade;
  std::mutex mutex;
  DeviceHandles handles = handmade.handles();
  handles.queueMutex = &mutex;
  int heldMeanwhile = 0;
  const auto use = [&handles] {
    const Device device = Device::adopt(handles);
    Submission submission(device);
    for (int i = 0; i < 400; ++i) submission.run([](VkCommandBuffer) {});
  };
  std::thread other(use);
  use();
  other.join();
  submitAndWait(Device::adopt(handles), [&](VkCommandBuffer) {
    if (mutex.try_lock())
      mutex.unlock();
    else
      ++heldMeanwhile;
  });
  CHECK(heldMeanwhile == 0);
  CHECK(Device::adopt(handles).validationMessages() == 0);
}

TEST_CASE("handles that cannot be adopted are named") {
  const test::HandmadeDevice handmade;
  DeviceHandles handles = handmade.handles();
  SECTION("a null handle") {
    handles.queue = VK_NULL_HANDLE;
    CHECK_THAT(errorOf(ErrorCode::invalidInput, [&] { Device::adopt(handles); }), Contains("queue"));
  }
  SECTION("a queue family that does not exist") {
    handles.queueFamily = 1000;
    CHECK_THAT(errorOf(ErrorCode::unsupported, [&] { Device::adopt(handles); }), Contains("1000"));
  }
  SECTION("a device created for an older Vulkan version") {
    const test::HandmadeDevice old(VK_API_VERSION_1_2);
    CHECK_THAT(errorOf(ErrorCode::unsupported, [&] { Device::adopt(old.handles()); }), Contains("1.3"));
  }
}

TEST_CASE("two devices in one process are independent") {
  const DeviceOptions options{.validation = true, .log = testLog()};
  const Device a = Device::create(options), b = Device::create(options);
  CHECK(a.handle() != b.handle());
  CHECK(a.instance() != b.instance());
  CHECK(test::samplePicture(a) == test::samplePicture(b));
}

TEST_CASE("devices can be moved") {
  const DeviceOptions options{.validation = true, .log = testLog()};
  Device a = Device::create(options);
  const VkDevice handle = a.handle();
  Device b = std::move(a);
  CHECK(b.handle() == handle);
  Device c = Device::create(options);
  c = std::move(b);  // destroys the previous device of c
  CHECK(c.handle() == handle);
  CHECK(test::samplePicture(c) == test::expectedPicture());
}
