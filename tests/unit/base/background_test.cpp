// SPDX-License-Identifier: Apache-2.0
#include "base/background.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <stdexcept>
#include <thread>

#include "base/stop.h"
#include "support/error_of.h"

using namespace ibr;

namespace {

// Runs until a stop is requested.
void untilStopped(const std::stop_token& stop) {
  for (;;) {
    checkStop(stop, "waiting");
    std::this_thread::yield();
  }
}

}  // namespace

TEST_CASE("background work returns its value once, or throws its exception") {
  Background<std::unique_ptr<int>> none;
  CHECK_FALSE(none.isRunning());
  CHECK_FALSE(none.isReady());
  Background<std::unique_ptr<int>> work([](const std::stop_token&) { return std::make_unique<int>(3); });
  CHECK(work.isRunning());
  CHECK(*work.take() == 3);
  CHECK_FALSE(work.isRunning());
  Background<int> fails([](const std::stop_token&) -> int { throw std::runtime_error("no"); });
  CHECK_THROWS_WITH(fails.take(), "no");
}

TEST_CASE("background work ends when it is stopped, replaced or destroyed") {
  std::atomic<int> ended = 0;
  const auto work = [&](const std::stop_token& stop) -> int {
    struct End {
      std::atomic<int>& count;
      ~End() { ++count; }
    } end{ended};
    untilStopped(stop);
    return 0;
  };
  {
    Background<int> one(work);
    CHECK_FALSE(one.isReady());
    one.requestStop();
    CHECK(test::errorOf([&] { one.take(); }).code() == ErrorCode::cancelled);
    CHECK(ended == 1);
    one = Background<int>(work);
    CHECK(ended == 1);
    one = Background<int>(work);
    CHECK(ended == 2);
    Background<int> moved = std::move(one);
    CHECK_FALSE(one.isRunning());
    CHECK(moved.isRunning());
  }
  CHECK(ended == 3);
}
