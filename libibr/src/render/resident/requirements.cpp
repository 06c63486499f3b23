// SPDX-License-Identifier: Apache-2.0
#include "ibr/requirements.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/photographs/photograph_choice.h"

namespace ibr {
namespace {

bool has(const auto& list, auto value) {
  return std::ranges::find(list, value) != std::ranges::end(list);
}

bool isPanorama(const Scene& scene, std::uint32_t node) {
  return scene.nodes[node].camera.intrinsics.model == CameraModel::equirectangular;
}

Requirements ofScene(const Scene& scene) {
  Requirements r;
  r.cells = std::uint32_t(scene.cells.size());
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    ++(isPanorama(scene, n) ? r.panoramas : r.pinholes);
    r.gains = r.gains || scene.nodes[n].gain != glm::dvec3(1.0);
  }
  r.masked = std::uint32_t(std::ranges::count_if(scene.nodes, [](const Node& node) { return !node.maskFile.empty(); }));
  for (const Cell& cell : scene.cells) {
    ++r.cellsByMemberCount[cell.members.size()];
    const auto panoramas =
        std::ranges::count_if(cell.members, [&](std::uint32_t member) { return isPanorama(scene, member); });
    r.mixedCells += panoramas != 0 && std::size_t(panoramas) != cell.members.size();
  }
  r.gatherable = std::uint32_t(gatherableBackdrops(scene).size());
  return r;
}

}  // namespace

Requirements withOptions(Requirements r, const RendererOptions& options) {
  const bool several = r.cells > 1;  // one cell needs no order, no switch and no colour mapping
  const bool any = r.cells + r.gatherable > 0;
  r.colourTables = several && options.colour != ColourSupport::off;
  r.colourSequence = r.colourTables && options.colour == ColourSupport::all;
  r.depthOrder = any && has(options.orders, DrawOrder::ours);
  r.painterOrder = r.cells > 0 && (has(options.orders, DrawOrder::paper) || r.colourSequence);
  r.dissolve = r.cells > 0 && options.dissolve;
  r.noise = r.dissolve || r.colourSequence ||  // its counting chooses pixels by noise
            (r.cells > 0 && (has(options.blends, BlendMode::dither) || has(options.blends, BlendMode::mixed)));
  r.crossFadeOrders = several && options.crossFadeOrders;
  r.fill = any && options.fill && r.masked == 0;  // planFrame does not fill scenes with masks
  r.depth = options.depth;
  r.multiview = any && options.maxViews == 2 && options.multiview;
  r.overlays.clear();
  for (const Overlay overlay : options.overlays)
    if (overlay != Overlay::none && !has(r.overlays, overlay)) r.overlays.push_back(overlay);
  r.buffers = options.bufferScene != nullptr;
  r.gather = r.gatherable > 0 &&
             (has(options.compositions, Composition::gathered) || has(options.compositions, Composition::hybrid));
  r.floor = options.floor;
  r.hiddenArea =
      r.depthOrder && (!options.hiddenArea[0].empty() || (options.maxViews == 2 && !options.hiddenArea[1].empty()));
  const std::uint32_t fadingOut = r.cells > 0 ? kMaxFadingOutCount : 0;
  r.maxDrawItems = std::min(r.cells, kMaxCellCount) + fadingOut;
  return r;
}

Requirements requirementsOf(const Scene& scene, const RendererOptions& options) {
  return withOptions(ofScene(scene), options);
}

std::vector<StageExplanation> explain(const Requirements& r, const RendererOptions& options) {
  std::vector<StageExplanation> stages;
  const auto add = [&](std::string name, bool runs, std::string why) {
    stages.push_back({std::move(name), runs, std::move(why)});
  };
  const char* const kinds[] = {"", "", "lines", "triangles", "tetrahedra"};
  for (std::size_t d = 2; d <= 4; ++d)
    add(fmt::format("shaders for cells of {} photographs", d), r.cellsByMemberCount[d] > 0,
        fmt::format("{} cells are {}", r.cellsByMemberCount[d], kinds[d]));
  add("pinhole coordinates", r.pinholes > 0, fmt::format("{} photographs are pinholes", r.pinholes));
  add("panorama coordinates", r.panoramas > 0,
      fmt::format("{} photographs are panoramas, {} cells are mixed", r.panoramas, r.mixedCells));
  add("masks", r.masked > 0, fmt::format("{} photographs have a mask", r.masked));
  add("depth test", r.depthOrder, r.depthOrder ? "cells and folds within a cell occlude one another" : "not requested");
  add("painter's algorithm", r.painterOrder,
      r.painterOrder
          ? (r.colourSequence ? "required by the paper's colour mapping" : "the paper's draw order is requested")
          : "not requested");
  add("dissolve", r.dissolve, r.dissolve ? "reordered and distant cells fade" : "not requested, or no cells");
  add("blue noise", r.noise, r.noise ? "used by dithering or dissolve" : "no dithering or dissolve");
  const char* const alone = "at most one cell: no switches and no colours to match";
  add("vote and gather", r.gather,
      r.gather ? fmt::format("{} photographs have a depth texture and evidence in the backdrop mesh", r.gatherable)
      : r.gatherable > 0 ? "not requested"
                         : "no photograph has a depth texture and evidence in the backdrop mesh");
  add("cross-fade of main cell switches", r.crossFadeOrders,
      r.crossFadeOrders ? "the main cell can change" : (r.cells > 1 ? "not requested" : alone));
  add("exposure gains", r.gains, r.gains ? "exposures of photographs differ" : "one exposure, or none measured");
  add("colour tables", r.colourTables,
      r.colourTables ? "exposures may differ" : (r.cells > 1 ? "not requested" : alone));
  add("the paper's colour sequence", r.colourSequence, r.colourSequence ? "requested" : "not requested");
  add("hole filling", r.fill,
      r.fill                         ? "requested"
      : options.fill && r.masked > 0 ? "masked regions of photographs are not filled"
                                     : "not requested");
  add("depth target", r.depth, r.depth ? "requested" : "not requested");
  add("multiview", r.multiview, r.multiview ? "two views" : "one view, or not requested");
  add("overlays", !r.overlays.empty(), r.overlays.empty() ? "not requested" : "requested");
  add("buffers of depth, tier and weights", r.buffers, r.buffers ? "requested" : "not requested");
  add("guiding floor", r.floor, r.floor ? "requested" : "not requested");
  add("hidden area", r.hiddenArea, r.hiddenArea ? "the lenses hide some pixels" : "not given, or no depth test");
  add("render scale", options.maxRenderScale > 0,
      options.maxRenderScale > 0 ? "cells may be drawn at another resolution" : "not requested");
  return stages;
}

}  // namespace ibr
