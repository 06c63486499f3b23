// SPDX-License-Identifier: Apache-2.0
// A session with one headset, from its discovery until the user leaves or the headset is lost. Threading: one thread;
// another one loads a scene, meanwhile the head is tracked over a grid.
#pragma once

#include <optional>

#include "base/background.h"
#include "shared/camera/up.h"
#include "shared/draw/picture_writer.h"
#include "vr/headset/eye_capture.h"
#include "vr/headset/eye_images.h"
#include "vr/headset/hands.h"
#include "vr/menu/mirror.h"
#include "vr/show/menu_layer.h"
#include "vr/show/shapes_pass.h"
#include "vr/show/state.h"

namespace ibr::app {

class VrApp {
 public:
  /// Throws Error.
  explicit VrApp(VrState& state);
  VrApp(const VrApp&) = delete;
  VrApp& operator=(const VrApp&) = delete;
  ~VrApp();  // stops the loading of a scene, waits for the device, writes screenshots

  /// Runs until the user leaves, VrOptions::frames frames were shown, or Ctrl-C. Throws Error; after deviceLost another
  /// VrApp may be created.
  void run();

 private:
  const VrOptions& options() const noexcept { return state_.options; }
  void logMessage(LogLevel level, const std::string& text) const;

  void showFrames();

  // Steps of a frame.
  void handleSessionEvents(const SessionEvents& events);
  void frame();
  void applySpaceChanges(XrTime time);
  void locateHeadAndHands(XrTime time);
  void walk(double seconds);
  void updateWhileLoading(double seconds);

  // Drawing.
  void draw(double seconds);
  void recordScene(const FrameRing::Frame& frame, double seconds, const std::array<Camera, 2>& eyes,
                   std::span<const Target> targets, bool captured);
  void recordBackground(VkCommandBuffer commands, std::span<const Target> targets) const;
  void setFloor(RenderSettings& settings);
  const Shapes& updatedShapes();
  void addHands(Shapes& shapes) const;
  std::span<const XrCompositionLayerBaseHeader* const> updatedLayers();
  void makeMirror();
  void showInMirror();

  // Loading and leaving scenes.
  void beginLoading();
  void beginUpload();
  void collectLoadedScene();
  void enterScene(std::unique_ptr<StereoScene> scene);
  void returnToPreviousScene(const std::string& why);
  void leaveScene();
  EyeFormat eyeFormat() const;
  std::vector<RenderSettings> levelsOf(const LoadedScene& files) const;

  // Menu.
  void updateMenuModel();
  void applyMenuRequests(double seconds);
  void applyLoadingMenu(double seconds);
  void returnToSpot();
  void cycleComposition();

  // Statistics.
  void recordStatistics(const XrFrameTiming& timing, double seconds, double processorMs);
  void finishStatistics(std::uint32_t slot, double deviceMs);
  void updateStatusLine(const FrameLogEntry& times, double periodMs);

  // Screenshots.
  struct Capture;
  Capture* dueCapture();
  void keepCapture(Capture& capture, std::uint64_t frame, const std::array<Camera, 2>& eyes);
  Capture* freeCapture() const;
  void writeCaptures(std::uint64_t completed);
  void reportPictures(const std::vector<PictureResult>& results);
  void finishPictures();

  VrState& state_;
  Headset headset_;
  Device device_;
  Session session_;
  EyeImages images_;
  Hands hands_;
  FrameRing ring_;
  ShapesPass shapesPass_;
  std::array<std::unique_ptr<Capture>, 3> captures_;
  PictureWriter writer_;  // declared after the captures that it reads
  MenuLayer menu_;
  std::optional<Swapchain> window_;  // of the mirror
  std::optional<Mirror> mirror_;
  std::unique_ptr<StereoScene> scene_;                  // null while a scene is loading
  Background<std::unique_ptr<StereoScene>> uploading_;  // declared after everything that its thread uses
  std::optional<std::size_t> nextScene_;                // index into options().places: loaded once the view is black
  GovernorState governor_;

  // State of the current frame.
  EyeViews eyes_;
  std::array<HandInput, 2> input_;
  WalkOutput walkOutput_;
  RenderSettings drawnSettings_;
  std::optional<FloorOptions> floor_;  // floor of drawnSettings_
  std::array<XrCompositionLayerProjectionView, 2> projectionViews_{};
  std::array<XrCompositionLayerDepthInfoKHR, 2> depthInfos_{};
  XrCompositionLayerProjection projection_{};
  std::array<const XrCompositionLayerBaseHeader*, 2> layers_{};
  Shapes shapes_;  // keeps its memory between frames

  Pose head_;  // between the eyes, in the session's space; while not tracked, the last known pose
  std::array<glm::dvec3, 2> eyeOffsets_{glm::dvec3(-0.0315, 0, 0), glm::dvec3(0.0315, 0, 0)};  // from head_, its axes
  std::vector<SessionEvents::Recentred> recentrings_;                                          // not yet applied

  // Requests of the menu, for the next frame.
  std::optional<std::size_t> teleportSpot_;
  double scale_ = 1;
  std::optional<double> eyeHeight_;

  SpotMap map_;                         // of the scene
  MenuModel menuModel_, loadingMenu_;   // of the scene, and while one is loading; keep their memory between frames
  std::string statusLine_, lastError_;  // lines for the menu: frame times, last error
  double statusSeconds_ = 0;            // since statusLine_ was written
  double loadingSeconds_ = 0;           // for the scene being loaded
  std::array<bool, 2> menuHeld_{};

  // The device time of a frame is known when its slot is used again.
  struct Pending {
    FrameLogEntry times;
    double periodMs;
  };
  std::array<std::optional<Pending>, FrameRing::kSlots> pending_;
  std::uint32_t slot_ = 0;
  XrTime lastTime_ = 0;    // 0: the previous frame was not just before
  double excludedMs_ = 0;  // of this frame: waiting for images, the device and the writer
  bool maskChanged_ = false, exitRequested_ = false, screenshotRequested_ = false, menuShown_ = false;
};

}  // namespace ibr::app
