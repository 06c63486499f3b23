// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/scores.h"

#include <cmath>
#include <nlohmann/json.hpp>

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

}  // namespace

Scores::Scores() {
  for (const Figure& figure : kFigures) this->*figure.value = std::nan("");
}

Scores score(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used) {
  Scores scores;
  static_cast<ViewScores&>(scores) = scoreView(prediction, truth, fitGain, used);
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
