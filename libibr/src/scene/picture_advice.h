// SPDX-License-Identifier: Apache-2.0
// What the pictures themselves say: exposure and sharpness beside their neighbours'.
#pragma once

#include <vector>

#include "ibr/advice.h"

namespace ibr {

/// Looks at the textures of the scene's folder, at 512 px or less for exposure and 1600 px or less for sharpness; nodes
/// whose texture cannot be read are passed over, as are all of a scene without a folder.
///   exposure   photographs that share a cell show the same at its vertices: the median ratio of their luminance in
///              linear light, in stops, solved for one figure a photograph (least squares, relaxed)
///   sharpness  (image/sharpness.h) beside the median of the photographs in its cells
std::vector<Advice> pictureAdvice(const Scene& scene);

}  // namespace ibr
