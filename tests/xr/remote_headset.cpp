// SPDX-License-Identifier: Apache-2.0
#include "remote_headset.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ibr::test {
namespace {

// The packet of Monado's driver "remote", in native byte order.
struct WirePose {
  float rotation[4];  // x, y, z, w
  float position[3];
};

struct WireEye {
  float fov[4];  // left, right, up, down
  WirePose pose;
  std::uint32_t padding;
};

struct WireHand {
  WirePose pose;
  float linearVelocity[3], angularVelocity[3];
  float curl[5];  // curl of the fingers
  float trigger, squeeze, squeezeForce;
  float stick[2];
  float trackpadForce, trackpad[2];
  std::uint8_t handTracking, there;
  std::uint8_t systemClick, systemTouch, aClick, aTouch, bClick, bTouch, triggerClick, triggerTouch, stickClick,
      stickTouch, trackpadTouch;
  std::uint8_t padding[3];
};

struct WirePacket {
  char header[8];
  WireEye eyes[2];
  WirePose head;
  std::uint8_t ownEyes, padding[3];
  WireHand left, right;
};
static_assert(sizeof(WireEye) == 48 && sizeof(WireHand) == 120 && sizeof(WirePacket) == 376);
static_assert(offsetof(WireHand, trigger) == 72 && offsetof(WireHand, handTracking) == 104);
static_assert(offsetof(WirePacket, head) == 104 && offsetof(WirePacket, left) == 136);

WirePose wire(const Pose& pose) {
  const glm::quat q(pose.rotation);
  const glm::vec3 p(pose.position);
  return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}

WireHand wire(const RemoteHand& hand) {
  WireHand out{};
  out.pose = wire(hand.pose);
  out.trigger = float(hand.trigger);
  out.squeeze = float(hand.squeeze);
  out.squeezeForce = hand.squeeze >= 1 ? 1.f : 0.f;
  out.stick[0] = hand.stick.x;
  out.stick[1] = hand.stick.y;
  out.there = hand.there;
  out.systemClick = hand.system;
  out.aClick = out.aTouch = hand.a;
  out.bClick = out.bTouch = hand.b;
  out.triggerClick = hand.trigger >= 1;
  out.triggerTouch = hand.trigger > 0;
  out.stickClick = hand.stickClick;
  out.stickTouch = hand.stick != glm::vec2(0);
  return out;
}

WirePacket wire(const RemoteState& state) {
  WirePacket packet{};
  std::memcpy(packet.header, "mndrmt3", 8);
  for (int i = 0; i < 2; ++i) {
    const RemoteEye& eye = state.eyes[std::size_t(i)];
    packet.eyes[i].pose = wire(eye.pose);
    const double angles[]{eye.fov.left, eye.fov.right, eye.fov.up, eye.fov.down};
    for (int k = 0; k < 4; ++k) packet.eyes[i].fov[k] = float(angles[k]);
  }
  packet.head = wire(state.head);
  packet.ownEyes = state.ownEyes;
  packet.left = wire(state.left);
  packet.right = wire(state.right);
  return packet;
}

}  // namespace

bool RemoteHeadset::connect() {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(std::uint16_t(port_));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int noDelay = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &noDelay, sizeof noDelay);
  // The runtime sends its initial and its current state as a greeting.
  WirePacket greeting[2];
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::recv(socket_, greeting, sizeof greeting, MSG_WAITALL) == sizeof greeting)
    return true;
  disconnect();
  return false;
}

void RemoteHeadset::disconnect() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

bool RemoteHeadset::send(const RemoteState& state) {
  if (socket_ < 0 && !connect()) return false;
  const WirePacket packet = wire(state);
  if (::send(socket_, &packet, sizeof packet, MSG_NOSIGNAL) == sizeof packet) return true;
  disconnect();  // another session may have connected since
  return connect() && ::send(socket_, &packet, sizeof packet, MSG_NOSIGNAL) == sizeof packet;
}

}  // namespace ibr::test
