// SPDX-License-Identifier: Apache-2.0
// What presets promise (NUMERICS §5.5, P11), checked on what was measured.
#pragma once

#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_result.h"

namespace ibr::app {

inline constexpr double kDominance = 0.03;      // a preset is beaten by more than this share in both axes
inline constexpr double kAccurateShare = 0.99;  // of the PSNR of `reference` that `accurate` has at least
inline constexpr double kFastShare = 1.25;      // of the error of `balanced` that `fast` has at most

struct TradeoffGate {
  std::string name;
  bool holds;
  std::string found;  // figures, or who beats whom
  bool counted;       // it depends on counts and pictures alone: the same on a machine that is busy
};

/// No preset is beaten in time and error by a setting of the sweep; `accurate` is nearly `reference`, `fast` not
/// much worse than `balanced`; presets rise in time, unless they draw the same, and fall in error; and the same with
/// counts in the place of times. Precondition: the first four rows are the presets. Rows that failed, of two views, or
/// of another build take no part.
std::vector<TradeoffGate> presetGates(const std::vector<TradeoffRow>& rows);

/// Whether `other` costs no more in draws, triangles, pixels that are drawn and bytes, each by itself, and in one of
/// them less, and shows more, both by more than kDominance.
bool beatsInCounts(const TradeoffRow& other, const TradeoffRow& row);

/// The Pareto front of time and error, by rising time: indices of rows that take part.
std::vector<std::size_t> timeFront(const std::vector<TradeoffRow>& rows);

}  // namespace ibr::app
