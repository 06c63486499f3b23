// SPDX-License-Identifier: Apache-2.0
// Settings by name, and what a renderer needs for them.
#include "ibr/renderer.h"

namespace ibr {

// Chosen from the measured front of time and error over scenes of several kinds (libibr/docs/tradeoff.md). The hybrid
// wins over cells and over gathered pictures in most of them; a vote of a quarter of the sides loses .04 dB at most.
// No colour mapping: where gains are known it loses, where they are not it hardly wins. The numbers of cells are for
// scenes that cannot be gathered.
RenderSettings preset(Preset preset, DeviceKind kind) {
  constexpr double kCoarseVote = 0.25;
  const bool software = kind == DeviceKind::software;
  RenderSettings s;
  s.composition = Composition::hybrid;
  s.lowestTier = kTierFilled;
  switch (preset) {
    case Preset::fast:
      s.gatherCandidates = 6;
      s.gatherColours = 2;
      s.voteScale = kCoarseVote;
      s.maxCells = 2;
      s.extrapolationLimit = 1;
      break;
    case Preset::balanced:
      if (software) s.voteScale = kCoarseVote;
      break;
    case Preset::accurate:
      if (!software) s.voteScale = 1;
      s.maxCells = 24;
      s.colourProxy = 4;
      break;
    case Preset::reference:
      s.gatherCandidates = kMaxGatherCandidates;
      s.voteScale = 1;
      s.maxCells = kLargestCellCount;
      s.colourProxy = 2;
      s.colourPeriod = 1;
      s.shareEyeColours = false;
      break;
  }
  return s;
}

RendererOptions optionsFor(const RenderSettings& settings, VkExtent2D largest, VkFormat format) {
  RendererOptions options{.largest = largest};
  options.switchMixing = settings.switchSeconds > 0;
  options.fill = settings.lowestTier >= kTierFilled;
  options.formats = {format};
  options.compositions = {settings.composition};
  options.gatherCandidates = settings.gatherCandidates;
  options.gatherColours = settings.gatherColours;
  options.gatherLayers = settings.gatherLayers;
  options.voteScale = settings.voteScale;
  options.orders = {settings.order};
  options.blends = {settings.blend};
  options.dissolve = settings.fadeShare > 0 || settings.switchSeconds > 0;  // what changes its place fades too
  if (settings.overlay != Overlay::none) options.overlays = {settings.overlay};
  options.floor = settings.floor.has_value();
  options.largestScale = settings.renderScale == 1 ? 0 : settings.renderScale;
  switch (settings.colourMapping) {
    case ColourMapping::off:
      options.colour = ColourSupport::off;
      break;
    case ColourMapping::ours:
      options.colour = ColourSupport::ours;
      break;
    case ColourMapping::paper:
    case ColourMapping::paperRedraw:
      options.colour = ColourSupport::all;
      break;
  }
  return options;
}

}  // namespace ibr
