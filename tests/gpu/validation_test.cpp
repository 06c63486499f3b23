// SPDX-License-Identifier: Apache-2.0
// Tests of the validation setup: deliberate errors must be reported, so that silence means a correct program.
#include <catch2/catch.hpp>
#include <cstddef>
#include <new>
#include <string>

#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "command_buffers.h"
#include "support/gpu.h"

using namespace ibr;
using test::CommandBuffers;

namespace {

constexpr VkBufferUsageFlags kCopied = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

/// A separate device, so that the message count of testDevice() stays at 0.
Device validatedDevice() {
  return Device::create({.validation = true, .log = test::testLog()});
}

int containing(const test::ExpectedMessages& messages, const char* text) {
  int count = 0;
  for (const std::string& message : messages.texts) count += message.find(text) != std::string::npos;
  return count;
}

void fill(VkCommandBuffer commands, const Buffer& buffer) {
  vkCmdFillBuffer(commands, buffer.get(), 0, VK_WHOLE_SIZE, 1);
}

void copy(VkCommandBuffer commands, const Buffer& from, const Buffer& to) {
  const VkBufferCopy region{0, 0, from.size()};
  vkCmdCopyBuffer(commands, from.get(), to.get(), 1, &region);
}

}  // namespace

TEST_CASE("a missing barrier between commands is reported, counted and sent to the log") {
  const Device device = validatedDevice();
  const Buffer a(device, 64, kCopied, MemoryKind::device, "a"), b(device, 64, kCopied, MemoryKind::device, "b");
  const auto fillAndCopy = [&](bool barrier) {
    submitAndWait(device, [&](VkCommandBuffer commands) {
      bufferBarrier(commands, use::kAllCommands, use::kAllCommands);
      fill(commands, a);
      if (barrier) bufferBarrier(commands, use::kTransferWrite, use::kTransferRead);
      copy(commands, a, b);
    });
  };
  fillAndCopy(true);
  CHECK(device.validationMessages() == 0);
  const test::ExpectedMessages messages;
  fillAndCopy(false);
  CHECK(containing(messages, "SYNC-HAZARD-READ-AFTER-WRITE") >= 1);
  CHECK(device.validationMessages() == messages.texts.size());
}

TEST_CASE("a missing barrier between submissions is reported") {
  const Device device = validatedDevice();
  const Buffer a(device, 64, kCopied, MemoryKind::device, "a"), b(device, 64, kCopied, MemoryKind::device, "b");
  const CommandBuffers commands(device, 2);
  const auto submitBoth = [&](bool barrier) {
    commands.submit(0, [&](VkCommandBuffer first) { fill(first, a); });
    commands.submit(1, [&](VkCommandBuffer second) {
      if (barrier) bufferBarrier(second, use::kTransferWrite, use::kTransferRead);
      copy(second, a, b);
    });
    vk(vkQueueWaitIdle(device.queue()), "vkQueueWaitIdle");
  };
  submitBoth(true);
  CHECK(device.validationMessages() == 0);
  const test::ExpectedMessages messages;
  submitBoth(false);
  CHECK(containing(messages, "SYNC-HAZARD-READ-AFTER-WRITE") >= 1);
}

#ifndef __SANITIZE_ADDRESS__  // which would report the deliberate leak
TEST_CASE("an object that is never destroyed is reported with its name") {
  const test::ExpectedMessages messages;
  {
    const Device device = validatedDevice();
    alignas(Buffer) std::byte place[sizeof(Buffer)];
    new (place) Buffer(device, 64, kCopied, MemoryKind::device, "forgotten buffer");
  }
  CHECK(containing(messages, "forgotten buffer") >= 1);
}
#endif
