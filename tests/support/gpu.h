// SPDX-License-Identifier: Apache-2.0
// What tests on a device share. They are linked with gpu_main.cpp (ibr_test(… GPU …)), which makes the device first.
//
// A message of the validation layer fails the test case in which it comes, unless an ExpectedMessages takes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ibr/device.h"

namespace ibr::test {

/// One for all tests of a program, with validation.
Device& testDevice();

/// For further devices: { .validation = true, .log = testLog() }.
LogCallback testLog();

/// Fails unless no message has come in this test case. For places in the middle of a long one.
void expectNoValidationMessages();

/// Takes the messages that come while it lives, so that a test can provoke them.
class ExpectedMessages {
 public:
  ExpectedMessages();
  ExpectedMessages(const ExpectedMessages&) = delete;
  ExpectedMessages& operator=(const ExpectedMessages&) = delete;
  ~ExpectedMessages();
  std::vector<std::string> texts;
};

}  // namespace ibr::test
