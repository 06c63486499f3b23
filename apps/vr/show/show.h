// SPDX-License-Identifier: Apache-2.0
// A visit with one headset, from finding it until the user leaves or it is lost. One thread, but for a place that is
// being read and put on the device: meanwhile the head is tracked as ever, over a grid.
#pragma once

#include <future>
#include <optional>

#include "shared/camera/up.h"
#include "vr/headset/eye_capture.h"
#include "vr/headset/eye_images.h"
#include "vr/headset/hands.h"
#include "vr/menu/mirror.h"
#include "vr/show/menu_layer.h"
#include "vr/show/shapes_pass.h"
#include "vr/show/visit.h"

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

 private:
  using Layers = std::vector<const XrCompositionLayerBaseHeader*>;

  const VrOptions& options() const noexcept { return visit_.options; }
  void say(LogLevel level, const std::string& text) const;

  // The frame.
  void obey(const SessionEvents& events);
  void frame();
  void changeSpace(XrTime time);
  void lookAround(XrTime time);
  void walk(double seconds);
  void waitInPlace(double seconds);

  // What the eyes see.
  void draw(double seconds);
  void recordPlace(const FrameRing::Frame& frame, double seconds, const std::vector<Camera>& eyes,
                   std::span<const Target> targets, bool toBeKept);
  void recordEmptiness(VkCommandBuffer commands, std::span<const Target> targets) const;
  void giveFloor(RenderSettings& settings);
  Shapes shapes() const;
  void addHands(Shapes& shapes) const;
  Layers layers();
  void makeMirror();
  void showInMirror();

  // The place.
  void beginLoading();
  void takeLoaded();
  void settle(std::unique_ptr<StereoPlace> place);
  void goBack(const std::string& why);
  void leavePlace();
  EyeFormat eyeFormat() const;
  std::vector<RenderSettings> levelsOf(const PlaceFiles& files) const;

  // The menu.
  MenuModel menuModel() const;
  void obeyMenu(double seconds);
  void obeyWaitingMenu(double seconds);
  void standAnew();
  void turnComposition();

  // How it goes.
  void account(const XrMoment& moment, double seconds, double processorMs);
  void conclude(std::uint32_t slot, double deviceMs);
  void tellPace(const FrameTimes& times, double periodMs);
  bool wantsPicture() const;
  void writePictures(const std::vector<Camera>& eyes);

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

  Pose head_;  // in the middle of the eyes, in the space; where it is not known, it is where it was
  std::array<glm::dvec3, 2> eyeOffsets_{glm::dvec3(-0.0315, 0, 0), glm::dvec3(0.0315, 0, 0)};  // from it, in its axes
  std::vector<SessionEvents::Recentred> recentrings_;                                          // to come

  // Wished for by the menu, for the next frame.
  std::optional<std::size_t> goTo_;
  double scale_ = 1;
  std::optional<double> eyeHeight_;

  SpotMap map_;                 // of the place
  std::string pace_, trouble_;  // lines for the menu: how frames go, what went wrong
  double paceSeconds_ = 0;      // since the former was written
  double waitedSeconds_ = 0;    // for the place
  std::array<bool, 2> menuHeld_{};

  // A frame's time on the device is known when its slot is used again.
  struct Pending {
    FrameTimes times;
    double periodMs;
  };
  std::array<std::optional<Pending>, FrameRing::kSlots> pending_;
  std::uint32_t slot_ = 0;
  XrTime lastTime_ = 0;   // 0: there was no frame just before
  double notWorkMs_ = 0;  // of this frame: waits for images and the device, files that are written
  bool maskChanged_ = false, exitAsked_ = false, pictureAsked_ = false, menuShown_ = false;
};

}  // namespace ibr::app
