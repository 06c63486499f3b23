// SPDX-License-Identifier: Apache-2.0
// Injects faults into Vulkan. A program linked with vulkan_faults.cpp passes that file's functions to
// Device::loadFunctions before main(). They forward each call to the loader until the selected one fails.
//
// The N-th call must be deterministic: Vulkan calls of several threads must not overlap.
#pragma once

#include <vulkan/vulkan_core.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <set>
#include <string>

#include "ibr/error.h"

namespace ibr::test {

/// The n-th Vulkan call after this one (0: the next) returns `result` and does nothing; later calls work.
void failCall(int n, VkResult result);

/// From the n-th call on, all calls that can report a loss (submit, wait, query results) return VK_ERROR_DEVICE_LOST.
void loseDevice(int n);

void failNothing();  // disables faults; failedCall() keeps its value

/// Returns the name of the call that has failed since failCall or loseDevice; null: none has.
const char* failedCall();

/// Device memory of all devices, counted from vkAllocateMemory and vkFreeMemory.
struct DeviceMemory {
  std::uint64_t bytes = 0, most = 0;  // current; maximum since the last resetMost()
  int count = 0;                      // number of allocations
};
DeviceMemory deviceMemory();
void resetMost();

/// Calls `watch` with the function's name before each vkQueueSubmit2, vkQueueWaitIdle and vkDeviceWaitIdle; empty: no
/// call. Any thread may call these functions.
void watchQueue(std::function<void(const char* call)> watch);

/// Number of failed calls, and number of failures from which the code recovered without an Error.
struct WalkedFaults {
  int failures = 0, madeGood = 0;
};

/// Runs `call` with its 1st, 2nd, … Vulkan call failing, until no call is left to fail. Each failure must throw
/// Error{code} that names the Vulkan call, and must leak no memory. `call` checks its results and must succeed after a
/// failure; this is tested once for each Vulkan function and at the end. `mayMakeGood`: `call` may recover without an
/// Error. `step` above 1: only every step-th call fails, unless the environment variable IBR_EVERY_FAULT is set.
template <class Call>
WalkedFaults failEachCall(VkResult result, ErrorCode code, Call call, bool mayMakeGood = false, int step = 1) {
  WalkedFaults walked;
  std::set<std::string> triedAgain;
  if (std::getenv("IBR_EVERY_FAULT")) step = 1;
  for (int n = 0;; n += step, ++walked.failures) {
    const int allocations = deviceMemory().count;
    bool failed = false;
    std::string message;
    failCall(n, result);
    try {
      call();
    } catch (const Error& error) {
      failed = true;
      message = error.what();
      CHECK(error.code() == code);
    }
    const char* which = failedCall();
    failNothing();
    if (!which) {
      CHECK(!failed);
      return walked;
    }
    INFO("call " << n << ", " << which << ": " << message);
    if (!failed) ++walked.madeGood;
    CHECK((failed || mayMakeGood));
    if (failed) CHECK_THAT(message, Catch::Contains(which));
    CHECK(deviceMemory().count == allocations);
    if (triedAgain.insert(which).second) CHECK_NOTHROW(call());
  }
}

}  // namespace ibr::test
