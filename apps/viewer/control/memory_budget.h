// SPDX-License-Identifier: Apache-2.0
// How much of the device's own memory there is for us.
#pragma once

#include <cstdint>
#include <optional>

#include "ibr/device.h"

namespace ibr::app {

struct MemoryBudget {
  std::uint64_t bytes = 0;            // of the device's largest local heap, for this program
  std::optional<std::uint64_t> used;  // of that, by this program, all that drivers need included; where it is known
};

/// By VK_EXT_memory_budget; where the device lacks that, `bytes` is the whole heap.
class MemoryMeter {
 public:
  explicit MemoryMeter(const Device& device);  // which must outlive it

  MemoryBudget read() const;

 private:
  const Device& device_;
  std::uint32_t heap_;
  bool saysBudgets_;
};

}  // namespace ibr::app
