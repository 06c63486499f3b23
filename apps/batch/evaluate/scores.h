// SPDX-License-Identifier: Apache-2.0
// Figures of a rendered view against the truth, and how they are reported. NaN: not measured, or there is none.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "ibr/metrics.h"

namespace ibr::app {

struct Scores {
  Scores();  // nothing measured
  double psnr, ssim, flip, coverage, coverageTier0, coverageTier2, psnrCovered, ssimCovered;
  double psnrGain, psnrCoveredGain;        // after the gain of each channel that fits best
  double msSsim;                           // of the whole picture; with `used`: none
  double detailEnergy, detailCorrelation;  // of what is covered (ibr/metrics.h, Detail)
  double tornTiles;                        // ibr/metrics.h
  double guessed;                          // share of pixels whose depth was completed or filled, or that are empty
  double rightDepth, tooFar, tooNear;      // depth_scores.h
  double withinDeviation, withinTwoDeviations;  // likewise
  double seam, seamDeltaE, deltaE;              // colour_scores.h
  double misaligned,
      misaligned95;  // px between what cells say of one place (render/plan/cell_alignment.h): median, 95 %
  double uncorrected, uncorrected95;  // likewise, had cells not been aligned
  double milliseconds;
  WorstTile worstTile;  // of one view; meanSquared −1 for means
};

/// `prediction`: RGBA, alpha of AlphaContent::tier, its holes black. `fitGain`: also psnrGain and psnrCoveredGain. The
/// figures after these are left to the caller. What is 0 in `used`, of the truth, is left out; it may be empty.
/// Precondition: equal sizes.
Scores score(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used = {});

/// Each figure by its name.
nlohmann::ordered_json scoresJson(const Scores& scores);

/// What scoresJson wrote; missing and null figures are NaN.
Scores scoresOf(const nlohmann::ordered_json& json);

/// Over the views that have the figure: a view without cover has no psnrCovered.
Scores meanOf(const std::vector<Scores>& all);

/// Columns of a table; those of gains only where asked.
std::vector<std::string> scoresHeading(const std::string& first, bool withGain);
std::vector<std::string> scoresRow(const std::string& name, const Scores& scores, bool withGain);

}  // namespace ibr::app
