// SPDX-License-Identifier: Apache-2.0
#include "lab/sweep/sweep_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "batch/build/optimise_options.h"
#include "shared/cli/options.h"

namespace ibr::app {
namespace {

using Values = std::array<std::vector<double>, kSweepFactorCount>;

bool uses(AlignmentMethod method, const SweepFactor& factor) {
  return method != AlignmentMethod::gradient || factor.name != std::string("instances");
}

bool prunes(AlignmentMethod method) {
  return method == AlignmentMethod::cpu || method == AlignmentMethod::compute;
}

Values valuesOf(const SweepLists& lists) {
  Values values = lists.values;
  for (std::size_t f = 0; f < values.size(); ++f)
    if (values[f].empty()) {
      const SweepFactor& factor = sweepFactors()[f];
      values[f] = lists.grid && !factor.inGrid ? std::vector{factor.get({})} : factor.usual;
    }
  return values;
}

AlignmentOptions usualOf(const Values& values) {
  AlignmentOptions usual;
  for (std::size_t f = 0; f < values.size(); ++f) {
    const SweepFactor& factor = sweepFactors()[f];
    if (std::ranges::find(values[f], factor.get(usual)) == values[f].end()) factor.set(usual, values[f].front());
  }
  return usual;
}

std::string labelOf(const AlignmentOptions& setting, const AlignmentOptions& usual) {
  std::string label;
  for (const SweepFactor& factor : sweepFactors())
    if (factor.get(setting) != factor.get(usual))
      label += fmt::format("{}{} {:g}", label.empty() ? "" : " ", factor.letter, factor.get(setting));
  if (setting.prune != usual.prune) label += label.empty() ? "pruned" : " pruned";
  return label.empty() ? "default" : label;
}

class Settings {
 public:
  Settings(const SweepLists& lists, std::uint64_t seed)
      : lists_(lists), values_(valuesOf(lists)), usual_(usualOf(values_)) {
    usual_.seed = seed;
  }

  std::vector<SweepSetting> all() {
    settings_.push_back({false, false, "unoptimised", usual_});
    const std::vector<AlignmentMethod> usual{AlignmentMethod::cpu, AlignmentMethod::gradient};
    for (const AlignmentMethod method : lists_.methods.empty() ? usual : lists_.methods) {
      usual_.method = method;
      add(usual_);
      if (lists_.grid)
        addGrid(usual_, 0);
      else
        addOneByOne();
    }
    return settings_;
  }

 private:
  void add(const AlignmentOptions& setting) {
    const std::string label = labelOf(setting, usual_);
    const bool there = std::ranges::any_of(settings_, [&](const SweepSetting& s) {
      return s.optimised && s.alignment.method == setting.method && s.label == label;
    });
    if (!there) settings_.push_back({true, label == "default", label, setting});
  }

  void addOneByOne() {
    for (std::size_t f = 0; f < values_.size(); ++f)
      for (const double value : values_[f]) {
        if (!uses(usual_.method, sweepFactors()[f])) continue;
        AlignmentOptions setting = usual_;
        sweepFactors()[f].set(setting, value);
        add(setting);
      }
    if (lists_.prune) addPruned(usual_);
  }

  void addGrid(AlignmentOptions setting, std::size_t f) {
    if (f == values_.size()) {
      add(setting);
      if (lists_.prune) addPruned(setting);
      return;
    }
    if (!uses(setting.method, sweepFactors()[f])) return addGrid(setting, f + 1);
    for (const double value : values_[f]) {
      sweepFactors()[f].set(setting, value);
      addGrid(setting, f + 1);
    }
  }

  void addPruned(AlignmentOptions setting) {
    if (!prunes(setting.method)) return;
    setting.prune = true;
    add(setting);
  }

  const SweepLists& lists_;
  Values values_;
  AlignmentOptions usual_;
  std::vector<SweepSetting> settings_;
};

}  // namespace

const std::array<SweepFactor, kSweepFactorCount>& sweepFactors() {
  using Options = AlignmentOptions;
  static const std::array<SweepFactor, kSweepFactorCount> kFactors{{
      {"--instances",
       "instances",
       "M",
       true,
       kInstancesLimits.first,
       kInstancesLimits.second,
       true,
       {16, 32, 64, 128},
       "Numbers of candidates per point, for cpu, compute and raster",
       [](const Options& o) { return double(o.instances); },
       [](Options& o, double v) { o.instances = int(v); }},
      {"--radius",
       "radius",
       "R",
       false,
       kRadiusLimits.first,
       kRadiusLimits.second,
       true,
       {1, 2.5, 5, 10, 20},
       "Maximum displacements of a candidate in the first cycle, px",
       [](const Options& o) { return o.radiusPx; },
       [](Options& o, double v) { o.radiusPx = v; }},
      {"--decay",
       "decay",
       "D",
       false,
       kDecayLimits.first,
       kDecayLimits.second,
       true,
       {0.25, 0.5, 0.75, 1},
       "Factors on the radius from one cycle to the next",
       [](const Options& o) { return o.decay; },
       [](Options& o, double v) { o.decay = v; }},
      {"--threshold",
       "threshold",
       "t",
       false,
       kThresholdLimits.first,
       kThresholdLimits.second,
       false,
       {0, 0.0005, 0.005, 0.02},
       "Relative gains of a cycle at or below which the optimiser stops",
       [](const Options& o) { return o.threshold; },
       [](Options& o, double v) { o.threshold = v; }},
      {"--rigidity",
       "rigidity",
       "rigidity",
       false,
       kRigidityLimits.first,
       kRigidityLimits.second,
       false,
       {0, 1, 10},
       "Penalties for a match that is 1 px from its initial position, grey^2 per sample and channel",
       [](const Options& o) { return o.rigidity; },
       [](Options& o, double v) { o.rigidity = v; }},
  }};
  return kFactors;
}

void declareSweepLists(CLI::App& app, SweepLists& lists) {
  addParsedList(
      app, "--method",
      [&lists](const std::vector<std::string>& words) {
        for (const std::string& word : words) lists.methods.push_back(parsedMethod("--method", word));
      },
      "Methods of the optimiser: cpu, compute, raster, gradient [cpu gradient]")
      .type("WORD...");
  for (std::size_t f = 0; f < kSweepFactorCount; ++f) {
    const SweepFactor& factor = sweepFactors()[f];
    addParsedList(
        app, factor.option,
        [&lists, &factor, f](const std::vector<std::string>& values) {
          for (const std::string& text : values)
            lists.values[f].push_back(factor.whole ? double(parsedInt(factor.option, text, std::int64_t(factor.low),
                                                                      std::int64_t(factor.high)))
                                                   : parsedDouble(factor.option, text, factor.low, factor.high));
        },
        fmt::format("{} [{:g}]", factor.description, fmt::join(factor.usual, " ")))
        .type(factor.whole ? "N..." : "X...");
  }
  addFlag(app, "--prune", lists.prune,
          "Also measure cpu and compute with pruning, which evaluates candidates on every "
          "8th row first");
  addFlag(app, "--grid", lists.grid,
          "All combinations, as in the paper: instances, radius, decay and all other given lists");
}

std::string SweepSetting::method() const {
  return optimised ? optionValue(alignment.method) : "none";
}

std::string SweepSetting::name() const {
  return optimised ? method() + " " + label : label;
}

std::vector<SweepSetting> sweepSettings(const SweepLists& lists, std::uint64_t seed) {
  return Settings(lists, seed).all();
}

}  // namespace ibr::app
