// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/scores.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "batch/evaluate/colour_scores.h"
#include "ibr/metrics.h"
#include "ibr/scene.h"
#include "shared/draw/image_operations.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

enum class Shown { never, always, withGain };

struct Figure {
  const char* name;  // in JSON
  const char* heading;
  Shown shown;
  int decimals;
  double Scores::*value;
};
constexpr Figure kFigures[] = {{"psnr", "PSNR", Shown::always, 2, &Scores::psnr},
                               {"ssim", "SSIM", Shown::always, 4, &Scores::ssim},
                               {"flip", "FLIP", Shown::always, 4, &Scores::flip},
                               {"coverage", "coverage", Shown::always, 3, &Scores::coverage},
                               {"coverageTier0", "tier 0", Shown::always, 3, &Scores::coverageTier0},
                               {"coverageTier2", "", Shown::never, 3, &Scores::coverageTier2},
                               {"psnrCovered", "PSNR covered", Shown::always, 2, &Scores::psnrCovered},
                               {"ssimCovered", "SSIM covered", Shown::always, 4, &Scores::ssimCovered},
                               {"psnrGain", "PSNR gain", Shown::withGain, 2, &Scores::psnrGain},
                               {"psnrCoveredGain", "covered gain", Shown::withGain, 2, &Scores::psnrCoveredGain},
                               {"msSsim", "MS-SSIM", Shown::always, 4, &Scores::msSsim},
                               {"detailEnergy", "detail", Shown::always, 2, &Scores::detailEnergy},
                               {"detailCorrelation", "", Shown::never, 3, &Scores::detailCorrelation},
                               {"tornTiles", "torn tiles", Shown::always, 3, &Scores::tornTiles},
                               {"guessed", "", Shown::never, 3, &Scores::guessed},
                               {"rightDepth", "", Shown::never, 3, &Scores::rightDepth},
                               {"tooFar", "", Shown::never, 3, &Scores::tooFar},
                               {"tooNear", "", Shown::never, 3, &Scores::tooNear},
                               {"withinDeviation", "", Shown::never, 3, &Scores::withinDeviation},
                               {"withinTwoDeviations", "", Shown::never, 3, &Scores::withinTwoDeviations},
                               {"seam", "", Shown::never, 3, &Scores::seam},
                               {"seamDeltaE", "", Shown::never, 3, &Scores::seamDeltaE},
                               {"deltaE", "", Shown::never, 3, &Scores::deltaE},
                               {"misalignedPx", "", Shown::never, 2, &Scores::misaligned},
                               {"misaligned95Px", "", Shown::never, 2, &Scores::misaligned95},
                               {"uncorrectedPx", "", Shown::never, 2, &Scores::uncorrected},
                               {"uncorrected95Px", "", Shown::never, 2, &Scores::uncorrected95},
                               {"milliseconds", "ms", Shown::always, 1, &Scores::milliseconds}};

bool isShown(const Figure& figure, bool withGain) {
  return figure.shown == Shown::always || (figure.shown == Shown::withGain && withGain);
}

// FLIP takes no mask: excluded pixels are made equal, and the mean is rescaled to the rest.
double flipOfPart(const Image8& prediction, const Image8& truth, const Image8& used, double share) {
  Image8 same = prediction;
  for (int y = 0; y < used.height; ++y)
    for (int x = 0; x < used.width; ++x)
      if (!used.pixel(x, y)[0]) std::copy_n(truth.pixel(x, y).begin(), 3, same.pixel(x, y).begin());
  return flip(same, truth) / share;
}

void scoreDetail(const Image8& prediction, const Image8& truth, const Image8& cover, Scores& scores) {
  const Detail found = detail(prediction, truth, cover);
  scores.detailEnergy = found.energy;
  scores.detailCorrelation = found.correlation;
}

// Shares are relative to the pixels that count.
Scores scoreOfPart(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used) {
  Image8 cover = coverOf(prediction);
  std::array<double, 4> tiers{};
  double count = 0, covered = 0;
  for (int y = 0; y < used.height; ++y)
    for (int x = 0; x < used.width; ++x) {
      std::uint8_t& here = cover.pixel(x, y)[0];
      if (!used.pixel(x, y)[0]) {
        here = 0;
        continue;
      }
      ++count;
      if (!here) continue;
      ++covered;
      ++tiers[std::size_t((255 - prediction.pixel(x, y)[3]) / 64)];
    }
  Scores scores;
  if (count == 0) return scores;
  scores.psnr = psnr(prediction, truth, used);
  scores.ssim = ssim(prediction, truth, used);
  scores.flip = flipOfPart(prediction, truth, used, count / double(used.values.size()));
  scores.coverage = covered / count;
  scores.coverageTier0 = tiers[kTierConsistent] / count;
  scores.coverageTier2 = tiers[kTierCompleted] / count;
  scores.psnrCovered = psnr(prediction, truth, cover);
  scores.ssimCovered = ssim(prediction, truth, cover);
  scoreDetail(prediction, truth, cover, scores);
  if (fitGain) {
    const Image8 fitted = gainFitted(prediction, truth, cover);
    scores.psnrGain = psnr(fitted, truth, used);
    scores.psnrCoveredGain = psnr(fitted, truth, cover);
  }
  return scores;
}

}  // namespace

Scores::Scores() : worstTile{0, 0, -1} {
  for (const Figure& figure : kFigures) this->*figure.value = std::nan("");
}

Scores score(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used) {
  if (!used.empty()) return scoreOfPart(prediction, truth, fitGain, used);
  const Image8 mask = coverOf(prediction);
  const std::array<double, 4> tiers = tierShares(prediction);
  Scores scores;
  scores.psnr = psnr(prediction, truth);
  scores.ssim = ssim(prediction, truth);
  scores.flip = flip(prediction, truth);
  scores.coverage = double(std::ranges::count(mask.values, std::uint8_t(255))) / double(mask.values.size());
  scores.coverageTier0 = tiers[kTierConsistent];
  scores.coverageTier2 = tiers[kTierCompleted];
  scores.psnrCovered = psnr(prediction, truth, mask);
  scores.ssimCovered = ssim(prediction, truth, mask);
  scores.msSsim = msSsim(prediction, truth);
  scoreDetail(prediction, truth, mask, scores);
  scores.tornTiles = tornTiles(prediction, truth);
  scores.worstTile = worstTile(prediction, truth);
  if (fitGain) {
    const Image8 fitted = gainFitted(prediction, truth, mask);
    scores.psnrGain = psnr(fitted, truth);
    scores.psnrCoveredGain = psnr(fitted, truth, mask);
  }
  return scores;
}

nlohmann::ordered_json scoresJson(const Scores& scores) {
  auto json = nlohmann::ordered_json::object();
  for (const Figure& figure : kFigures) json[figure.name] = scores.*figure.value;
  if (const WorstTile& tile = scores.worstTile; tile.meanSquared >= 0)
    json["worstTile"] = {{"x", tile.x}, {"y", tile.y}, {"meanSquared", tile.meanSquared}};
  return json;
}

Scores scoresOf(const nlohmann::ordered_json& json) {
  Scores scores;
  for (const Figure& figure : kFigures)
    if (const auto found = json.find(figure.name); found != json.end() && found->is_number())
      scores.*figure.value = found->get<double>();
  if (const auto tile = json.find("worstTile"); tile != json.end())
    scores.worstTile = {tile->at("x"), tile->at("y"), tile->at("meanSquared")};
  return scores;
}

Scores meanOf(const std::vector<Scores>& all) {
  Scores result;
  for (const Figure& figure : kFigures) {
    double sum = 0;
    std::size_t count = 0;
    for (const Scores& scores : all)
      if (std::isfinite(scores.*figure.value)) {
        sum += scores.*figure.value;
        ++count;
      }
    if (count > 0) result.*figure.value = sum / double(count);
  }
  return result;
}

std::vector<std::string> scoresHeading(const std::string& first, bool withGain) {
  std::vector<std::string> heading{first};
  for (const Figure& figure : kFigures)
    if (isShown(figure, withGain)) heading.emplace_back(figure.heading);
  return heading;
}

std::vector<std::string> scoresRow(const std::string& name, const Scores& scores, bool withGain) {
  std::vector<std::string> row{name};
  for (const Figure& figure : kFigures)
    if (isShown(figure, withGain)) row.push_back(numberText(scores.*figure.value, figure.decimals));
  return row;
}

}  // namespace ibr::app
