// SPDX-License-Identifier: Apache-2.0
// The menu as a panel in the room, shown by the runtime over everything else (quad layer), with the hands as pointers.
// Threading: one thread.
#pragma once

#include <array>
#include <optional>

#include "vr/headset/eye_images.h"
#include "vr/headset/frame_ring.h"
#include "vr/menu/menu_drawer.h"
#include "vr/menu/menu_panel.h"
#include "vr/walk/locomotion.h"

namespace ibr::app {

class MenuLayer {
 public:
  /// Without 8-bit sRGB images of the runtime there is no menu; a warning goes to the log.
  MenuLayer(Headset& headset, const Device& device, const Session& session, const LogCallback& log);
  MenuLayer(const MenuLayer&) = delete;
  MenuLayer& operator=(const MenuLayer&) = delete;

  bool isOpen() const noexcept { return open_; }
  /// Opens the panel upright in front of the head (pose in the session's space), or moves an open panel there.
  void open(const Pose& head);
  void close() noexcept { open_ = false; }
  /// Adapts the panel's pose to a moved session space; `newInOld`: the new origin's pose in the previous space.
  void recentred(const Pose& newInOld);

  /// Sets HandInput::onPanel for hands that point at the open panel.
  void point(std::array<HandInput, 2>& hands);
  /// Distance along the hand's ray to the panel, metres; nullopt: no hit.
  std::optional<double> rayLength(Hand hand) const noexcept { return rayHits_[hand].metres; }

  /// Runs one frame of the menu. Call after the walk's step, which decides whether a press belongs to the panel.
  MenuRequests show(const MenuModel& model, const std::array<HandOutput, 2>& hands, double seconds);

  /// Acquires the runtime's next image and records the panel into it. Call `release` after submitting the commands.
  /// Only while the panel is open.
  void record(const FrameRing::Frame& frame);
  void release();
  /// Layer of the recorded image; valid until the next call.
  const XrCompositionLayerBaseHeader* layer(XrSpace space) noexcept;

 private:
  struct RayHit {
    std::optional<glm::dvec2> at;  // on the panel: x to the right, y down, 0 to 1
    std::optional<double> metres;
  };
  RayHit rayHit(const Pose& aim) const;

  Headset& headset_;
  MenuPanel panel_;
  XrImages images_;
  std::optional<MenuDrawer> drawer_;  // nullopt: there is no menu
  bool open_ = false;
  Pose pose_;  // of the panel's centre, whose front faces +z
  std::array<RayHit, 2> rayHits_;
  Hand pointer_ = kRight;  // the hand that controls the panel
  XrCompositionLayerQuad quad_{};
};

}  // namespace ibr::app
