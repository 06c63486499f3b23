// SPDX-License-Identifier: Apache-2.0
// report.html of `ibr tradeoff`: one file that needs no other and no scripts.
#pragma once

#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_figures.h"

namespace ibr::app {

/// The view that a preset shows worst.
struct WorstView {
  std::string preset, view;
  double flip;
  Image8 picture, truth, difference;  // RGB of one size; the difference as FLIP sees it
};

/// Where FLIP sees a difference: black none, over red and yellow to white. RGB.
Image8 flipPicture(const Image8& picture, const Image8& truth);

/// `scratch`: a folder that may be written to. Throws Error{io}.
std::string tradeoffHtml(const TradeoffReport& report, const std::vector<TradeoffFigure>& figures,
                         const std::vector<WorstView>& worst, const std::filesystem::path& scratch);

}  // namespace ibr::app
