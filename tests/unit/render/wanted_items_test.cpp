// SPDX-License-Identifier: Apache-2.0
// Items that a frame wants, against a plain search in the graph.
#include "render/resident/wanted_items.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <set>
#include <vector>

#include "support/plan_scenes.h"

using namespace ibr;

namespace {

struct Search {
  explicit Search(const Scene& of) : scene(of), items(of) {}

  // Mesh and photographs of cells, by their distance from `first` in the graph of cells that share a photograph.
  std::vector<std::uint32_t> around(std::uint32_t first) const {
    std::vector<std::uint32_t> found;
    std::set<std::uint32_t> listed, reached{first};
    const auto add = [&](std::uint32_t item) {
      if (listed.insert(item).second) found.push_back(item);
    };
    for (std::deque<std::uint32_t> queue{first}; !queue.empty(); queue.pop_front()) {
      const std::vector<std::uint32_t>& members = scene.cells[queue.front()].members;
      add(items.cell(queue.front()));
      for (const std::uint32_t member : members) add(member);
      for (const std::uint32_t member : members)
        for (std::uint32_t c = 0; c < scene.cells.size(); ++c)
          if (std::ranges::count(scene.cells[c].members, member) && reached.insert(c).second) queue.push_back(c);
    }
    return found;
  }

  const Scene& scene;
  StreamItems items;
};

}  // namespace

TEST_CASE("a frame wants what it shows, then what is nearest in the graph, up to a limit") {
  const test::PlanSceneShape shape{20, 20, 1, 1};
  const Scene scene = test::makePlanScene(shape);
  const SceneBounds bounds = sceneBounds(scene);
  const StreamItems items(scene);
  WantedItems wanted(scene, std::vector<bool>(items.count(), true));
  for (int frame = 0; frame < 5; ++frame) {
    const FramePlan plan = planFrame(scene, bounds, {{test::planWalk(shape, 40 * frame)}, {}, 0});
    REQUIRE(!plan.cells.empty());
    std::vector<std::uint32_t> expected;
    const auto add = [&](std::uint32_t item) {
      if (std::ranges::find(expected, item) == expected.end()) expected.push_back(item);
    };
    for (const PlannedCell& cell : plan.cells) {
      add(items.cell(cell.cell));
      for (const std::uint32_t member : scene.cells[cell.cell].members) add(member);
    }
    const std::size_t needed = expected.size();
    for (const std::uint32_t item : Search(scene).around(plan.cells[0].cell)) add(item);
    REQUIRE(expected.size() > WantedItems::kMaxListed);
    for (const std::size_t most : {std::size_t(0), std::size_t(100), std::size_t(100000)}) {
      wanted.update(plan, most);
      CHECK(wanted.needed() == needed);
      const std::size_t size = std::max(needed, std::min(most, WantedItems::kMaxListed));
      CHECK(std::ranges::equal(wanted.items(), std::span(expected).first(size)));
    }
  }
}
