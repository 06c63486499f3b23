// SPDX-License-Identifier: Apache-2.0
// Which settings of the optimiser a sweep measures ([T] §3.8.1).
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "ibr/optimiser.h"

namespace ibr::app {

/// A number of the optimiser that is varied.
struct SweepFactor {
  const char* option;
  const char* name;    // in reports
  const char* letter;  // in names of settings
  bool whole;
  double low, high;
  bool inGrid;  // the paper varies it
  std::vector<double> usual;
  const char* description;
  double (*get)(const AlignmentOptions&);
  void (*set)(AlignmentOptions&, double);
};
inline constexpr std::size_t kSweepFactorCount = 5;
const std::array<SweepFactor, kSweepFactorCount>& sweepFactors();

/// Empty lists were not given.
struct SweepLists {
  std::vector<AlignmentMethod> methods;
  std::array<std::vector<double>, kSweepFactorCount> values;
  bool prune = false, grid = false;
};
void declareSweepLists(CLI::App& app, SweepLists& lists);

struct SweepSetting {
  bool optimised = true;  // false: the scene as it is
  bool usual = false;     // the one around which the others of its method stand
  std::string label;      // what is not as usual; "default", or "unoptimised"
  AlignmentOptions alignment;

  std::string method() const;  // "none" where nothing is optimised
  std::string name() const;    // method and label
};

/// The scene as it is first, then method by method the usual setting and those that differ from it: in one number, or
/// with `grid` in all combinations. Usual is AlignmentOptions' default where its list has it, else the first of the
/// list. Without `grid` a list that was not given has usual values of its factor; with it, if the paper does not vary
/// it, the default alone. Numbers that a method does not use are not varied for it. No setting comes twice.
std::vector<SweepSetting> sweepSettings(const SweepLists& lists, std::uint64_t seed);

}  // namespace ibr::app
