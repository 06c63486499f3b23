// SPDX-License-Identifier: Apache-2.0
// A screenshot between the frame that it shows and the file.
#pragma once

#include <array>
#include <optional>

#include "shared/camera/up.h"
#include "vr/headset/eye_capture.h"
#include "vr/show/vr_app.h"

namespace ibr::app {

struct VrApp::Capture {
  explicit Capture(const Device& device) : images(device) {}

  EyeCapture images;
  bool isQueued = false;  // the writer has the capture
  bool required = false;  // VrOptions::screenshot
  std::array<Camera, 2> eyes;
  RenderSettings settings;
  std::optional<FloorOptions> floor;
};

}  // namespace ibr::app
