// SPDX-License-Identifier: Apache-2.0
// The frame governor: holds a frame's time by drawing less before frames are missed, and more again when there is room.
// Pure: no clock, time is counted in periods.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

/// From what is asked for (the first) to the cheapest, each level cheaper than the one before by one thing and in
/// nothing above it. In this order:
/// - photographs that are gathered from (composition cells: cells), down to 4: the best are kept;
/// - resolution, to 0.85 and 0.7 of what is asked: soft, but still;
/// - dithering for blending: one photograph is read a pixel instead of all of a cell, but [T] §2.5.1 finds the grain
///   much more visible on a headset and advises against it, so a softer picture comes before a grainy one;
/// - these down to 2, where holes may open;
/// - resolution 0.5;
/// - colour mapping off: last, as it changes how everything looks.
/// Levels that would change nothing are left out: `cells` and `photographs` are how many the scene has.
std::vector<RenderSettings> ladder(const RenderSettings& asked, std::size_t cells = kLargestCellCount,
                                   std::size_t photographs = kMaxGatherCandidates);

/// What tells two levels apart, for people: "photographs 12 → 8".
std::string levelChange(const RenderSettings& from, const RenderSettings& to);

struct FrameCost {
  double workMs = 0;    // the longer of what processor and device took; not above 0 or not finite: not known
  double periodMs = 0;  // of the display; not above 0 or not finite: as before
  bool missed = false;  // it was shown late, or its predecessor twice
};

struct GovernorState {
  std::vector<RenderSettings> levels;  // ladder
  std::size_t level = 0;               // of levels
  std::uint64_t frame = 0;             // frames governed so far
  double periodMs = 0;                 // the last that was known, 0: none
  std::vector<double> recent;          // ms, the last frames' at this level, oldest first
  int ignored = 0;                     // frames still to come that were begun before the last step
  double roomSeconds = 0;              // for which there has been headroom
  double heldSeconds = 0;              // at this level
  bool climbed = false;                // the last step was up
  double climbCostMs = 0;              // before that step
  std::vector<int> taken;              // of each level: how often in a row it was stepped up to and taken back soon
  std::vector<double> takenCostMs;     // of each level: what the next cheaper took when that happened
  bool exhausted = false;              // too slow at the cheapest level, and that was said
};

/// `ladder`: at least one level.
GovernorState startGovernor(std::vector<RenderSettings> ladder);

/// Other settings are asked for, or another scene is shown: at the same level as far as there is one; of costs nothing
/// is remembered.
void changeLadder(GovernorState& state, std::vector<RenderSettings> ladder);

/// What comes now is not the fault of what is drawn (a file was written, pipelines were made, the headset was off): the
/// next frames are not looked at.
void excuse(GovernorState& state);

struct Decision {
  std::size_t level = 0;  // to draw the next frame with, of GovernorState::levels
  std::string reason;     // a line for a log where something was decided, else empty:
                          // "frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"
};

/// One frame has been measured.
/// Down: when two of the last eight took more than 85 % of the period, which is before one is missed while a load
/// grows; after a miss at once, where another of them had little room too; two levels when they are over by a quarter.
/// A single frame, however late, changes nothing while the others have room. Up: after 1.5 s below 60 %, one level;
/// where that has to be taken back within 10 s (longer after longer waits) the next try waits twice as long, up to 96
/// s, unless the load has become smaller by a fifth. The first frames after a step were begun before it and are not
/// looked at.
Decision govern(GovernorState& state, const FrameCost& cost);

}  // namespace ibr::app
