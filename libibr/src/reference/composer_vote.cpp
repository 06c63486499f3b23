// SPDX-License-Identifier: Apache-2.0
#include "reference/composer_vote.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "reference/fill.h"

namespace ibr::reference {
namespace {

// Constants are fixed, because results for different depth maps are compared.
constexpr double kStepTolerance = 2;       // tolerance: steps …
constexpr double kShareTolerance = 0.01;   // … and a share of ρ
constexpr double kNearness = 0.3;          // u = trust / (kNearness + squared distance in spacings)
constexpr double kSameSurface = 0.25;      // kernel value above which the lesser hypothesis is not a surface of its own
constexpr double kFullConsensus = 0.9;     // consensus at which a present surface hides all behind it
constexpr double kCompletedTrust = 0.155;  // trust below which a hypothesis was completed, not matched; the middle
                                           // between no and one confirmation
constexpr double kCompletedShare = 0.5;    // of a surface's weight
constexpr double kExactConsensus = 0.5;    // consensus at which ρ counts as exact; below it …
constexpr double kMaxRelativeError = 0.1;  // … maximum relative error of ρ
constexpr double kOpaque = 0.5;            // minimum opacity of the surface that defines depth
constexpr double kMinInverseDepth = 1e-6;  // minimum ρ for relative spreads
constexpr double kAloneSpread = 0.05;      // relative; for a pixel with a single hypothesis
constexpr double kStepDeviation = 0.18;    // of a confirmed ρ: steps, and …
constexpr double kSpreadDeviation = 0.85;  // … factor on the spread, times 1 + …
constexpr double kColourDeviation = 4;     // … this × the colours' deviation in kColourSpread, …
constexpr double kMaxColourFactor = 2;     // … limited to this

// Support of a hypothesis at `here` by one at `there`: 0 to 1.
double kernel(double here, double there, double step) {
  const double off = (here - there) / toleranceOf(step, here);
  return std::max(0.0, 1 - off * off);
}

std::vector<double> supports(std::span<const Vote> votes, double step) {
  std::vector<double> support(votes.size(), 0.0);
  for (std::size_t i = 0; i < votes.size(); ++i)
    for (const Vote& other : votes)
      support[i] += other.weight * kernel(votes[i].inverseDepth, other.inverseDepth, step);
  return support;
}

// Relative difference of the two largest supports; 1 for a single one.
double marginOf(std::vector<double> support) {
  if (support.size() < 2) return 1;
  std::ranges::sort(support, std::greater());
  return (support[0] - support[1]) / support[0];
}

// Presence of each hypothesis: its share of the largest support, reduced by the nearness of hypotheses of more support.
std::vector<double> presences(std::span<const Vote> votes, std::span<const double> support, double step) {
  const double most = *std::ranges::max_element(support);
  std::vector<double> present;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    present.push_back(support[i] / most);
    for (std::size_t j = 0; j < votes.size(); ++j)
      if (support[j] > support[i] || (support[j] == support[i] && j < i))
        present[i] *= std::max(0.0, 1 - kernel(votes[i].inverseDepth, votes[j].inverseDepth, step) / kSameSurface);
  }
  return present;
}

double spreadAbout(std::span<const Vote> votes, double surface) {
  if (votes.size() == 1) return kAloneSpread;
  double sum = 0, square = 0;
  for (const Vote& vote : votes) {
    const double off = std::min(std::abs(vote.inverseDepth - surface) / std::max(surface, kMinInverseDepth), 1.0);
    sum += vote.weight;
    square += vote.weight * off * off;
  }
  return std::sqrt(square / sum);
}

// Mean of the hypotheses around a peak, and its opacity as far as the peak is present.
Surface surfaceAt(std::span<const Vote> votes, std::size_t peak, double step) {
  double sum = 0, depth = 0, consensus = 0, completed = 0;
  for (const Vote& vote : votes) {
    const double weight = vote.weight * kernel(votes[peak].inverseDepth, vote.inverseDepth, step);
    sum += weight;
    depth += weight * vote.inverseDepth;
    consensus += weight * vote.consensus;
    completed += vote.trust < kCompletedTrust ? weight : 0.0;
  }
  consensus /= sum;
  return {depth / sum, std::clamp(consensus / kFullConsensus, 0.0, 1.0), uncertaintyOf(consensus),
          completed > kCompletedShare * sum};
}

}  // namespace

double toleranceOf(double step, double inverseDepth) {
  return kStepTolerance * step + kShareTolerance * inverseDepth;
}

double uncertaintyOf(double consensus) {
  return kMaxRelativeError * std::max(0.0, 1 - consensus / kExactConsensus);
}

const Surface& opaqueSurface(const Surfaces& surfaces) {
  std::size_t l = 0;
  while (l + 1 < surfaces.count && surfaces.surface[l].opacity < kOpaque) ++l;
  return surfaces.surface[l];
}

double deviationOf(const Surfaces& surfaces, bool confirmed, double step, double variance) {
  const double inverseDepth = opaqueSurface(surfaces).inverseDepth;
  if (!confirmed) return inverseDepth;
  const double colours = std::min(std::sqrt(variance) / kColourSpread, kMaxColourFactor);
  return std::hypot(kStepDeviation * step,
                    kSpreadDeviation * (1 + kColourDeviation * colours) * surfaces.spread * inverseDepth);
}

double voteWeight(double photographWeight, double trust, double distance) {
  return photographWeight * trust / (kNearness + distance * distance);
}

Surfaces vote(std::span<const Vote> votes, double step, std::size_t layers) {
  Surfaces result;
  if (votes.empty()) return result;
  const std::vector<double> support = supports(votes, step);
  const std::vector<double> present = presences(votes, support, step);
  // From front to back. The last surface hides nothing that is known, and shows in full.
  std::vector<std::size_t> order(votes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order,
                           [&](std::size_t i, std::size_t j) { return votes[i].inverseDepth > votes[j].inverseDepth; });
  struct Shown {
    double share;  // of the pixel
    Surface surface;
  };
  std::vector<Shown> shown;
  double through = 1;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (!(present[order[k]] > 0)) continue;
    double nothingBehind = 1;
    for (std::size_t l = k + 1; l < order.size(); ++l) nothingBehind *= 1 - present[order[l]];
    const Surface surface = surfaceAt(votes, order[k], step);
    const double share = through * present[order[k]] * std::lerp(surface.opacity, 1.0, nothingBehind);
    through -= share;
    if (share > 0) shown.push_back({share, surface});
  }
  std::vector<Shown> most = shown;
  std::ranges::stable_sort(most, std::ranges::greater(), &Shown::share);
  result.margin = marginOf(support);
  if (most.size() > layers) result.margin = std::min(result.margin, most[layers - 1].share - most[layers].share);
  most.resize(std::min(most.size(), layers));
  std::ranges::stable_sort(most, std::ranges::greater(), [](const Shown& one) { return one.surface.inverseDepth; });
  double behind = 0;
  for (std::size_t l = most.size(); l-- > 0;) {  // share of this surface and all behind it
    behind += most[l].share;
    result.surface[l] = most[l].surface;
    result.surface[l].opacity = most[l].share / behind;
  }
  result.count = most.size();
  result.spread = spreadAbout(votes, opaqueSurface(result).inverseDepth);
  return result;
}

void fillHoles(std::vector<Surfaces>& pixels, int width, int height) {
  FillLevel<double> depth(width, height);
  for (std::size_t at = 0; at < pixels.size(); ++at) {
    if (pixels[at].count == 0) continue;
    depth.value[at] = pixels[at].surface[0].inverseDepth;
    depth.weight[at] = 1;
  }
  if (!fill(depth)) return;
  for (std::size_t at = 0; at < pixels.size(); ++at)
    if (pixels[at].count == 0) {
      pixels[at].surface[0] = {depth.value[at], 1.0, uncertaintyOf(0), true};
      pixels[at].count = 1;
      pixels[at].filled = true;
    }
}

}  // namespace ibr::reference
