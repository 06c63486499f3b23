// SPDX-License-Identifier: Apache-2.0
// Pareto fronts and rank correlations of measurements.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace ibr::app {

/// Returns the indices of the Pareto front of (cost, worth), by increasing cost. A point is on the front if no other
/// has at most its cost and at least its worth, one strictly. Of equal points the first counts. Skips NaN and infinity.
std::vector<std::size_t> paretoFront(std::span<const glm::dvec2> points);

/// Spearman's rank correlation, -1 to 1: Pearson's correlation of the ranks; equal values share their mean rank. Skips
/// pairs that are not finite. NaN: fewer than two pairs, or a constant side. Precondition: equal lengths.
double spearman(std::span<const double> a, std::span<const double> b);

}  // namespace ibr::app
