// SPDX-License-Identifier: Apache-2.0
// The menu in a headset: a panel in the room, which the runtime shows over everything, and hands that point at it. One
// thread.
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
  /// Where the runtime has no sRGB images of 8 bits there is no menu, and the log says so.
  MenuLayer(Headset& headset, const Device& device, const Session& session, const LogCallback& log);
  MenuLayer(const MenuLayer&) = delete;
  MenuLayer& operator=(const MenuLayer&) = delete;

  bool isOpen() const noexcept { return open_; }
  /// Before the head (in the session's space), upright; where it was open, it comes there.
  void open(const Pose& head);
  void close() noexcept { open_ = false; }
  /// The space has another origin, whose pose in the former one this is.
  void recentred(const Pose& newInOld);

  /// Finds out which hands point at it: HandInput::onPanel.
  void point(std::array<HandInput, 2>& hands);
  /// How far along its ray a hand meets it, metres.
  std::optional<double> rayLength(Hand hand) const noexcept { return meets_[hand].metres; }

  /// One frame of it, after the walk's step, which says whose press is the panel's.
  MenuWishes show(const MenuModel& model, const std::array<HandOutput, 2>& hands, double seconds);

  /// Records it into the runtime's next image, which `release` gives back after the commands were submitted. Only while
  /// it is open.
  void record(const FrameRing::Frame& frame);
  void release();
  /// As it was recorded; valid until the next call.
  const XrCompositionLayerBaseHeader* layer(XrSpace space) noexcept;

 private:
  struct Meeting {
    std::optional<glm::dvec2> at;  // of the panel: x to the right, y down, 0 to 1
    std::optional<double> metres;
  };
  Meeting meeting(const Pose& aim) const;

  Headset& headset_;
  MenuPanel panel_;
  XrImages images_;
  std::optional<MenuDrawer> drawer_;  // none: there is no menu
  bool open_ = false;
  Pose pose_;  // its middle, looking along +z
  std::array<Meeting, 2> meets_;
  Hand pointer_ = kRight;  // that it listens to
  XrCompositionLayerQuad quad_{};
};

}  // namespace ibr::app
