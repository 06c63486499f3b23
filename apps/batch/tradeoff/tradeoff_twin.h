// SPDX-License-Identifier: Apache-2.0
// Third kind of accuracy: the device's image against the double-precision reference implementation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_stage.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Statistics over the pixels that show one tier of one cell with all their neighbours, and lie on no triangle's edge:
/// on other pixels rasterisation may differ (reference::isCertain).
struct ImplementationError {
  std::string name;       // of the view
  double compared = 0;    // share of the image's pixels
  double meanLevels = 0;  // over R, G, B, 8-bit levels; NaN if nothing is compared
  double largestLevels = 0;
  double beyondBound = 0;  // share of the values with errors above the bound from the texture filter's precision
};

/// Measures errors with default-constructed RenderSettings and trilinear filters, as the reference implementation has.
/// `step` is called before each view and may throw.
std::vector<ImplementationError> implementationErrors(TradeoffStage& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step);

}  // namespace ibr::app
