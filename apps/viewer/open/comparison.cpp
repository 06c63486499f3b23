// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "ibr/metrics.h"
#include "shared/cli/presets.h"
#include "viewer/open/item_on_device.h"

namespace ibr::app {
namespace {

constexpr const char* kReference = "reference";

}  // namespace

bool SettingsComparison::done() const {
  return std::ranges::all_of(lines, [](const ComparedSettings& line) { return line.measured.has_value(); });
}

SettingsComparison comparisonOf(const OpenItem& item, VkExtent2D extent, DeviceKind kind) {
  SettingsComparison comparison{.view = cameraOf(item, extent)};
  for (const auto& [name, preset] : kPresets)
    comparison.lines.push_back({name, withPreset(item.settings, preset, kind), {}});
  comparison.lines.push_back({kCurrentSettingsName, item.settings, {}});
  for (ComparedSettings& line : comparison.lines)
    line.settings.overlay = Overlay::none;  // compares the images without overlays
  return comparison;
}

void measureNext(SettingsComparison& comparison, ItemOnDevice& item, std::uint64_t& frame) {
  // The reference first: the other images are compared with it.
  const auto wanted = [&](const ComparedSettings& line) {
    return !line.measured && (!comparison.reference.values.empty() || line.name == std::string_view(kReference));
  };
  const auto line = std::ranges::find_if(comparison.lines, wanted);
  if (line == comparison.lines.end()) return;
  TimedImage picture = item.timed(comparison.view, line->settings, frame);
  if (comparison.reference.values.empty()) comparison.reference = picture.image;
  line->measured = {picture.milliseconds, psnr(picture.image, comparison.reference)};
}

std::string text(const ComparedSettings& effect) {
  if (!effect.measured) return "measuring ...";
  const ComparedSettings::Measured& m = *effect.measured;
  if (effect.name == std::string_view(kReference)) return fmt::format("{:.1f} ms", m.milliseconds);
  if (std::isinf(m.psnr)) return fmt::format("{:.1f} ms, identical to the reference", m.milliseconds);
  return fmt::format("{:.1f} ms, {:.1f} dB", m.milliseconds, m.psnr);
}

}  // namespace ibr::app
