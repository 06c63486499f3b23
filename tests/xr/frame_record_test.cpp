// SPDX-License-Identifier: Apache-2.0
#include "frame_record.h"

#include <array>
#include <catch2/catch.hpp>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

using namespace ibr::test;
using nlohmann::json;

namespace {

const auto kSession = reinterpret_cast<XrSession>(1);
const auto kStage = reinterpret_cast<XrSpace>(2), kOther = reinterpret_cast<XrSpace>(3);
const auto kImages = reinterpret_cast<XrSwapchain>(4);

// A correctly submitted frame at time 1000.
struct Submitted {
  std::array<XrCompositionLayerProjectionView, 2> views{};
  XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
  XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO};
};

std::array<XrView, 2> places() {
  std::array<XrView, 2> views{};
  for (std::size_t i = 0; i < 2; ++i) {
    views[i].pose = {{0, 0.6f, 0, 0.8f}, {float(i), 1.5f, -2}};
    views[i].fov = {-0.5f - 0.1f * float(i), 0.5f, 0.4f, -0.4f};
  }
  return views;
}

// Returns the record of the frame after `change`.
json recorded(const std::function<void(Submitted&)>& change, bool holds = false) {
  const TemporaryFolder folder;
  FrameRecord record(folder / "record");
  const XrSwapchainCreateInfo made{XR_TYPE_SWAPCHAIN_CREATE_INFO};
  record.session(kSession);
  record.space(kStage, kSession, "STAGE");
  record.space(kOther, kSession, "LOCAL");
  record.swapchain(kImages, kSession, made);
  record.waited({XR_TYPE_FRAME_STATE, nullptr, 1000, 10, XR_TRUE});
  record.begun();
  const std::array<XrView, 2> views = places();
  XrViewLocateInfo where{XR_TYPE_VIEW_LOCATE_INFO};
  where.displayTime = 1000;
  where.space = kStage;
  record.located(where, views.data(), 2);
  record.acquired(kImages, 1);
  record.released(kImages);
  if (holds) record.acquired(kImages, 2);

  Submitted frame;
  for (std::size_t i = 0; i < 2; ++i) {
    frame.views[i].pose = views[i].pose;
    frame.views[i].fov = views[i].fov;
    frame.views[i].subImage = {kImages, {{1, 2}, {30, 40}}, std::uint32_t(i)};
  }
  frame.layer.space = kStage;
  frame.layer.viewCount = 2;
  frame.layer.views = frame.views.data();
  frame.end.displayTime = 1000;
  change(frame);
  const std::array layers{reinterpret_cast<const XrCompositionLayerBaseHeader*>(&frame.layer)};
  frame.end.layerCount = 1;
  frame.end.layers = layers.data();
  record.ended(7, frame.end, XR_SUCCESS);
  const std::string text = ibr::readTextFile(folder / "record");
  return parseJson(text.substr(text.rfind('\n', text.size() - 2) + 1));
}

json viewOf(const json& frame, std::size_t eye) {
  return frame["layers"][0]["views"][eye];
}

}  // namespace

TEST_CASE("a frame is recorded with time, space and views") {
  const json frame = recorded([](Submitted&) {});
  CHECK(frame["frame"] == 7);
  CHECK(frame["displayTime"] == 1000);
  CHECK(frame["predicted"] == 1000);
  CHECK(frame["shouldRender"] == true);
  CHECK(frame["layers"][0]["space"] == "STAGE");
  for (std::size_t eye = 0; eye < 2; ++eye) {
    CHECK(viewOf(frame, eye)["asLocated"] == true);
    CHECK(viewOf(frame, eye)["released"] == true);
    CHECK(viewOf(frame, eye)["layer"] == eye);
    CHECK(viewOf(frame, eye)["rect"] == json::array({1, 2, 30, 40}));
    CHECK(!viewOf(frame, eye).contains("depth"));
  }
  CHECK(viewOf(recorded([](Submitted&) {}, true), 0)["released"] == false);
}

TEST_CASE("views that differ from their located poses are marked") {
  using Change = std::function<void(Submitted&)>;
  const Change changes[]{[](Submitted& s) { s.views[1].pose.position.z += 1e-4f; },
                         [](Submitted& s) { s.views[1].pose.orientation.w = -0.8f; },
                         [](Submitted& s) { s.views[1].fov = s.views[0].fov; },
                         [](Submitted& s) { s.end.displayTime = 1001; },
                         [](Submitted& s) { s.layer.space = kOther; },
                         [](Submitted& s) { s.views[1].pose.position.x = std::numeric_limits<float>::quiet_NaN(); }};
  for (const Change& change : changes) CHECK(viewOf(recorded(change), 1)["asLocated"] == false);
  CHECK(viewOf(recorded(changes[0]), 0)["asLocated"] == true);
}

TEST_CASE("depth is recorded, also with an infinite far plane") {
  XrCompositionLayerDepthInfoKHR depth{XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR};
  depth.subImage = {kImages, {{0, 0}, {5, 6}}, 1};
  depth.minDepth = 0.25f;
  depth.maxDepth = 0.75f;
  depth.nearZ = 0.5f;
  depth.farZ = 8;
  const json frame = recorded([&](Submitted& s) { s.views[0].next = &depth; });
  CHECK(viewOf(frame, 0)["depth"]["range"] == json::array({0.25, 0.75}));
  CHECK(viewOf(frame, 0)["depth"]["near"] == 0.5);
  CHECK(viewOf(frame, 0)["depth"]["far"] == 8);
  CHECK(viewOf(frame, 0)["depth"]["layer"] == 1);
  depth.farZ = std::numeric_limits<float>::infinity();
  CHECK(!viewOf(recorded([&](Submitted& s) { s.views[0].next = &depth; }), 0)["depth"].contains("far"));
}
