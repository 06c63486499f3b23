// SPDX-License-Identifier: Apache-2.0
// Cost and quality of settings, measured at the current view. Each preset and the current settings are compared with
// the reference preset.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "ibr/renderer.h"

namespace ibr::app {

class ItemOnDevice;
struct OpenItem;

inline constexpr const char* kCurrentSettingsName = "as set";  // name of the line with the current settings

struct ComparedSettings {
  struct Measured {
    double milliseconds = 0;  // of a frame on the device
    double psnr = 0;          // dB, against the reference's image; infinite if identical
  };
  const char* name;
  RenderSettings settings;
  std::optional<Measured> measured;
};

struct SettingsComparison {
  Camera view;
  std::vector<ComparedSettings> lines;  // from the fastest preset to the reference, then the current settings
  Image8 reference;

  bool done() const;
};

/// Prepares the lines for the current view of a scene; measures nothing.
SettingsComparison comparisonOf(const OpenItem& item, VkExtent2D extent, DeviceKind kind);

/// Measures the next line. Waits for the device. Throws Error.
void measureNext(SettingsComparison& comparison, ItemOnDevice& item, std::uint64_t& frame);

/// Returns "12.3 ms, 38.1 dB", or a text for a line that is not measured yet.
std::string text(const ComparedSettings& effect);

}  // namespace ibr::app
