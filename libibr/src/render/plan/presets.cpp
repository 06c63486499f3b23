// SPDX-License-Identifier: Apache-2.0
#include "ibr/render_settings.h"

namespace ibr {

// Chosen from the measured Pareto front of time and error over scenes of several kinds (libibr/docs/tradeoff.md). The
// hybrid beats cells and gathered images in most scenes; a vote at a quarter of the sides loses .04 dB at most. Colour
// mapping is off: it loses where gains are known, and hardly gains where they are not. The numbers of cells are for
// scenes that cannot be gathered.
RenderSettings preset(Preset preset, DeviceKind kind) {
  constexpr double kCoarseVote = 0.25;
  const bool software = kind == DeviceKind::software;
  RenderSettings s;
  s.composition = Composition::hybrid;
  s.maxTier = kTierFilled;
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
      break;
    case Preset::reference:
      s.gatherCandidates = kMaxGatherCandidates;
      s.voteScale = 1;
      s.maxCells = kMaxCellCount;
      break;
  }
  return s;
}

}  // namespace ibr
