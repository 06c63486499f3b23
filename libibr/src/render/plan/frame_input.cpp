// SPDX-License-Identifier: Apache-2.0
#include "render/plan/frame_input.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"
#include "scene/scene_faults.h"

namespace ibr {
namespace {

void checkView(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "view: the camera model must be pinhole");
  check(k.width > 0 && k.height > 0, ErrorCode::invalidInput, "view: size {}x{} is empty", k.width, k.height);
  check(k.fx > 0 && k.fy > 0 && std::isfinite(k.fx) && std::isfinite(k.fy), ErrorCode::invalidInput,
        "view: focal lengths {} and {} are not positive", k.fx, k.fy);
  check(std::isfinite(k.cx) && std::isfinite(k.cy), ErrorCode::invalidInput, "view: principal point is not finite");
  const glm::dvec3 p = view.pose.position;
  check(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), ErrorCode::invalidInput,
        "view: position ({}, {}, {}) is not finite", p.x, p.y, p.z);
  check(withinWorld(p), ErrorCode::invalidInput,
        "view: position ({}, {}, {}) is further from the origin than {} world units", p.x, p.y, p.z, kWorldRadius);
  const double length = glm::length(view.pose.rotation);
  check(std::abs(length - 1.0) <= 1e-3, ErrorCode::invalidInput, "view: rotation has length {}, not 1", length);
}

void checkScale(const char* name, double scale) {
  check(scale > 0 && std::isfinite(scale), ErrorCode::invalidInput, "settings: {} {} is not positive", name, scale);
}

void checkGather(const RenderSettings& settings) {
  const auto inRange = [](const char* name, std::uint32_t value, std::uint32_t most) {
    check(value >= 1 && value <= most, ErrorCode::invalidInput, "settings: {} {} is not between 1 and {}", name, value,
          most);
  };
  inRange("gatherCandidates", settings.gatherCandidates, kMaxGatherCandidates);
  inRange("gatherColours", settings.gatherColours, kMaxGatherColours);
  inRange("gatherLayers", settings.gatherLayers, kMaxGatherLayers);
  check(settings.voteScale > 0 && settings.voteScale <= 1, ErrorCode::invalidInput,
        "settings: voteScale {} must be above 0 and at most 1", settings.voteScale);
  check(settings.order == DrawOrder::ours, ErrorCode::invalidInput, "settings: order paper requires composition cells");
  check(settings.colourMapping <= ColourMapping::ours, ErrorCode::invalidInput,
        "settings: the paper's colourMapping requires composition cells");
}

}  // namespace

void checkInput(const FrameInput& input) {
  check(input.views.size() == 1 || input.views.size() == 2, ErrorCode::invalidInput,
        "views: {} cameras, must be 1 or 2", input.views.size());
  for (const Camera& view : input.views) checkView(view);
  checkScale("textureScale", input.settings.textureScale);
  checkScale("renderScale", input.settings.renderScale);
  if (input.settings.composition != Composition::cells) checkGather(input.settings);
}

}  // namespace ibr
