// SPDX-License-Identifier: Apache-2.0
// A simulated hand that points at the menu's panel and presses its items.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "vr/menu/menu_panel.h"

namespace ibr::test {

/// Duration of a frame, s.
inline constexpr double kMenuFrame = 1.0 / 90;

struct MenuHand {
  app::MenuPanel& panel;
  app::MenuModel& model;

  app::MenuRequests away(bool held = false) { return panel.show(model, {{}, held}, kMenuFrame); }
  app::MenuRequests point(glm::dvec2 at, bool held = false) { return panel.show(model, {at, held}, kMenuFrame); }

  bool has(const std::string& name) const {
    return std::ranges::any_of(panel.items(), [&](const auto& item) { return item.name == name; });
  }
  /// A position inside an item, as shares of the panel's sides; `part`: of the item's. Fails if the item is missing.
  glm::dvec2 in(const std::string& name, glm::dvec2 part = {0.5, 0.5}) const {
    for (const app::MenuItem& item : panel.items())
      if (item.name == name)
        return (item.low + part * (item.high - item.low)) / glm::dvec2(panel.width(), panel.height());
    FAIL("the menu has no " << name);
    return {};
  }

  /// Presses and releases. Returns the resulting requests; there are none before the release.
  app::MenuRequests press(glm::dvec2 at) {
    CHECK(point(at) == app::MenuRequests{});
    CHECK(point(at) == app::MenuRequests{});
    CHECK(point(at, true) == app::MenuRequests{});
    CHECK(point(at, true) == app::MenuRequests{});
    const app::MenuRequests requests = point(at);
    CHECK(away() == app::MenuRequests{});
    return requests;
  }
  app::MenuRequests press(const std::string& name) {
    if (panel.items().empty()) away();
    return press(in(name));
  }
};

}  // namespace ibr::test
