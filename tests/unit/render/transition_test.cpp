// SPDX-License-Identifier: Apache-2.0
#include "render/plan/transition.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <numeric>
#include <random>

using namespace ibr;

namespace {

using Order = std::vector<std::uint32_t>;

std::vector<ShownMesh> show(const std::vector<ShownMesh>& before, const Order& cells, double step, bool hidden = true,
                            bool visible = true) {
  return showMeshes(before, {cells, [=](std::uint32_t) { return hidden; }, [=](std::uint32_t) { return visible; }},
                    step);
}

Order staying(const std::vector<ShownMesh>& shown) {
  Order order;
  for (const ShownMesh& s : shown)
    if (!s.leaving) order.push_back(s.mesh);
  return order;
}

std::size_t leavingCount(const std::vector<ShownMesh>& shown) {
  return shown.size() - staying(shown).size();
}

// How much of a pixel that all cells cover shows each cell, front to back. Copies of a cell use one noise, so the
// second adds what the first lacks.
std::map<std::uint32_t, double> shares(const std::vector<ShownMesh>& shown) {
  std::map<std::uint32_t, double> share;
  double covered = 0;  // all cells use one noise: what is covered is the largest opacity so far
  for (const ShownMesh& s : shown) {
    share[s.mesh] += std::max(0.0, s.opacity - covered);
    covered = std::max(covered, s.opacity);
  }
  return share;
}

}  // namespace

TEST_CASE("an order stays until its last change has faded, but for what goes out of view and comes into it") {
  const auto none = [](std::uint32_t) { return false; };
  const auto but2 = [](std::uint32_t mesh) { return mesh != 2; };
  const auto is9 = [](std::uint32_t mesh) { return mesh == 9; };
  const Order wanted{9, 8, 1, 3};
  const std::vector<ShownMesh> whole{{3, 1, false}, {1, 1, false}},
      fading{{3, 0.5, true}, {2, 1, false}, {1, 1, false}, {3, 1, false}};
  CHECK(keepWhileFading(whole, {wanted, none, but2}, 8) == wanted);
  CHECK(keepWhileFading({}, {wanted, none, but2}, 8) == wanted);
  CHECK(keepWhileFading(fading, {wanted, is9, but2}, 8) == Order{1, 3, 8});
  CHECK(keepWhileFading(fading, {wanted, none, but2}, 3) == Order{1, 3, 9});
  CHECK(keepWhileFading(fading,
                        {wanted, [](std::uint32_t) { return true; }, [](std::uint32_t mesh) { return mesh == 1; }},
                        8) == wanted);
}

TEST_CASE("the same order again is shown whole") {
  const std::vector<ShownMesh> first = show({}, {4, 2, 7}, 0.1);
  CHECK(first == std::vector<ShownMesh>{{4, 1, false}, {2, 1, false}, {7, 1, false}});
  CHECK(show(first, {4, 2, 7}, 0.1) == first);
}

TEST_CASE("a cell that falls back fades out where it was, and is whole where it goes") {
  std::vector<ShownMesh> shown = show({}, {1, 2, 3}, 0.25);
  shown = show(shown, {2, 3, 1}, 0.25);
  CHECK(shown == std::vector<ShownMesh>{{1, 0.75, true}, {2, 1, false}, {3, 1, false}, {1, 1, false}});
  for (int i = 0; i < 3; ++i) shown = show(shown, {2, 3, 1}, 0.25);
  CHECK(shown == std::vector<ShownMesh>{{2, 1, false}, {3, 1, false}, {1, 1, false}});
}

TEST_CASE("a cell that comes forward fades in, and stays where it was until then") {
  std::vector<ShownMesh> shown = show({}, {1, 2, 3, 4, 5}, 0.25);
  shown = show(shown, {5, 1, 2, 3, 4}, 0.25);
  CHECK(shown.front() == ShownMesh{5, 0.25, false});
  CHECK(shown.back() == ShownMesh{5, 1, true});
  for (int i = 0; i < 3; ++i) shown = show(shown, {5, 1, 2, 3, 4}, 0.25);
  CHECK(shown.front() == ShownMesh{5, 1, false});
  CHECK(leavingCount(shown) == 0);
}

TEST_CASE("where nothing of the frame before is left in view, what was hidden is there at once") {
  const std::vector<ShownMesh> before = show({}, {1, 2}, 0.25);
  CHECK(show(before, {3, 4}, 0.25, true, false) == std::vector<ShownMesh>{{3, 1, false}, {4, 1, false}});
  CHECK(show(before, {}, 0.25, true, false).empty());
  CHECK(show(before, {3, 1}, 0.25, true, false) == std::vector<ShownMesh>{{3, 0.25, false}, {1, 1, false}});
}

TEST_CASE("what was left out fades in, what comes into view is there; what is out of view is gone") {
  const std::vector<ShownMesh> before = show({}, {1, 2}, 0.25);
  CHECK(show(before, {1, 3}, 0.25, true) == std::vector<ShownMesh>{{1, 1, false}, {2, 1, true}, {3, 0.25, false}});
  CHECK(show(before, {1, 3}, 0.25, false, false) == std::vector<ShownMesh>{{1, 1, false}, {3, 1, false}});
  CHECK(show(before, {3}, 1.0) == std::vector<ShownMesh>{{3, 1, false}});
  CHECK(show(before, {1}, 0.25) == std::vector<ShownMesh>{{1, 1, false}, {2, 0.75, true}});
  CHECK(show(before, {}, 0.25).size() == 2);
  CHECK(show(before, {3}, 0.0).size() == 3);
}

TEST_CASE(
    "whatever the orders, cells are shown as wanted, once, no hole opens, and no share jumps after a quiet time") {
  std::mt19937 random(3);
  const double step = GENERATE(0.05, 0.3);
  Order all(12);
  std::iota(all.begin(), all.end(), 0u);
  const bool hurried = GENERATE(false, true);  // orders change while others are still changing
  std::vector<ShownMesh> shown = show({}, {0, 1, 2, 3}, step);
  for (int frame = 0; frame < 2000; ++frame) {
    Order wanted = staying(shown);
    const bool quiet = std::ranges::all_of(shown, [](const ShownMesh& s) { return s.opacity == 1 && !s.leaving; });
    if (random() % 5 == 0 && (hurried || quiet)) {
      std::shuffle(all.begin(), all.end(), random);
      wanted.assign(all.begin(), all.begin() + 1 + random() % 6);
    }
    const auto before = shares(shown);
    shown = show(shown, wanted, step);
    REQUIRE(staying(shown) == wanted);
    REQUIRE(leavingCount(shown) <= kLargestLeavingCount);
    for (const ShownMesh& s : shown) REQUIRE((s.opacity > 0 && s.opacity <= 1));
    double covered = 0;  // kLargestLeavingCount is not met here
    auto after = shares(shown);
    for (const auto& [cell, share] : after) covered += share;
    CHECK(covered > 1 - 1e-9);  // no hole opens
    for (const std::uint32_t cell : hurried ? Order{} : all) {
      const auto was = before.find(cell);
      const double change = after[cell] - (was == before.end() ? 0.0 : was->second);
      CHECK(std::abs(change) <= 2 * step + 1e-9);
    }
  }
}

TEST_CASE("no more leave at once than there is room for, the faintest goes first") {
  std::vector<ShownMesh> shown = show({}, {0}, 0.01);
  for (std::uint32_t c = 1; c < 40; ++c) {
    shown = show(shown, {c}, 0.01);
    CHECK(leavingCount(shown) <= kLargestLeavingCount);
  }
  CHECK(leavingCount(shown) == kLargestLeavingCount);
}
