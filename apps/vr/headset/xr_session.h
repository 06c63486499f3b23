// SPDX-License-Identifier: Apache-2.0
// An OpenXR session: its life from state to state, its frames, and where the eyes are. One thread.
//
// All poses are in "the space": metres, y up, its origin on the floor. It is the runtime's STAGE, or where there is
// none its LOCAL space, put so that the head is at a chosen height to begin with.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "vr/headset/headset.h"

namespace ibr::app {

enum class SpaceKind : std::uint8_t { stage, local };

/// What has happened since the last call.
struct SessionEvents {
  struct Recentred {
    XrTime time;                 // from then on
    std::optional<Pose> change;  // the new space's origin in the space as it was, where the runtime knows
  };
  std::vector<Recentred> recentred;  // in their order
  bool maskChanged = false;          // hiddenArea gives others
  bool handsChanged = false;         // other controllers
};

/// To be drawn, and when it will be seen.
struct XrMoment {
  XrTime time = 0;
  double periodMs = 0;  // from one frame to the next
  bool shown = false;   // false: nothing need be drawn
};

struct EyeView {
  Pose pose;  // in the space
  XrFovf fov{};
};

struct EyeViews {
  std::array<EyeView, 2> eyes;
  bool oriented = false;    // there are fields of view to draw, and where they look is known
  bool positioned = false;  // and where they are
  /// In the middle of the eyes ([T] §2.5.4).
  Pose head() const;
};

class Session {
 public:
  /// `space`: what is wanted; STAGE where it is nullopt and there is one. `eyeHeight`: of LOCAL, m. Throws Error.
  Session(Headset& headset, std::optional<SpaceKind> space, double eyeHeight);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  XrSession get() const noexcept { return session_.get(); }
  XrSpace space() const noexcept { return space_.get(); }
  SpaceKind spaceKind() const noexcept { return kind_; }

  /// Goes where the runtime wants the session to be. Throws Error{deviceLost} where it, or all of the runtime, is lost
  /// or about to be.
  SessionEvents handleEvents();
  bool running() const noexcept { return running_; }  // frames are wanted
  bool ended() const noexcept { return ended_; }
  /// The runtime then lets it end. Nothing while it does not run.
  void requestExit();

  /// The size in which the runtime would like each eye's picture.
  VkExtent2D eyeExtent() const noexcept { return eyeExtent_; }

  /// Waits until it is time for the next frame, and begins it.
  XrMoment beginFrame();
  EyeViews locate(XrTime time) const;
  std::optional<Pose> locate(XrSpace what, XrTime time) const;  // nullopt: not tracked
  void endFrame(const XrMoment& moment, std::span<const XrCompositionLayerBaseHeader* const> layers);

  /// Triangles in tangents (x right, y up) that an eye's lens never shows; none where the runtime does not tell.
  std::vector<glm::vec2> hiddenArea(std::uint32_t eye) const;

  /// Of LOCAL: the floor lies so far below where the head was when the space was set up.
  void setEyeHeight(double metres);

 private:
  void chooseView();
  void makeSpace(double eyeHeight);
  void enter(XrSessionState state);

  Headset& headset_;
  XrSessionOwner session_;
  SpaceKind kind_ = SpaceKind::stage;
  XrSpaceOwner space_;
  VkExtent2D eyeExtent_{0, 0};
  XrEnvironmentBlendMode blendMode_ = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
  bool running_ = false, ended_ = false;
};

}  // namespace ibr::app
