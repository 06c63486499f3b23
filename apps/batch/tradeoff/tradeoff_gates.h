// SPDX-License-Identifier: Apache-2.0
// Requirements on the presets, checked against the measurements.
#pragma once

#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_result.h"

namespace ibr::app {

inline constexpr double kDominance = 0.03;      // minimum share by which a setting must be better to beat a preset
inline constexpr double kAccurateShare = 0.99;  // minimum PSNR of `accurate`, share of that of `reference`
inline constexpr double kFastShare = 1.25;      // maximum error of `fast`, share of that of `balanced`

struct TradeoffGate {
  std::string name;
  bool holds;
  std::string found;  // figures, or names of the settings that beat the preset
  bool counted;       // true: depends on counts and images alone, so the result is the same on a busy machine
};

/// Checks that no setting beats a preset in time and error, or in counts and error. Further: `accurate` is nearly as
/// good as `reference`, `fast` not much worse than `balanced`. From preset to preset times rise, unless costs are
/// equal, and errors fall. Precondition: the first four rows are the presets. Rows that failed, have two views or
/// another build are ignored.
std::vector<TradeoffGate> presetGates(const std::vector<TradeoffRow>& rows);

/// True if `other` has at most the row's draws, triangles, drawn pixels and bytes. One of these, and the error, must be
/// less by more than kDominance.
bool dominatesInCounts(const TradeoffRow& other, const TradeoffRow& row);

/// Returns the indices of the Pareto front of time and error, by increasing time.
std::vector<std::size_t> timeFront(const std::vector<TradeoffRow>& rows);

}  // namespace ibr::app
