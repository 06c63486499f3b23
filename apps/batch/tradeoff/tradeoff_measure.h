// SPDX-License-Identifier: Apache-2.0
// Measures settings on a scene: images of each setting once, then times in rounds over all settings, so that a change
// of the machine's speed favours none. Measurements are cached.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "batch/files/measurement_cache.h"
#include "batch/tradeoff/tradeoff_renderer.h"
#include "batch/tradeoff/tradeoff_result.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// A view with its photograph, if known: RGB of the view's size, else empty.
struct TradeoffSubject {
  View view;
  Image8 truth;
};

struct TradeoffPlan {
  int repeat = 9;          // rounds
  std::uint64_t seed = 1;  // of the order of settings in a round
  std::uint64_t key = 0;   // of all other inputs of the measurements
};

class TradeoffMeasure {
 public:
  TradeoffMeasure(TradeoffRenderer& stage, const std::vector<TradeoffSubject>& subjects, const TradeoffPlan& plan,
                  MeasurementCache& cache);

  /// Returns one row for each setting. Rows with an empty `failure` have views and times; `failure` is set if the
  /// device cannot draw a setting or lacks memory. `step` is called with (done, total) and may throw.
  std::vector<TradeoffRow> measure(const std::vector<TradeoffSetting>& settings,
                                   const std::function<void(std::size_t, std::size_t)>& step);

  /// Returns the number of cached image rows and rounds.
  std::size_t found() const { return found_; }

 private:
  void renderViews(TradeoffRow& row);
  void timeRound(std::vector<TradeoffRow>& rows, int round);
  const std::vector<Image8>& references();
  std::uint64_t keyOf(const std::string& what) const;

  TradeoffRenderer& stage_;
  const std::vector<TradeoffSubject>& subjects_;
  TradeoffPlan plan_;
  MeasurementCache& cache_;
  std::vector<Image8> references_;
  std::size_t found_ = 0;
  bool warm_ = false;
};

}  // namespace ibr::app
