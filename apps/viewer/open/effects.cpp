// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "ibr/metrics.h"
#include "shared/cli/presets.h"
#include "viewer/open/place_on_device.h"

namespace ibr::app {
namespace {

constexpr const char* kReference = "reference";

}  // namespace

bool Effects::done() const {
  return std::ranges::all_of(lines, [](const Effect& line) { return line.measured.has_value(); });
}

Effects effectsOf(const OpenItem& place, VkExtent2D extent, DeviceKind kind) {
  Effects effects{.view = cameraOf(place, extent)};
  for (const auto& [name, preset] : kPresets)
    effects.lines.push_back({name, presetOver(place.settings, preset, kind), {}});
  effects.lines.push_back({kAsSet, place.settings, {}});
  for (Effect& line : effects.lines) line.settings.overlay = Overlay::none;  // compares the images without overlays
  return effects;
}

void measureNext(Effects& effects, PlaceOnDevice& place, std::uint64_t& frame) {
  // The reference first: the other images are compared with it.
  const auto wanted = [&](const Effect& line) {
    return !line.measured && (!effects.reference.values.empty() || line.name == std::string_view(kReference));
  };
  const auto line = std::ranges::find_if(effects.lines, wanted);
  if (line == effects.lines.end()) return;
  TimedPicture picture = place.timed(effects.view, line->settings, frame);
  if (effects.reference.values.empty()) effects.reference = picture.image;
  line->measured = {picture.milliseconds, psnr(picture.image, effects.reference)};
}

std::string text(const Effect& effect) {
  if (!effect.measured) return "measuring ...";
  const Effect::Measured& m = *effect.measured;
  if (effect.name == std::string_view(kReference)) return fmt::format("{:.1f} ms", m.milliseconds);
  if (std::isinf(m.psnr)) return fmt::format("{:.1f} ms, identical to the reference", m.milliseconds);
  return fmt::format("{:.1f} ms, {:.1f} dB", m.milliseconds, m.psnr);
}

}  // namespace ibr::app
