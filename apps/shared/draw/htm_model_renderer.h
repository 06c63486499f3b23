// SPDX-License-Identifier: Apache-2.0
// A harmonised model on a device, and rendering of single images.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "ibr/graph_overlay.h"
#include "ibr/htm.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// Reads a camera's photograph and visibility from their files below `model.folder`. Throws Error.
HtmImage readHtmPicture(const HtmModel& model, std::size_t camera);

class HtmModelRenderer {
 public:
  /// Creates the device of --device. Each image is read by `source`, readHtmPicture except in tests. The model
  /// must outlive this object.
  HtmModelRenderer(const HtmModel& model, const Context& context, const HtmImageSource& source = readHtmPicture);
  /// Uses an existing device, which must outlive this object, for models that are compared with each other.
  HtmModelRenderer(const HtmModel& model, Device& device, const HtmImageSource& source = readHtmPicture);

  /// Replaces the model by GpuHtmModel::replace; the new model must outlive this object. After an exception only show()
  /// may be called.
  void show(const HtmModel& model, const HtmImageSource& source = readHtmPicture);

  /// Images rendered from here on also show the cameras of the current model.
  void showGraph();

  struct Picture {
    Image8 image;              // RGBA; alpha: covered (HtmRenderer::record)
    double preparation = 0;    // creation of missing pipelines and targets, ms
    double weights = 0;        // [H] eq. 5, CPU time, ms
    double coordinates = 0;    // [H] eq. 6, device time, ms
    double rasterisation = 0;  // [H] eq. 7, device time, ms
    double milliseconds = 0;   // from planning until the image is on the host, without preparation
  };
  /// Renders an image of any size. `state` comes from the previous image of the same walk, `dtSeconds` is the time
  /// since. Single images take {} and 0.
  Picture render(const Camera& view, const HtmSettings& settings, HtmPlanState& state, double dtSeconds = 0);
  Picture render(const Camera& view, const HtmSettings& settings) {
    HtmPlanState state;
    return render(view, settings, state);
  }

  Device& device() { return *device_; }
  const HtmModel& model() const { return *model_; }
  GpuHtmModel::Memory memory() const { return gpuModel_.memory(); }

 private:
  HtmModelRenderer(const HtmModel& model, std::unique_ptr<Device> owned, Device* device, const HtmImageSource& source);
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
