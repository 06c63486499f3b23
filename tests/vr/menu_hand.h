// SPDX-License-Identifier: Apache-2.0
// A hand that points at the menu's panel and presses what it finds there.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "vr/menu/menu_panel.h"

namespace ibr::test {

/// A frame's time, s.
inline constexpr double kMenuFrame = 1.0 / 90;

struct MenuHand {
  app::MenuPanel& panel;
  app::MenuModel& model;

  app::MenuWishes away(bool held = false) { return panel.show(model, {{}, held}, kMenuFrame); }
  app::MenuWishes point(glm::dvec2 at, bool held = false) { return panel.show(model, {at, held}, kMenuFrame); }

  bool has(const std::string& name) const {
    return std::ranges::any_of(panel.items(), [&](const auto& item) { return item.name == name; });
  }
  /// A place in something, of the whole panel's sides; `part` of the thing's. Fails where it is not there.
  glm::dvec2 in(const std::string& name, glm::dvec2 part = {0.5, 0.5}) const {
    for (const app::MenuItem& item : panel.items())
      if (item.name == name)
        return (item.low + part * (item.high - item.low)) / glm::dvec2(panel.width(), panel.height());
    FAIL("the menu has no " << name);
    return {};
  }

  /// Presses and lets go; what is wished then. Nothing is wished before.
  app::MenuWishes press(glm::dvec2 at) {
    CHECK(point(at) == app::MenuWishes{});
    CHECK(point(at) == app::MenuWishes{});
    CHECK(point(at, true) == app::MenuWishes{});
    CHECK(point(at, true) == app::MenuWishes{});
    const app::MenuWishes wishes = point(at);
    CHECK(away() == app::MenuWishes{});
    return wishes;
  }
  app::MenuWishes press(const std::string& name) {
    if (panel.items().empty()) away();
    return press(in(name));
  }
};

}  // namespace ibr::test
