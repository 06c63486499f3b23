// SPDX-License-Identifier: Apache-2.0
// What settings cost and what they show, measured where the view stands: each preset, and the settings as they are,
// against the reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "ibr/renderer.h"

namespace ibr::app {

class PlaceOnDevice;
struct OpenItem;

inline constexpr const char* kAsSet = "as set";  // the settings as they are

struct Effect {
  struct Measured {
    double milliseconds = 0;  // of a frame on the device
    double psnr = 0;          // dB, against the reference's picture; infinite where they are the same
  };
  const char* name;
  RenderSettings settings;
  std::optional<Measured> measured;
};

struct Effects {
  Camera view;
  std::vector<Effect> lines;  // from the fastest preset to the reference, then the settings as they are
  Image8 reference;

  bool done() const;
};

/// Of a scene's view; nothing is measured yet.
Effects effectsOf(const OpenItem& place, VkExtent2D extent, DeviceKind kind);

/// Measures the next line. Waits for the device. Throws Error.
void measureNext(Effects& effects, PlaceOnDevice& place, std::uint64_t& frame);

/// "12.3 ms, 38.1 dB", or that it is still to come.
std::string text(const Effect& effect);

}  // namespace ibr::app
