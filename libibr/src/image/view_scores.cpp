// SPDX-License-Identifier: Apache-2.0
#include "ibr/view_scores.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/median.h"
#include "base/srgb.h"
#include "ibr/scene.h"
#include "image/comparable.h"

namespace ibr {
namespace {

double decoded(std::uint8_t level) {
  return srgbToLinear(level / 255.0);
}
std::uint8_t encoded(double linear) {
  return std::uint8_t(std::lround(255 * linearToSrgb(std::clamp(linear, 0.0, 1.0))));
}

bool isClipped(std::uint8_t level) {
  return level < 4 || level > 250;
}

/// Tier of a pixel by its alpha, which is not 0 (AlphaContent::tier).
std::size_t tierOf(int alpha) {
  return std::size_t(std::clamp(int(std::lround((255 - alpha) / 64.0)), 0, 3));
}

// FLIP takes no mask: excluded pixels are made equal, and the mean is rescaled to the rest.
double flipOfPart(const Image8& prediction, const Image8& truth, const Image8& used, double share) {
  Image8 same = prediction;
  for (int y = 0; y < used.height; ++y)
    for (int x = 0; x < used.width; ++x)
      if (!used.pixel(x, y)[0]) std::copy_n(truth.pixel(x, y).begin(), 3, same.pixel(x, y).begin());
  return flip(same, truth) / share;
}

void scoreDetail(const Image8& prediction, const Image8& truth, const Image8& cover, ViewScores& scores) {
  const Detail found = detail(prediction, truth, cover);
  scores.detailEnergy = found.energy;
  scores.detailCorrelation = found.correlation;
}

// Shares are relative to the pixels that count.
ViewScores scoreOfPart(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used) {
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
      ++tiers[tierOf(prediction.pixel(x, y)[3])];
    }
  ViewScores scores;
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

ViewScores scoreView(const Image8& prediction, const Image8& truth, bool fitGain, const Image8& used) {
  checkComparable(prediction, truth, used.empty() ? nullptr : &used);
  check(prediction.channels == 4, ErrorCode::invalidInput, "a rendered view has 4 channels, not {}",
        prediction.channels);
  if (!used.empty()) return scoreOfPart(prediction, truth, fitGain, used);
  const Image8 mask = coverOf(prediction);
  const std::array<double, 4> tiers = tierShares(prediction);
  ViewScores scores;
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

Image8 coverOf(const Image8& prediction) {
  Image8 cover(prediction.width, prediction.height, 1);
  for (std::size_t i = 0; i < cover.values.size(); ++i) cover.values[i] = prediction.values[4 * i + 3] > 0 ? 255 : 0;
  return cover;
}

std::array<double, 4> tierShares(const Image8& prediction) {
  std::array<double, 4> shares{};
  const double pixels = double(prediction.width) * prediction.height;
  for (std::size_t at = 3; at < prediction.values.size(); at += 4)
    if (const int alpha = prediction.values[at]; alpha > 0) ++shares[tierOf(alpha)];
  for (double& share : shares) share /= pixels;
  return shares;
}

Image8 gainFitted(const Image8& picture, const Image8& truth, const Image8& mask) {
  std::array<std::vector<double>, 3> ratios;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (std::size_t c = 0; mask.pixel(x, y)[0] && c < 3; ++c) {
        const std::uint8_t p = picture.pixel(x, y)[c], t = truth.pixel(x, y)[c];
        if (!isClipped(p) && !isClipped(t)) ratios[c].push_back(decoded(t) / decoded(p));
      }
  Image8 fitted(picture.width, picture.height, 3);
  for (std::size_t c = 0; c < 3; ++c) {
    const double gain = ratios[c].empty() ? 1.0 : median(std::move(ratios[c]));
    std::array<std::uint8_t, 256> table;
    for (int level = 0; level < 256; ++level) table[std::size_t(level)] = encoded(gain * decoded(std::uint8_t(level)));
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) fitted.pixel(x, y)[c] = table[picture.pixel(x, y)[c]];
  }
  return fitted;
}

}  // namespace ibr
