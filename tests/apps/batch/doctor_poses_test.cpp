// SPDX-License-Identifier: Apache-2.0
// Pose sets with one problem each: doctor finds this problem and no other.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "batch/doctor/findings.h"
#include "support/json.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::app;
using Catch::Contains;
using Catch::StartsWith;

namespace {

std::vector<Camera> row(std::vector<double> places) {
  std::vector<Camera> cameras;
  for (const double x : places) cameras.push_back(test::lookingAlong({x, 0, 0}, {0, 1, 0}));
  return cameras;
}

// Points on a wall at a distance of 5.
std::vector<glm::dvec3> wall(double from, double to) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 60; ++i)
    for (int j = -4; j <= 4; ++j) points.push_back({from + (to - from) * i / 59, 5, 0.4 * j});
  return points;
}

std::vector<std::string> namesOf(const PosedModel& model) {
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  return names;
}

std::string found(const PosedModel& model, const std::vector<std::string>& pictures) {
  Findings findings;
  examinePoses(model, pictures, findings);
  std::string text;
  const auto json = findings.json();
  for (const auto& finding : json.at("findings")) {
    CHECK(!finding.at("remedy").get<std::string>().empty());
    text += finding.at("severity").get<std::string>() + ' ' + finding.at("subject").get<std::string>() + ": " +
            finding.at("problem").get<std::string>() + '\n';
  }
  CHECK((findings.code() == kExitOk) == (text.find("serious") == std::string::npos));
  return text;
}

std::string found(const PosedModel& model) {
  return found(model, namesOf(model));
}

// Checks that `text` is a single finding that starts with severity and subject and contains all words.
void checkOne(const std::string& text, const std::string& start, const std::vector<std::string>& words) {
  CHECK(std::ranges::count(text, '\n') == 1);
  CHECK_THAT(text, StartsWith(start));
  for (const std::string& word : words) CHECK_THAT(text, Contains(word));
}

}  // namespace

TEST_CASE("accurate poses and poses without points have no findings") {
  PosedModel model = test::modelOf(row({0, 1, 2, 3, 4}), wall(-6, 10));
  CHECK(found(model) == "");
  model.tracks.clear();
  CHECK(found(model) == "");
  CHECK(found(PosedModel{}) == "");
}

TEST_CASE("photographs without a pose and poses without a photograph are reported") {
  const PosedModel model = test::modelOf(row({0, 1, 2}), wall(-6, 8));
  checkOne(found(model, {"000.png", "001.png", "002.png", "IMG_1.jpg"}), "warning poses: ", {"1 of 4", "IMG_1.jpg"});
  checkOne(found(model, {"000.png", "001.png"}), "serious poses: ", {"002.png"});
  checkOne(found(model, {"a.png"}), "serious poses: ", {"000.png"});
}

TEST_CASE("one inaccurate pose is reported by name, and inaccurate poses of all photographs once") {
  PosedModel model = test::modelOf(row({0, 1, 2, 3, 4}), wall(-6, 10));
  const auto shift = [&](std::uint32_t image, double px) {
    for (Track& track : model.tracks)
      for (TrackObservation& seen : track.observations)
        if (seen.image == image) seen.pixel.x += px;
  };
  for (std::uint32_t i = 0; i < 5; ++i) shift(i, 0.02);  // a small error in all poses
  CHECK(found(model) == "");
  shift(3, 2);
  checkOne(found(model), "warning poses: ", {"003.png", "2.0 px"});
  for (const std::uint32_t i : {0u, 1u, 2u, 4u}) shift(i, 2);
  checkOne(found(model), "warning poses: ", {"2.0 px"});
  CHECK_THAT(found(model), !Contains(".png"));
}

TEST_CASE("unconnected groups and a photograph with few shared points are reported") {
  CHECK_THAT(found(test::modelOf(row({0, 1, 2, 40, 41}), wall(-6, 50))),
             Contains("serious parts: ") && Contains("003.png") && Contains("004.png"));
  PosedModel model = test::modelOf(row({0, 1, 2}), wall(-6, 8));
  std::size_t kept = 0;
  for (Track& track : model.tracks)
    std::erase_if(track.observations, [&](const TrackObservation& seen) { return seen.image == 1 && ++kept > 40; });
  checkOne(found(model), "warning poses: ", {"001.png", "40"});
}

TEST_CASE("steps too large for the depth and photographs from one position are reported") {
  CHECK_THAT(found(test::modelOf(row({0, 4, 8}), wall(-6, 14))), StartsWith("warning steps: ") && Contains(" %"));
  std::vector<Camera> turned = row({0, 0, 0});
  checkOne(found(test::modelOf(turned, wall(-6, 6))), "serious steps: ", {});
}

TEST_CASE("findings are sorted by severity, and long lists of names are shortened") {
  Findings findings;
  CHECK(findings.code() == kExitOk);
  findings.add({"a", Severity::hint, "A.", "a."});
  findings.add({"b", Severity::warning, "B.", "b."});
  CHECK(findings.code() == kExitOk);
  findings.add({"c", Severity::serious, "C.", "c.", kExitUnsupported});
  findings.add({"d", Severity::serious, "D.", "d.", kExitIo});
  CHECK(findings.code() == kExitUnsupported);
  const auto list = findings.json().at("findings");
  CHECK(list[0].at("problem") == "C.");
  CHECK(list[3].at("subject") == "a");
  CHECK(someOf({"A"}) == "A");
  CHECK(someOf({"A", "B"}) == "A and B");
  CHECK(someOf({"A", "B", "C"}) == "A, B and C");
  CHECK(someOf({"A", "B", "C", "D"}) == "A, B and 2 more");
  CHECK(someOf({}) == "");
}
