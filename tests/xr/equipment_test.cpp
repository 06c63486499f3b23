// SPDX-License-Identifier: Apache-2.0
// Tests of the test equipment: the runtime, the scripted headset, the faults and the record, as seen by a minimal
// program (probe).
#include <openxr/openxr.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "faults.h"
#include "support/json.h"
#include "xr_setup.h"

using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

namespace {

struct Seen {
  int code = -1;
  json start;                // of the first session
  std::vector<json> frames;  // as the program received them
  std::vector<json> sessions;
  std::string out, err;
};

Seen readLines(const Outcome& outcome) {
  Seen seen{.code = outcome.code, .out = outcome.out, .err = outcome.err};
  std::istringstream in(outcome.out);
  for (std::string line; std::getline(in, line);) {
    const json one = parseJson(line);
    if (one.contains("formats")) seen.sessions.push_back(one);
    if (one.contains("frame")) seen.frames.push_back(one);
  }
  if (!seen.sessions.empty()) seen.start = seen.sessions[0];
  return seen;
}

Seen probe(const XrSetup& setup, int frames) {
  return readLines(runProgram({std::to_string(frames)}, {.program = IBR_XR_PROBE, .environment = setup.environment()}));
}

bool near(const json& values, std::initializer_list<double> expected) {
  std::size_t i = 0;
  for (const double value : expected)
    if (!values[i].is_number() || std::abs(values[i++].get<double>() - value) > 1e-5) return false;
  return true;
}

}  // namespace

TEST_CASE("the scripted headset sets the poses of head, eyes and hands") {
  XrSetup setup;
  RunningProgram program({"100000"}, {.program = IBR_XR_PROBE, .environment = setup.environment()});
  RemoteState state;
  state.head.position = {1, 1.7, -2};
  state.ownEyes = true;
  state.eyes[0] = {{{-0.03, 0.01, 0}, {1, 0, 0, 0}}, {-0.9, 0.7, 0.8, -0.85}};
  state.eyes[1] = {{{0.04, 0, 0}, {1, 0, 0, 0}}, {-0.7, 0.9, 0.75, -0.8}};
  state.right.pose.position = {0.5, 1.2, -0.4};
  state.left.stick = {-0.5f, 0.25f};
  REQUIRE(setup.move(program, state));
  state.right.trigger = 1;
  state.head.position.x = 1.5;
  REQUIRE(setup.move(program, state));
  const std::size_t moved = setup.frames().size();
  program.interrupt();
  const Seen seen = readLines(program.finish());
  REQUIRE(seen.frames.size() >= moved);
  const json& last = seen.frames[moved - 1];
  INFO(jsonLine(last));
  CHECK(near(last["eyes"][0], {1.47, 1.71, -2}));
  CHECK(near(last["eyes"][1], {1.54, 1.7, -2}));
  CHECK(near(last["fov"][0], {-0.9, 0.7, 0.8, -0.85}));
  CHECK(near(last["fov"][1], {-0.7, 0.9, 0.75, -0.8}));
  CHECK(near(last["hand"], {0.5, 1.2, -0.4}));
  CHECK(near(last["stick"], {-0.5, 0.25}));
  CHECK(last["select"] == true);
  CHECK(seen.frames[0]["select"] == false);
  // The record contains the same values.
  const json recorded = setup.frames()[moved - 1];
  const json& view = recorded["layers"][0]["views"][1];
  INFO(jsonLine(recorded));
  CHECK(recorded["displayTime"] == recorded["predicted"]);
  CHECK(recorded["layers"][0]["space"] == "STAGE");
  CHECK(near(view["pose"], {1.54, 1.7, -2, 0, 0, 0, 1}));
  CHECK(near(view["fov"], {-0.7, 0.9, 0.75, -0.8}));
  CHECK(view["asLocated"] == true);
  CHECK(view["released"] == true);
  CHECK(view["rect"] == json::array({0, 0, 320, 240}));
}

TEST_CASE("without faults a session starts and continues") {
  XrSetup setup;
  const Seen seen = probe(setup, 10);
  INFO(seen.out + seen.err);
  CHECK(seen.code == 0);
  CHECK(seen.frames.size() == 10);
  CHECK(setup.states() == "IDLE READY SYNCHRONIZED VISIBLE FOCUSED");
  CHECK(seen.start["depthLayer"] == true);
  CHECK(seen.start["visibilityMask"] == true);
  CHECK(seen.start["maskIndices"] > 0);
  CHECK(seen.start["layers"] == 2);
  CHECK(seen.start["size"] == json::array({320, 240}));
  CHECK(seen.start["formats"].size() > 4);
  CHECK(jsonLine(seen.start["spaces"]).find('3') != std::string::npos);  // STAGE
}

TEST_CASE("faults remove optional features of the runtime") {
  XrSetup setup(
      "formats=97:91,no-stage,no-array,odd-size=333x217,empty-mask,"
      "hide=XR_KHR_composition_layer_depth");
  const Seen seen = probe(setup, 3);
  INFO(seen.out + seen.err);
  CHECK(seen.code == 0);
  CHECK(seen.start["formats"] == json::array({97, 91}));
  CHECK(jsonLine(seen.start["spaces"]).find('3') == std::string::npos);
  CHECK(seen.start["layers"] == 1);
  CHECK(seen.start["size"] == json::array({333, 217}));
  CHECK(seen.start["maskIndices"] == 0);
  CHECK(seen.start["depthLayer"] == false);
  CHECK(seen.start["visibilityMask"] == true);
  XrSetup others("hide=XR_KHR_visibility_mask:XR_KHR_composition_layer_depth");
  CHECK(probe(others, 1).start["visibilityMask"] == false);
  XrSetup half("half-mask");
  CHECK(probe(half, 1).start["maskIndices"] == 6);
  XrSetup none("no-headset");
  CHECK_THAT(probe(none, 1).out, Contains("xrGetSystem"));
  XrSetup back("instance-loss@3,no-headset=0@3");
  CHECK(probe(back, 5).code == 0);
  XrSetup away("instance-loss@3,no-headset=1@3");
  CHECK_THAT(probe(away, 5).out, Contains("xrGetSystem"));
  XrSetup full("no-swapchain");
  CHECK_THAT(probe(full, 1).out, Contains("xrCreateSwapchain"));
}

TEST_CASE("faults change frames at their numbers") {
  XrSetup setup("not-rendered@4-5,no-view-pose@6,half-view-pose@7,frame-discarded@8");
  const Seen seen = probe(setup, 9);
  INFO(seen.out + seen.err);
  REQUIRE(seen.frames.size() == 9);
  for (int i = 2; i <= 9; ++i) {
    const json& frame = seen.frames[std::size_t(i - 1)];
    CHECK(frame["shouldRender"] == (i != 4 && i != 5));
    CHECK(frame["discarded"] == (i == 8));
    CHECK(((frame["flags"].get<int>() & 2) == 0) == (i == 6 || i == 7));  // position
    CHECK(((frame["flags"].get<int>() & 1) == 0) == (i == 6));            // orientation
    CHECK(frame["eyes"][0][0].is_null() == (i == 6 || i == 7));           // NaN
  }
  CHECK(setup.frames()[2]["layers"][0]["views"][0]["asLocated"] == true);
  CHECK(setup.frames()[5]["layers"].empty());
  CHECK(setup.frames()[6]["layers"][0]["views"][0]["asLocated"] == false);
}

TEST_CASE("after a lost session a new one continues") {
  XrSetup setup("session-loss@4,loss-pending@8");
  const Seen seen = probe(setup, 12);
  INFO(seen.out + seen.err);
  CHECK(seen.code == 0);
  CHECK(seen.frames.size() == 12);
  CHECK(seen.sessions.size() == 3);
  CHECK_THAT(setup.states(), Contains("LOSS_PENDING"));
}

TEST_CASE("after a lost instance a new one continues") {
  XrSetup setup("instance-loss@4");
  const Seen seen = probe(setup, 8);
  INFO(seen.out + seen.err);
  CHECK(seen.code == 0);
  CHECK(seen.frames.size() == 8);
  CHECK(seen.sessions.size() == 2);
}

TEST_CASE("a headset is taken off and put on, then the runtime requests the exit") {
  XrSetup setup("stopping@4,recentre@6,mask-changed@6,exit@8");
  const Seen seen = probe(setup, 20);
  INFO(seen.out + seen.err);
  CHECK(seen.code == 2);
  CHECK(setup.states() ==
        "IDLE READY SYNCHRONIZED VISIBLE FOCUSED VISIBLE SYNCHRONIZED STOPPING IDLE READY SYNCHRONIZED VISIBLE FOCUSED "
        "VISIBLE SYNCHRONIZED STOPPING IDLE EXITING");
  std::string events;
  for (const json& line : setup.record())
    if (line.contains("event")) events += jsonLine(line["event"]) + " ";
  CHECK_THAT(events, Contains(std::to_string(XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING)) &&
                         Contains(std::to_string(XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR)));
}

TEST_CASE("unknown faults are refused") {
  for (const char* words : {"session-los@4", "session-loss@x", "stopping@-3", "exit@3-", "@4", "exit@4x"}) {
    INFO(words);
    CHECK_THROWS_AS(Faults(words), std::invalid_argument);
  }
  CHECK_NOTHROW(Faults(""));
  XrSetup setup("no-stge");
  const Seen seen = probe(setup, 1);
  CHECK(seen.code == 1);
  CHECK_THAT(seen.err, Contains("no-stge"));
}
