// SPDX-License-Identifier: Apache-2.0
// What a sweep has measured: as a table, CSV, JSON and a drawing.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/evaluate/scores.h"
#include "batch/sweep/sweep_settings.h"

namespace ibr::app {

/// Of a setting. ECCs are means over the cells, of all points and pictures of each; NaN: there is none.
struct SweepRow {
  SweepSetting setting;
  double seconds = 0;           // of the optimiser, all cells
  double processorSeconds = 0;  // of all threads: what another program on the machine does not change much
  double mutations = 0, cycles = 0;
  double ecc = 0, eccPaper = 0;  // AlignmentSummary::finalEcc, finalEccPaper
  Scores scores;                 // mean over the views
  std::string device;            // that rendered them
};

nlohmann::ordered_json rowJson(const SweepRow& row);

/// What rowJson wrote of this setting. Throws nlohmann::json::exception for anything else.
SweepRow rowOf(const nlohmann::ordered_json& json, const SweepSetting& setting);

/// Spearman's rho between ECC and PSNR over the settings that optimise, of one method or ("") of all.
double rankCorrelation(const std::vector<SweepRow>& rows, const std::string& method = "");

/// "Does ECC predict PSNR? …", in words.
std::string verdict(const std::vector<SweepRow>& rows);

std::string sweepTable(const std::vector<SweepRow>& rows);
std::string sweepCsv(const std::vector<SweepRow>& rows);

/// A setting a line; `more` joins it.
std::string sweepJson(const std::vector<SweepRow>& rows, const nlohmann::ordered_json& more);

/// Time against ECC, time against PSNR, ECC against PSNR ([T] fig. 17 and what it leaves open).
std::string sweepSvg(const std::vector<SweepRow>& rows, const std::string& title,
                     const std::vector<std::string>& notes);

}  // namespace ibr::app
