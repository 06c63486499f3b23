// SPDX-License-Identifier: Apache-2.0
// Plays 3D video, or shows a single harmonised model, on a device. Renders images at any time of the video.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ibr/htm_sequence.h"
#include "shared/draw/htm_model_renderer.h"

namespace ibr::app {

struct HtmPlayerOptions {
  bool sourceMesh = false;      // draws the meshes from before the optimisation
  std::size_t framesAhead = 8;  // frames loaded in the background
  double seconds = 0;           // first time to show, s
  bool graph = false;           // draws the model's cameras as well
};

/// Loads the next frames while one is drawn. Waits for a frame that is not loaded yet. The device holds one frame at a
/// time.
class HtmPlayer {
 public:
  /// Opens a model or a sequence and reads its first frame. The device is created for the first image. Throws Error;
  /// invalidInput if `sourceMesh` is set and a model has no mesh from before the optimisation.
  HtmPlayer(const std::filesystem::path& path, const HtmPlayerOptions& options, const Context& context);

  bool isVideo() const { return sequence_ != nullptr; }
  double fps() const { return sequence_ ? sequence_->fps() : 0; }  // 0 for a single model
  const HtmModel& model() const { return *model_; }                // of the frame that was shown last
  std::string deviceName() const { return device_ ? device_->name() : std::string(); }

  /// Renders the frame at a time; a single model is the same at all times. `state` and `dtSeconds`: see
  /// HtmModelRenderer::render. Weights continue from frame to frame.
  struct Picture : HtmModelRenderer::Picture {
    std::size_t frame = 0;
  };
  Picture render(const Camera& view, double seconds, const HtmSettings& settings, HtmPlanState& state,
                 double dtSeconds);

  /// Cost of showing a frame, for each time it was shown, ms.
  struct FrameCosts {
    std::size_t frame = 0;
    std::string name;        // folder of the frame's model
    double loading = 0;      // reading the model and its images' mip levels; in the background for 3D video
    double waiting = 0;      // part of `loading` that blocked the player
    double upload = 0;       // onto the device
    double preparation = 0;  // pipelines and targets; first frame only
    double rendering = 0;    // of all images of the frame
    std::size_t pictures = 0;
  };
  const std::vector<FrameCosts>& shown() const { return shown_; }

 private:
  void show(double seconds);
  void take(std::shared_ptr<const HtmFrame> frame);
  void upload();

  std::filesystem::path path_;
  bool sourceMesh_, showsGraph_;
  const Context& context_;
  std::unique_ptr<HtmSequence> sequence_;
  std::shared_ptr<const HtmFrame> frame_;
  std::shared_ptr<const HtmModel> model_;    // frame_'s model, or its copy with the mesh from before the optimisation
  std::shared_ptr<const HtmModel> stateOf_;  // model of the last image's state
  std::unique_ptr<Device> device_;
  std::unique_ptr<HtmModelRenderer> pictures_;
  bool uploaded_ = false;  // pictures_ shows model_
  std::vector<FrameCosts> shown_;
};

}  // namespace ibr::app
