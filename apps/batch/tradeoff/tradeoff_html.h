// SPDX-License-Identifier: Apache-2.0
// report.html of `ibr tradeoff`: a single file without external files or scripts.
#pragma once

#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_figures.h"

namespace ibr::app {

/// The view with a preset's largest error.
struct WorstView {
  std::string preset, view;
  double flip;
  Image8 picture, truth, difference;  // RGB, equal sizes; difference: by FLIP
};

/// Returns the FLIP differences as colours: black (none), red, yellow, white. RGB.
Image8 flipPicture(const Image8& picture, const Image8& truth);

/// `scratch`: a writable folder. Throws Error{io}.
std::string tradeoffHtml(const TradeoffReport& report, const std::vector<TradeoffFigure>& figures,
                         const std::vector<WorstView>& worst, const std::filesystem::path& scratch);

}  // namespace ibr::app
