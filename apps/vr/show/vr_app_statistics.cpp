// SPDX-License-Identifier: Apache-2.0
// VrApp: frame statistics.
#include <algorithm>
#include <iterator>
#include <utility>

#include "vr/show/vr_app.h"

namespace ibr::app {

void VrApp::recordStatistics(const XrFrameTiming& timing, double seconds, double processorMs) {
  constexpr double kPause = 1;  // s: a longer interval is a pause, not a slow frame
  if (seconds == 0 || seconds > kPause) ignoreNextFrames(governor_);
  pending_[slot_] = {{.frame = ++state_.shown,
                      .intervalMs = seconds > kPause ? 0 : 1e3 * seconds,
                      .processorMs = processorMs,
                      .level = state_.governorEnabled ? governor_.level : 0,
                      .cells = scene_->plan().cells.size(),
                      .missed = timing.periodMs > 0 && seconds > 1.5e-3 * timing.periodMs && seconds <= kPause},
                     timing.periodMs};
  // The slots of the last frames are not used again, so their statistics are written here, without device times.
  if (state_.shown != options().frames) return;
  for (std::uint32_t i = 1; i <= FrameRing::kSlots; ++i) finishStatistics((slot_ + i) % FrameRing::kSlots, 0);
}

void VrApp::finishStatistics(std::uint32_t slot, double deviceMs) {
  if (!pending_[slot]) return;
  Pending pending = *std::exchange(pending_[slot], std::nullopt);
  FrameLogEntry& times = pending.times;
  times.deviceMs = deviceMs;
  state_.log.add(times);
  updateStatusLine(times, pending.periodMs);
  if (!state_.governorEnabled || !scene_) return;
  const Decision decision = govern(
      governor_,
      {.workMs = std::max(times.processorMs, times.deviceMs), .periodMs = pending.periodMs, .missed = times.missed});
  if (decision.reason.empty()) return;
  state_.log.add(times.frame, decision.reason);
  logMessage(LogLevel::info, decision.reason);
}

// Updates the menu's line every 0.5 s, so that people can read it.
void VrApp::updateStatusLine(const FrameLogEntry& times, double periodMs) {
  constexpr double kSeconds = 0.5;
  statusSeconds_ += 1e-3 * times.intervalMs;
  if (statusSeconds_ < kSeconds) return;
  statusSeconds_ = 0;
  statusLine_.clear();
  fmt::format_to(std::back_inserter(statusLine_), "{:.1f} ms of {:.1f} ms per frame, {} cells",
                 std::max(times.processorMs, times.deviceMs), periodMs, times.cells);
  if (times.level > 0)
    fmt::format_to(std::back_inserter(statusLine_), ", detail reduced by {} of {} levels", times.level,
                   governor_.levels.size() - 1);
}

}  // namespace ibr::app
