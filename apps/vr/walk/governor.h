// SPDX-License-Identifier: Apache-2.0
// The frame governor: reduces quality before frames are missed, and restores it where the better level is predicted to
// fit. Pure: no clock; time is counted in display periods.
#pragma once

#include <array>
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

/// Cost of a level divided by the cost of the next cheaper one, measured when the level changed.
struct StepRatio {
  double ratio = 0;       // 1 or more; 0: never measured
  double measuredAt = 0;  // GovernorState::seconds
};

struct GovernorState {
  std::vector<RenderSettings> levels;           // as returned by ladder()
  std::size_t level = 0;                        // index into levels
  std::uint64_t frame = 0;                      // number of frames measured so far
  double seconds = 0;                           // sum of these frames' periods
  double periodMs = 0;                          // last known; 0: none
  static constexpr std::size_t kMaxRecent = 8;  // number of recent frames that decide
  std::array<double, kMaxRecent> recent{};      // ms of the last frames at this level, oldest first
  std::size_t recentCount = 0;                  // of valid values in `recent`
  int ignored = 0;                              // frames to ignore, because they began before the last step
  double headroomSeconds = 0;                   // time for which the next better level was predicted to fit
  double levelSeconds = 0;                      // time at this level
  std::vector<StepRatio> ratios;                // by level, the last one unused
  std::vector<int> reversals;                   // by level: consecutive steps up to it that were reversed soon
  struct Step {
    std::size_t from;
    double costMs;
  };
  std::optional<Step> lastStep;      // level before the last step, and its cost; none at the start and after a pause
  bool lastStepMeasured = false;     // the ratios of that step are known
  bool lowestLevelReported = false;  // too slow at the cheapest level, and reported
};

/// `ladder`: at least one level.
GovernorState startGovernor(std::vector<RenderSettings> ladder);

/// Continues with other settings or another scene: keeps the level if the new ladder is long enough, and forgets all
/// costs and ratios.
void changeLadder(GovernorState& state, std::vector<RenderSettings> ladder);

/// Ignores the next frames: they are slow for reasons other than drawing (a file was written, pipelines were built, the
/// headset was off).
void ignoreNextFrames(GovernorState& state);

struct Decision {
  std::size_t level = 0;  // level of the next frame, index into GovernorState::levels
  std::string reason;     // log line if something was decided, else empty:
                          // "frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"
};

/// Predicted time of a frame at the next better level, ms, from the recent frames and the measured ratio. A ratio that
/// was never measured counts as 1.3; so does a higher one after a minute, since the view has changed meanwhile. Each
/// step up that was reversed soon doubles this minute, up to four minutes. 0 at the best level and without frames.
double predictedMs(const GovernorState& state);

/// Decides the level of the next frame from a measured one. Down, one level: when two of the last
/// eight frames took over 85 % of the period, which is before a frame is missed while a load grows. At
/// once after a miss if another recent frame took over 60 %. Two levels if the frames exceed the
/// period by a quarter. A single late frame changes nothing. Up: one level after predictedMs() has
/// been below 78 % of the period for 1.5 s. Each step measures the ratio of the two levels' costs, on the way down too.
/// Frames begun before a step are ignored.
Decision govern(GovernorState& state, const FrameCost& cost);

}  // namespace ibr::app
