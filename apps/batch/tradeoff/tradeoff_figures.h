// SPDX-License-Identifier: Apache-2.0
// The figures of `ibr tradeoff` (NUMERICS §5.5), as drawings (SVG).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_report.h"

namespace ibr::app {

struct TradeoffFigure {
  std::string file;     // "pareto.svg"
  std::string caption;  // what is seen, for people
  std::string svg;
};

/// Time against error, knobs, memory against PSNR, passes and, where they are known, the optimiser and colour tables.
/// `sweep`: what `ibr sweep` reported, or null; settings of it that lack a figure are left out.
std::vector<TradeoffFigure> tradeoffFigures(const TradeoffReport& report, const nlohmann::json& sweep);

}  // namespace ibr::app
