// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/frame_times.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace ibr;
using namespace ibr::app;

TEST_CASE("the history keeps the times of the last frames, and assigns device times to their frame") {
  FrameHistory history;
  CHECK(history.of(0).passes.empty());
  CHECK(std::isnan(history.of(7).sinceLast));
  for (std::size_t frame = 1; frame <= 200; ++frame) {
    history.add(frame, float(frame));
    // Device times arrive two frames later. Nested scopes are not counted as passes.
    if (frame > 2)
      history.addDevice(frame - 2, {{"canvas", 0, double(frame - 2)}, {"cells", 1, 0.5}, {"composite", 0, 0.25}});
  }
  for (std::size_t frame = 200; frame > 200 - FrameHistory::kLength; --frame) {
    CHECK(history.of(frame).frame == frame);
    CHECK(history.of(frame).sinceLast == float(frame));
  }
  CHECK(history.of(80).frame != 80);  // older than the history
  REQUIRE(history.of(150).passes.size() == 2);
  CHECK(history.names()[history.of(150).passes[0].first] == "canvas");
  CHECK(history.of(150).passes[0].second == 150.0f);
  CHECK(history.names()[history.of(150).passes[1].first] == "composite");
  CHECK(history.of(200).passes.empty());  // device times not yet available

  history.addDevice(80, {{"late", 0, 1.0}});  // the slot belongs to a later frame
  CHECK(history.of(200).passes.empty());
  CHECK(history.names().size() == 2);
}
