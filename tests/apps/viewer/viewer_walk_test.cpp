// SPDX-License-Identifier: Apache-2.0
// Walking in the viewer: keys and the mouse, bounds, orbit centres, trust, camera paths.
#include "support/json.h"
#include "viewer_harness.h"

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

namespace {

// Writes a camera path of the given length in seconds, from x = 7 along x.
void writePath(const fs::path& file, double seconds, double x) {
  const json rotation{0.0, 0.0, 0.0, 1.0};
  const auto key = [&](double time, double at) {
    return json{{"time", time}, {"position", {at, 0, 1}}, {"rotation", rotation}, {"fovY", 0.8}};
  };
  writeFile(file,
            jsonLine(json{{"version", 1}, {"size", {320, 240}}, {"fps", 30}, {"keys", {key(0, 7), key(seconds, x)}}}));
}

}  // namespace

TEST_CASE("keys and the mouse move the view") {
  if (!canView()) return;
  const auto begin = parseJson(view({tinyScene(), "--size", "320x240", "--frames", "2"}).out)["documents"][0];
  const glm::dvec3 from = positionOf(begin), forward = rotationOf(begin) * glm::dvec3(0, 0, -1);
  const auto forwards =
      whileViewing({tinyScene(), "--size", "320x240"}, [](const std::string&) { hold("w", 0.6); })["documents"][0];
  const glm::dvec3 way = positionOf(forwards) - from;
  CHECK(glm::dot(way, forward) > 0.01);
  CHECK(glm::length(way - forward * glm::dot(way, forward)) < 1e-9);
  CHECK(rotationOf(forwards) == rotationOf(begin));

  const auto turned = whileViewing({tinyScene(), "--size", "320x240", "--no-interface"}, [](const std::string& w) {
    act({"mousemove", "--window", w, "100", "100"});
    act({"mousedown", "3"});
    for (int i = 0; i < 5; ++i) act({"mousemove_relative", "10", "0"});
    act({"mouseup", "3"});
  })["documents"][0];
  CHECK(positionOf(turned) == from);
  const glm::dvec3 right = rotationOf(begin) * glm::dvec3(1, 0, 0);
  CHECK(glm::dot(rotationOf(turned) * glm::dvec3(0, 0, -1), right) > 0.02);  // the view follows the mouse

  const auto next = whileViewing({tinyScene(), "--size", "320x240"}, [](const std::string&) {
    pressAll({"bracketright"});
    sleepFor(1.5);
  })["documents"][0];
  CHECK(glm::distance(positionOf(next), from) > 0.01);
}

TEST_CASE("a bounded view stays near the photographs") {
  if (!canView()) return;
  const auto away = [](bool bounded) {
    const auto report = whileViewing({tinyScene(), "--size", "320x240"}, [&](const std::string&) {
      if (bounded) pressAll({"b"});
      hold("Shift_L+w", 2.5);
      sleepFor(0.5);
    });
    return glm::length(positionOf(report["documents"][0]));
  };
  CHECK(away(true) < 0.6 * away(false));
}

TEST_CASE("the middle mouse button orbits the point under the pointer") {
  if (!canView()) return;
  const auto begin = parseJson(view({tinyScene(), "--size", "320x240", "--frames", "2"}).out)["documents"][0];
  CHECK(begin["centre"].is_null());
  const json place = whileViewing({tinyScene(), "--size", "320x240", "--no-interface"}, [](const std::string& w) {
    act({"mousemove", "--window", w, "203", "113"});
    act({"mousedown", "2"});
    for (int i = 0; i < 5; ++i) act({"mousemove_relative", "4", "0"});
    act({"mouseup", "2"});
  })["documents"][0];
  REQUIRE(!place["centre"].is_null());
  const glm::dvec3 centre(place["centre"][0], place["centre"][1], place["centre"][2]);
  const glm::dvec3 from = positionOf(begin), to = positionOf(place);
  // The board is at a distance of 3.5, the wall around the board at 5.
  const glm::dvec3 seen = glm::conjugate(rotationOf(begin)) * (centre - from);
  const double focal = 120 / std::tan(0.5 * begin["fovY"].get<double>());
  CHECK(seen.z == Approx(-3.5).epsilon(0.05));
  CHECK(seen.x / -seen.z == Approx((203.5 - 160) / focal).margin(1 / focal));
  CHECK(glm::distance(centre, to) == Approx(glm::distance(centre, from)));
  CHECK(glm::distance(from, to) > 0.2);
}

TEST_CASE("trust is measured when the view is at rest") {
  if (!canView()) return;
  const auto after = [](const char* key, double seconds) {
    return whileViewing({tinyScene(), "--size", "320x240"}, [&](const std::string&) {
      if (seconds > 0) hold(key, seconds);
      sleepFor(2);
    })["documents"][0];
  };
  const json at = after("", 0)["trust"], behind = after("s", 0.4), away = after("s", 2.5)["trust"];
  for (const json& trust : {at, behind["trust"], away}) REQUIRE(trust.is_object());
  double sum = 0;
  for (const json& share : at["tiers"]) sum += share.get<double>();
  CHECK(sum == Approx(1));
  CHECK(at["tiers"][0] > 0.4);
  CHECK(at["extrapolation"] < 1e-6);
  // The photographs lie in the plane z = 0; the furthest two are half a unit apart.
  CHECK(behind["trust"]["extrapolation"] == Approx(positionOf(behind).z / 0.5).epsilon(1e-6));
  CHECK(away["extrapolation"].is_null());  // infinite: no cell is near
  CHECK(away["tiers"][0] < at["tiers"][0]);
}

TEST_CASE("a camera path of the command line plays in a loop") {
  if (!canView()) return;
  TemporaryFolder folder;
  // Slow frames step by exactly 0.1 s: the duration is no simple multiple of it, so that the images below differ.
  writePath(folder / "path.json", 0.2371, 7.1);
  const auto outcome = view({tinyScene(), "--size", "320x240", "--path", folder / "path.json", "--frames", "60"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json report = parseJson(outcome.out);
  const glm::dvec3 at = positionOf(report["documents"][0]);
  CHECK(at.x >= 7);
  CHECK(at.x <= 7.1);
  CHECK(report["documents"][0]["fovY"] == Approx(0.8));
  CHECK(report["times"]["framesMs"]["count"] > 50);
  CHECK(report["times"]["framesMs"]["p50"] > 0);
  CHECK(report["times"]["framesMs"]["p95"] >= report["times"]["framesMs"]["p50"]);
  CHECK(report["times"]["firstPicture"] > 0);
  CHECK(report["residentBytes"] > 20'000'000);  // the driver alone takes more
  // Long after its end the path repeats.
  whileViewing({tinyScene(), "--size", "320x240", "--path", folder / "path.json", "--screenshots", folder.path()},
               [&](const std::string&) {
                 for (const char* shot : {"view_0001.png", "view_0002.png"}) {
                   sleepFor(1.5);
                   act({"key", "p"});
                   CHECK(comes([&] { return fs::exists(folder / shot); }));
                 }
               });
  const auto infoOf = [&](const char* shot) { return runProgram({"info", folder / shot, "--json", "-"}).out; };
  REQUIRE(fs::exists(folder / "view_0002.png"));
  CHECK(parseJson(infoOf("view_0001.png"))["view"]["position"] !=
        parseJson(infoOf("view_0002.png"))["view"]["position"]);
  writeFile(folder / "path.json", "{}");
  const auto bad = view({tinyScene(), "--path", folder / "path.json", "--frames", "2"});
  CHECK(bad.code != 0);
  CHECK_THAT(bad.err, Contains("path.json"));
}

TEST_CASE("playing a camera path ends at its last key") {
  if (!canView()) return;
  const json report = whileViewing({tinyScene(), "--size", "320x240"}, [](const std::string&) {
    pressAll({"k", "bracketright"});
    sleepFor(1.5);
    pressAll({"k", "bracketleft"});
    sleepFor(1.5);
    pressAll({"j"});
    sleepFor(3);
  });
  const json moved = whileViewing({tinyScene(), "--size", "320x240"}, [](const std::string&) {
    pressAll({"bracketright"});
    sleepFor(1.5);
  });
  CHECK(glm::distance(positionOf(report["documents"][0]), positionOf(moved["documents"][0])) < 1e-9);
}

TEST_CASE("moving the view stops a playing camera path") {
  if (!canView()) return;
  TemporaryFolder folder;
  writePath(folder / "path.json", 20, 9);
  const json report =
      whileViewing({tinyScene(), "--size", "320x240", "--path", folder / "path.json"}, [](const std::string&) {
        pressAll({"bracketright"});
        sleepFor(2);
      });
  const glm::dvec3 at = positionOf(report["documents"][0]);
  double nearest = 1e9;
  for (const NamedCamera& c : tinySet().cameras) nearest = std::min(nearest, glm::distance(at, c.camera.pose.position));
  CHECK(nearest < 1e-6);
}
