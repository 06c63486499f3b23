// SPDX-License-Identifier: Apache-2.0
// Contents of the headset program's menu, and the requests that a user makes by pointing and one button.
//
// The pages are drawn with Dear ImGui from a model, within the caller's ImGui frame. menu_panel.h provides input,
// menu_drawer.h draws the result.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/camera/point_map.h"

namespace ibr::app {

/// Data that the menu shows. Numbers may be infinite or NaN; such values are not shown.
struct MenuModel {
  std::vector<std::string> scenes;
  std::optional<std::size_t> scene;                    // the open scene
  PointMap spots;                                      // capture sites from above: x to the right, y down, 0 to 1
  std::optional<std::size_t> here;                     // the user's spot
  std::optional<glm::dvec2> you;                       // the user's position on the map; clamped to its edge
  glm::dvec2 facing{0.0};                              // the user's direction on the map, any length; (0, 0): not shown
  double unitsPerMetre = 1, initialUnitsPerMetre = 1;  // world units; current, and when the scene was opened
  bool smoothMotion = false;
  double snapDegrees = 30;          // of one turn
  std::optional<double> eyeHeight;  // m; nullopt: the headset knows the floor
  std::optional<bool> governor;     // frame governor on or off; nullopt: cannot be changed
  std::string composition;          // a word of --composition; empty: cannot be changed
  std::string line;                 // status line, such as frame times
  std::optional<double> loading;    // 0 to 1, while a scene is read
};

/// Requests of one frame; empty unless something was pressed.
struct MenuRequests {
  std::optional<std::size_t> teleport;  // index into MenuModel::spots
  std::optional<std::size_t> scene;     // index into MenuModel::scenes; not the open scene
  std::optional<double> scaleFactor;    // factor on world units per metre; finite, above 0
  std::optional<bool> smoothMotion;
  std::optional<double> snapDegrees;
  std::optional<double> eyeHeight;  // m, 0.5 to 2.5
  std::optional<bool> governor;
  bool nextComposition = false;
  bool recentre = false, picture = false, close = false, exit = false;
  bool operator==(const MenuRequests&) const = default;
};

/// An item that can be pointed at, in pixels. Names: "map page", "scenes page", "settings page", "picture", "recentre",
/// "close", "exit"; "map", whose corners are (0, 0) and (1, 1) of MenuModel::spots; "scene 0" and so on, "scenes
/// up", "scenes down"; "smaller", "larger", "first scale", "turn 15", 30, 45, 90, "lower", "higher", "smooth motion",
/// "governor", "composition".
struct MenuItem {
  std::string name;
  glm::dvec2 low{0.0}, high{0.0};
};

struct MenuCanvas;

class Menu {
 public:
  /// Draws the menu over `pixels`, within an ImGui frame whose font height is kMenuFontShare of pixels.y.
  MenuRequests show(const MenuModel& model, glm::vec2 pixels);

  /// Items of the last frame.
  const std::vector<MenuItem>& items() const noexcept { return items_; }

  /// Returns to the state of a newly opened menu: map page, no pending confirmation.
  void reset();

 private:
  enum class Page { map, scenes, settings };

  void showColumn(MenuCanvas& canvas, MenuRequests& requests);
  void showExit(MenuCanvas& canvas, MenuRequests& requests, float y);
  void showMap(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests);
  void showScenes(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests);

  std::vector<MenuItem> items_;
  Page page_ = Page::map;
  std::optional<std::size_t> pressedSpot_;
  std::optional<std::size_t> seenScene_;  // scene that the list was scrolled to
  std::size_t firstScene_ = 0;            // first row of the list
  double exitSeconds_ = 0;                // remaining time in which a second press exits
};

/// Font height as a share of the panel's height: 24 of 480 pixels.
inline constexpr double kMenuFontShare = 0.05;

}  // namespace ibr::app
