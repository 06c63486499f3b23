// SPDX-License-Identifier: Apache-2.0
#include "ibr/renderer.h"

namespace ibr {

RendererOptions optionsFor(const RenderSettings& settings, VkExtent2D maxExtent, TargetFormat format) {
  RendererOptions options{.maxExtent = maxExtent};
  options.crossFadeOrders = settings.switchSeconds > 0;
  options.fill = settings.maxTier >= kTierFilled;
  options.formats = {format};
  options.compositions = {settings.composition};
  options.gatherCandidates = settings.gatherCandidates;
  options.gatherColours = settings.gatherColours;
  options.gatherLayers = settings.gatherLayers;
  options.voteScale = settings.voteScale;
  options.orders = {settings.order};
  options.blends = {settings.blend};
  options.dissolve = settings.fadeShare > 0 || settings.switchSeconds > 0;  // cells that change rank fade too
  if (settings.overlay != Overlay::none) options.overlays = {settings.overlay};
  options.floor = settings.floor.has_value();
  options.maxRenderScale = settings.renderScale == 1 ? 0 : settings.renderScale;
  switch (settings.colourMapping) {
    case ColourMapping::off:
      options.colour = ColourSupport::off;
      break;
    case ColourMapping::ours:
      options.colour = ColourSupport::ours;
      break;
    case ColourMapping::paper:
    case ColourMapping::paperRedraw:
      options.colour = ColourSupport::all;
      break;
  }
  return options;
}

}  // namespace ibr
