// SPDX-License-Identifier: Apache-2.0
// Template matching on a device ([H] Alg. 3): as a recorder into the caller's command buffer, and as the TemplateSearch
// for harmonise().
//
//   TemplateSearchPass pass(device, pictures, {.tasks = 1000, .samples = 500000});
//   pass.set(tasks, samples, radius, measure);
//   pass.record(commands);   … the caller submits and waits …
//   pass.matches()
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/template_search.h"
#include "ibr/uploads.h"

namespace ibr {

/// Maximum numbers per TemplateSearchPass::set, both at least 1.
struct TemplateCapacity {
  std::size_t tasks = 1, samples = 1;  // tasks: number of tasks; samples: number of samples of all tasks together
};

/// Records searches. Move-only; the device must outlive it. One thread at a time uses it, with at most one submission
/// in flight.
///
/// With absolute differences, matches are bit-identical to those of cpuTemplateSearch. Correlations differ by
/// rounding, about 10⁻⁶; where costs are that close, another match may win.
class IBR_API TemplateSearchPass {
 public:
  /// Uploads the pictures, which need not outlive the call: submits to the device's queue and waits, unless `uploads`
  /// collect the uploads. Throws Error: invalidInput as cpuTemplateSearch, and for a capacity of 0; unsupported where
  /// the pictures (4 bytes a pixel) or the capacity exceed the device's largest storage buffer or dispatch;
  /// outOfMemory, deviceLost.
  TemplateSearchPass(const Device& device, std::span<const Image8* const> pictures, TemplateCapacity capacity,
                     Uploads* uploads = nullptr);
  TemplateSearchPass(TemplateSearchPass&&) noexcept;
  TemplateSearchPass& operator=(TemplateSearchPass&&) noexcept;
  ~TemplateSearchPass();  // frees device memory; does not wait

  /// Sets the tasks of the next submission of record(). Copies them to memory that the recorded commands read, so none
  /// of these may be in flight. Throws Error{invalidInput} as calls of cpuTemplateSearch, and beyond the
  /// capacity; then the previous tasks stay set.
  void set(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
           TemplateMeasure measure);

  /// Records the search for the tasks set last, outside a render pass: upload copies, one dispatch, a readback copy.
  /// Barriers separate these, and order them after earlier commands of this pass. Records nothing if no tasks are set.
  void record(VkCommandBuffer commands) const noexcept;

  /// Returns the matches of the tasks set last, in their order; valid once the submission has finished.
  std::vector<TemplateMatch> matches() const;

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

/// Search on the device. Submits to the device's queue and waits; many tasks are split into several submissions.
/// Several threads may call the searches made by one returned function; they take turns. Nothing else may use the
/// device meanwhile. One thread must make and destroy the searches. They throw what TemplateSearchPass throws. The
/// device must outlive them.
IBR_API TemplateSearchFactory deviceTemplateSearch(const Device& device);

}  // namespace ibr
