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

std::vector<DrawOrderEntry> advanced(const std::vector<DrawOrderEntry>& before, const WantedOrder& wanted,
                                     double step) {
  std::vector<DrawOrderEntry> shown{{99, 0.5, true}};  // is overwritten
  advanceFades(before, wanted, step, std::pmr::get_default_resource(), shown);
  return shown;
}

// `hidden`, `visible`: all cells were hidden, and are still visible.
std::vector<DrawOrderEntry> show(const std::vector<DrawOrderEntry>& before, const Order& cells, double step,
                                 bool hidden = true, bool visible = true) {
  Order all(100);
  std::iota(all.begin(), all.end(), 0u);
  WantedOrder wanted{cells, {}, {}};
  if (hidden) wanted.hidden = all;
  if (visible) wanted.stillVisible = all;
  return advanced(before, wanted, step);
}

Order staying(const std::vector<DrawOrderEntry>& shown) {
  Order order;
  for (const DrawOrderEntry& s : shown)
    if (!s.fadingOut) order.push_back(s.cell);
  return order;
}

std::size_t leavingCount(const std::vector<DrawOrderEntry>& shown) {
  return shown.size() - staying(shown).size();
}

// Share of each cell in a pixel that all cells cover, front to back. Copies of a cell use the same noise, so the second
// copy adds only the difference of the opacities.
std::map<std::uint32_t, double> shares(const std::vector<DrawOrderEntry>& shown) {
  std::map<std::uint32_t, double> share;
  double covered = 0;  // all cells use one noise: the covered share is the largest opacity so far
  for (const DrawOrderEntry& s : shown) {
    share[s.cell] += std::max(0.0, s.opacity - covered);
    covered = std::max(covered, s.opacity);
  }
  return share;
}

}  // namespace

TEST_CASE("above other content the first cell fades in, and the last cell fades out") {
  const Order one{7}, none;
  const std::vector<DrawOrderEntry> in = advanced({}, {one, one, one, true}, 0.25);
  CHECK(in == std::vector<DrawOrderEntry>{{7, 0.25, false}});
  CHECK(advanced({}, {one, one, one, false}, 0.25) == std::vector<DrawOrderEntry>{{7, 1, false}});
  const std::vector<DrawOrderEntry> whole{{7, 1, false}};
  CHECK(advanced(whole, {none, one, one, true}, 0.25) == std::vector<DrawOrderEntry>{{7, 0.75, true}});
}

TEST_CASE("an unchanged order is shown without fading") {
  const std::vector<DrawOrderEntry> first = show({}, {4, 2, 7}, 0.1);
  CHECK(first == std::vector<DrawOrderEntry>{{4, 1, false}, {2, 1, false}, {7, 1, false}});
  CHECK(show(first, {4, 2, 7}, 0.1) == first);
}

TEST_CASE("a cell that moves back fades out at its old rank and is opaque at its new rank") {
  std::vector<DrawOrderEntry> shown = show({}, {1, 2, 3}, 0.25);
  shown = show(shown, {2, 3, 1}, 0.25);
  CHECK(shown == std::vector<DrawOrderEntry>{{1, 0.75, true}, {2, 1, false}, {3, 1, false}, {1, 1, false}});
  for (int i = 0; i < 3; ++i) shown = show(shown, {2, 3, 1}, 0.25);
  CHECK(shown == std::vector<DrawOrderEntry>{{2, 1, false}, {3, 1, false}, {1, 1, false}});
}

TEST_CASE("a cell that moves forward fades in, and stays at its old rank until then") {
  std::vector<DrawOrderEntry> shown = show({}, {1, 2, 3, 4, 5}, 0.25);
  shown = show(shown, {5, 1, 2, 3, 4}, 0.25);
  CHECK(shown.front() == DrawOrderEntry{5, 0.25, false});
  CHECK(shown.back() == DrawOrderEntry{5, 1, true});
  for (int i = 0; i < 3; ++i) shown = show(shown, {5, 1, 2, 3, 4}, 0.25);
  CHECK(shown.front() == DrawOrderEntry{5, 1, false});
  CHECK(leavingCount(shown) == 0);
}

TEST_CASE("with no previous cell in view hidden cells are shown at once") {
  const std::vector<DrawOrderEntry> before = show({}, {1, 2}, 0.25);
  CHECK(show(before, {3, 4}, 0.25, true, false) == std::vector<DrawOrderEntry>{{3, 1, false}, {4, 1, false}});
  CHECK(show(before, {}, 0.25, true, false).empty());
  CHECK(show(before, {3, 1}, 0.25, true, false) == std::vector<DrawOrderEntry>{{3, 0.25, false}, {1, 1, false}});
}

TEST_CASE("omitted cells fade in, cells entering the view show at once, and cells out of view vanish") {
  const std::vector<DrawOrderEntry> before = show({}, {1, 2}, 0.25);
  CHECK(show(before, {1, 3}, 0.25, true) == std::vector<DrawOrderEntry>{{1, 1, false}, {2, 1, true}, {3, 0.25, false}});
  CHECK(show(before, {1, 3}, 0.25, false, false) == std::vector<DrawOrderEntry>{{1, 1, false}, {3, 1, false}});
  CHECK(show(before, {3}, 1.0) == std::vector<DrawOrderEntry>{{3, 1, false}});
  CHECK(show(before, {1}, 0.25) == std::vector<DrawOrderEntry>{{1, 1, false}, {2, 0.75, true}});
  CHECK(show(before, {}, 0.25).size() == 2);
  CHECK(show(before, {3}, 0.0).size() == 3);
}

TEST_CASE("random orders of cells are reached without holes, duplicates or jumps") {
  std::mt19937 random(3);
  const double step = GENERATE(0.05, 0.3);
  Order all(12);
  std::iota(all.begin(), all.end(), 0u);
  const bool hurried = GENERATE(false, true);  // orders change before earlier fades have ended
  std::vector<DrawOrderEntry> shown = show({}, {0, 1, 2, 3}, step);
  for (int frame = 0; frame < 2000; ++frame) {
    Order wanted = staying(shown);
    const bool quiet =
        std::ranges::all_of(shown, [](const DrawOrderEntry& s) { return s.opacity == 1 && !s.fadingOut; });
    if (random() % 5 == 0 && (hurried || quiet)) {
      std::shuffle(all.begin(), all.end(), random);
      wanted.assign(all.begin(), all.begin() + 1 + random() % 6);
    }
    const auto before = shares(shown);
    shown = show(shown, wanted, step);
    REQUIRE(staying(shown) == wanted);
    REQUIRE(leavingCount(shown) <= kMaxFadingOutCount);
    for (const DrawOrderEntry& s : shown) REQUIRE((s.opacity > 0 && s.opacity <= 1));
    double covered = 0;  // kMaxFadingOutCount is not reached
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

TEST_CASE("at most kMaxFadingOutCount cells fade out at once") {
  std::vector<DrawOrderEntry> shown = show({}, {0}, 0.01);
  for (std::uint32_t c = 1; c < 40; ++c) {
    shown = show(shown, {c}, 0.01);
    CHECK(leavingCount(shown) <= kMaxFadingOutCount);
  }
  CHECK(leavingCount(shown) == kMaxFadingOutCount);
}
