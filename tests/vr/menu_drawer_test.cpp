// SPDX-License-Identifier: Apache-2.0
// The menu's panel in the image of a layer: equal values in all formats, and visible changes.
#include "vr/menu/menu_drawer.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "ibr/error.h"
#include "ibr/offscreen.h"
#include "io/image_file.h"
#include "menu_hand.h"
#include "support/gpu.h"
#include "vr/menu/menu_canvas.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

MenuModel model() {
  MenuModel m;
  m.scenes = {"Town hall, morning", "Garden behind the museum with its long wall and the old gate", "Station"};
  m.scene = 1;
  std::vector<glm::dvec2> spots;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.33 * i, radius = 0.06 + 0.006 * i;
    spots.emplace_back(0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle));
  }
  m.spots = PointMap(std::move(spots));
  m.here = 20;
  m.you = m.spots[20] + 0.015;
  m.facing = {0.6, -0.8};
  m.unitsPerMetre = 1.25;
  m.eyeHeight = 1.6;
  m.governor = true;
  m.line = "89.9 frames a second, 12 cells, 24.1 MP/s";
  return m;
}

struct Drawn {
  explicit Drawn(VkFormat format) : layer(testDevice(), {800, 600}, format), drawer(testDevice(), panel, format, 2) {
    hand.away();
  }
  // Draws twice, as successive frames do.
  Image8 picture() {
    return layer.render([&](VkCommandBuffer commands) {
      drawer.record(commands, layer.target().image, use::kUndefined, use::kColourAttachment);
      drawer.record(commands, layer.target().image, use::kColourAttachment, use::kTransferSource);
    });
  }
  // Also writes the image to the folder IBR_MENU_PICTURES, if set, for visual inspection.
  Image8 picture(const std::string& name) {
    Image8 image = picture();
    if (const char* folder = std::getenv("IBR_MENU_PICTURES")) writeImage(std::string(folder) + "/" + name, image);
    return image;
  }
  MenuPanel panel{800, 600};
  MenuModel shown = model();
  MenuHand hand{panel, shown};
  Offscreen layer;
  MenuDrawer drawer;
};

bool isColour(const Image8& image, glm::dvec2 at, ImU32 colour) {
  const auto pixel = image.pixel(int(at.x * image.width), int(at.y * image.height));
  for (int c = 0; c < 4; ++c)
    if (pixel[std::size_t(c)] != ((colour >> (8 * c)) & 255)) return false;
  return true;
}

}  // namespace

TEST_CASE("the menu has the same values in sRGB and UNORM layers") {
  Drawn plain(VK_FORMAT_R8G8B8A8_UNORM);
  const Image8 wanted = plain.picture();
  const glm::dvec2 corner{0.999, 0.5}, button = plain.hand.in("picture", {0.05, 0.5});
  CHECK(isColour(wanted, corner, kMenuBackground));
  CHECK(isColour(wanted, button, kMenuButton));
  CHECK(isColour(wanted, plain.hand.in("map page", {0.05, 0.5}), kMenuSelected));
  bool opaque = true;
  for (std::size_t i = 3; i < wanted.values.size(); i += 4) opaque &= wanted.values[i] == 255;
  CHECK(opaque);
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM}) {
    Drawn other(format);
    CHECK((other.picture().values == wanted.values));
  }
}

TEST_CASE("the menu marks hovered and pressed items") {
  Drawn menu(VK_FORMAT_R8G8B8A8_SRGB);
  const glm::dvec2 button = menu.hand.in("picture", {0.05, 0.5}), middle = menu.hand.in("picture", {0.5, 0.2});
  menu.hand.point(middle);
  menu.hand.point(middle);
  const Image8 hovered = menu.picture("hovered.png");
  CHECK(isColour(hovered, button, kMenuHovered));
  CHECK(isColour(hovered, middle, kMenuText));  // the pointer
  menu.hand.point(middle, true);
  const Image8 pressed = menu.picture();
  CHECK(isColour(pressed, button, kMenuPressed));
  CHECK(isColour(pressed, middle, kMenuCurrentSpot));
  menu.hand.away();
  CHECK(isColour(menu.picture(), button, kMenuButton));
}

TEST_CASE("the menu's map shows spots, the person and the target spot") {
  Drawn menu(VK_FORMAT_R8G8B8A8_SRGB);
  menu.shown.spots = PointMap({{0.25, 0.25}, {0.75, 0.25}});
  menu.shown.here = 1;
  menu.shown.you = {0.5, 0.75};
  menu.hand.away();
  const glm::dvec2 first = menu.hand.in("map", {0.25, 0.25}), second = menu.hand.in("map", {0.75, 0.25});
  const glm::dvec2 person = menu.hand.in("map", {0.5, 0.75}), nowhere = menu.hand.in("map", {0.5, 0.5});
  const Image8 bare = menu.picture();
  CHECK(isColour(bare, nowhere, kMenuField));
  CHECK_FALSE(isColour(bare, first, kMenuField));
  CHECK(isColour(bare, second, kMenuCurrentSpot));
  CHECK(isColour(bare, person, kMenuText));
  for (const glm::dvec2 none : {glm::dvec2(0), glm::dvec2(0, std::nan(""))}) {
    menu.shown.facing = none;
    menu.hand.away();
    CHECK(isColour(menu.picture(), person, kMenuText));
  }
  menu.hand.point(menu.hand.in("map", {0.27, 0.25}));
  menu.hand.point(menu.hand.in("map", {0.27, 0.25}));
  CHECK(isColour(menu.picture(), first, kMenuSelected));
  // The item stays marked while the trigger is held, wherever the hand points.
  menu.hand.point(menu.hand.in("map", {0.27, 0.25}), true);
  menu.hand.point(second, true);
  CHECK(isColour(menu.picture(), first, kMenuSelected));
}

TEST_CASE("the menu shortens long names") {
  Drawn menu(VK_FORMAT_R8G8B8A8_SRGB);
  menu.shown.scenes[0] = std::string(200, 'i');
  menu.hand.press("scenes page");
  menu.hand.away();
  const Image8 picture = menu.picture();
  bool clean = true, written = false;
  for (double y = 0.2; y < 0.8; y += 0.01) {
    for (double x = 0.001; x < 0.012; x += 0.002)
      for (const double side : {x, 1 - x}) clean &= isColour(picture, menu.hand.in("scene 0", {side, y}), kMenuButton);
    for (double x = 0.1; x < 0.9; x += 0.01) written |= isColour(picture, menu.hand.in("scene 0", {x, y}), kMenuText);
  }
  CHECK(clean);
  CHECK(written);
}

TEST_CASE("the menu draws every page with many entries and with none") {
  Drawn menu(VK_FORMAT_R8G8B8A8_SRGB);
  menu.shown.loading = 0.4;
  menu.hand.point(menu.hand.in("map", menu.shown.spots[31]));
  menu.hand.point(menu.hand.in("map", menu.shown.spots[31]));
  menu.picture("map.png");
  menu.hand.press("scenes page");
  menu.hand.away();
  menu.picture("scenes.png");
  for (int i = 0; i < 20; ++i) menu.shown.scenes.push_back("Room " + std::to_string(i));
  menu.hand.away();
  menu.picture("many_scenes.png");
  menu.hand.press("settings page");
  menu.hand.press("exit");
  menu.picture("settings.png");
  menu.hand.press("map page");
  std::vector<glm::dvec2> spots;
  for (int i = 0; i < 40000; ++i) spots.emplace_back((i % 200 + 0.5) / 200, (i / 200 + 0.5) / 200);
  menu.shown.spots = PointMap(std::move(spots));
  menu.hand.away();
  menu.picture("many_spots.png");
  menu.shown = {};
  menu.hand.away();
  menu.picture("nothing.png");
}

TEST_CASE("two panels are drawn one after the other, each in its own context") {
  Drawn one(VK_FORMAT_R8G8B8A8_SRGB), other(VK_FORMAT_B8G8R8A8_SRGB);
  CHECK(ImGui::GetCurrentContext() == nullptr);
  other.hand.press("settings page");
  one.hand.away();
  other.hand.away();
  const Image8 map = one.picture();
  CHECK((other.picture().values != map.values));
  CHECK((one.picture().values == map.values));
}

TEST_CASE("a menu refuses a layer that is not display-encoded") {
  const MenuPanel panel(640, 480);
  CHECK_THROWS_AS(MenuDrawer(testDevice(), panel, VK_FORMAT_R16G16B16A16_SFLOAT, 2), Error);
}
