// SPDX-License-Identifier: Apache-2.0
#include "render/exceeded_option.h"

#include <algorithm>

#include "base/vulkan/target_format.h"

namespace ibr {
namespace {

template <class T>
bool contains(const std::vector<T>& values, T value) {
  return std::ranges::find(values, value) != values.end();
}

bool isMapped(ColourMapping mapping, ColourSupport support) {
  return mapping == ColourMapping::off || support == ColourSupport::all ||
         (mapping == ColourMapping::ours && support == ColourSupport::ours);
}

bool isTranslucent(const FramePlan& plan) {
  const auto below1 = [](const PlannedCell& cell) { return cell.opacity < 1; };
  return std::ranges::any_of(plan.cells, below1) || std::ranges::any_of(plan.previous, below1) ||
         std::ranges::any_of(plan.fadingOut, below1, &FadingOutCell::planned);
}

bool fits(const FramePlan& plan, VkExtent2D extent) {
  return std::ranges::all_of(plan.views, [&](const Camera& view) {
    return std::uint32_t(view.intrinsics.width) <= extent.width &&
           std::uint32_t(view.intrinsics.height) <= extent.height;
  });
}

}  // namespace

const char* exceededOption(const FramePlan& plan, const RendererOptions& options) noexcept {
  const RenderSettings& settings = plan.settings;
  if (plan.views.empty() || plan.views.size() > options.maxViews) return "maxViews";
  if (!fits(plan, options.maxExtent)) return "maxExtent";
  if (!contains(options.orders, settings.order)) return "orders";
  if (!contains(options.blends, settings.blend)) return "blends";
  if (settings.composition != Composition::cells && !contains(options.compositions, settings.composition))
    return "compositions";
  if (plan.photographs.size() > options.gatherCandidates) return "gatherCandidates";
  if (settings.composition != Composition::cells) {
    if (settings.gatherColours != options.gatherColours) return "gatherColours";
    if (settings.gatherLayers != options.gatherLayers) return "gatherLayers";
    if (settings.voteScale > options.voteScale) return "voteScale";
  }
  if (options.maxRenderScale > 0 && settings.renderScale > options.maxRenderScale) return "maxRenderScale";
  if (!isMapped(settings.colourMapping, options.colour)) return "colour";
  if (settings.overlay != Overlay::none && !contains(options.overlays, settings.overlay)) return "overlays";
  if (settings.floor && !options.floor) return "floor";
  if (!options.dissolve && isTranslucent(plan)) return "dissolve";
  return nullptr;
}

const char* exceededOption(const Target& target, const RendererOptions& options) noexcept {
  if (!contains(options.formats, formatOf(target))) return "formats";
  if (target.depth && !options.depth) return "depth";
  return nullptr;
}

}  // namespace ibr
