// SPDX-License-Identifier: Apache-2.0
// A visit with one headset, from finding it until the user leaves or it is lost. One thread, but for a place that is
// being read and put on the device: meanwhile the head is tracked as ever, over a grid.
#pragma once

#include <future>
#include <optional>

#include "shared/up.h"
#include "vr/eye_capture.h"
#include "vr/eye_images.h"
#include "vr/hands.h"
#include "vr/menu_layer.h"
#include "vr/mirror.h"
#include "vr/shapes_pass.h"
#include "vr/visit.h"

namespace ibr::app {

class Show {
 public:
  /// Throws Error.
  explicit Show(Visit& visit);
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;
  ~Show();  // waits for the device, and for a place that is being read

  /// Until the user leaves, the frames asked for have been shown, or Ctrl-C. Throws Error: deviceLost, where making
  /// another may go on.
  void run();

  std::uint64_t validationMessages() const noexcept { return headset_.validationMessages(); }

 private:
  using Layers = std::vector<const XrCompositionLayerBaseHeader*>;

  const VrOptions& options() const noexcept { return visit_.options; }
  void say(LogLevel level, const std::string& text) const;

  void obey(const SessionEvents& events);
  void frame();
  void draw(double seconds);
  void recordPlace(const FrameRing::Frame& frame, double seconds, const std::vector<Camera>& eyes,
                   std::span<const Target> targets, bool toBeKept);
  void recordEmptiness(VkCommandBuffer commands, std::span<const Target> targets) const;
  Layers layersOf(bool menu);
  void walk(double seconds);
  Shapes shapes() const;
  void addHands(Shapes& shapes, const Pose& head) const;
  void makeMirror();
  void showInMirror();
  MenuModel menuModel() const;
  void obeyMenu(double seconds);
  void standAnew();
  void account(const XrMoment& moment, double seconds, double processorMs);
  void tellPace(double seconds, double workMs, double periodMs);
  bool wantsPicture() const;
  void writePictures(const std::vector<Camera>& eyes);

  void beginLoading();
  void takeLoaded();
  void settle(std::unique_ptr<StereoPlace> place);
  void leavePlace();
  EyeFormat eyeFormat() const;
  void giveFloor(RenderSettings& settings);

  Visit& visit_;
  Headset headset_;
  Device device_;
  Session session_;
  EyeImages images_;
  Hands hands_;
  FrameRing ring_;
  ShapesPass shapesPass_;
  EyeCapture capture_;
  MenuLayer menu_;
  std::optional<Swapchain> window_;  // the mirror
  std::optional<Mirror> mirror_;
  std::unique_ptr<StereoPlace> place_;                 // null while it is being read
  std::future<std::unique_ptr<StereoPlace>> loading_;  // after all that it uses
  std::optional<std::size_t> nextPlace_;               // of options().places: gone to once all is black
  std::optional<std::size_t> formerPlace_;             // come back to where the next one cannot be shown
  GovernorState governor_;

  // Of the frame that is being made.
  EyeViews eyes_;
  std::array<HandInput, 2> input_;
  WalkOutput walked_;
  RenderSettings drawnWith_;
  std::optional<FloorWish> floor_;  // of drawnWith_
  std::array<XrCompositionLayerProjectionView, 2> projectionViews_{};
  std::array<XrCompositionLayerDepthInfoKHR, 2> depthInfos_{};
  XrCompositionLayerProjection projection_{};

  std::optional<Pose> head_;         // as it was seen last, in the space
  std::optional<std::size_t> goTo_;  // wished for by the menu, for the next step
  double scale_ = 1;                 // likewise
  SpotMap map_;                      // of the place
  std::string pace_, trouble_;       // lines for the menu: how frames go, why a place is not shown
  double paceSeconds_ = 0;           // since the former was written
  std::optional<SessionEvents::Recentred> recentring_;
  XrTime lastTime_ = 0;
  double loadingSeconds_ = 0;
  bool maskChanged_ = false, leaving_ = false, exitAsked_ = false, pictureAsked_ = false, menuShown_ = false;
};

}  // namespace ibr::app
