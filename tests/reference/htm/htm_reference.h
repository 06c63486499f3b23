// SPDX-License-Identifier: Apache-2.0
// Double-precision reference implementation of src/htm and shaders/htm.
#pragma once

#include <vector>

#include "ibr/htm.h"

namespace ibr::test::reference {

/// Eq. 6: displaced texture coordinates in px, indexed [planned camera][vertex].
std::vector<std::vector<glm::dvec2>> harmonise(const HtmModel& model, const HtmFramePlan& plan);

struct HtmReferenceImage {
  int width = 0, height = 0;
  std::vector<glm::dvec4> colour;  // 0 to 1; w: 1 where a surface is shown
  // True if a shift of the images by 1/100 px changes neither the surface at the pixel nor the surfaces that the
  // cameras see there (rasterisers round corners to 1/256 px), and if each camera's visibility is clear.
  std::vector<bool> safe;
};

/// Renders eq. 7 with HtmSettings::method. Samples as a trilinear GpuHtmModel does.
HtmReferenceImage render(const HtmModel& model, const std::vector<HtmImage>& pictures, const HtmFramePlan& plan);

}  // namespace ibr::test::reference
