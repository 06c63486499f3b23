// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_evaluator.h"

#include <cmath>
#include <limits>

#include "ibr/metrics.h"
#include "ibr/view_scores.h"

namespace ibr::app {
namespace {

HtmModel adjustedBaseline(const HtmModel& model) {
  HtmModel same = model;
  for (HtmCamera& camera : same.cameras) camera.given.reset();
  return unoptimisedModel(same);
}

Image8 commonCover(const std::array<Image8, kHtmMethodCount>& pictures) {
  Image8 cover = coverOf(pictures[0]);
  for (std::size_t r = 1; r < kHtmMethodCount; ++r) {
    const Image8 other = coverOf(pictures[r]);
    for (std::size_t p = 0; p < cover.values.size(); ++p) cover.values[p] &= other.values[p];
  }
  return cover;
}

}  // namespace

HtmEvaluator::HtmEvaluator(const HtmModel& model, Device& device, const HtmImageSource& source)
    : given_(unoptimisedModel(model)),
      adjusted_(adjustedBaseline(model)),
      harmonised_(model, device, source),
      baseline_(given_, device, source),
      adjustedBaseline_(adjusted_, device, source) {}

HtmViewScores HtmEvaluator::judge(const HtmTruthView& view, HtmSettings settings) {
  settings.background = glm::vec3(0.0f);
  const auto drawn = [&](HtmModelRenderer& pictures, HtmMethod method) {
    settings.method = method;
    return pictures.render(view.camera, settings).image;
  };
  HtmViewScores verdict{view.name, {}, {}, view.picture};
  verdict.picture[kHtm] = drawn(harmonised_, HtmMethod::harmonised);
  verdict.picture[kVdtbm] = drawn(baseline_, HtmMethod::blended);
  verdict.picture[kVdvbm] = drawn(baseline_, HtmMethod::vertexColours);
  verdict.picture[kVdtbmAdjusted] = drawn(adjustedBaseline_, HtmMethod::blended);

  Image8 covered = commonCover(verdict.picture);
  const Image8 counts = view.mask.empty() ? covered : view.mask;
  for (std::size_t p = 0; p < covered.values.size(); ++p) covered.values[p] = covered.values[p] && counts.values[p];
  for (std::size_t r = 0; r < kHtmMethodCount; ++r)
    verdict.score[r] = {psnr(verdict.picture[r], view.picture, counts), ssim(verdict.picture[r], view.picture, counts),
                        psnr(verdict.picture[r], view.picture, covered)};
  return verdict;
}

std::array<HtmScore, kHtmMethodCount> meanScores(const std::vector<HtmViewScores>& verdicts) {
  std::array<HtmScore, kHtmMethodCount> means;
  const auto mean = [&](std::size_t rival, double HtmScore::*figure) {
    double sum = 0, count = 0;
    for (const HtmViewScores& verdict : verdicts)
      if (const double value = verdict.score[rival].*figure; std::isfinite(value)) sum += value, ++count;
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  };
  for (std::size_t r = 0; r < kHtmMethodCount; ++r)
    means[r] = {mean(r, &HtmScore::psnr), mean(r, &HtmScore::ssim), mean(r, &HtmScore::psnrCovered)};
  return means;
}

}  // namespace ibr::app
