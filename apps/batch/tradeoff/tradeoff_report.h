// SPDX-License-Identifier: Apache-2.0
// Results of `ibr tradeoff`, as tradeoff.json (libibr/schemas/tradeoff.schema.json) and as a table.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_gates.h"
#include "batch/tradeoff/tradeoff_histogram.h"
#include "batch/tradeoff/tradeoff_implementation.h"
#include "batch/tradeoff/tradeoff_result.h"
#include "batch/tradeoff/tradeoff_walk.h"

namespace ibr::app {

struct TradeoffReport {
  std::vector<TradeoffRow> rows;  // the first four are the presets
  std::vector<TradeoffKnob> knobs;
  std::vector<TradeoffWalk> walks;                                  // of the presets; may be empty
  std::vector<ImplementationError> implementation;                  // of some views
  double sampledDetail = std::numeric_limits<double>::quiet_NaN();  // of the truth (ibr/metrics.h); NaN: no truth
  std::vector<MapError> mapErrors;                                  // of a photograph of the scene
  nlohmann::ordered_json about;      // "version", "scene", "device" and all other values common to all rows
  std::vector<std::string> missing;  // knobs that were not measured, with the reasons

  std::vector<TradeoffGate> gates() const;
};

nlohmann::ordered_json reportJson(const TradeoffReport& report);

/// Returns the tables of settings, the front, the walks and the gates, for people.
std::string reportText(const TradeoffReport& report);

}  // namespace ibr::app
