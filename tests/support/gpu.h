// SPDX-License-Identifier: Apache-2.0
// Device and validation log shared by GPU tests. Link with gpu_main.cpp (ibr_test(… GPU …)), which creates the device.
//
// A message of the validation layer fails the current test case, unless an ExpectedMessages object takes the message.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ibr/device.h"

namespace ibr::test {

/// Returns the test program's only device; validation is on.
Device& testDevice();

/// Log callback for additional devices: { .validation = true, .log = testLog() }.
LogCallback testLog();

/// Fails if this test case has caused a validation message. For use in the middle of a long test case.
void expectNoValidationMessages();

/// Collects the messages that arrive during its lifetime, so that a test can provoke them.
class ExpectedMessages {
 public:
  ExpectedMessages();
  ExpectedMessages(const ExpectedMessages&) = delete;
  ExpectedMessages& operator=(const ExpectedMessages&) = delete;
  ~ExpectedMessages();
  std::vector<std::string> texts;
};

}  // namespace ibr::test
