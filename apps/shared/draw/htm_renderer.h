// SPDX-License-Identifier: Apache-2.0
// A harmonised model on a device, and single pictures of it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gpu/draw/scope.h"
#include "ibr/graph_overlay.h"
#include "ibr/htm.h"
#include "ibr/offscreen.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// The photograph and the visibility of a camera, read from their files below `model.folder`. Throws Error.
HtmPicture readHtmPicture(const HtmModel& model, std::size_t camera);

class HtmPictures {
 public:
  /// The device that --device names. Reads every picture by `source`, which is readHtmPicture but in tests. The model
  /// must outlive it.
  HtmPictures(const HtmModel& model, const Context& context, const HtmPictureSource& source = readHtmPicture);
  /// The same on a device that is there already and outlives it: for models to compare with.
  HtmPictures(const HtmModel& model, Device& device, const HtmPictureSource& source = readHtmPicture);

  /// Another model in the place of this one, by GpuHtmModel::replace; it must outlive this too. After an exception
  /// nothing but show() may follow.
  void show(const HtmModel& model, const HtmPictureSource& source = readHtmPicture);

  /// Pictures from now on show the cameras as well, as they were in the model of this moment.
  void showGraph();

  struct Picture {
    Image8 image;              // RGBA; alpha: covered (HtmRenderer::record)
    double preparation = 0;    // pipelines and targets that were not there yet, ms
    double weights = 0;        // eq. 5, ms of the processor
    double coordinates = 0;    // eq. 6, ms of the device
    double rasterisation = 0;  // eq. 7, likewise
    double milliseconds = 0;   // from planning until the picture is on the host, without preparation
  };
  /// Of any size. `state` is that of the last picture of the same walk, `dtSeconds` the time since; {} and 0 for a
  /// picture by itself.
  Picture render(const Camera& view, const HtmSettings& settings, HtmState& state, double dtSeconds = 0);
  Picture render(const Camera& view, const HtmSettings& settings) {
    HtmState state;
    return render(view, settings, state);
  }

  Device& device() { return *device_; }
  const HtmModel& model() const { return *model_; }
  GpuHtmModel::Memory memory() const { return gpuModel_.memory(); }

 private:
  HtmPictures(const HtmModel& model, std::unique_ptr<Device> owned, Device* device, const HtmPictureSource& source);
  void prepare(const Intrinsics& intrinsics);

  const HtmModel* model_;
  HtmBounds bounds_;
  std::unique_ptr<Device> owned_;
  Device* device_;
  GpuHtmModel gpuModel_;
  ScopeTimer timer_;
  std::optional<GraphOverlay> graph_;
  std::optional<HtmRenderer> renderer_;
  std::optional<Offscreen> offscreen_;
};

}  // namespace ibr::app
