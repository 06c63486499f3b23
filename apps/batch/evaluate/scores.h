// SPDX-License-Identifier: Apache-2.0
// Scores of a rendered view against the truth, and their reports. NaN: not measured, or undefined.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "ibr/view_scores.h"

namespace ibr::app {

struct Scores : ViewScores {
  Scores();                                     // all NaN
  double guessed;                               // share of pixels with completed or filled depth, or empty
  double rightDepth, tooFar, tooNear;           // depth_scores.h
  double withinDeviation, withinTwoDeviations;  // depth_scores.h
  double seam, seamDeltaE, deltaE;              // colour_scores.h
  double misaligned,
      misaligned95;  // px between cells that show the same point (render/plan/cell_alignment.h): median, 95 %
  double uncorrected, uncorrected95;  // the same without alignment of the cells
  double milliseconds;
};

/// scoreView (ibr/view_scores.h). The caller sets the scores that Scores adds.
Scores score(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used = {});

/// Returns each score under its name.
nlohmann::ordered_json scoresJson(const Scores& scores);

/// Reads scoresJson's output; missing and null scores become NaN.
Scores scoresOf(const nlohmann::ordered_json& json);

/// Returns the means over the views that have the score: a view without covered pixels has no psnrCovered.
Scores meanOf(const std::vector<Scores>& all);

/// Returns the columns of a table; columns of gains only if requested.
std::vector<std::string> scoresHeading(const std::string& first, bool withGain);
std::vector<std::string> scoresRow(const std::string& name, const Scores& scores, bool withGain);

}  // namespace ibr::app
