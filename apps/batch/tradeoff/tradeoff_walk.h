// SPDX-License-Identifier: Apache-2.0
// How steady presets are where the main cell changes, and how whole: a walk in steps so small that what is seen between
// two frames is the change, not the motion. Only frames around the changes are drawn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_gates.h"
#include "batch/tradeoff/tradeoff_stage.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

struct TradeoffWalk {
  std::string preset;
  std::size_t frames = 0, drawn = 0;  // of the path; those around changes
  std::size_t switches = 0;           // of the main cell, along the path
  // Mean absolute difference of neighbouring frames, levels: median of those in motion alone, largest in a change. NaN:
  // there was none.
  double medianStep = 0, switchStep = 0;
  double pop = 0;              // largest FLIP of neighbouring frames
  std::size_t holePixels = 0;  // of a frame at most, of one in 8×8 of those that some photograph sees
};

/// `walk`: views 1/60 s apart. `step` is called before each frame that is drawn and may throw.
TradeoffWalk walkThrough(TradeoffStage& stage, const std::string& preset, const TradeoffWay& way,
                         const std::vector<View>& walk, const std::function<void()>& step);

/// Holes 0, a change at most 1.5 times the median step, and of each preset the gradient energy of its pictures against
/// the truth's: neither blur beyond that of reading the truth itself between its pixels (`sampledDetail`,
/// ibr/metrics.h), nor edges of ghosts.
std::vector<TradeoffGate> walkGates(const std::vector<TradeoffWalk>& walks, const std::vector<TradeoffRow>& rows,
                                    double sampledDetail);

nlohmann::ordered_json walkJson(const TradeoffWalk& walk);
/// Throws nlohmann::json::exception for what walkJson did not write.
TradeoffWalk walkOf(const nlohmann::ordered_json& json);

}  // namespace ibr::app
