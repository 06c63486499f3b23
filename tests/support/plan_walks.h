// SPDX-License-Identifier: Apache-2.0
// Settings that take different ways through planning, and indices that leave nothing out.
#pragma once

#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "ibr/frame_plan.h"
#include "render/plan/scene_index.h"

namespace ibr::test {

/// Returns bounds whose indices have one leaf each that no view leaves out, so that planning visits every cell and
/// every photograph.
inline SceneBounds withoutIndex(const Scene& scene, SceneBounds bounds) {
  constexpr auto kInfinity = std::numeric_limits<double>::infinity();
  const auto index = std::make_shared<SceneBounds::Index>(*bounds.index);
  index->cells = makeCellIndex(scene, bounds.cells, ~0u);
  for (CellIndex::Node& node : index->cells.nodes) {
    node.low = glm::dvec3(-kInfinity);
    node.high = glm::dvec3(kInfinity);
    node.shownLow = glm::vec3(-kInfinity);
    node.shownHigh = glm::vec3(kInfinity);
    node.maxSize = kInfinity;
  }
  std::iota(index->cells.cells.begin(), index->cells.cells.end(), 0u);
  index->photographs = makePhotographIndex(scene, ~0u);
  bounds.index = index;
  return bounds;
}

inline std::vector<RenderSettings> planSettings() {
  std::vector<RenderSettings> all;
  const auto add = [&](auto change) { change(all.emplace_back()); };
  add([](RenderSettings&) {});
  add([](RenderSettings& s) { s.colourMapping = ColourMapping::ours; });
  add([](RenderSettings& s) { s.composition = Composition::hybrid; });
  add([](RenderSettings& s) { s.composition = Composition::gathered; });
  add([](RenderSettings& s) { s.alignCells = true; });
  add([](RenderSettings& s) { s.morph = Morph::paper; });
  add([](RenderSettings& s) {
    s.order = DrawOrder::paper;
    s.colourMapping = ColourMapping::paper;
  });
  add([](RenderSettings& s) { s.extrapolationLimit = std::numeric_limits<double>::infinity(); });
  add([](RenderSettings& s) { s.extrapolationLimit = 0; });
  add([](RenderSettings& s) {
    s.maxCells = kMaxCellCount;
    s.extrapolationLimit = 6;
  });
  add([](RenderSettings& s) { s.mutedCells = {7, 3, 3, 20, 1000000}; });
  add([](RenderSettings& s) {
    s.composition = Composition::gathered;
    s.gatherCandidates = kMaxGatherCandidates;
    s.exposure = Exposure::scene;
  });
  return all;
}

}  // namespace ibr::test
