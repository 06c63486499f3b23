// SPDX-License-Identifier: Apache-2.0
// 3D video, or a single harmonised model, on a device, and pictures of it at any time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ibr/htm_sequence.h"
#include "shared/draw/htm_renderer.h"

namespace ibr::app {

struct HtmPlayerOptions {
  bool onSource = false;  // meshes from before they were optimised
  std::size_t ahead = 8;  // frames loaded in the background
  double seconds = 0;     // the first moment that is shown
  bool graph = false;     // the cameras of its model are shown too
};

/// The next frames are loaded while one is drawn; a frame that is not there yet is waited for. One frame is on the
/// device at a time.
class HtmPlayer {
 public:
  /// A model or a sequence. Reads the frame of the first moment, and looks for a device once a picture is asked for.
  /// Throws Error, invalidInput where a mesh from before is asked for and a model keeps none.
  HtmPlayer(const std::filesystem::path& path, const HtmPlayerOptions& options, const Context& context);

  bool isVideo() const { return sequence_ != nullptr; }
  double fps() const { return sequence_ ? sequence_->fps() : 0; }  // of a model: 0
  const HtmModel& model() const { return *model_; }                // of the frame that was shown last
  std::string deviceName() const { return device_ ? device_->name() : std::string(); }

  /// Of the moment; a model is the same at all times. State and `dtSeconds` as HtmPictures::render has them: weights go
  /// on from frame to frame.
  struct Picture : HtmPictures::Picture {
    std::size_t frame = 0;
  };
  Picture render(const Camera& view, double seconds, const HtmSettings& settings, HtmState& state, double dtSeconds);

  /// What a frame cost each time it came, ms.
  struct Shown {
    std::size_t frame = 0;
    std::string name;        // its model's folder
    double loading = 0;      // model and mip levels of pictures from files, of 3D video in the background
    double waiting = 0;      // of that, how long nothing else was done
    double upload = 0;       // onto the device
    double preparation = 0;  // pipelines and targets, of the first frame
    double rendering = 0;    // of all its pictures
    std::size_t pictures = 0;
  };
  const std::vector<Shown>& shown() const { return shown_; }

 private:
  void show(double seconds);
  void take(std::shared_ptr<const HtmFrame> frame);
  void upload();

  std::filesystem::path path_;
  bool onSource_, showsGraph_;
  const Context& context_;
  std::unique_ptr<HtmSequence> sequence_;
  std::shared_ptr<const HtmFrame> frame_;
  std::shared_ptr<const HtmModel> model_;    // frame_'s, or what onSource makes of it
  std::shared_ptr<const HtmModel> stateOf_;  // of the last picture
  std::unique_ptr<Device> device_;
  std::unique_ptr<HtmPictures> pictures_;
  bool uploaded_ = false;  // whether pictures_ show model_
  std::vector<Shown> shown_;
};

}  // namespace ibr::app
