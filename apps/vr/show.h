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
                   std::span<const Target> targets);
  void recordEmptiness(VkCommandBuffer commands, std::span<const Target> targets) const;
  Layers layersOf();
  void walk(double seconds);
  Shapes shapes();
  void account(const XrMoment& moment, double seconds, double processorMs);
  bool wantsPicture() const;
  void writePictures(const std::vector<Camera>& eyes);

  void beginLoading();
  void takeLoaded();
  std::vector<RenderSettings> levels() const;
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

  std::optional<Pose> head_;  // as it was seen last, in the space
  std::optional<SessionEvents::Recentred> recentring_;
  XrTime lastTime_ = 0;
  double loadingSeconds_ = 0;
  bool maskChanged_ = false, leaving_ = false, pictureAsked_ = false;
};

}  // namespace ibr::app
