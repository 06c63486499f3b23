// SPDX-License-Identifier: Apache-2.0
// Steadiness and coverage of a walk, from its frames.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
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
  bool switching = false;  // true between a switch of the main cell and the end of the cross-fade
  double step = NAN;       // mean absolute difference from the previous frame, 8-bit levels; NaN for the first
  double flipStep = NAN;   // the same as FLIP, if requested
  double coverage = 0;
  double coverageInside = NAN;  // of the pixels that some photograph sees; NaN if there are none
  std::array<double, kTierCount> tier{};
  int flicker = -1;  // maximum difference between images of a still camera at this frame, 8-bit levels; -1: not held
  std::optional<EyeAgreement> eyes;  // with two views
};

/// Summary of a walk. NaN: nothing was measured.
struct WalkSummary {
  std::size_t switches = 0;
  double medianStep = NAN, maxStep = NAN, maxStepAtSwitch = NAN;
  double medianFlipStep = NAN, pop = NAN;  // pop: largest FLIP step at a switch
  double minCoverage = 1, minCoverageInside = NAN, meanCoverageInside = NAN;
  std::array<double, kTierCount> tier{};
  int flicker = -1;              // maximum
  std::size_t flickerFrame = 0;  // first frame that has it; undefined if the camera was never held
  std::string flickerAt;         // name of this frame
  EyeAgreement eyes;             // means
};

WalkSummary summaryOf(const std::vector<WalkFrame>& frames);

nlohmann::ordered_json frameJson(const WalkFrame& frame);
nlohmann::ordered_json summaryJson(const WalkSummary& summary);

/// Returns rows for the measured figures.
Table summaryTable(const WalkSummary& summary, std::size_t frames);

}  // namespace ibr::app
