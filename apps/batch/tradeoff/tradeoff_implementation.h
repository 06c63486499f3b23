// SPDX-License-Identifier: Apache-2.0
// Third kind of accuracy: the device's image against the double-precision reference implementation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_renderer.h"
#include "ibr/author/reference.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// The error of one view.
struct ImplementationError : ReferenceDifference {
  std::string name;  // of the view
};

/// Measures errors with default-constructed RenderSettings and trilinear filters, as the reference implementation has.
/// `step` is called before each view and may throw.
std::vector<ImplementationError> implementationErrors(TradeoffRenderer& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step);

}  // namespace ibr::app
