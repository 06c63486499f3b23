// SPDX-License-Identifier: Apache-2.0
// Template matching on a device as a recorder ([H] Alg. 3), in the caller's command buffer; and as the TemplateSearch
// that is handed to harmonise().
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
#include "ibr/template_search.h"

namespace ibr {

/// Most that a search takes at once, both at least 1.
struct TemplateCapacity {
  std::size_t tasks = 1, samples = 1;
};

/// What absolute differences find is bit for bit what processorTemplateSearch finds; correlations differ by roundings,
/// about 10⁻⁶, and where costs are so close the match may be another one.
///
/// Move-only; the device must outlive it. Used by one thread at a time, with one submission at a time in flight.
class TemplateSearchPass {
 public:
  /// Uploads the pictures, which may go afterwards: submits to the device's queue and waits. Throws Error: invalidInput
  /// as processorTemplateSearch, and for a capacity of 0; unsupported where the pictures, 4 bytes a pixel, or the
  /// capacity exceed the device's largest storage buffer or dispatch; outOfMemory, deviceLost.
  TemplateSearchPass(const Device& device, std::span<const Image8* const> pictures, TemplateCapacity capacity);
  TemplateSearchPass(TemplateSearchPass&&) noexcept;
  TemplateSearchPass& operator=(TemplateSearchPass&&) noexcept;
  ~TemplateSearchPass();

  /// What the next submission of record() looks for; copied to memory that its commands read, so none may be in
  /// flight. Throws Error{invalidInput} as the calls of processorTemplateSearch, and beyond the capacity; what was set
  /// before then stays.
  void set(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
           TemplateMeasure measure);

  /// Copies, one dispatch, copies back to the host, with all barriers between them and to earlier records of this pass.
  /// Outside a render pass; for what was set last, nothing where that is no task.
  void record(VkCommandBuffer commands) const noexcept;

  /// Of the tasks that were set last, in their order, once the submission is done.
  std::vector<TemplateMatch> matches() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A search that uses the device, piece by piece where tasks are many; it submits to the device's queue and waits.
/// Searches that one call of this function leads to may be used from several threads at once: they take turns. Nothing
/// else may use the device meanwhile. Searches are made and go on one thread. They throw what TemplateSearchPass
/// throws. The device must outlive them.
MakeTemplateSearch deviceTemplateSearch(const Device& device);

}  // namespace ibr
