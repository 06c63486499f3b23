// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "shared/cli/settings.h"
#include "vr/walk/governor.h"

namespace ibr::app {
namespace {

constexpr std::array<std::uint32_t, 6> kCounts{32, 16, 12, 8, 6, 4};
constexpr std::uint32_t kMinCount = 2;
constexpr double kCoarseVote = 0.25;  // of the image's sides: hardly visible (libibr/docs/tradeoff.md)

void addLevel(std::vector<RenderSettings>& levels, const RenderSettings& level) {
  if (!(level == levels.back())) levels.push_back(level);
}

// Limits the number of cells or photographs to `count`, if that is a reduction.
RenderSettings fewer(RenderSettings settings, std::uint32_t count, std::size_t cells, std::size_t photographs) {
  const bool ofCells = settings.composition == Composition::cells;  // the hybrid draws few cells
  std::uint32_t& most = ofCells ? settings.maxCells : settings.gatherCandidates;
  if (count < std::min<std::size_t>(most, ofCells ? cells : photographs)) most = count;
  return settings;
}

}  // namespace

std::vector<RenderSettings> ladder(const RenderSettings& requested, std::size_t cells, std::size_t photographs) {
  const bool ofCells = requested.composition == Composition::cells;
  std::vector<RenderSettings> levels{requested};
  const auto scaledBy = [&](double share) {
    RenderSettings level = levels.back();
    level.renderScale = share * requested.renderScale;
    addLevel(levels, level);
  };
  if (!ofCells && requested.voteScale > kCoarseVote) {
    RenderSettings coarse = requested;
    coarse.voteScale = kCoarseVote;
    addLevel(levels, coarse);
  }
  for (const std::uint32_t count : kCounts) addLevel(levels, fewer(levels.back(), count, cells, photographs));
  scaledBy(0.85);
  scaledBy(0.7);
  const bool gathered = requested.composition == Composition::gathered;
  RenderSettings dithered = levels.back();
  if (!gathered) dithered.blend = BlendMode::dither;
  addLevel(levels, dithered);
  addLevel(levels, fewer(levels.back(), kMinCount, cells, photographs));
  scaledBy(0.5);
  RenderSettings unmapped = levels.back();
  if (!gathered) unmapped.colourMapping = ColourMapping::off;
  addLevel(levels, unmapped);
  return levels;
}

std::string levelChange(const RenderSettings& from, const RenderSettings& to) {
  std::string text;
  const auto add = [&](bool differs, const char* what, const auto& before, const auto& after) {
    if (differs) text += fmt::format("{}{} {} → {}", text.empty() ? "" : ", ", what, before, after);
  };
  add(from.maxCells != to.maxCells, "cells", from.maxCells, to.maxCells);
  add(from.gatherCandidates != to.gatherCandidates, "photographs", from.gatherCandidates, to.gatherCandidates);
  add(from.voteScale != to.voteScale, "vote", fmt::format("{:.3g}", from.voteScale),
      fmt::format("{:.3g}", to.voteScale));
  add(from.renderScale != to.renderScale, "resolution", fmt::format("{:.3g}", from.renderScale),
      fmt::format("{:.3g}", to.renderScale));
  add(from.blend != to.blend, "blending", optionValue(from.blend), optionValue(to.blend));
  add(from.colourMapping != to.colourMapping, "colour mapping", optionValue(from.colourMapping),
      optionValue(to.colourMapping));
  return text;
}

}  // namespace ibr::app
