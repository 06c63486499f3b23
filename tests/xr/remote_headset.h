// SPDX-License-Identifier: Apache-2.0
// A headset and two controllers controlled by a test: the client side of Monado's driver "remote". A state persists
// until the next one is sent.
#pragma once

#include <array>
#include <glm/vec2.hpp>

#include "ibr/camera.h"

namespace ibr::test {

struct RemoteFov {
  double left, right, up, down;  // radians from straight ahead; left and down are negative
};

struct RemoteEye {
  Pose pose;  // relative to the head
  RemoteFov fov;
};

/// A controller like that of a Valve Index.
struct RemoteHand {
  Pose pose;  // of both grip and aim
  bool there = true;
  double trigger = 0, squeeze = 0;  // 0 … 1; the trigger clicks at 1
  glm::vec2 stick{0};               // −1 … 1, right and up
  bool stickClick = false, a = false, b = false, system = false;
};

/// Poses are in the space STAGE, metres. LOCAL is 1.6 m above it.
struct RemoteState {
  Pose head{{0, 1.6, 0}, {1, 0, 0, 0}};
  bool ownEyes = false;  // false: the runtime uses its own eyes, 63 mm apart
  std::array<RemoteEye, 2> eyes{};
  RemoteHand left{{{-0.2, 1.3, -0.5}, {1, 0, 0, 0}}}, right{{{0.2, 1.3, -0.5}, {1, 0, 0, 0}}};
};

class RemoteHeadset {
 public:
  explicit RemoteHeadset(int port) : port_(port) {}
  ~RemoteHeadset() { disconnect(); }
  RemoteHeadset(const RemoteHeadset&) = delete;
  RemoteHeadset& operator=(const RemoteHeadset&) = delete;

  /// Sends a state; connects first if necessary. Returns false, and sends nothing, while no runtime is running.
  bool send(const RemoteState& state);

 private:
  bool connect();
  void disconnect();

  int port_, socket_ = -1;
};

}  // namespace ibr::test
