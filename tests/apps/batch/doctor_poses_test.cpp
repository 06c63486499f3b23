// SPDX-License-Identifier: Apache-2.0
// Pose sets with one problem each: doctor finds this problem and no other.
#include <algorithm>
#include <catch2/catch.hpp>

#include "batch/doctor/findings.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::app;
using Catch::Matchers::Contains;

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
    text += finding.at("severity").get<std::string>() + ": " + finding.at("sentence").get<std::string>() + '\n';
  }
  CHECK((findings.code() == kExitOk) == (text.find("serious") == std::string::npos));
  return text;
}

std::string found(const PosedModel& model) {
  return found(model, namesOf(model));
}

}  // namespace

TEST_CASE("nothing is found in good poses, and in those without points") {
  PosedModel model = test::modelOf(row({0, 1, 2, 3, 4}), wall(-6, 10));
  CHECK(found(model) == "");
  model.tracks.clear();
  CHECK(found(model) == "");
  CHECK(found(PosedModel{}) == "");
}

TEST_CASE("photographs without a pose, and poses without a photograph") {
  const PosedModel model = test::modelOf(row({0, 1, 2}), wall(-6, 8));
  CHECK(found(model, {"000.png", "001.png", "002.png", "IMG_1.jpg"}) ==
        "warning: 1 of 4 photographs have no pose: IMG_1.jpg.\n");
  CHECK(found(model, {"000.png", "001.png"}) ==
        "serious: 1 of the photographs that have a pose are not here: 002.png.\n");
  CHECK(found(model, {"a.png"}) ==
        "serious: None of the photographs that the poses name is here; the first is 000.png.\n");
}

TEST_CASE("a pose that its points do not fit is doubtful; where no pose fits, all are") {
  PosedModel model = test::modelOf(row({0, 1, 2, 3, 4}), wall(-6, 10));
  const auto shift = [&](std::uint32_t image, double px) {
    for (Track& track : model.tracks)
      for (TrackObservation& seen : track.observations)
        if (seen.image == image) seen.pixel.x += px;
  };
  for (std::uint32_t i = 0; i < 5; ++i) shift(i, 0.02);  // a small error in all poses
  CHECK(found(model) == "");
  shift(3, 2);
  CHECK(found(model) == "warning: The pose of 003.png is doubtful: its points are off by 2.0 px.\n");
  for (const std::uint32_t i : {0u, 1u, 2u, 4u}) shift(i, 2);
  CHECK(found(model) == "warning: The poses fit the photographs badly: points are off by 2.0 px.\n");
}

TEST_CASE("parts that share nothing, and a photograph that shares little") {
  CHECK_THAT(found(test::modelOf(row({0, 1, 2, 40, 41}), wall(-6, 50))),
             Contains("serious: 003.png and 004.png share too little with the other photographs."));
  PosedModel model = test::modelOf(row({0, 1, 2}), wall(-6, 8));
  std::size_t kept = 0;
  for (Track& track : model.tracks)
    std::erase_if(track.observations, [&](const TrackObservation& seen) { return seen.image == 1 && ++kept > 40; });
  CHECK(found(model) == "warning: 001.png shares only 40 points with the others.\n");
}

TEST_CASE("steps that are too large for what is near, and none at all") {
  CHECK(found(test::modelOf(row({0, 4, 8}), wall(-6, 14))).find("warning: From one photograph to the next it is") == 0);
  std::vector<Camera> turned = row({0, 0, 0});
  CHECK(found(test::modelOf(turned, wall(-6, 6))) ==
        "serious: All photographs were taken from one place, by turning the camera.\n");
}

TEST_CASE("findings are sorted by how much they matter, and of many alike some are told") {
  Findings findings;
  CHECK(findings.code() == kExitOk);
  findings.add({"a", Severity::hint, "A.", "a."});
  findings.add({"b", Severity::warning, "B.", "b."});
  CHECK(findings.code() == kExitOk);
  findings.add({"c", Severity::serious, "C.", "c.", kExitUnsupported});
  findings.add({"d", Severity::serious, "D.", "d.", kExitIo});
  CHECK(findings.code() == kExitUnsupported);
  const auto list = findings.json().at("findings");
  CHECK(list[0].at("sentence") == "C.");
  CHECK(list[3].at("subject") == "a");
  CHECK(someOf({"A"}) == "A");
  CHECK(someOf({"A", "B"}) == "A and B");
  CHECK(someOf({"A", "B", "C"}) == "A, B and C");
  CHECK(someOf({"A", "B", "C", "D"}) == "A, B and 2 more");
  CHECK(someOf({}) == "");
}
