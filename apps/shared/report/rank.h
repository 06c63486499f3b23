// SPDX-License-Identifier: Apache-2.0
// Which measurements are worth having, and whether two figures rank them alike.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace ibr::app {

/// Indices of the Pareto front of (cost, worth): points beside which no other one costs no more and is worth no less,
/// one of the two strictly. By rising cost; of equal points the first. Points that are not finite are left out.
std::vector<std::size_t> paretoFront(std::span<const glm::dvec2> points);

/// Spearman's rank correlation, -1 to 1: Pearson's of the ranks, equal values having the mean of theirs. Pairs that are
/// not finite are left out. NaN for fewer than two pairs and where a side is constant. Precondition: equal lengths.
double spearman(std::span<const double> a, std::span<const double> b);

}  // namespace ibr::app
