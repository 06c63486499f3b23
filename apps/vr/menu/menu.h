// SPDX-License-Identifier: Apache-2.0
// The menu of a program for headsets: what it shows, and what a person wishes by pointing and one button.
//
// Contents alone: pages of Dear ImGui made from a model, in whose frame they are shown. menu_panel.h gives them input,
// menu_drawer.h draws them.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

namespace ibr::app {

/// What the menu shows. Numbers that are not finite are survived: what they stand for is not shown.
struct MenuModel {
  struct Spot {
    glm::dvec2 at{0.0};  // of the map: x to the right, y down, 0 to 1
    bool here = false;   // where the person stands
  };
  std::vector<std::string> scenes;
  std::optional<std::size_t> scene;                  // the one that is open
  std::vector<Spot> spots;                           // places of photographs, seen from above
  std::optional<glm::dvec2> you;                     // on the map; held at its edge
  glm::dvec2 facing{0.0};                            // of the person, on the map, of any length; (0, 0): not shown
  double unitsPerMetre = 1, firstUnitsPerMetre = 1;  // world units; now, and when the scene was opened
  bool smoothMotion = false;
  double snapDegrees = 30;          // of one turn
  std::optional<double> eyeHeight;  // m; none where the headset knows the floor
  std::optional<bool> governor;     // whether less may be drawn to keep the pace; none where that is no choice
  std::string composition;          // a word of --composition; empty where that is no choice
  std::string line;                 // what is happening, such as frames a second
  std::optional<double> loading;    // 0 to 1, while a scene is read
};

/// What was asked for in one frame; nothing without a press.
struct MenuWishes {
  std::optional<std::size_t> teleport;  // MenuModel::spots
  std::optional<std::size_t> scene;     // MenuModel::scenes; another one than is open
  std::optional<double> scaleFactor;    // times as many world units a metre; finite, above 0
  std::optional<bool> smoothMotion;
  std::optional<double> snapDegrees;
  std::optional<double> eyeHeight;  // m, 0.5 to 2.5
  std::optional<bool> governor;
  bool nextComposition = false;
  bool recentre = false, picture = false, close = false, exit = false;
  bool operator==(const MenuWishes&) const = default;
};

/// Something that can be pointed at, in pixels. Names: "map page", "scenes page", "settings page", "picture",
/// "recentre", "close", "exit"; "map", whose corners are (0, 0) and (1, 1) of MenuModel::Spot::at; "scene 0" and so on,
/// "scenes up", "scenes down"; "smaller", "larger", "first scale", "turn 15", 30, 45, 90, "lower", "higher",
/// "smooth motion", "governor", "composition".
struct MenuItem {
  std::string name;
  glm::dvec2 low{0.0}, high{0.0};
};

struct MenuSheet;

class Menu {
 public:
  /// Shows all of it over so many pixels, in a frame of ImGui whose letters are kMenuLetters of their height.
  MenuWishes show(const MenuModel& model, glm::vec2 pixels);

  /// What was there in the last frame.
  const std::vector<MenuItem>& items() const noexcept { return items_; }

  /// As if it were opened anew: on its map, nothing half done.
  void reset();

 private:
  enum class Page { map, scenes, settings };

  void showColumn(MenuSheet& sheet, MenuWishes& wishes);
  void showExit(MenuSheet& sheet, MenuWishes& wishes, float y);
  void showMap(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes);
  void showScenes(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes);

  std::vector<MenuItem> items_;
  Page page_ = Page::map;
  std::optional<std::size_t> pressedSpot_;
  std::optional<std::size_t> seenScene_;  // that the list was scrolled to
  std::size_t firstScene_ = 0;            // of the list
  double exitSeconds_ = 0;                // for which a second press leaves
};

/// Height of letters, of the panel's: 24 of 480 pixels.
inline constexpr double kMenuLetters = 0.05;

}  // namespace ibr::app
