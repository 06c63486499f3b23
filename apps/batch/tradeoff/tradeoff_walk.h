// SPDX-License-Identifier: Apache-2.0
// Steadiness and coverage of presets at changes of the main cell, on a walk in small steps: differences between frames
// come from the change rather than from motion. Only frames around changes are drawn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_gates.h"
#include "batch/tradeoff/tradeoff_renderer.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

struct TradeoffWalk {
  std::string preset;
  std::size_t frames = 0, drawn = 0;  // frames of the path; drawn: those around changes
  std::size_t switches = 0;           // changes of the main cell along the path
  // Mean absolute differences of neighbouring frames, 8-bit levels: median in motion without a change; maximum in a
  // change. NaN: none.
  double medianStep = 0, switchStep = 0;
  double pop = 0;              // maximum FLIP of neighbouring frames
  std::size_t holePixels = 0;  // maximum of a frame, of every eighth pixel in x and y that some photograph sees
};

/// Measures a walk of views 1/60 s apart. `step` is called before each drawn frame and may throw.
TradeoffWalk measureWalk(TradeoffRenderer& stage, const std::string& preset, const TradeoffVariant& variant,
                         const std::vector<View>& walk, const std::function<void()>& step);

/// Checks that there are no holes, and that a change is at most 1.5 times the median step. Each preset's gradient
/// energy must be at least 0.9 of `sampledDetail` (the truth resampled between pixels, ibr/metrics.h; less is blur)
/// and at most 1.1 of the truth's (more is ghosting).
std::vector<TradeoffGate> walkGates(const std::vector<TradeoffWalk>& walks, const std::vector<TradeoffRow>& rows,
                                    double sampledDetail);

nlohmann::ordered_json walkJson(const TradeoffWalk& walk);
/// Reads walkJson's output. Throws nlohmann::json::exception for other input.
TradeoffWalk walkOf(const nlohmann::ordered_json& json);

}  // namespace ibr::app
