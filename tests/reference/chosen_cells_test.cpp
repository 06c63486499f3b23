// SPDX-License-Identifier: Apache-2.0
// Muted cells and solo cells: RenderSettings::mutedCells, soloCells.
#include <catch2/catch.hpp>

#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Three cells that partly hide one another.
const SyntheticScene& threeCells() {
  static const SyntheticScene place = [] {
    SyntheticOptions options = test::place(4);
    options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
    SyntheticScene made = makeScene(options);
    for (std::size_t i = 0; i < made.photographs.size(); ++i)  // different exposures
      for (std::uint8_t& value : made.photographs[i].values) value = std::uint8_t(value / 2 + 30 * i);
    return made;
  }();
  return place;
}

SyntheticScene without(std::vector<std::uint32_t> cells) {
  SyntheticScene place = threeCells();
  std::erase_if(place.scene.cells, [&](const Cell& cell) {
    const Cell* all = place.scene.cells.data();
    return std::ranges::find(cells, std::uint32_t(&cell - all)) != cells.end();
  });
  return place;
}

Camera view() {
  return cameraAt({0.55, 0.35, 0.15}, 0.4, 0.1, 240, 180);
}

}  // namespace

TEST_CASE("a scene with a muted cell equals the scene without the cell") {
  const Stage whole(testDevice(), threeCells());
  for (const ColourMapping mapping : {ColourMapping::off, ColourMapping::ours}) {
    RenderSettings settings = withTiers();
    settings.colourMapping = mapping;
    const Image8 all = whole.render(view(), settings);
    for (const std::vector<std::uint32_t>& cells : {std::vector<std::uint32_t>{0}, {1}, {2}, {2, 0}, {0, 1, 2}}) {
      INFO("mapping " << int(mapping) << ", " << cells.size() << " cells, first " << cells[0]);
      RenderSettings muted = settings;
      muted.mutedCells = cells;
      muted.mutedCells.push_back(99);  // unknown cells are ignored
      const Image8 picture = whole.render(view(), muted);
      CHECK(picture == Stage(testDevice(), without(cells)).render(view(), settings));
      CHECK_FALSE(picture == all);
    }
  }
}

TEST_CASE("solo cells equal a scene of only these cells") {
  const Stage whole(testDevice(), threeCells());
  const RenderSettings settings = withTiers();
  const auto soloed = [&](std::vector<std::uint32_t> cells, std::vector<std::uint32_t> muted = {}) {
    RenderSettings solo = settings;
    solo.soloCells = std::move(cells);
    solo.mutedCells = std::move(muted);
    return whole.render(view(), solo);
  };
  CHECK(soloed({2, 0, 1}) == whole.render(view(), settings));
  CHECK_FALSE(soloed({1}) == whole.render(view(), settings));
  CHECK(soloed({1}) == Stage(testDevice(), without({0, 2})).render(view(), settings));
  CHECK(soloed({0, 1}, {0}) == soloed({1}));
  const Image8 nothing = soloed({99});
  CHECK(std::ranges::all_of(nothing.values, [](std::uint8_t v) { return v == 0; }));
}
