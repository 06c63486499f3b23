// SPDX-License-Identifier: Apache-2.0
// The menu of ibr-vr, operated by a scripted hand.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/image_file.h"
#include "shared/draw/picture_record.h"
#include "support/json.h"
#include "vr/walk/spots.h"
#include "vr_menu_user.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

namespace {

bool near(glm::dvec3 a, glm::dvec3 b) {
  return glm::distance(a, b) < 1e-4;
}

glm::dvec3 ahead(const Camera& eye) {
  return eye.pose.rotation * glm::dvec3(0, 0, -1);
}

glm::dvec3 middle(const std::array<Camera, 2>& eyes) {
  return 0.5 * (eyes[0].pose.position + eyes[1].pose.position);
}

double eyesApart(const std::array<Camera, 2>& eyes) {
  return glm::distance(eyes[0].pose.position, eyes[1].pose.position);
}

// Position of a photograph's dot, as shares of the map's sides.
glm::dvec2 dotOf(std::size_t photograph) {
  std::vector<Pose> poses;
  for (const NamedCamera& one : tinySet().cameras) poses.push_back(one.camera.pose);
  const glm::dvec3 up(0, 1, 0);
  return app::mapOf(app::spotsOf(poses, up), up).places.at(photograph);
}

}  // namespace

TEST_CASE("the menu opens in front of the head, and a hand teleports, recentres and closes") {
  MenuUser user;
  user.visitor().waitForScene();
  user.pressMenuButton();
  const json panel = user.panel();
  REQUIRE(!panel.is_null());
  CHECK(near(recordedPose(panel["pose"]).position, {0, 1.6 - 0.12, -0.85}));
  CHECK(panel["size"][0].get<double>() == Approx(0.72));
  CHECK(panel["size"][1].get<double>() == Approx(0.54));

  user.press("map", dotOf(1));
  const std::array<Camera, 2> there = user.eyes();
  CHECK(near(middle(there), tinySet().cameras[1].camera.pose.position));
  CHECK(near(ahead(there[0]), {0, 0, -1}));

  // The head moves and turns; then recentring restores the nearest photograph's pose.
  user.state().head.position += glm::dvec3(0.06, 0, 0.05);
  user.state().head.rotation = glm::angleAxis(0.6, glm::dvec3(0, 1, 0));
  user.send();
  CHECK(!near(ahead(user.eyes()[0]), {0, 0, -1}));
  user.press("recentre");
  const std::array<Camera, 2> again = user.eyes();
  CHECK(near(middle(again), tinySet().cameras[1].camera.pose.position));
  CHECK(near(ahead(again[0]), {0, 0, -1}));

  user.press("close");
  user.visitor().pass(2);
  CHECK(user.panel().is_null());
  user.pressMenuButton();
  CHECK(user.exit().code == 0);
}

TEST_CASE("the menu's settings take effect at once") {
  MenuUser user("no-stage");
  user.visitor().waitForScene();
  user.state().left.there = true;
  const std::array<Camera, 2> first = user.eyes();
  user.pressMenuButton();
  user.pressOn("settings page", "larger");
  const std::array<Camera, 2> larger = user.eyes();
  CHECK(eyesApart(larger) == Approx(1.25 * eyesApart(first)));
  CHECK(near(middle(larger), middle(first)));
  user.press("turn 90");
  user.press("smooth motion");
  // The eyes rise, and the panel rises with them in its space; in the room the panel does not move.
  const double panelBefore = recordedPose(user.panel()["pose"]).position.y;
  user.press("higher");
  CHECK(near(user.head() - middle(larger), {0, 1.25 * 0.05, 0}));
  CHECK(recordedPose(user.panel()["pose"]).position.y == Approx(panelBefore + 0.05));
  user.pressMenuButton();  // a hand at rest in STAGE does not point at the moved panel
  user.state().right.pose = RemoteState().right.pose;
  for (const float x : {0.f, 1.f, 0.f}) {
    user.state().right.stick = {x, 0};
    user.send();
  }
  const std::array<Camera, 2> turned = user.eyes();
  CHECK(near(ahead(turned[0]), {1, 0, 0}));
  for (const float y : {1.f, 0.f}) {
    user.state().left.stick = {0, y};
    user.send();
  }
  CHECK(user.head().x > middle(turned).x + 0.05);
  const json report = user.visitor().leave();
  CHECK(report["unitsPerMetre"].get<double>() == Approx(1.25));
}

TEST_CASE("ibr render reproduces a picture of the menu, and a picture that cannot be written does not end ibr-vr") {
  const TemporaryFolder folder;
  MenuUser user("", {"--screenshots", folder.path(), "--no-governor", "--no-floor", "--tiers", "2"});
  user.visitor().waitForScene();
  CHECK(fs::is_empty(folder.path()));
  user.pressMenuButton();
  user.press("picture");
  user.waitUntil([&] { return user.says("view_0001_r.png"); });
  CHECK(user.visitor().leave()["pictures"].size() == 2);
  const fs::path left = folder / "view_0001_l.png", right = folder / "view_0001_r.png";
  const std::array again = drawnAgain(user.setup(), left, folder / "again", {"--tiers", "2"});
  CHECK((readImage(left).values == again[0].values));
  CHECK((readImage(right).values == again[1].values));

  XrSetup setup;
  Visitor visitor(setup, {"--screenshots", "/dev/null/nowhere", "--screenshot-every", "5", "--frames", "20"});
  const Outcome outcome = visitor.finish();
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("nowhere"));
  const json report = parseJson(outcome.out);
  CHECK(report["pictures"].empty());
  CHECK(report["frames"]["frames"] == 20);
}

TEST_CASE("the menu changes the composition, and a picture records its composition") {
  const TemporaryFolder folder;
  MenuUser user("", {"--screenshots", folder.path(), "--composition", "cells"});
  user.visitor().waitForScene();
  user.pressMenuButton();
  for (int picture = 1; picture <= 3; ++picture) {
    user.press("picture");
    const std::string name = fmt::format("view_{:04}", picture);
    user.waitUntil([&] { return user.says(name + "_r.png"); });
    const char* expected[]{"cells", "gathered", "hybrid"};
    CHECK(app::readRecord(folder / (name + "_l.png")).value().settings.at("composition") == expected[picture - 1]);
    user.pressOn("settings page", "composition");
  }
  CHECK(user.visitor().leave()["pictures"].size() == 6);
}

TEST_CASE("another scene loads while the head is tracked, and a broken scene returns to the previous one") {
  const TemporaryFolder folder;
  const fs::path second = folder / "second", broken = folder / "broken";
  fs::copy(tinyScene(), second, fs::copy_options::recursive);
  fs::create_directories(broken);
  MenuUser user("", {second, broken}, 2);
  user.visitor().waitForScene();
  user.pressMenuButton();
  user.press("map", dotOf(1));
  const glm::dvec3 stood = user.head();
  user.pressOn("scenes page", "scene 2");
  user.waitUntil([&] { return user.says("broken"); });
  // The previous scene is shown again at the same position, and the menu shows the reason.
  user.waitUntil([&] { return !user.panel().is_null(); });
  CHECK(near(user.head(), stood));
  user.pressOn("scenes page", "scene 1");
  user.waitUntil([&] { return user.panel().is_null(); });
  user.state().head.position.x += 0.2;
  user.visitor().pass(20);
  user.send();
  CHECK(near(user.head() - glm::dvec3(0.2, 0, 0), tinySet().cameras[0].camera.pose.position));
  for (const json& frame : shownFrames(user.setup())) {
    CHECK(frame["result"] == 0);
    for (const json& view : frame["layers"][0]["views"]) CHECK(view["asLocated"] == true);
  }
  const json report = user.visitor().leave();
  CHECK(report["scene"] == second.string());
  CHECK(report["losses"] == 0);
}
