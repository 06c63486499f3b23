// SPDX-License-Identifier: Apache-2.0
// What `ibr tradeoff` measures of a setting. Three kinds of accuracy are kept apart (NUMERICS §5.3): against the truth,
// against the reference preset, and, for the device alone, against the double-precision twin.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batch/evaluate/eye_agreement.h"
#include "batch/tradeoff/tradeoff_settings.h"
#include "ibr/image.h"

namespace ibr::app {

/// A picture beside another. NaN: not measured, or there is none.
struct Likeness {
  Likeness();
  double psnr, ssim, msSsim, flip;
  double detail;  // gradient energy, of the other's where the picture shows something: below 1 blurred, above ghosts
  double edges;   // correlation of gradients there
};

/// RGB of two pictures of equal size; `cover`: where `picture` shows something, one channel.
Likeness likeness(const Image8& picture, const Image8& other, const Image8& cover);

/// Mean of what is finite, figure by figure.
Likeness meanOf(const std::vector<Likeness>& all);

struct TradeoffView {
  std::string name;
  Likeness truth, reference;
  double holes = 0;        // share of the pixels
  std::string prediction;  // SHA-256 of width × height × RGBA bytes
  std::uint64_t passes = 0, draws = 0, dispatches = 0, triangles = 0, cells = 0, photographs = 0;
  std::optional<EyeAgreement> eyes;  // where there are two
};

struct TradeoffBytes {
  std::uint64_t positions = 0, indices = 0, textures = 0;
  std::uint64_t sum() const { return positions + indices + textures; }
};

struct TradeoffRow {
  TradeoffSetting setting;
  std::string failure;  // why there is nothing else; empty: there is
  std::vector<TradeoffView> views;
  TradeoffBytes measured, predicted;
  std::uint64_t pipelines = 0, workingBytes = 0;
  std::vector<std::vector<double>> deviceMs, planMs;  // by round and view
  std::map<std::string, std::vector<double>> passMs;  // by round, mean over the views

  Likeness truth() const;
  Likeness reference() const;
  double holes() const;
  /// Mean of the views that have two eyes, figure by figure.
  std::optional<EyeAgreement> eyes() const;
  std::uint64_t bytes() const { return measured.sum() + workingBytes; }
  std::uint64_t draws() const;      // of all views
  std::uint64_t triangles() const;  // likewise
  /// Of rounds: mean over the views of planning and device together, ms.
  std::vector<double> frameMs() const;
  double quantileMs(double q) const;
  double medianMs() const { return quantileMs(0.5); }
};

/// How far it is off: mean FLIP against the truth where there is one, else against the reference preset.
double errorOf(const TradeoffRow& row);

/// What does not depend on times: views, bytes, pipelines.
nlohmann::ordered_json pictureJson(const TradeoffRow& row);
/// Throws nlohmann::json::exception for what pictureJson did not write.
void readPicture(const nlohmann::ordered_json& json, TradeoffRow& row);

/// A row of the report, raw times among it.
nlohmann::ordered_json rowJson(const TradeoffRow& row);

std::string tradeoffCsv(const std::vector<TradeoffRow>& rows);
std::string tradeoffTable(const std::vector<TradeoffRow>& rows);

}  // namespace ibr::app
