// SPDX-License-Identifier: Apache-2.0
// Figures of `ibr tradeoff` as SVG drawings.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_report.h"

namespace ibr::app {

struct TradeoffFigure {
  std::string file;     // "pareto.svg"
  std::string caption;  // description, for people
  std::string svg;
};

/// Draws time against error, knobs, memory against PSNR, passes, and if known the optimiser and colour tables.
/// `sweep`: report of `ibr-lab sweep`, or null; settings without the needed values are left out.
std::vector<TradeoffFigure> tradeoffFigures(const TradeoffReport& report, const nlohmann::ordered_json& sweep);

}  // namespace ibr::app
