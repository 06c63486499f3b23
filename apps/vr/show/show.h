// SPDX-License-Identifier: Apache-2.0
// A session with one headset, from its discovery until the user leaves or the headset is lost. Threading: one thread;
// another one loads a scene, meanwhile the head is tracked over a grid.
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
  ~Show();  // waits for the device, and for a scene that is being loaded

  /// Runs until the user leaves, VrOptions::frames frames were shown, or Ctrl-C. Throws Error; after deviceLost another
  /// Show may be created.
  void run();

 private:
  using Layers = std::vector<const XrCompositionLayerBaseHeader*>;

  const VrOptions& options() const noexcept { return visit_.options; }
  void say(LogLevel level, const std::string& text) const;

  // Steps of a frame.
  void obey(const SessionEvents& events);
  void frame();
  void changeSpace(XrTime time);
  void lookAround(XrTime time);
  void walk(double seconds);
  void waitInPlace(double seconds);

  // Drawing.
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

  // Loading and leaving scenes.
  void beginLoading();
  void takeLoaded();
  void settle(std::unique_ptr<StereoPlace> place);
  void goBack(const std::string& why);
  void leavePlace();
  EyeFormat eyeFormat() const;
  std::vector<RenderSettings> levelsOf(const PlaceFiles& files) const;

  // Menu.
  MenuModel menuModel() const;
  void obeyMenu(double seconds);
  void obeyWaitingMenu(double seconds);
  void standAnew();
  void turnComposition();

  // Statistics and screenshots.
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
  std::optional<Swapchain> window_;  // of the mirror
  std::optional<Mirror> mirror_;
  std::unique_ptr<StereoPlace> place_;                 // null while a scene is loading
  std::future<std::unique_ptr<StereoPlace>> loading_;  // declared after everything that the loading thread uses
  std::optional<std::size_t> nextPlace_;               // index into options().places: loaded once the view is black
  GovernorState governor_;

  // State of the current frame.
  EyeViews eyes_;
  std::array<HandInput, 2> input_;
  WalkOutput walked_;
  RenderSettings drawnWith_;
  std::optional<FloorWish> floor_;  // floor of drawnWith_
  std::array<XrCompositionLayerProjectionView, 2> projectionViews_{};
  std::array<XrCompositionLayerDepthInfoKHR, 2> depthInfos_{};
  XrCompositionLayerProjection projection_{};

  Pose head_;  // between the eyes, in the session's space; while not tracked, the last known pose
  std::array<glm::dvec3, 2> eyeOffsets_{glm::dvec3(-0.0315, 0, 0), glm::dvec3(0.0315, 0, 0)};  // from head_, its axes
  std::vector<SessionEvents::Recentred> recentrings_;                                          // not yet applied

  // Requests of the menu, for the next frame.
  std::optional<std::size_t> goTo_;
  double scale_ = 1;
  std::optional<double> eyeHeight_;

  SpotMap map_;                 // of the scene
  std::string pace_, trouble_;  // lines for the menu: frame times, last error
  double paceSeconds_ = 0;      // since pace_ was written
  double waitedSeconds_ = 0;    // for the scene being loaded
  std::array<bool, 2> menuHeld_{};

  // The device time of a frame is known when its slot is used again.
  struct Pending {
    FrameTimes times;
    double periodMs;
  };
  std::array<std::optional<Pending>, FrameRing::kSlots> pending_;
  std::uint32_t slot_ = 0;
  XrTime lastTime_ = 0;   // 0: the previous frame was not just before
  double notWorkMs_ = 0;  // of this frame: waiting for images and the device, writing files
  bool maskChanged_ = false, exitAsked_ = false, pictureAsked_ = false, menuShown_ = false;
};

}  // namespace ibr::app
