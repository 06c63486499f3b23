// SPDX-License-Identifier: Apache-2.0
// The frame governor: reduces quality before frames are missed, and restores it when there is room. Pure: no clock;
// time is counted in display periods.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

/// Returns the levels from the requested settings (first) to the cheapest; each level reduces one thing. With
/// composition gathered or hybrid, the first step is a vote at 0.25 of the size. Then, in this order:
/// - number of photographs gathered from (composition cells: of cells), down to 4: the best are kept;
/// - resolution 0.85 and 0.7 of the requested one: softer, but without grain;
/// - dithering instead of blending: reads one photograph per pixel instead of all of a cell. [T] §2.5.1 finds the
///   grain much more visible on a headset and advises against it, so a softer image comes first;
/// - the number of cells or photographs down to 2, where holes may open;
/// - resolution 0.5;
/// - colour mapping off: last, because it changes how everything looks.
/// Levels that would change nothing are left out: `cells` and `photographs` are the scene's numbers of them.
std::vector<RenderSettings> ladder(const RenderSettings& requested, std::size_t cells = kMaxCellCount,
                                   std::size_t photographs = kMaxGatherCandidates);

/// Describes the difference between two levels, for people: "photographs 12 → 8".
std::string levelChange(const RenderSettings& from, const RenderSettings& to);

struct FrameCost {
  double workMs = 0;    // max. of CPU and GPU time; not above 0 or not finite: unknown
  double periodMs = 0;  // of the display; not above 0 or not finite: unchanged
  bool missed = false;  // shown late, or the previous frame was shown twice
};

struct GovernorState {
  std::vector<RenderSettings> levels;  // as returned by ladder()
  std::size_t level = 0;               // index into levels
  std::uint64_t frame = 0;             // number of frames measured so far
  double periodMs = 0;                 // last known; 0: none
  std::vector<double> recent;          // ms of the last frames at this level, oldest first
  int ignored = 0;                     // frames to ignore, because they began before the last step
  double headroomSeconds = 0;          // time with headroom so far
  double levelSeconds = 0;             // time at this level
  bool lastStepWasUp = false;          // the last step was up
  double costBeforeStepUpMs = 0;       // cost before that step
  std::vector<int> reversals;          // by level: consecutive steps up to it that were reversed soon
  std::vector<double> reversedCostMs;  // by level: cost of the next cheaper level when that happened
  bool lowestLevelReported = false;    // too slow at the cheapest level, and reported
};

/// `ladder`: at least one level.
GovernorState startGovernor(std::vector<RenderSettings> ladder);

/// Continues with other settings or another scene: keeps the level if the new ladder is long enough, and forgets all
/// costs.
void changeLadder(GovernorState& state, std::vector<RenderSettings> ladder);

/// Ignores the next frames: they are slow for reasons other than drawing (a file was written, pipelines were built, the
/// headset was off).
void ignoreNextFrames(GovernorState& state);

struct Decision {
  std::size_t level = 0;  // level of the next frame, index into GovernorState::levels
  std::string reason;     // log line if something was decided, else empty:
                          // "frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"
};

/// Decides the level of the next frame from a measured one. Down, one level: when two of the last
/// eight frames took over 85 % of the period, which is before a frame is missed while a load grows. At
/// once after a miss if another recent frame took over 60 %. Two levels if the frames exceed the
/// period by a quarter. A single late frame changes nothing. Up: one level after 1.5 s below 60 %. If
/// that step is reversed within 10 s (longer after longer waits), the next attempt waits twice as
/// long, up to 96 s. A load that has fallen by a fifth resets the wait. Frames begun before a step are
/// ignored.
Decision govern(GovernorState& state, const FrameCost& cost);

}  // namespace ibr::app
