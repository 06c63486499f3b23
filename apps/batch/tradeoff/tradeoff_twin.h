// SPDX-License-Identifier: Apache-2.0
// The third kind of accuracy (NUMERICS §5.3 C): what a device makes of a picture, against the same in double precision.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_stage.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Over the pixels that show one tier of one cell with all their neighbours, and lie on no triangle's edge: elsewhere
/// rasterisation may differ (reference::isCertain).
struct ImplementationError {
  std::string name;       // of the view
  double compared = 0;    // share of the picture's pixels
  double meanLevels = 0;  // over R, G, B of 255; NaN where nothing is compared
  double largestLevels = 0;
  double beyondBound = 0;  // share of the values further off than the device's texture filter allows (NUMERICS §6 b)
};

/// Of the default settings, sampled with trilinear filters, which is what the twin does. `step` is called before each
/// view and may throw.
std::vector<ImplementationError> implementationErrors(TradeoffStage& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step);

}  // namespace ibr::app
