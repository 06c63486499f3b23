// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>

#include "ibr/error.h"
#include "ibr/export.h"
#include "support/gpu_session.h"
#include "support/locale.h"
#include "support/skipped.h"

#ifdef __SANITIZE_ADDRESS__
// Synchronisation validation of layer 1.3.239 leaks every command buffer's state through a reference cycle.
// The leak suppressions are safe: the layer itself reports Vulkan objects that the library fails to destroy.
// Exported, since the sanitizer is a shared library.
extern "C" IBR_API const char* __lsan_default_suppressions() {
  return "leak:libVkLayer_khronos_validation\n";
}
#endif

namespace {

struct Listener : Catch::TestEventListenerBase {
  using Base = Catch::TestEventListenerBase;
  using Base::Base;
  void testCaseStarting(const Catch::TestCaseInfo&) override { ibr::test::beginTestCase(); }
  void testCaseEnded(const Catch::TestCaseStats&) override { ibr::test::endTestCase(); }
};
CATCH_REGISTER_LISTENER(Listener)

}  // namespace

int main(int argc, char** argv) {
  if (!ibr::test::setTestLocale()) return 77;
  // Enables hazard checks between submissions; the layer has no other switch for them.
  ::setenv("VK_LAYER_ENABLES", "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);
  try {
    ibr::test::makeTestDevice();
  } catch (const ibr::Error& error) {
    const char* required = std::getenv("IBR_REQUIRE_DEVICE");
    const bool skip = !(required && *required) && error.code() == ibr::ErrorCode::unsupported;
    std::fprintf(stderr, "%s: %s\n", skip ? "skipped" : "failed", error.what());
    return skip ? 77 : 1;
  }
  const int result = Catch::Session().run(argc, argv);
  ibr::test::destroyTestDevice();
  const int stray = ibr::test::strayMessages();
  if (stray > 0) std::fprintf(stderr, "failed: %d validation messages outside test cases\n", stray);
  return result == 0 && stray > 0 ? 1 : ibr::test::exitCodeOf(result);
}
