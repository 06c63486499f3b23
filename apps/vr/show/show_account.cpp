// SPDX-License-Identifier: Apache-2.0
// Show: frame statistics and screenshots.
#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "ibr/error.h"
#include "shared/cli/settings.h"
#include "vr/headset/eye_pictures.h"
#include "vr/show/show.h"

namespace ibr::app {

void Show::account(const XrMoment& moment, double seconds, double processorMs) {
  constexpr double kPause = 1;  // s: a longer interval is a pause, not a slow frame
  if (seconds == 0 || seconds > kPause) excuse(governor_);
  pending_[slot_] = {{.frame = ++visit_.shown,
                      .intervalMs = seconds > kPause ? 0 : 1e3 * seconds,
                      .processorMs = processorMs,
                      .level = visit_.governed ? governor_.level : 0,
                      .cells = place_->plan().cells.size(),
                      .missed = moment.periodMs > 0 && seconds > 1.5e-3 * moment.periodMs && seconds <= kPause},
                     moment.periodMs};
  // The slots of the last frames are not used again, so their statistics are written here, without device times.
  if (visit_.shown != options().frames) return;
  for (std::uint32_t i = 1; i <= FrameRing::kSlots; ++i) conclude((slot_ + i) % FrameRing::kSlots, 0);
}

void Show::conclude(std::uint32_t slot, double deviceMs) {
  if (!pending_[slot]) return;
  Pending pending = *std::exchange(pending_[slot], std::nullopt);
  FrameTimes& times = pending.times;
  times.deviceMs = deviceMs;
  visit_.log.add(times);
  tellPace(times, pending.periodMs);
  if (!visit_.governed || !place_) return;
  const Decision decision = govern(
      governor_,
      {.workMs = std::max(times.processorMs, times.deviceMs), .periodMs = pending.periodMs, .missed = times.missed});
  if (decision.reason.empty()) return;
  visit_.log.add(times.frame, decision.reason);
  say(LogLevel::info, decision.reason);
}

// Updates the menu's line every 0.5 s, so that people can read it.
void Show::tellPace(const FrameTimes& times, double periodMs) {
  constexpr double kSeconds = 0.5;
  paceSeconds_ += 1e-3 * times.intervalMs;
  if (paceSeconds_ < kSeconds) return;
  paceSeconds_ = 0;
  pace_ = fmt::format("{:.1f} ms of {:.1f} ms per frame, {} cells", std::max(times.processorMs, times.deviceMs),
                      periodMs, times.cells);
  if (times.level > 0)
    pace_ += fmt::format(", detail reduced by {} of {} levels", times.level, governor_.levels.size() - 1);
}

bool Show::wantsPicture() const {
  const std::uint64_t number = visit_.shown + 1;
  const bool last = number == options().frames && !options().screenshot.empty();
  return last || pictureAsked_ || (options().screenshotEvery > 0 && number % options().screenshotEvery == 0);
}

void Show::writePictures(const std::vector<Camera>& eyes) {
  const Stopwatch writing;
  ring_.wait();
  const bool last = visit_.shown + 1 == options().frames && !options().screenshot.empty();
  try {
    const std::filesystem::path file = last ? options().screenshot : freePicture(options().screenshots);
    const auto written =
        writeEyes(file, capture_.read(), eyes, pictureSettingsJson(drawnWith_, options().gpuScene, floor_));
    visit_.pictures.insert(visit_.pictures.end(), written.begin(), written.end());
    say(LogLevel::info, fmt::format("{} and {} written", written[0].string(), written[1].string()));
  } catch (const std::exception& e) {
    if (last) throw;  // the requested screenshot failed, so the program fails
    trouble_ = e.what();
    say(LogLevel::error, trouble_);
  }
  pictureAsked_ = false;
  notWorkMs_ += 1e3 * writing.seconds();
  excuse(governor_);
}

}  // namespace ibr::app
