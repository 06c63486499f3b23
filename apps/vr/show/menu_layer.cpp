// SPDX-License-Identifier: Apache-2.0
#include "vr/show/menu_layer.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace ibr::app {
namespace {

constexpr int kWidth = 960, kHeight = 720;         // px
constexpr glm::dvec2 kSize{0.72, 0.54};            // m
constexpr double kDistance = 0.85, kLower = 0.12;  // m, ahead of the head and below it

constexpr ImageUse kInitialUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};

}  // namespace

MenuLayer::MenuLayer(Headset& headset, const Device& device, const Session& session, const LogCallback& log)
    : headset_(headset), panel_(kWidth, kHeight) {
  const std::optional<VkFormat> format = pictureFormat(session);
  if (!format) {
    if (log) log(LogLevel::warning, "no menu: the OpenXR runtime offers no 8-bit sRGB format");
    return;
  }
  images_ =
      XrImages(headset, device, session, *format,
               XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT, {kWidth, kHeight}, 1);
  drawer_.emplace(device, panel_, *format, FrameRing::kSlots);
}

void MenuLayer::open(const Pose& head) {
  open_ = drawer_.has_value();
  if (!open_) return;
  panel_.open();
  const glm::dvec3 ahead = facingOf(head.rotation);
  pose_.position = head.position + kDistance * ahead - glm::dvec3(0, kLower, 0);
  pose_.rotation = glm::angleAxis(headingOf(head.rotation), glm::dvec3(0, 1, 0));
}

void MenuLayer::recentred(const Pose& newInOld) {
  const glm::dquat back = glm::conjugate(newInOld.rotation);
  pose_ = {back * (pose_.position - newInOld.position), back * pose_.rotation};
}

MenuLayer::RayHit MenuLayer::rayHit(const Pose& aim) const {
  const glm::dquat back = glm::conjugate(pose_.rotation);
  const glm::dvec3 from = back * (aim.position - pose_.position), along = back * (aim.rotation * glm::dvec3(0, 0, -1));
  if (from.z <= 0 || along.z >= 0) return {};  // from behind, or pointing away
  const double metres = -from.z / along.z;
  const glm::dvec3 hit = from + metres * along;
  const glm::dvec2 at{0.5 + hit.x / kSize.x, 0.5 - hit.y / kSize.y};
  if (!(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1)) return {};
  return {at, metres};
}

void MenuLayer::point(std::array<HandInput, 2>& hands) {
  for (const Hand hand : {kLeft, kRight}) {
    rayHits_[hand] = open_ && hands[hand].active ? rayHit(hands[hand].aim) : RayHit();
    hands[hand].onPanel = rayHits_[hand].at.has_value();
  }
}

MenuRequests MenuLayer::show(const MenuModel& model, const std::array<HandOutput, 2>& hands, double seconds) {
  // The pressing hand has the pointer; without a press, a hand that points at the panel while the other does not.
  for (const Hand hand : {kLeft, kRight})
    if (hands[hand].panelSelect && !hands[pointer_].panelSelect) pointer_ = hand;
  const Hand other = pointer_ == kLeft ? kRight : kLeft;
  if (!hands[pointer_].panelSelect && !rayHits_[pointer_].at && rayHits_[other].at) pointer_ = other;
  return panel_.show(model, {rayHits_[pointer_].at, hands[pointer_].panelSelect}, seconds);
}

void MenuLayer::record(const FrameRing::Frame& frame) {
  images_.acquire(headset_);
  drawer_->record(frame.commands, images_.image(), kInitialUse, use::kColourAttachment);
}

void MenuLayer::release() {
  images_.release(headset_);
}

const XrCompositionLayerBaseHeader* MenuLayer::layer(XrSpace space) noexcept {
  quad_ = {.type = XR_TYPE_COMPOSITION_LAYER_QUAD,
           .next = nullptr,
           .layerFlags = 0,
           .space = space,
           .eyeVisibility = XR_EYE_VISIBILITY_BOTH,
           .subImage = {images_.get(), {{0, 0}, {kWidth, kHeight}}, 0},
           .pose = xrPoseOf(pose_),
           .size = {float(kSize.x), float(kSize.y)}};
  return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad_);
}

}  // namespace ibr::app
