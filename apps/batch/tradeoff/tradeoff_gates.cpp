// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/cli/presets.h"
#include "shared/report/rank.h"

namespace ibr::app {
namespace {

bool isComparable(const TradeoffRow& row) {
  return row.failure.empty() && row.setting.variant.views == 1 && row.setting.variant.build == 0;
}

bool dominatesInTime(const TradeoffRow& other, const TradeoffRow& row) {
  return other.medianMs() < (1 - kDominance) * row.medianMs() && errorOf(other) < (1 - kDominance) * errorOf(row);
}

using Dominates = bool (*)(const TradeoffRow&, const TradeoffRow&);

TradeoffGate notDominated(const std::vector<TradeoffRow>& rows, std::size_t preset, const char* in, Dominates beats) {
  TradeoffGate gate{fmt::format("{} is not beaten in {}", kPresets[preset].first, in), true, "",
                    beats == dominatesInCounts};
  std::size_t beaten = 0;
  for (const TradeoffRow& row : rows) {
    if (!isComparable(row) || !beats(row, rows[preset])) continue;
    gate.holds = false;
    if (++beaten <= 3) gate.found += (gate.found.empty() ? "by " : ", by ") + row.setting.name();
  }
  if (beaten > 3) gate.found += fmt::format(" and {} more", beaten - 3);
  return gate;
}

// True if each value is at least the previous one, with the tolerance kDominance.
bool rises(const std::array<double, 4>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(values[i] >= values[i - 1] * (1 - kDominance))) return false;
  return true;
}

std::string numbers(const std::array<double, 4>& values, int decimals) {
  std::string text;
  for (std::size_t p = 0; p < values.size(); ++p)
    text += fmt::format("{}{} {:.{}f}", p == 0 ? "" : ", ", kPresets[p].first, values[p], decimals);
  return text;
}

template <class Value>
std::array<double, 4> ofPresets(const std::vector<TradeoffRow>& rows, Value value) {
  std::array<double, 4> values{};
  for (std::size_t p = 0; p < values.size(); ++p) values[p] = value(rows[p]);
  return values;
}

// Counts that determine a device's time: draws, triangles, shaded pixels (relative) and bytes.
std::array<double, 4> costs(const TradeoffRow& row) {
  const double scale = row.setting.variant.settings.renderScale;
  return {double(row.draws()), double(row.triangles()), scale * scale, double(row.bytes())};
}

// Skips pairs of presets with equal costs, whose times differ by noise alone.
bool risesInTime(const std::vector<TradeoffRow>& rows) {
  for (std::size_t p = 1; p < kPresets.size(); ++p)
    if (costs(rows[p]) != costs(rows[p - 1]) && !(rows[p].medianMs() >= rows[p - 1].medianMs() * (1 - kDominance)))
      return false;
  return true;
}

}  // namespace

bool dominatesInCounts(const TradeoffRow& other, const TradeoffRow& row) {
  const std::array<double, 4> theirs = costs(other), ours = costs(row);
  bool cheaper = false;
  for (std::size_t c = 0; c < ours.size(); ++c) {
    if (theirs[c] > ours[c]) return false;
    cheaper |= theirs[c] < (1 - kDominance) * ours[c];
  }
  return cheaper && errorOf(other) < (1 - kDominance) * errorOf(row);
}

std::vector<TradeoffGate> presetGates(const std::vector<TradeoffRow>& rows) {
  std::vector<TradeoffGate> gates;
  for (std::size_t p = 0; p < kPresets.size(); ++p)
    if (!rows[p].failure.empty()) return {{"all presets can be drawn", false, rows[p].failure, true}};
  for (std::size_t p = 0; p < kPresets.size(); ++p) {
    gates.push_back(notDominated(rows, p, "time and error", dominatesInTime));
    gates.push_back(notDominated(rows, p, "counts and error", dominatesInCounts));
  }
  const auto psnrs = ofPresets(rows, [](const TradeoffRow& row) { return row.truth().psnr; });
  if (std::isfinite(psnrs[3]))
    gates.push_back({"accurate has 99 % of the PSNR of reference", psnrs[2] >= kAccurateShare * psnrs[3],
                     fmt::format("{:.2f} dB of {:.2f} dB", psnrs[2], psnrs[3]), true});
  const auto times = ofPresets(rows, [](const TradeoffRow& row) { return row.medianMs(); });
  gates.push_back({"frame time rises from fast to reference", risesInTime(rows), numbers(times, 1) + " ms", false});
  auto errors = ofPresets(rows, errorOf);
  const std::string found = "FLIP " + numbers(errors, 4);
  gates.push_back({fmt::format("fast has at most {} times the error of balanced", kFastShare),
                   errors[0] <= kFastShare * errors[1], found, true});
  std::ranges::reverse(errors);
  gates.push_back({"error falls from fast to reference", rises(errors), found, true});
  return gates;
}

std::vector<std::size_t> timeFront(const std::vector<TradeoffRow>& rows) {
  std::vector<glm::dvec2> points;
  for (const TradeoffRow& row : rows)
    points.emplace_back(isComparable(row) ? row.medianMs() : std::nan(""), -errorOf(row));
  return paretoFront(points);
}

}  // namespace ibr::app
