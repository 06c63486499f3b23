// SPDX-License-Identifier: Apache-2.0
// The twin of src/htm and shaders/htm in double precision.
#pragma once

#include <vector>

#include "ibr/htm.h"

namespace ibr::test::reference {

/// Eq. 6: px, [planned camera][vertex].
std::vector<std::vector<glm::dvec2>> harmonise(const HtmModel& model, const HtmFramePlan& plan);

struct HtmTwin {
  int width = 0, height = 0;
  std::vector<glm::dvec4> colour;  // 0 to 1; w: 1 where something is shown
  // What the pixel and the cameras that count see there is the same when pictures are shifted by a hundredth of a pixel
  // (rasterisers round corners to 1/256), and is clearly seen or clearly not.
  std::vector<bool> safe;
};

/// Eq. 7, by HtmSettings::method, sampling as a trilinear GpuHtmModel does.
HtmTwin render(const HtmModel& model, const std::vector<HtmPicture>& pictures, const HtmFramePlan& plan);

}  // namespace ibr::test::reference
