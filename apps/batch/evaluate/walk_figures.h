// SPDX-License-Identifier: Apache-2.0
// How steady and how whole a walk is, from its frames.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batch/evaluate/eye_agreement.h"
#include "ibr/scene.h"
#include "shared/report/table.h"

namespace ibr::app {

inline constexpr int kTierCount = kTierFilled + 1;

struct WalkFrame {
  std::string name;
  std::int64_t mainCell = -1;
  bool switching = false;  // between a switch of the main cell and the end of its mixture
  double step = NAN;       // mean absolute difference from the frame before, levels; NaN for the first
  double flipStep = NAN;   // likewise as FLIP, where asked for
  double coverage = 0;
  double coverageInside = NAN;  // of the pixels that some photograph sees; NaN where none does
  std::array<double, kTierCount> tier{};
  int flicker = -1;  // largest difference, levels, between pictures of a camera that holds still here; -1: it did not
  std::optional<EyeAgreement> eyes;  // of two
};

/// NaN where nothing was measured.
struct WalkSummary {
  std::size_t switches = 0;
  double medianStep = NAN, largestStep = NAN, largestStepAtSwitch = NAN;
  double medianFlipStep = NAN, pop = NAN;  // the latter: the largest FLIP step at a switch (NUMERICS §5.2)
  double leastCoverage = 1, leastCoverageInside = NAN, meanCoverageInside = NAN;
  std::array<double, kTierCount> tier{};
  int flicker = -1;              // the largest
  std::size_t flickerFrame = 0;  // the first frame that has it; meaningless where none was held
  std::string flickerAt;         // that frame's name
  EyeAgreement eyes;             // means
};

WalkSummary summaryOf(const std::vector<WalkFrame>& frames);

nlohmann::ordered_json frameJson(const WalkFrame& frame);
nlohmann::ordered_json summaryJson(const WalkSummary& summary);

/// Rows for what was measured.
Table summaryTable(const WalkSummary& summary, std::size_t frames);

}  // namespace ibr::app
