// SPDX-License-Identifier: Apache-2.0
#include "reference/composer_vote.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "shared/fill.h"

namespace ibr::reference {
namespace {

// Fixed: depth maps are compared by them.
constexpr double kStepTolerance = 2;       // of the tolerance: steps …
constexpr double kShareTolerance = 0.01;   // … and a share of ρ
constexpr double kNearness = 0.3;          // u = trust / (kNearness + squared distance in spacings)
constexpr double kSupportShare = 0.05;     // of the largest support of a pixel: less is no surface
constexpr double kFullConsensus = 0.9;     // consensus from which on a surface hides all behind it
constexpr double kCompletedTrust = 0.155;  // trust: a hypothesis below it was completed, not matched; the middle
                                           // between no and one confirmation
constexpr double kCompletedShare = 0.5;    // of a surface's weight

// A level of the image pyramid: means of ρ, and how much is known, 0 to 1.
struct Level {
  Level(int w, int h)
      : width(w),
        height(h),
        value(std::size_t(w) * std::size_t(h), 0.0),
        weight(std::size_t(w) * std::size_t(h), 0.0) {}
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

  int width, height;
  std::vector<double> value, weight;
};

Level pulled(const Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t from = fine.index(x, y), to = coarse.index(x / 2, y / 2);
      coarse.value[to] += fine.weight[from] * fine.value[from];
      coarse.weight[to] += fine.weight[from];
    }
  for (std::size_t at = 0; at < coarse.value.size(); ++at)
    if (coarse.weight[at] > 0) {
      coarse.value[at] /= coarse.weight[at];
      coarse.weight[at] = double(shader::pulledWeight(float(coarse.weight[at])));
    }
  return coarse;
}

void push(const Level& coarse, Level& fine) {
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t at = fine.index(x, y);
      if (fine.weight[at] >= 1) continue;
      const double u = std::clamp((x + 0.5) / 2 - 0.5, 0.0, coarse.width - 1.0),
                   v = std::clamp((y + 0.5) / 2 - 0.5, 0.0, coarse.height - 1.0);
      const int left = int(u), top = int(v), right = std::min(left + 1, coarse.width - 1),
                below = std::min(top + 1, coarse.height - 1);
      const auto across = [&](int row) {
        return std::lerp(coarse.value[coarse.index(left, row)], coarse.value[coarse.index(right, row)], u - left);
      };
      fine.value[at] = std::lerp(std::lerp(across(top), across(below), v - top), fine.value[at], fine.weight[at]);
    }
}

}  // namespace

double toleranceOf(double step, double inverseDepth) {
  return kStepTolerance * step + kShareTolerance * inverseDepth;
}

double voteWeight(double photographWeight, double trust, double distance) {
  return photographWeight * trust / (kNearness + distance * distance);
}

Surfaces vote(std::span<const Vote> votes, double step, std::size_t layers) {
  Surfaces result;
  const std::size_t n = votes.size();
  if (n == 0) return result;
  const auto kernel = [&](std::size_t i, std::size_t j) {
    const double off = (votes[i].inverseDepth - votes[j].inverseDepth) / toleranceOf(step, votes[i].inverseDepth);
    return std::max(0.0, 1 - off * off);
  };
  std::vector<double> support(n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) support[i] += votes[j].weight * kernel(i, j);
  std::vector<double> sorted = support;
  std::ranges::sort(sorted);
  const double most = sorted[n - 1];
  if (n > 1) result.margin = (most - sorted[n - 2]) / most;
  const auto isPeak = [&](std::size_t i) {
    if (support[i] <= kSupportShare * most) return false;
    for (std::size_t j = 0; j < n; ++j)
      if (kernel(i, j) > 0 && (support[j] > support[i] || (support[j] == support[i] && j < i))) return false;
    return true;
  };
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order,
                           [&](std::size_t i, std::size_t j) { return votes[i].inverseDepth > votes[j].inverseDepth; });
  for (const std::size_t i : order) {
    if (result.count == layers) break;
    if (!isPeak(i)) continue;
    double sum = 0, depth = 0, consensus = 0, completed = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double weight = votes[j].weight * kernel(i, j);
      sum += weight;
      depth += weight * votes[j].inverseDepth;
      consensus += weight * votes[j].consensus;
      completed += votes[j].trust < kCompletedTrust ? weight : 0.0;
    }
    result.surface[result.count++] = {depth / sum, std::clamp(consensus / sum / kFullConsensus, 0.0, 1.0),
                                      completed > kCompletedShare * sum};
  }
  return result;
}

void fillHoles(std::vector<Surfaces>& pixels, int width, int height) {
  std::vector<Level> levels{Level(width, height)};
  bool holes = false, known = false;
  for (std::size_t at = 0; at < pixels.size(); ++at) {
    (pixels[at].count > 0 ? known : holes) = true;
    if (pixels[at].count == 0) continue;
    levels[0].value[at] = pixels[at].surface[0].inverseDepth;
    levels[0].weight[at] = 1;
  }
  if (!holes || !known) return;
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(pulled(levels.back()));
  for (std::size_t l = levels.size() - 1; l-- > 0;) push(levels[l + 1], levels[l]);
  for (std::size_t at = 0; at < pixels.size(); ++at)
    if (pixels[at].count == 0) {
      pixels[at].surface[0] = {levels[0].value[at], 1.0, true};
      pixels[at].count = 1;
      pixels[at].filled = true;
    }
}

}  // namespace ibr::reference
