// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/frame_log.h"

#include <cmath>
#include <nlohmann/json.hpp>

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
  if (path_.empty()) return;
  file_.open(path_, std::ios::trunc);
  ibr::check(file_.good(), ErrorCode::io, "{}: cannot be written", path_.string());
}

void FrameLog::write(const Json& line) {
  if (!path_.empty()) file_ << jsonLine(line) << '\n' << std::flush;
}

void FrameLog::add(const FrameLogEntry& times) {
  ++frames_;
  missed_ += times.missed;
  if (times.intervalMs > 0) intervals_.push_back(times.intervalMs);
  processor_.push_back(times.processorMs);
  if (times.deviceMs > 0) device_.push_back(times.deviceMs);
  write({{"frame", times.frame},
         {"intervalMs", rounded(times.intervalMs)},
         {"processorMs", rounded(times.processorMs)},
         {"deviceMs", rounded(times.deviceMs)},
         {"level", times.level},
         {"cells", times.cells},
         {"missed", times.missed}});
}

void FrameLog::add(std::uint64_t frame, const std::string& decision) {
  ++decisions_;
  write({{"frame", frame}, {"decision", decision}});
}

Json FrameLog::finish() {
  const Json summary{{"frames", frames_},
                     {"intervalMs", percentiles(intervals_)},
                     {"processorMs", percentiles(processor_)},
                     {"deviceMs", percentiles(device_)},
                     {"missed", missed_},
                     {"decisions", decisions_}};
  write({{"summary", summary}});
  return summary;
}

void FrameLog::check() const {
  ibr::check(path_.empty() || file_.good(), ErrorCode::io, "{}: cannot be written completely", path_.string());
}

}  // namespace ibr::app
