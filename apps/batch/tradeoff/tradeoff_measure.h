// SPDX-License-Identifier: Apache-2.0
// Measures settings of a place: pictures of each once, then times, round by round over all of them, so that a machine
// whose speed drifts favours none. What was measured is kept and not measured again.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "batch/files/kept_lines.h"
#include "batch/tradeoff/tradeoff_result.h"
#include "batch/tradeoff/tradeoff_stage.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// A view, and as it really looks, where that is known: RGB of its size, else empty.
struct TradeoffSubject {
  View view;
  Image8 truth;
};

struct TradeoffPlan {
  int repeat = 9;          // rounds
  std::uint64_t seed = 1;  // of the order of settings in a round
  std::uint64_t key = 0;   // of all else that figures depend on
};

class TradeoffMeasure {
 public:
  TradeoffMeasure(TradeoffStage& stage, const std::vector<TradeoffSubject>& subjects, const TradeoffPlan& plan,
                  KeptLines& kept);

  /// A row a setting. Rows whose `failure` is empty have views and times; a setting that a device cannot draw, or has
  /// not the memory for, says so. `step` is called with (done, of all) and may throw.
  std::vector<TradeoffRow> measure(const std::vector<TradeoffSetting>& settings,
                                   const std::function<void(std::size_t, std::size_t)>& step);

  /// How many pictures' rows and rounds were kept from before.
  std::size_t found() const { return found_; }

 private:
  void look(TradeoffRow& row);
  void timeRound(std::vector<TradeoffRow>& rows, int round);
  const std::vector<Image8>& references();
  std::uint64_t keyOf(const std::string& what) const;

  TradeoffStage& stage_;
  const std::vector<TradeoffSubject>& subjects_;
  TradeoffPlan plan_;
  KeptLines& kept_;
  std::vector<Image8> references_;
  std::size_t found_ = 0;
  bool warm_ = false;
};

}  // namespace ibr::app
