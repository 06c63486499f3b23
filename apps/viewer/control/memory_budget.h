// SPDX-License-Identifier: Apache-2.0
// Device memory available to this program.
#pragma once

#include <cstdint>
#include <optional>

#include "ibr/device.h"

namespace ibr::app {

struct MemoryBudget {
  std::uint64_t bytes = 0;            // of the device's largest local heap, for this program
  std::optional<std::uint64_t> used;  // used by this program, driver overhead included; nullopt: unknown
};

/// Reads VK_EXT_memory_budget. Without the extension, `bytes` is the size of the whole heap.
class MemoryMeter {
 public:
  explicit MemoryMeter(const Device& device);  // `device` must outlive the meter

  MemoryBudget read() const;

 private:
  const Device& device_;
  std::uint32_t heap_;
  bool reportsBudgets_;
};

}  // namespace ibr::app
