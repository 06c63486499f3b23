// SPDX-License-Identifier: Apache-2.0
// Wishes of the menu when a hand points and presses. Positions of items come from the menu itself.
#include "menu_hand.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "ibr/error.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

MenuModel model() {
  MenuModel m;
  m.scenes = {"Town hall", "Garden", "Station"};
  m.scene = 1;
  m.spots = PointMap({{0.2, 0.2}, {0.5, 0.5}, {0.8, 0.3}});
  m.here = 1;
  m.you = {0.5, 0.55};
  m.facing = {0, -1};
  m.unitsPerMetre = 2.5;
  m.initialUnitsPerMetre = 1;
  m.eyeHeight = 1.6;
  m.governor = true;
  m.composition = "hybrid";
  return m;
}

struct Opened {
  explicit Opened(MenuModel m = model(), int width = 800, int height = 600)
      : panel(width, height), shown(std::move(m)), hand{panel, shown} {
    hand.away();
  }
  void page(const char* name) {
    CHECK(hand.press(name) == MenuRequests{});
    hand.away();
  }
  MenuPanel panel;
  MenuModel shown;
  MenuHand hand;
};

MenuRequests wish(auto MenuRequests::*what, auto value) {
  MenuRequests requests;
  requests.*what = value;
  return requests;
}

}  // namespace

TEST_CASE("the menu's column takes a picture, recentres, closes, and exits at the second press") {
  Opened menu;
  CHECK(menu.hand.press("picture") == wish(&MenuRequests::picture, true));
  CHECK(menu.hand.press("recentre") == wish(&MenuRequests::recentre, true));
  CHECK(menu.hand.press("close") == wish(&MenuRequests::close, true));
  CHECK(menu.hand.press("exit") == MenuRequests{});
  CHECK(menu.hand.press("exit") == wish(&MenuRequests::exit, true));
  CHECK(menu.hand.press("exit") == MenuRequests{});
}

TEST_CASE("the menu drops the first press of exit after another press, after a while and when closed") {
  Opened menu;
  menu.hand.press("exit");
  menu.hand.press("picture");
  CHECK(menu.hand.press("exit") == MenuRequests{});
  menu.hand.press(glm::dvec2(0.99, 0.01));  // no item is there
  CHECK(menu.hand.press("exit") == MenuRequests{});
  for (int i = 0; i < 50; ++i) menu.panel.show(menu.shown, {}, 0.1);
  CHECK(menu.hand.press("exit") == MenuRequests{});
  menu.panel.open();
  menu.hand.away();
  CHECK(menu.hand.press("exit") == MenuRequests{});
  for (int i = 0; i < 30; ++i) menu.panel.show(menu.shown, {}, 0.1);
  CHECK(menu.hand.press("exit") == wish(&MenuRequests::exit, true));
}

TEST_CASE("the menu's map teleports to the spot where the press began") {
  Opened menu;
  for (std::size_t i = 0; i < menu.shown.spots.size(); ++i)
    CHECK(menu.hand.press(menu.hand.in("map", menu.shown.spots[i] + 0.01)) == wish(&MenuRequests::teleport, i));
  CHECK(menu.hand.press(menu.hand.in("map", {0.5, 0.9})) == MenuRequests{});
  CHECK(menu.hand.press(menu.hand.in("map", {0.3, 0.3})) == MenuRequests{});
  // The press starts on the first spot and ends on the third.
  const glm::dvec2 first = menu.hand.in("map", menu.shown.spots[0]);
  const glm::dvec2 third = menu.hand.in("map", menu.shown.spots[2]);
  menu.hand.point(first);
  menu.hand.point(first, true);
  menu.hand.point(third, true);
  CHECK(menu.hand.point(third) == wish(&MenuRequests::teleport, std::size_t(0)));
  // A release away from the map cancels.
  menu.hand.point(first);
  menu.hand.point(first, true);
  menu.hand.away(true);
  CHECK(menu.hand.away() == MenuRequests{});
}

TEST_CASE("the menu's map selects the nearest spot, and the first of spots at one position") {
  MenuModel m = model();
  m.spots = PointMap({{0.50, 0.5}, {0.52, 0.5}, {0.52, 0.5}});
  Opened menu(m);
  CHECK(menu.hand.press(menu.hand.in("map", {0.508, 0.5})).teleport == 0u);
  CHECK(menu.hand.press(menu.hand.in("map", {0.512, 0.5})).teleport == 1u);
}

TEST_CASE("the menu's map does not teleport to a spot that was removed during the press") {
  Opened menu;
  const glm::dvec2 third = menu.hand.in("map", menu.shown.spots[2]);
  menu.hand.point(third);
  menu.hand.point(third, true);
  menu.shown.spots = PointMap({{0.2, 0.2}});
  menu.hand.point(third, true);
  CHECK(menu.hand.point(third) == MenuRequests{});
}

TEST_CASE("the menu's page of scenes opens other scenes only") {
  Opened menu;
  menu.page("scenes page");
  CHECK(menu.hand.press("scene 0") == wish(&MenuRequests::scene, std::size_t(0)));
  CHECK(menu.hand.press("scene 2") == wish(&MenuRequests::scene, std::size_t(2)));
  CHECK(menu.hand.press("scene 1") == MenuRequests{});
  CHECK_FALSE(menu.hand.has("scenes down"));
  CHECK_FALSE(menu.hand.has("map"));
}

TEST_CASE("the menu's page of scenes scrolls, and starts at the open scene") {
  MenuModel m = model();
  m.scenes.assign(40, "a scene");
  m.scene = 20;
  Opened menu(m);
  menu.page("scenes page");
  CHECK(menu.hand.has("scene 20"));
  CHECK_FALSE(menu.hand.has("scene 39"));
  const auto end = [&](const char* button) {
    for (int i = 0; i < 40; ++i) CHECK(menu.hand.press(button) == MenuRequests{});
    menu.hand.away();
  };
  end("scenes down");
  CHECK(menu.hand.has("scene 39"));
  CHECK(menu.hand.press("scene 39").scene == 39u);
  menu.hand.press("scenes up");
  menu.hand.away();
  CHECK((menu.hand.has("scene 27") && menu.hand.has("scene 33")));
  end("scenes up");
  CHECK(menu.hand.has("scene 0"));
  CHECK(menu.hand.press("scene 0").scene == 0u);
  // One press scrolls past no scene.
  menu.hand.press("scenes down");
  menu.hand.away();
  CHECK(menu.hand.has("scene 6"));
  // Another interface opened a scene.
  menu.shown.scene = 30;
  menu.hand.away();
  CHECK(menu.hand.has("scene 30"));
  menu.shown.scenes.resize(2);
  menu.hand.away();
  CHECK(menu.hand.has("scene 0"));
}

TEST_CASE("the menu's settings request the new values, within limits") {
  Opened menu;
  menu.page("settings page");
  CHECK(menu.hand.press("larger") == wish(&MenuRequests::scaleFactor, 1.25));
  CHECK(menu.hand.press("smaller") == wish(&MenuRequests::scaleFactor, 0.8));
  CHECK(menu.hand.press("first scale") == wish(&MenuRequests::scaleFactor, 0.4));
  for (const int degrees : {15, 30, 45, 90})
    CHECK(menu.hand.press("turn " + std::to_string(degrees)) == wish(&MenuRequests::snapDegrees, double(degrees)));
  for (const bool on : {false, true}) {
    menu.shown.smoothMotion = on;
    menu.shown.governor = on;
    CHECK(menu.hand.press("smooth motion") == wish(&MenuRequests::smoothMotion, !on));
    CHECK(menu.hand.press("governor") == wish(&MenuRequests::governor, !on));
  }
  CHECK(menu.hand.press("composition") == wish(&MenuRequests::nextComposition, true));
  CHECK(menu.hand.press("higher").eyeHeight == Approx(1.65));
  CHECK(menu.hand.press("lower").eyeHeight == Approx(1.55));
  menu.shown.eyeHeight = 2.48;
  CHECK(menu.hand.press("higher").eyeHeight == 2.5);
  menu.shown.eyeHeight = 0.51;
  CHECK(menu.hand.press("lower").eyeHeight == 0.5);
}

TEST_CASE("the menu hides settings that do not apply") {
  MenuModel m = model();
  m.eyeHeight.reset();
  m.governor.reset();
  m.composition.clear();
  Opened menu(m);
  menu.page("settings page");
  CHECK_FALSE(menu.hand.has("higher"));
  CHECK_FALSE(menu.hand.has("lower"));
  CHECK_FALSE(menu.hand.has("governor"));
  CHECK_FALSE(menu.hand.has("composition"));
  CHECK(menu.hand.has("smooth motion"));
}

TEST_CASE("a press on the menu counts only if it began on the same item of the open panel") {
  Opened menu;
  const glm::dvec2 picture = menu.hand.in("picture"), close = menu.hand.in("close");
  // A press that began beside the panel.
  for (const glm::dvec2 beside : {glm::dvec2(-0.1, 0.5), glm::dvec2(0.5, 1.01), glm::dvec2(kNaN, 0.5)}) {
    menu.hand.point(beside);
    menu.hand.point(beside, true);
    menu.hand.point(picture, true);
    CHECK(menu.hand.point(picture) == MenuRequests{});
  }
  menu.hand.away();
  menu.hand.away(true);
  menu.hand.point(picture, true);
  menu.hand.point(picture, true);
  CHECK(menu.hand.point(picture) == MenuRequests{});
  // A press that began on another item.
  menu.hand.point(close);
  menu.hand.point(close, true);
  menu.hand.point(picture, true);
  CHECK(menu.hand.point(picture) == MenuRequests{});
  // A press that began before the panel was opened.
  menu.panel.open();
  menu.hand.point(picture, true);
  menu.hand.point(picture, true);
  CHECK(menu.hand.point(picture) == MenuRequests{});
  CHECK(menu.hand.press("picture").picture);
}

TEST_CASE("pointing without a press requests nothing") {
  Opened menu;
  for (const char* page : {"map page", "scenes page", "settings page"}) {
    menu.page(page);
    bool wished = false;
    for (int y = 0; y <= 60; ++y)
      for (int x = 0; x <= 80; ++x) wished |= menu.hand.point({x / 80.0, y / 60.0}) != MenuRequests{};
    CHECK_FALSE(wished);
  }
}

TEST_CASE("menu items lie on the panel, do not overlap and are large at every panel size") {
  for (const glm::ivec2 size : {glm::ivec2(640, 480), glm::ivec2(800, 600), glm::ivec2(1280, 960)}) {
    MenuModel m = model();
    m.scenes.assign(40, "a scene");
    Opened menu(m, size.x, size.y);
    for (const char* page : {"map page", "scenes page", "settings page"}) {
      menu.page(page);
      const std::vector<MenuItem>& items = menu.panel.items();
      for (std::size_t i = 0; i < items.size(); ++i) {
        INFO(page << ": " << items[i].name);
        const glm::dvec2 extent = items[i].high - items[i].low;
        CHECK((items[i].low.x >= 0 && items[i].low.y >= 0 && items[i].high.x <= size.x && items[i].high.y <= size.y));
        CHECK(std::min(extent.x, extent.y) >= 0.1 * size.y - 1e-3);
        for (std::size_t k = 0; k < i; ++k)
          CHECK((items[i].low.x >= items[k].high.x || items[i].high.x <= items[k].low.x ||
                 items[i].low.y >= items[k].high.y || items[i].high.y <= items[k].low.y));
      }
    }
  }
}

TEST_CASE("the menu accepts an empty model") {
  Opened menu{MenuModel{}};
  for (const char* page : {"map page", "scenes page", "settings page"}) menu.page(page);
  menu.page("map page");
  CHECK(menu.hand.press("map") == MenuRequests{});
  menu.page("scenes page");
  CHECK_FALSE(menu.hand.has("scene 0"));
  menu.shown.scene = 7;  // no such scene
  CHECK(menu.hand.away() == MenuRequests{});
}

TEST_CASE("the menu accepts tens of thousands of spots and scenes, and any names") {
  MenuModel m = model();
  std::vector<glm::dvec2> spots;
  for (int i = 0; i < 40000; ++i) spots.emplace_back((i % 200 + 0.5) / 200, (i / 200 + 0.5) / 200);
  m.spots = PointMap(std::move(spots));
  m.here = 5050;
  m.scenes.assign(10000, std::string(5000, 'M'));
  m.scenes[0] = "100 % ##hidden \xff\xfe %s";
  m.scenes[2] = "";
  m.line = std::string(100000, '%');
  Opened menu(m);
  CHECK(menu.hand.press(menu.hand.in("map", m.spots[4321])).teleport == 4321u);
  menu.page("scenes page");
  CHECK(menu.hand.press("scene 0").scene == 0u);
  CHECK(menu.hand.press("scene 2").scene == 2u);
}

TEST_CASE("the menu accepts numbers that are not finite or out of range") {
  for (const double bad : {kNaN, kInfinite, -kInfinite, 0.0, -1.0, 1e300, 1e-300}) {
    INFO(bad);
    MenuModel m = model();
    m.spots = PointMap({{bad, 0.5}, {0.5, 0.5}, {0.5, bad}});
    m.you = {bad, bad};
    m.facing = {bad, 1};
    m.unitsPerMetre = bad;
    m.snapDegrees = bad;
    m.eyeHeight = bad;
    m.loading = bad;
    Opened menu(m);
    menu.panel.show(menu.shown, {}, bad);
    const glm::dvec2 middle = menu.hand.in("map", m.spots[1]);
    CHECK(menu.hand.press(middle).teleport == 1u);
    if (!std::isfinite(bad)) {
      // A spot with an invalid position does not appear at the map's corner.
      CHECK(menu.hand.press(menu.hand.in("map", {0.01, 0.01})) == MenuRequests{});
    }
    menu.page("settings page");
    const auto isFactor = [](const std::optional<double>& f) { return !f || (std::isfinite(*f) && *f > 0); };
    CHECK(isFactor(menu.hand.press("first scale").scaleFactor));
    menu.shown.unitsPerMetre = 2;
    menu.shown.initialUnitsPerMetre = bad;
    CHECK(isFactor(menu.hand.press("first scale").scaleFactor));
    const std::optional<double> eyes = menu.hand.press("higher").eyeHeight;
    CHECK((eyes && *eyes >= 0.5 && *eyes <= 2.5));
  }
}

TEST_CASE("a panel below the minimum size is refused") {
  CHECK_THROWS_AS(MenuPanel(63, 600), Error);
  CHECK_THROWS_AS(MenuPanel(800, 0), Error);
}
