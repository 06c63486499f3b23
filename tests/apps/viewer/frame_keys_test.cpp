// SPDX-License-Identifier: Apache-2.0
#include "window/frame_keys.h"

#include <array>
#include <catch2/catch.hpp>

using ibr::app::FrameKeys;
using ibr::app::KeyChange;

TEST_CASE("a key that goes down and up between two frames is down for one frame") {
  FrameKeys keys;
  keys.beginFrame(std::array{KeyChange{65, true}, KeyChange{65, false}, KeyChange{66, true}});
  CHECK(keys.isDown(65));
  CHECK(!keys.isDown(66));  // waits, because changes keep their order
  CHECK(keys.hasPending());
  keys.beginFrame({});
  CHECK(!keys.isDown(65));
  CHECK(keys.isDown(66));
  CHECK(!keys.hasPending());
}

TEST_CASE("changes of different keys reach one frame together, and a held key stays down") {
  FrameKeys keys;
  keys.beginFrame(std::array{KeyChange{65, true}, KeyChange{66, true}});
  keys.beginFrame(std::array{KeyChange{66, false}});
  CHECK(keys.isDown(65));
  CHECK(!keys.isDown(66));
  CHECK(!keys.hasPending());
}

TEST_CASE("a repeated press or release changes nothing") {
  FrameKeys keys;
  keys.beginFrame(std::array{KeyChange{65, false}});
  CHECK(!keys.isDown(65));
  keys.beginFrame(std::array{KeyChange{65, true}});
  keys.beginFrame(std::array{KeyChange{65, true}});
  CHECK(keys.isDown(65));
}
