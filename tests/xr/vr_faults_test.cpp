// SPDX-License-Identifier: Apache-2.0
// Faults of a headset: ibr-vr continues, or ends with a message and an exit code that state the reason.
#include "support/json.h"
#include "vr_harness.h"

#include <nlohmann/json.hpp>

using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

namespace {

struct End {
  Outcome outcome;
  json report;  // null if the program failed
  std::vector<json> record;
  std::string states;
};

End visit(const std::string& faults, int frames, std::vector<std::string> more = {}) {
  XrSetup setup(faults);
  more.insert(more.end(), {"--frames", std::to_string(frames)});
  Visitor visitor(setup, more);
  End end{visitor.finish(), nullptr, setup.record(), setup.states()};
  if (end.outcome.code == 0) end.report = parseJson(end.outcome.out);
  return end;
}

// Checks that the program runs to its end and the runtime accepted every submitted frame.
End survives(const std::string& faults, int frames = 40) {
  End end = visit(faults, frames);
  INFO(faults);
  INFO(end.outcome.err);
  CHECK(end.outcome.code == 0);
  for (const json& line : end.record)
    if (line.contains("frame")) CHECK(line["result"] == 0);
  return end;
}

std::size_t count(const End& end, const char* what) {
  return std::size_t(std::ranges::count_if(end.record, [&](const json& line) { return line.contains(what); }));
}

}  // namespace

TEST_CASE("ibr-vr continues after a lost session") {
  const End lost = survives("session-loss@20");
  CHECK(count(lost, "session") == 2);
  CHECK(lost.report["losses"] == 1);
  CHECK_THAT(lost.outcome.err, Contains("XR_ERROR_SESSION_LOST"));
  const End pending = survives("loss-pending@20");
  CHECK(count(pending, "session") == 2);
  CHECK(pending.report["losses"] == 1);
}

TEST_CASE("ibr-vr continues after a lost instance") {
  const End end = survives("instance-loss@20");
  CHECK(count(end, "session") == 2);
  CHECK(end.report["losses"] == 1);
}

TEST_CASE("ibr-vr waits for a headset that is missing after a loss") {
  const End end = survives("session-loss@20,no-headset=2@20");
  CHECK(count(end, "session") == 2);
  CHECK_THAT(end.outcome.err, Contains("XR_ERROR_FORM_FACTOR_UNAVAILABLE"));
}

TEST_CASE("ibr-vr gives up after repeated losses of the session") {
  const End end = visit("session-loss@4,session-loss@7,session-loss@10,session-loss@13,session-loss@16", 1000);
  CHECK(end.outcome.code == 4);
  CHECK_THAT(end.outcome.err, Contains("XR_ERROR_SESSION_LOST"));
}

TEST_CASE("ibr-vr pauses while the headset is off, and exits when the runtime requests it") {
  const End off = survives("stopping@20");
  CHECK_THAT(off.states, Contains("STOPPING IDLE READY SYNCHRONIZED VISIBLE FOCUSED"));
  CHECK(off.report["losses"] == 0);
  const End exit = visit("exit@20", 0);
  CHECK(exit.outcome.code == 0);
  CHECK_THAT(exit.states, Contains("STOPPING IDLE EXITING"));
}

TEST_CASE("frames that should not be rendered or have no pose submit no layers") {
  const End end = survives("not-rendered@20-22,no-view-pose@25,frame-discarded@28");
  std::vector<std::size_t> empty;
  for (const json& line : end.record)
    if (line.contains("frame") && line["frame"] > 10 && line["layers"].empty()) empty.push_back(line["frame"]);
  CHECK(empty == std::vector<std::size_t>{20, 21, 22, 25});
}

TEST_CASE("without a tracked position the head stays in place") {
  const End end = survives("half-view-pose@30-32");
  json before;
  for (const json& line : end.record) {
    if (!line.contains("frame") || line["layers"].empty()) continue;
    const json& pose = line["layers"][0]["views"][0]["pose"];
    if (line["frame"] == 29) before = pose;
    if (line["frame"] >= 30 && line["frame"] <= 32) CHECK(pose == before);
  }
  CHECK(before.is_array());
}

TEST_CASE("events for recentring and for the visibility mask are handled") {
  survives("recentre@20,recentre=stage@22,mask-changed@24");
}

TEST_CASE("ibr-vr runs without optional features of the runtime") {
  const End local = survives("no-stage", 20);
  CHECK_THAT(local.outcome.err, Contains("LOCAL"));
  for (const json& line : local.record)
    if (line.contains("frame") && !line["layers"].empty()) CHECK(line["layers"][0]["space"] == "LOCAL");
  const End flat = survives("no-array", 20);
  for (const json& line : flat.record)
    if (line.contains("frame") && !line["layers"].empty()) {
      const json& views = line["layers"][0]["views"];
      CHECK(views[0]["swapchain"] != views[1]["swapchain"]);
      CHECK(views[0]["layer"] == 0);
      CHECK(views[1]["layer"] == 0);
    }
  const End shallow = survives("hide=XR_KHR_composition_layer_depth:XR_KHR_visibility_mask,odd-size=333x217", 20);
  for (const json& line : shallow.record)
    if (line.contains("frame") && !line["layers"].empty()) {
      const json& view = line["layers"][0]["views"][0];
      CHECK(!view.contains("depth"));
      CHECK(view["rect"] == json::array({0, 0, 333, 217}));
    }
  survives("empty-mask", 20);
}

TEST_CASE("any supported swapchain format is used, and an error names unsupported formats") {
  for (const char* format : {"43", "50", "97", "91", "37", "44"}) survives(std::string("formats=") + format, 8);
  const End none = visit("formats=126:10", 8);
  CHECK(none.outcome.code == 5);
  CHECK_THAT(none.outcome.err, Contains("126"));
}

TEST_CASE("a missing headset, swapchain, extension or STAGE space gives an error") {
  const End none = visit("no-headset", 8);
  CHECK(none.outcome.code == 5);
  CHECK_THAT(none.outcome.err, Contains("XR_ERROR_FORM_FACTOR_UNAVAILABLE"));
  const End full = visit("no-swapchain", 8);
  CHECK(full.outcome.code != 0);
  CHECK_THAT(full.outcome.err, Contains("xrCreateSwapchain"));
  const End bare = visit("hide=XR_KHR_vulkan_enable2", 8);
  CHECK(bare.outcome.code == 5);
  CHECK_THAT(bare.outcome.err, Contains("XR_KHR_vulkan_enable2"));
  const End stage = visit("no-stage", 8, {"--space", "stage"});
  CHECK(stage.outcome.code == 5);
  CHECK_THAT(stage.outcome.err, Contains("STAGE"));
}
