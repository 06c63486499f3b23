// SPDX-License-Identifier: Apache-2.0
// A harmonised model on a device, rendered to images in host memory.
#pragma once

#include <memory>
#include <optional>

#include "ibr/htm.h"
#include "ibr/offscreen.h"
#include "runtime/shared_device.h"

namespace ibr::python {

/// A plan belongs to its model: a renderer of another model refuses it.
struct ModelPlan {
  HtmFramePlan plan;
  std::shared_ptr<const HtmModel> model;
};

/// Functions are thread-safe: they lock the device. They release the interpreter's lock, which the caller has.
class ModelRenderer {
 public:
  /// `source` is called without the interpreter's lock. Throws what it throws, and Error.
  ModelRenderer(std::shared_ptr<const HtmModel> model, const DeviceChoice& device, const HtmImageSource& source,
                std::optional<bool> trilinear);
  ModelRenderer(const ModelRenderer&) = delete;
  ModelRenderer& operator=(const ModelRenderer&) = delete;
  ~ModelRenderer();

  /// `previous`: the frame before, or null. Throws Error{invalidInput} as planHtmFrame, and for another model's plan.
  ModelPlan plan(const Camera& view, const HtmSettings& settings, double dtSeconds, const ModelPlan* previous) const;

  /// Returns an image (RGBA); alpha 0: no camera shows the pixel. Throws Error.
  Image8 image(const ModelPlan& plan);

  const std::shared_ptr<SharedDevice>& device() const { return device_; }

 private:
  std::shared_ptr<const HtmModel> model_;
  HtmBounds bounds_;
  std::shared_ptr<SharedDevice> device_;
  // Destroyed by the destructor, while it locks the device.
  std::optional<GpuHtmModel> gpuModel_;
  std::optional<HtmRenderer> renderer_;
  std::optional<Offscreen> offscreen_;
};

}  // namespace ibr::python
