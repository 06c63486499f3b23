// SPDX-License-Identifier: Apache-2.0
// Figures of optimised cells and their means, for tables and reports.
#pragma once

#include <utility>
#include <vector>

#include "ibr/author/optimise_scene.h"

namespace ibr::app {

/// Name in JSON, and value: NaN if a cell lacks the figure.
using CellFigure = std::pair<const char*, double (*)(const OptimisedCell&)>;
inline constexpr CellFigure kCellFigures[] = {
    {"points", [](const OptimisedCell& c) { return double(c.points); }},
    {"images", [](const OptimisedCell& c) { return double(c.members.size()); }},
    {"initialEcc", [](const OptimisedCell& c) { return c.summary.initialEcc; }},
    {"finalEcc", [](const OptimisedCell& c) { return c.summary.finalEcc; }},
    {"initialEccPaper", [](const OptimisedCell& c) { return c.summary.initialEccPaper; }},
    {"finalEccPaper", [](const OptimisedCell& c) { return c.summary.finalEccPaper; }},
    {"seconds", [](const OptimisedCell& c) { return c.seconds; }},
};

/// Returns the mean over the cells that have the figure; NaN if none has.
double meanOf(const OptimiseSceneReport& report, double (*figure)(const OptimisedCell&));

/// Returns the sums of mutations, pixels, points and edges over all cycles.
AlignmentCycle sumOf(const std::vector<AlignmentCycle>& cycles);

}  // namespace ibr::app
