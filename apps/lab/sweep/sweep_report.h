// SPDX-License-Identifier: Apache-2.0
// Results of a sweep as a table, CSV, JSON and a drawing.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batch/evaluate/scores.h"
#include "lab/sweep/sweep_settings.h"

namespace ibr::app {

/// Result of a setting. ECCs are means over the cells, of all points and images of each cell; NaN: not measured.
struct SweepRow {
  SweepSetting setting;
  double seconds = 0;     // elapsed time of the optimiser, all cells
  double cpuSeconds = 0;  // CPU time of all threads, which depends little on other programs on the machine
  double mutations = 0, cycles = 0;
  double ecc = 0, eccPaper = 0;  // AlignmentSummary::finalEcc, finalEccPaper
  Scores scores;                 // mean over the views
  std::string device;            // device that rendered the views
};

nlohmann::ordered_json rowJson(const SweepRow& row);

/// Reads a row of this setting from rowJson's output. Throws nlohmann::json::exception for other input.
SweepRow rowOf(const nlohmann::ordered_json& json, const SweepSetting& setting);

/// Spearman's rho between ECC and PSNR over the optimised settings, of one method or ("") of all.
double rankCorrelation(const std::vector<SweepRow>& rows, const std::string& method = "");

/// Returns the answer to "Does ECC predict PSNR?" as text.
std::string verdict(const std::vector<SweepRow>& rows);

std::string sweepTable(const std::vector<SweepRow>& rows);
std::string sweepCsv(const std::vector<SweepRow>& rows);

/// Returns one line for each setting; the fields of `more` are added.
nlohmann::ordered_json sweepJson(const std::vector<SweepRow>& rows, const nlohmann::ordered_json& more);

/// Plots time against ECC, time against PSNR ([T] fig. 17), and ECC against PSNR, which the paper does not show.
std::string sweepSvg(const std::vector<SweepRow>& rows, const std::string& title,
                     const std::vector<std::string>& notes);

}  // namespace ibr::app
