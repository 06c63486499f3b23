// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/frame_log.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/check.h"
#include "shared/json/json_text.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// Rounds to microseconds.
double rounded(double ms) {
  return std::round(1e3 * ms) / 1e3;
}

Json percentiles(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {{"p50", rounded(quantile(values, 0.5))},
          {"p95", rounded(quantile(values, 0.95))},
          {"p99", rounded(quantile(values, 0.99))}};
}

}  // namespace

FrameLog::FrameLog(const std::filesystem::path& file) : path_(file) {
  constexpr std::size_t kReserved = 1 << 16;  // frames, 12 minutes at 90 Hz
  for (std::vector<double>* values : {&intervals_, &processor_, &device_}) values->reserve(kReserved);
  if (path_.empty()) return;
  file_.open(path_, std::ios::trunc);
  ibr::check(file_.good(), ErrorCode::io, "{}: cannot be written", path_.string());
  thread_ = std::thread([this] { run(); });
}

FrameLog::~FrameLog() {
  writeLines();
}

void FrameLog::run() {
  for (std::vector<Line> lines;;) {
    bool last = false;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !lines_.empty() || ending_; });
      lines.swap(lines_);
      last = ending_;
    }
    for (const auto& [times, decision] : lines)
      if (decision.empty())
        write({{"frame", times.frame},
               {"intervalMs", rounded(times.intervalMs)},
               {"processorMs", rounded(times.processorMs)},
               {"deviceMs", rounded(times.deviceMs)},
               {"level", times.level},
               {"cells", times.cells},
               {"missed", times.missed}});
      else
        write({{"frame", times.frame}, {"decision", decision}});
    lines.clear();
    file_.flush();
    if (last) return;
  }
}

void FrameLog::write(const Json& line) {
  file_ << jsonLine(line) << '\n';
}

// Waits until the thread has written all lines.
void FrameLog::writeLines() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void FrameLog::add(Line line) {
  if (path_.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::move(line));
  }
  changed_.notify_one();
}

void FrameLog::add(const FrameLogEntry& times) {
  ++frames_;
  missed_ += times.missed;
  if (times.intervalMs > 0) intervals_.push_back(times.intervalMs);
  processor_.push_back(times.processorMs);
  if (times.deviceMs > 0) device_.push_back(times.deviceMs);
  add(Line{times, {}});
}

void FrameLog::add(std::uint64_t frame, const std::string& decision) {
  ++decisions_;
  add(Line{{.frame = frame}, decision});
}

Json FrameLog::finish() {
  const Json summary{{"frames", frames_},
                     {"intervalMs", percentiles(intervals_)},
                     {"processorMs", percentiles(processor_)},
                     {"deviceMs", percentiles(device_)},
                     {"missed", missed_},
                     {"decisions", decisions_}};
  writeLines();
  if (!path_.empty()) {
    write({{"summary", summary}});
    file_.flush();
  }
  return summary;
}

void FrameLog::check() const {
  ibr::check(path_.empty() || file_.good(), ErrorCode::io, "{}: cannot be written completely", path_.string());
}

}  // namespace ibr::app
