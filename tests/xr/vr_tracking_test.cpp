// SPDX-License-Identifier: Apache-2.0
// Partial or invalid head tracking in ibr-vr, and output files that cannot be written.
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/json.h"
#include "vr_menu_user.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using nlohmann::json;

namespace {

glm::dvec3 eyeOf(const json& frame, std::size_t eye) {
  return recordedPose(frame["layers"][0]["views"][eye]["pose"]).position;
}

}  // namespace

TEST_CASE("without any tracked position the scene is shown in stereo at the default height") {
  XrSetup setup("half-view-pose");
  Visitor visitor(setup);
  visitor.move(lookingAhead());
  visitor.waitForScene();
  visitor.leave();
  const std::vector<json> frames = shownFrames(setup);
  REQUIRE(frames.size() > 15);
  for (const json& frame : frames) {
    INFO(jsonLine(frame));
    REQUIRE(frame["layers"][0]["views"][0]["pose"][0].is_number());
    CHECK(glm::distance(eyeOf(frame, 0), {-0.0315, 1.6, 0}) < 1e-5);
    CHECK(glm::distance(eyeOf(frame, 1), {0.0315, 1.6, 0}) < 1e-5);
  }
}

TEST_CASE("frames with invalid poses or fields of view are skipped") {
  XrSetup setup;
  Visitor visitor(setup);
  visitor.move(lookingAhead());
  visitor.waitForScene();
  RemoteState state = lookingAhead();
  state.eyes[0].fov = {0.5, -0.5, 0.5, -0.5};
  visitor.move(state);
  const json without = setup.frames().back();
  CHECK(without["layers"].empty());
  state = lookingAhead();
  state.head.position.x = std::nan("");
  visitor.move(state);
  state.head.rotation.x = std::nan("");
  visitor.move(state);
  visitor.move(lookingAhead({0.1, 1.6, 0}));
  visitor.leave();
  for (const json& frame : shownFrames(setup))
    for (const json& layer : frame["layers"])
      for (const json& view : layer["views"])
        for (const json& number : view["pose"]) CHECK(number.is_number());
  const json last = shownFrames(setup).back();
  CHECK(glm::distance(eyeOf(last, 0), glm::dvec3(0.1, 1.6, 0) + lookingAhead().eyes[0].pose.position) < 1e-5);
}

TEST_CASE("a log that cannot be written gives an error after the report") {
  XrSetup setup;
  fs::create_symlink("/dev/full", setup.folder() / "log");
  Visitor visitor(setup, {"--frames", "8"});
  const Outcome outcome = visitor.finish();
  CHECK(outcome.code == 2);
  CHECK(parseJson(outcome.out)["frames"]["frames"] == 8);
}

TEST_CASE("a headset lost during the exit does not prevent the exit") {
  XrSetup setup("loss-at-exit");
  Visitor visitor(setup, {"--frames", "8"});
  const Outcome outcome = visitor.finish();
  CHECK(outcome.code == 0);
  const json report = parseJson(outcome.out);
  CHECK(report["losses"] == 0);
  CHECK(report["frames"]["frames"] == 8);
}
