// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <mutex>

#include "shared/cli/signals.h"

namespace ibr::app {
namespace {

std::mutex stderrMutex;   // threads of the library may send messages
std::string barOnScreen;  // current text of the terminal's last line; guarded by stderrMutex

void put(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void setBar(std::string bar) {
  const std::lock_guard lock(stderrMutex);
  if (bar == barOnScreen) return;
  put("\r\033[K" + bar);
  std::fflush(stderr);
  barOnScreen = std::move(bar);
}

}  // namespace

std::string durationText(double seconds) {
  const auto whole = static_cast<long long>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

void writeBesideProgress(std::string_view line) {
  const std::lock_guard lock(stderrMutex);
  if (!barOnScreen.empty()) put("\r\033[K");
  put(line);
  put(barOnScreen);
  std::fflush(stderr);
}

ProgressLine::ProgressLine(const Context& context)
    : program_(context.options().program),
      visible_(!context.options().quiet),
      terminal_(::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (visible_ && terminal_) setBar("");
}

void ProgressLine::enter(std::string_view stage) {
  const auto now = Clock::now();
  if (!stages_.empty()) {
    if (stages_[current_].first == stage) return;
    stages_[current_].second += std::chrono::duration<double>(now - entered_).count();
  }
  const auto found = std::ranges::find(stages_, stage, [](const auto& s) { return std::string_view(s.first); });
  current_ = std::size_t(found - stages_.begin());
  if (found == stages_.end()) stages_.emplace_back(stage, 0.0);
  entered_ = now;
  tenths_ = -1;
}

std::vector<std::pair<std::string, double>> ProgressLine::stageSeconds() const {
  auto stages = stages_;
  if (!stages.empty()) stages[current_].second += std::chrono::duration<double>(Clock::now() - entered_).count();
  return stages;
}

bool ProgressLine::show(const Progress& progress) {
  const bool first = stages_.empty() || stages_[current_].first != progress.stage;
  enter(progress.stage);
  if (first) firstDone_ = progress.done;
  if (visible_) draw(progress);
  return !interrupted();
}

void ProgressLine::draw(const Progress& progress) {
  const auto now = Clock::now();
  const double share = progress.total > 0 ? double(progress.done) / double(progress.total) : 0.0;
  if (!terminal_) {
    const int tenths = int(share * 10);
    if (tenths == tenths_ || (tenths_ >= 0 && now - drawn_ < std::chrono::seconds(5))) return;
    tenths_ = tenths;
    drawn_ = now;
    writeBesideProgress(progress.total > 1 ? fmt::format("{}: {}: {} %\n", program_, progress.stage, tenths * 10)
                                           : fmt::format("{}: {}\n", program_, progress.stage));
    return;
  }
  if (now - drawn_ < std::chrono::milliseconds(100) && progress.done < progress.total) return;
  drawn_ = now;
  if (progress.total == 0) return setBar(fmt::format("{} …", progress.stage));
  constexpr int kWidth = 30;
  const int filled = int(share * kWidth);
  std::string rest;
  if (progress.done > firstDone_ && progress.done < progress.total) {
    const double elapsed = std::chrono::duration<double>(now - entered_).count();
    rest = ", " + durationText(elapsed * double(progress.total - progress.done) / double(progress.done - firstDone_)) +
           " left";
  }
  setBar(fmt::format("{} [{:#<{}}{:.<{}}] {}/{}{}", progress.stage, "", filled, "", kWidth - filled, progress.done,
                     progress.total, rest));
}

}  // namespace ibr::app
