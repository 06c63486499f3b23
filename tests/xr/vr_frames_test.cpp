// SPDX-License-Identifier: Apache-2.0
// Frames that ibr-vr submits to the runtime, from the record.
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/json.h"
#include "vr_harness.h"

using namespace ibr::test;
using nlohmann::json;

namespace {

// Checks the properties of every frame that shows something.
void checkFrame(const json& frame, const std::string& space) {
  INFO(jsonLine(frame));
  CHECK(frame["result"] == 0);
  CHECK(frame["displayTime"] == frame["predicted"]);
  CHECK(frame["shouldRender"] == true);
  REQUIRE(frame["layers"].size() == 1);
  const json& layer = frame["layers"][0];
  CHECK(layer["type"] == "projection");
  CHECK(layer["space"] == space);
  REQUIRE(layer["views"].size() == 2);
  for (int eye = 0; eye < 2; ++eye) {
    const json& view = layer["views"][std::size_t(eye)];
    CHECK(view["asLocated"] == true);
    CHECK(view["released"] == true);
    CHECK(view["layer"] == eye);
    CHECK(view["rect"] == json::array({0, 0, 320, 240}));
    REQUIRE(view.contains("depth"));
    const json& depth = view["depth"];
    CHECK(depth["released"] == true);
    CHECK(depth["swapchain"] != view["swapchain"]);
    CHECK(depth["layer"] == eye);
    CHECK(depth["rect"] == view["rect"]);
    CHECK(depth["range"] == json::array({0.0, 1.0}));
    CHECK(depth["near"] > 0);
    CHECK(depth["near"] < depth.value("far", 1e9));
  }
}

}  // namespace

TEST_CASE("hundreds of frames are submitted at their predicted times and poses") {
  XrSetup setup;
  Visitor visitor(setup);
  RemoteState state = lookingAhead();
  visitor.move(state);
  visitor.waitForScene();
  for (int i = 0; i < 30; ++i) {
    const double t = 0.2 * i;
    state.head.position = {0.3 * std::sin(t), 1.6 + 0.1 * std::cos(t), 0.2 * std::sin(2 * t)};
    state.head.rotation = glm::angleAxis(0.5 * std::sin(t), glm::normalize(glm::dvec3(0.2, 1, 0.1)));
    visitor.move(state);
    visitor.pass(4);
  }
  const json report = visitor.leave();
  CHECK(report["losses"] == 0);
  const std::vector<json> frames = shownFrames(setup);
  REQUIRE(frames.size() >= 200);
  for (const json& frame : frames) checkFrame(frame, "STAGE");
  // The head moved all the time. The last frame shows the last pose.
  const json& last = frames.back()["layers"][0]["views"][0];
  const glm::dvec3 eye = state.head.position + state.head.rotation * state.eyes[0].pose.position;
  for (int k = 0; k < 3; ++k) CHECK(last["pose"][std::size_t(k)].get<double>() == Approx(eye[k]).margin(1e-5));
  CHECK(last["fov"][0].get<double>() == Approx(state.eyes[0].fov.left));
  CHECK(last["pose"] != frames[frames.size() / 2]["layers"][0]["views"][0]["pose"]);
  CHECK(setup.states() == "IDLE READY SYNCHRONIZED VISIBLE FOCUSED VISIBLE SYNCHRONIZED STOPPING IDLE EXITING");
}

TEST_CASE("an sRGB swapchain format is preferred to the first offered format") {
  XrSetup setup;
  Visitor visitor(setup, {"--frames", "3"});
  CHECK(visitor.finish().code == 0);
  std::vector<json> swapchains = setup.record();
  std::erase_if(swapchains, [](const json& line) { return line.value("width", 0) != 320; });  // only those of the eyes
  REQUIRE(swapchains.size() == 2);
  CHECK((swapchains[0]["format"] == 43 || swapchains[0]["format"] == 50));
  CHECK((swapchains[1]["format"] == 126 || swapchains[1]["format"] == 130));  // floating-point depth
  for (const json& one : swapchains) {
    CHECK(one["layers"] == 2);
    CHECK(one["samples"] == 1);
  }
}

TEST_CASE("the log contains each frame and a summary") {
  XrSetup setup;
  Visitor visitor(setup, {"--frames", "20"});
  const Outcome outcome = visitor.finish();
  CHECK(outcome.code == 0);
  const json report = parseJson(outcome.out);
  std::ifstream in(setup.folder() / "log");
  int frames = 0;
  json last;
  for (std::string line; std::getline(in, line);) {
    last = parseJson(line);
    if (last.contains("intervalMs")) CHECK(last["frame"] == ++frames);
  }
  CHECK(last["summary"] == report["frames"]);
  CHECK(last["summary"]["frames"] == frames);
  CHECK(frames >= 20);
  for (const char* time : {"intervalMs", "processorMs", "deviceMs"}) {
    const json& t = last["summary"][time];
    CHECK(t["p50"] > 0);
    CHECK(t["p50"] <= t["p95"]);
    CHECK(t["p95"] <= t["p99"]);
  }
}
