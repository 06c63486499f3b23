// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/signals.h"

#include <csignal>

#include "base/check.h"

namespace ibr::app {
namespace {
volatile std::sig_atomic_t pressed = 0;
extern "C" void onInterrupt(int) {
  pressed = 1;
}
}  // namespace

void watchForInterrupt() {
  struct sigaction action {};
  action.sa_handler = onInterrupt;
  action.sa_flags = int(SA_RESETHAND) | SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() noexcept {
  return pressed != 0;
}

void stopIfInterrupted() {
  check(!interrupted(), ErrorCode::cancelled, "stopped");
}

}  // namespace ibr::app
