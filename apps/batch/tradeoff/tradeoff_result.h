// SPDX-License-Identifier: Apache-2.0
// Measurements of `ibr tradeoff` for a setting. Three kinds of accuracy are kept apart: against the truth, against
// the reference preset, and, for the device alone, against the double-precision reference implementation.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batch/evaluate/eye_agreement.h"
#include "batch/tradeoff/tradeoff_settings.h"
#include "ibr/image.h"

namespace ibr::app {

/// Similarity of two images. NaN: not measured, or undefined.
struct ImageSimilarity {
  ImageSimilarity();
  double psnr, ssim, msSsim, flip;
  double detail;  // gradient energy relative to the other image, where the image is covered: < 1 blurred, > 1 ghosts
  double edges;   // correlation of gradients on the same pixels
};

/// Compares two RGB images of equal size; `cover`: mask of the pixels that `picture` covers, one channel.
ImageSimilarity similarity(const Image8& picture, const Image8& other, const Image8& cover);

/// Returns the mean of the finite values, figure by figure.
ImageSimilarity meanOf(const std::vector<ImageSimilarity>& all);

struct TradeoffView {
  std::string name;
  ImageSimilarity truth, reference;
  double holes = 0;        // share of the pixels
  std::string prediction;  // SHA-256 of width × height × RGBA bytes
  std::uint64_t passes = 0, draws = 0, dispatches = 0, triangles = 0, cells = 0, photographs = 0;
  std::optional<EyeAgreement> eyes;  // with two views only
};

struct TradeoffBytes {
  std::uint64_t positions = 0, indices = 0, textures = 0;
  std::uint64_t sum() const { return positions + indices + textures; }
};

struct TradeoffRow {
  TradeoffSetting setting;
  std::string failure;  // reason why the rest is empty; empty: success
  std::vector<TradeoffView> views;
  TradeoffBytes measured, predicted;
  std::uint64_t pipelines = 0, workingBytes = 0;
  std::vector<std::vector<double>> deviceMs, planMs;  // by round and view
  std::map<std::string, std::vector<double>> passMs;  // by round, mean over the views

  ImageSimilarity truth() const;
  ImageSimilarity reference() const;
  double holes() const;
  /// Returns the means over the views with two eyes, figure by figure.
  std::optional<EyeAgreement> eyes() const;
  std::uint64_t bytes() const { return measured.sum() + workingBytes; }
  std::uint64_t draws() const;      // of all views
  std::uint64_t triangles() const;  // of all views
  /// Returns for each round the mean over the views of planning plus device time, ms.
  std::vector<double> frameMs() const;
  double quantileMs(double q) const;
  double medianMs() const { return quantileMs(0.5); }
};

/// Returns the mean FLIP against the truth, or against the reference preset if there is no truth.
double errorOf(const TradeoffRow& row);

/// Returns all values that do not depend on times: views, bytes, pipelines.
nlohmann::ordered_json pictureJson(const TradeoffRow& row);
/// Reads pictureJson's output. Throws nlohmann::json::exception for other input.
void readPicture(const nlohmann::ordered_json& json, TradeoffRow& row);

/// Returns a row of the report, with the raw times.
nlohmann::ordered_json rowJson(const TradeoffRow& row);

std::string tradeoffCsv(const std::vector<TradeoffRow>& rows);
std::string tradeoffTable(const std::vector<TradeoffRow>& rows);

}  // namespace ibr::app
