// SPDX-License-Identifier: Apache-2.0
// The pinhole images in which a scene's depth is found: its photographs, and the faces of its panoramas.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

struct DepthView {
  std::uint32_t node = 0;  // the photograph
  bool isFace = false;     // of a panorama
  Camera camera;           // at the photograph's stored size
};

/// Views in the order of the photographs; a panorama contributes its depthFaces() in their order.
std::vector<DepthView> depthViews(std::span<const Camera> photographs);

}  // namespace ibr
