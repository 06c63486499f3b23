// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "vr/walk/governor.h"

using namespace ibr;
using namespace ibr::app;

namespace {

int dearness(BlendMode mode) {
  return mode == BlendMode::dither ? 0 : 1;
}

// Returns `level` with all fields that the governor may change set to the requested values.
RenderSettings elsewhere(RenderSettings level, const RenderSettings& requested) {
  level.maxCells = requested.maxCells;
  level.renderScale = requested.renderScale;
  level.blend = requested.blend;
  level.colourMapping = requested.colourMapping;
  level.gatherCandidates = requested.gatherCandidates;
  level.voteScale = requested.voteScale;
  return level;
}

void checkFalls(const std::vector<RenderSettings>& levels) {
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const RenderSettings &before = levels[i - 1], &after = levels[i];
    REQUIRE(after.maxCells <= before.maxCells);
    REQUIRE(after.renderScale <= before.renderScale);
    REQUIRE(after.gatherCandidates <= before.gatherCandidates);
    REQUIRE(after.voteScale <= before.voteScale);
    REQUIRE(dearness(after.blend) <= dearness(before.blend));
    REQUIRE((after.colourMapping == before.colourMapping || after.colourMapping == ColourMapping::off));
    REQUIRE(!(after == before));
    REQUIRE((elsewhere(after, levels.front()) == levels.front()));
    REQUIRE(!levelChange(before, after).empty());
  }
}

// Counts of cells and photographs, without repetitions.
std::vector<std::pair<std::uint32_t, std::uint32_t>> counts(const std::vector<RenderSettings>& levels) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
  for (const RenderSettings& level : levels)
    if (const std::pair count{level.maxCells, level.gatherCandidates}; all.empty() || all.back() != count)
      all.push_back(count);
  return all;
}

}  // namespace

TEST_CASE("ladder: starts with the requested settings, and each level reduces one of them") {
  std::mt19937 random(1);
  const auto upTo = [&](unsigned most) { return std::uint32_t(random() % (most + 1)); };
  for (int i = 0; i < 500; ++i) {
    RenderSettings requested;
    requested.maxCells = upTo(kMaxCellCount);
    requested.renderScale = 0.3 + 0.1 * upTo(12);
    requested.blend = BlendMode(upTo(2));
    requested.colourMapping = ColourMapping(upTo(3));
    requested.textureScale = 0.5;
    requested.mutedCells = {3};
    requested.maxTier = int(upTo(3));
    requested.composition = Composition(upTo(2));
    requested.gatherCandidates = 1 + upTo(kMaxGatherCandidates - 1);
    requested.voteScale = 0.1 + 0.1 * upTo(9);
    const auto levels = ladder(requested, upTo(20), upTo(20));
    REQUIRE((levels.front() == requested));
    REQUIRE(levels.size() <= 13);
    checkFalls(levels);
    REQUIRE(levels.back().renderScale == 0.5 * requested.renderScale);
    if (requested.composition == Composition::gathered) continue;  // does not use these settings
    REQUIRE(levels.back().blend == BlendMode::dither);
    REQUIRE(levels.back().colourMapping == ColourMapping::off);
  }
}

TEST_CASE("ladder: the default settings give the expected sequence of changes") {
  RenderSettings requested;
  requested.colourMapping = ColourMapping::ours;
  std::vector<std::string> changes;
  const auto levels = ladder(requested);
  for (std::size_t i = 1; i < levels.size(); ++i) changes.push_back(levelChange(levels[i - 1], levels[i]));
  CHECK(changes == std::vector<std::string>{"cells 12 → 8", "cells 8 → 6", "cells 6 → 4", "resolution 1 → 0.85",
                                            "resolution 0.85 → 0.7", "blending blend → dither", "cells 4 → 2",
                                            "resolution 0.7 → 0.5", "colour mapping ours → off"});
  CHECK(levelChange(requested, requested).empty());
}

TEST_CASE("ladder: gathering compositions first reduce the vote scale, then the number of photographs") {
  const auto changesOf = [](Composition composition, std::size_t cells) {
    RenderSettings requested;
    requested.composition = composition;
    std::vector<std::string> changes;
    const auto levels = ladder(requested, cells, 300);
    for (std::size_t i = 1; i < levels.size(); ++i) changes.push_back(levelChange(levels[i - 1], levels[i]));
    return changes;
  };
  using Changes = std::vector<std::string>;
  const Changes gathered{"vote 0.5 → 0.25",     "photographs 12 → 8",    "photographs 8 → 6", "photographs 6 → 4",
                         "resolution 1 → 0.85", "resolution 0.85 → 0.7", "photographs 4 → 2", "resolution 0.7 → 0.5"};
  CHECK(changesOf(Composition::gathered, 300) == gathered);
  CHECK(changesOf(Composition::gathered, 0) == gathered);
  const Changes hybrid = changesOf(Composition::hybrid, 300);
  REQUIRE(hybrid.size() == 9);
  CHECK(hybrid[1] == "photographs 12 → 8");
  CHECK(hybrid[6] == "blending blend → dither");
}

TEST_CASE("ladder: limits above the scene's number of cells or photographs are skipped") {
  RenderSettings requested;
  requested.gatherCandidates = 14;
  using Counts = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  CHECK(counts(ladder(requested)) == Counts{{12, 14}, {8, 14}, {6, 14}, {4, 14}, {2, 14}});
  CHECK(counts(ladder(requested, 5, 14)) == Counts{{12, 14}, {4, 14}, {2, 14}});
  CHECK(counts(ladder(requested, 0, 14)) == Counts{{12, 14}});
  for (const Composition composition : {Composition::gathered, Composition::hybrid}) {
    requested.composition = composition;
    CHECK(counts(ladder(requested)) == Counts{{12, 14}, {12, 12}, {12, 8}, {12, 6}, {12, 4}, {12, 2}});
    CHECK(counts(ladder(requested, 12, 5)) == Counts{{12, 14}, {12, 4}, {12, 2}});
    CHECK(counts(ladder(requested, 12, 2)) == Counts{{12, 14}});
  }
}

TEST_CASE("ladder: resolution is reduced before dithering, and dithering comes before few cells") {
  const auto levels = ladder({});
  for (const RenderSettings& level : levels) {
    if (level.blend == BlendMode::dither) CHECK(level.renderScale <= 0.7);
    if (level.maxCells < 4) CHECK(level.blend == BlendMode::dither);
  }
}
