// SPDX-License-Identifier: Apache-2.0
// Everything that `ibr tradeoff` found, as tradeoff.json (libibr/schemas/tradeoff.schema.json) and as a table.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_gates.h"
#include "batch/tradeoff/tradeoff_histogram.h"
#include "batch/tradeoff/tradeoff_result.h"
#include "batch/tradeoff/tradeoff_twin.h"
#include "batch/tradeoff/tradeoff_walk.h"

namespace ibr::app {

struct TradeoffReport {
  std::vector<TradeoffRow> rows;  // the first four are the presets
  std::vector<TradeoffKnob> knobs;
  std::vector<TradeoffWalk> walks;                                  // of the presets, or none
  std::vector<ImplementationError> implementation;                  // of some views
  double sampledDetail = std::numeric_limits<double>::quiet_NaN();  // of the truth (ibr/metrics.h); NaN: there is none
  std::vector<MapError> mapErrors;                                  // of a photograph of the scene
  nlohmann::ordered_json about;      // "version", "scene", "device" and all else that is one for all rows
  std::vector<std::string> missing;  // knobs of NUMERICS §5.4 that were not measured, and why

  std::vector<TradeoffGate> gates() const;
};

std::string reportJson(const TradeoffReport& report);

/// The table of settings, the front, the walks and the gates, for people.
std::string reportText(const TradeoffReport& report);

}  // namespace ibr::app
