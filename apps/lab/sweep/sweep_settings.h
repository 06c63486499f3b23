// SPDX-License-Identifier: Apache-2.0
// Settings of the optimiser that a sweep measures ([T] §3.8.1).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ibr/optimiser.h"
#include "shared/cli/cli_fwd.h"

namespace ibr::app {

/// A numeric setting of the optimiser that is varied.
struct SweepFactor {
  const char* option;
  const char* name;    // in reports
  const char* letter;  // in names of settings
  bool whole;
  double low, high;
  bool inGrid;  // varied in the paper's grid
  std::vector<double> usual;
  const char* description;
  double (*get)(const AlignmentOptions&);
  void (*set)(AlignmentOptions&, double);
};
inline constexpr std::size_t kSweepFactorCount = 5;
const std::array<SweepFactor, kSweepFactorCount>& sweepFactors();

/// Lists of values; an empty list was not given.
struct SweepLists {
  std::vector<AlignmentMethod> methods;
  std::array<std::vector<double>, kSweepFactorCount> values;
  bool prune = false, grid = false;
};
void declareSweepLists(CLI::App& app, SweepLists& lists);

struct SweepSetting {
  bool optimised = true;  // false: the scene unchanged
  bool usual = false;     // true: the base setting that the others of its method differ from
  std::string label;      // values that differ from the base; "default", or "unoptimised"
  AlignmentOptions alignment;

  std::string method() const;  // "none" if nothing is optimised
  std::string name() const;    // method and label
};

/// Returns the unchanged scene, then for each method the base setting and the settings that differ in one number, or
/// with `grid` in all combinations. Base values: the default of AlignmentOptions if in the list, else the list's first
/// value. Without `grid`, a missing list is replaced by the factor's usual values; with `grid`, by the default alone if
/// the paper does not vary the factor. Numbers that a method ignores are not varied. Settings are unique.
std::vector<SweepSetting> sweepSettings(const SweepLists& lists, std::uint64_t seed);

}  // namespace ibr::app
