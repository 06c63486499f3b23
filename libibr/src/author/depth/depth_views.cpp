// SPDX-License-Identifier: Apache-2.0
#include "author/depth/depth_views.h"

#include "author/depth/panorama_depth.h"

namespace ibr {

std::vector<DepthView> depthViews(std::span<const Camera> photographs) {
  std::vector<DepthView> views;
  for (std::uint32_t n = 0; n < photographs.size(); ++n) {
    if (photographs[n].intrinsics.model != CameraModel::equirectangular) {
      views.push_back({n, false, photographs[n]});
    } else {
      for (const Camera& face : depthFaces(photographs[n])) views.push_back({n, true, face});
    }
  }
  return views;
}

}  // namespace ibr
