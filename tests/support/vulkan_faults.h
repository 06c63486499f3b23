// SPDX-License-Identifier: Apache-2.0
// Faults of Vulkan, made. A program that is linked with vulkan_faults.cpp calls the loader through functions of the
// same names there, which hand on until it is a call's turn to fail; the library itself has nothing for it.
//
// From one thread: which call is the N-th must not depend on chance.
#pragma once

#include <vulkan/vulkan_core.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>

#include "ibr/error.h"

namespace ibr::test {

/// The n-th call from now on (0: the next) answers `result` and does nothing; those after it work.
void failCall(int n, VkResult result);

/// From the n-th of the calls on that may say so (submitting, waiting, reading queries), all say VK_ERROR_DEVICE_LOST.
void loseDevice(int n);

void failNothing();  // failedCall() stays as it is

/// Whether a call's turn has come since failCall or loseDevice, and which it was; null: none.
const char* failedCall();

/// Of all devices, as vkAllocateMemory and vkFreeMemory tell.
struct DeviceMemory {
  std::uint64_t bytes = 0, most = 0;  // now; at most since the last resetMost()
  int count = 0;                      // of allocations
};
DeviceMemory deviceMemory();
void resetMost();

/// How many calls failed, and how many of these failures were made good without an error.
struct WalkedFaults {
  int failures = 0, madeGood = 0;
};

/// `call` with its 1st, 2nd, … call of Vulkan failing, until none is left to fail. Each failure must be an Error{code}
/// that names the call and leave no memory behind; `call`, which checks what it makes, must work right afterwards, as
/// it is tried after each call of another name and in the end. With `mayMakeGood` it may also go on as if nothing had
/// happened. With a `step` above 1 only every so manieth call fails, unless the environment has IBR_EVERY_FAULT.
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
    if (failed) CHECK_THAT(message, Catch::Matchers::Contains(which));
    CHECK(deviceMemory().count == allocations);
    if (triedAgain.insert(which).second) CHECK_NOTHROW(call());
  }
}

}  // namespace ibr::test
