// SPDX-License-Identifier: Apache-2.0
#include "frame_record.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace ibr::test {

using nlohmann::json;

namespace {

json asJson(const XrPosef& p) {
  return {p.position.x, p.position.y, p.position.z, p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w};
}

json asJson(const XrFovf& fov) {
  return {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown};
}

// Compares values up to rounding errors, for example of a normalised rotation.
template <class T>
bool same(const T& a, const T& b) {
  std::array<float, sizeof(T) / sizeof(float)> x, y;
  std::memcpy(x.data(), &a, sizeof a);
  std::memcpy(y.data(), &b, sizeof b);
  return std::ranges::equal(x, y, [](float p, float q) { return std::abs(p - q) <= 1e-6f; });
}

std::string nameOf(XrSessionState state) {
  constexpr const char* kNames[]{"UNKNOWN", "IDLE",     "READY",        "SYNCHRONIZED", "VISIBLE",
                                 "FOCUSED", "STOPPING", "LOSS_PENDING", "EXITING"};
  return state >= 0 && std::size_t(state) < std::size(kNames) ? kNames[state] : std::to_string(state);
}

}  // namespace

FrameRecord::FrameRecord(const std::string& file) {
  if (!file.empty()) out_.open(file, std::ios::app);
}

void FrameRecord::write(const json& line) {
  if (out_.is_open()) out_ << line.dump() << std::endl;
}

void FrameRecord::session(XrSession) {
  waited_.clear();
  located_.clear();
  write({{"session", sessions_++}});
}

void FrameRecord::swapchain(XrSwapchain swapchain, XrSession session, const XrSwapchainCreateInfo& info) {
  swapchains_[swapchain] = {.owner = session, .number = swapchainsMade_++, .given = {.format = info.format}};
  write({{"swapchain", swapchains_[swapchain].number},
         {"format", info.format},
         {"width", info.width},
         {"height", info.height},
         {"layers", info.arraySize},
         {"samples", info.sampleCount}});
}

void FrameRecord::released(XrSwapchain swapchain) {
  Swapchain& given = swapchains_[swapchain];
  if (given.held.empty()) return;
  given.given.image = given.held.front();
  given.held.pop_front();
}

void FrameRecord::begun() {
  if (waited_.empty()) return;
  begun_ = waited_.front();
  waited_.pop_front();
}

void FrameRecord::located(const XrViewLocateInfo& info, const XrView* views, std::uint32_t count) {
  located_.push_back({info.displayTime, info.space, {views, views + count}});
  if (located_.size() > 32) located_.pop_front();
}

void FrameRecord::event(const XrEventDataBuffer& event) {
  if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
    const auto& changed = reinterpret_cast<const XrEventDataSessionStateChanged&>(event);
    write({{"event", "state"}, {"state", nameOf(changed.state)}});
  } else {
    write({{"event", event.type}});
  }
}

bool FrameRecord::isAsLocated(const XrCompositionLayerProjectionView& view, std::uint32_t index, XrTime time,
                              XrSpace space) const {
  for (const Located& located : located_)
    if (located.time == time && located.space == space && index < located.views.size() &&
        same(located.views[index].pose, view.pose) && same(located.views[index].fov, view.fov))
      return true;
  return false;
}

json FrameRecord::subImage(const XrSwapchainSubImage& image) const {
  const Swapchain swapchain = find(swapchains_, image.swapchain);
  const auto& [offset, extent] = image.imageRect;
  return {{"swapchain", swapchain.number},
          {"layer", image.imageArrayIndex},
          {"rect", {offset.x, offset.y, extent.width, extent.height}},
          {"released", swapchain.given.image >= 0 && swapchain.held.empty()}};
}

json FrameRecord::view(const XrCompositionLayerProjectionView& view, std::uint32_t index, XrTime time,
                       XrSpace space) const {
  json line = subImage(view.subImage);
  line["pose"] = asJson(view.pose);
  line["fov"] = asJson(view.fov);
  line["asLocated"] = isAsLocated(view, index, time, space);
  using Depth = XrCompositionLayerDepthInfoKHR;
  if (const Depth* depth = chained<Depth>(view.next, XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR)) {
    line["depth"] = subImage(depth->subImage);
    line["depth"]["range"] = {depth->minDepth, depth->maxDepth};
    line["depth"]["near"] = depth->nearZ;
    // JSON has no infinity; the far plane of reversed depth may be infinite.
    if (std::isfinite(depth->farZ)) line["depth"]["far"] = depth->farZ;
  }
  return line;
}

json FrameRecord::layer(const XrCompositionLayerBaseHeader& layer, XrTime time) const {
  json line{{"space", find(spaces_, layer.space).type}, {"flags", layer.layerFlags}};
  if (layer.type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
    const auto& projection = reinterpret_cast<const XrCompositionLayerProjection&>(layer);
    line["type"] = "projection";
    for (std::uint32_t i = 0; i < projection.viewCount; ++i)
      line["views"].push_back(view(projection.views[i], i, time, layer.space));
  } else if (layer.type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
    const auto& quad = reinterpret_cast<const XrCompositionLayerQuad&>(layer);
    line["type"] = "quad";
    line["image"] = subImage(quad.subImage);
    line["pose"] = asJson(quad.pose);
    line["size"] = {quad.size.width, quad.size.height};
  } else {
    line["type"] = layer.type;
  }
  return line;
}

void FrameRecord::ended(int frame, const XrFrameEndInfo& info, XrResult result) {
  json line{{"frame", frame},
            {"result", result},
            {"displayTime", info.displayTime},
            {"predicted", begun_.predictedDisplayTime},
            {"shouldRender", begun_.shouldRender == XR_TRUE},
            {"layers", json::array()}};
  for (std::uint32_t i = 0; i < info.layerCount; ++i)
    line["layers"].push_back(layer(*info.layers[i], info.displayTime));
  write(line);
}

}  // namespace ibr::test
