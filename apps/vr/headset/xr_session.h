// SPDX-License-Identifier: Apache-2.0
// An OpenXR session: its states, its frames, and the poses of the eyes. Threading: one thread.
//
// All poses are in the session's space: metres, y up, origin on the floor. The space is the runtime's STAGE space.
// Without STAGE it is LOCAL, shifted so that the head starts at a chosen height.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "vr/headset/headset.h"

namespace ibr::app {

enum class SpaceKind : std::uint8_t { stage, local };

/// Events since the last call.
struct SessionEvents {
  struct Recentred {
    XrTime time;                 // the new space is valid from this time on
    std::optional<Pose> change;  // new origin in the previous space; nullopt: unknown
  };
  std::vector<Recentred> recentred;  // in the order of events
  bool maskChanged = false;          // hiddenArea has changed
  bool handsChanged = false;         // controllers have changed
};

/// Display time of a frame, and whether to draw.
struct XrFrameTiming {
  XrTime time = 0;
  double periodMs = 0;  // between frames
  bool shown = false;   // false: nothing needs to be drawn
};

struct EyeView {
  Pose pose;  // in the session's space
  XrFovf fov{};
};

struct EyeViews {
  std::array<EyeView, 2> eyes;
  bool oriented = false;    // fields of view are valid and rotations are tracked
  bool positioned = false;  // positions are tracked, too
  /// Pose in the middle between the eyes ([T] §2.5.4).
  Pose head() const;
};

class Session {
 public:
  /// `space`: the requested one; nullopt: STAGE if available, else LOCAL. `eyeHeight`: for LOCAL, m. Throws Error.
  Session(Headset& headset, std::optional<SpaceKind> space, double eyeHeight);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  XrSession get() const noexcept { return session_.get(); }
  XrSpace space() const noexcept { return space_.get(); }
  SpaceKind spaceKind() const noexcept { return kind_; }

  /// Polls events and follows the runtime's state changes. Throws Error{deviceLost} if the session or the instance is
  /// lost or about to be lost.
  SessionEvents handleEvents();
  bool running() const noexcept { return running_; }  // frames must be submitted
  bool ended() const noexcept { return ended_; }
  /// Asks the runtime to end the session. Does nothing while the session is not running.
  void requestExit();

  /// Size that the runtime recommends for each eye's image.
  VkExtent2D eyeExtent() const noexcept { return eyeExtent_; }

  /// Waits until the runtime wants the next frame, and begins that frame.
  XrFrameTiming beginFrame();
  EyeViews locate(XrTime time) const;
  std::optional<Pose> locate(XrSpace what, XrTime time) const;  // nullopt: not tracked
  void endFrame(const XrFrameTiming& timing, std::span<const XrCompositionLayerBaseHeader* const> layers);

  /// Triangles, as tangents (x right, y up), that an eye's lens never shows; empty if the runtime has no mask.
  std::vector<glm::vec2> hiddenArea(std::uint32_t eye) const;

  /// For LOCAL: sets the height of the head's initial position above the floor.
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
