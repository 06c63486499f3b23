// SPDX-License-Identifier: Apache-2.0
#include "render/passes/cell_parameters.h"

#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/gtc/quaternion.hpp>

#include "render/plan/correction.h"

namespace ibr {
namespace {

// Offset of the second view's noise. Both eyes must see one noise pattern, as if at infinity straight ahead, to avoid
// binocular rivalry. The offset is the difference of the pixels at which the views see their middle direction.
shader::uvec2 noiseOffset(const FramePlan& plan, std::size_t view) {
  if (view == 0) return {0, 0};
  const Pose &first = plan.views[0].pose, &other = plan.views[view].pose;
  const glm::dvec3 ahead = glm::slerp(first.rotation, other.rotation, 0.5) * glm::dvec3(0, 0, -1);
  const auto in = [&](const Camera& eye) { return project(eye.intrinsics, glm::conjugate(eye.pose.rotation) * ahead); };
  const auto here = in(plan.views[view]), there = in(plan.views[0]);
  if (!here || !there) return {0, 0};
  const auto wrapped = [](double pixels) {
    const double tiles = std::round(pixels) / shader::kNoiseSize;
    return std::uint32_t(std::lround((tiles - std::floor(tiles)) * shader::kNoiseSize)) % shader::kNoiseSize;
  };
  return {wrapped(there->x - here->x), wrapped(there->y - here->y)};
}

}  // namespace

shader::CellParameters cellParameters(const FramePlan& plan, std::size_t view, const DrawItem& item) noexcept {
  const Camera& eye = plan.views[view];
  const glm::dquat toView = glm::conjugate(eye.pose.rotation), turned = toView * item.correction->rotation;
  shader::CellParameters cell{};
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < item.mesh->cameras.size(); ++i) {
    const Camera& camera = item.mesh->cameras[i];
    const Intrinsics& k = camera.intrinsics;
    shader::CellMember& member = cell.member[i];
    member.toView = glm::mat3(glm::mat3_cast(turned * camera.pose.rotation));
    member.focal = {float(k.fx / k.width), float(k.fy / k.height)};
    member.principal = {float(k.cx / k.width), float(k.cy / k.height)};
    member.position = float(item.weights.position[i]);
    member.blend = float(item.weights.blend[i]);
    if (item.mesh->masked) member.blend = std::max(member.blend, shader::kMinMaskedWeight);
    member.layer = item.mesh->layers[i];
    shift += item.weights.position[i] * (camera.pose.position - eye.pose.position);
  }
  cell.shift = glm::vec3(toView * corrected(*item.correction, shift, eye.pose.position));
  cell.nearDistance = float(plan.nearDistance);
  const Intrinsics& k = eye.intrinsics;
  // Vulkan's clip space: x right, y down, both −1 to 1 over the image.
  cell.projection = {float(2.0 * k.fx / k.width), float(2.0 * k.cx / k.width - 1.0), float(-2.0 * k.fy / k.height),
                     float(2.0 * k.cy / k.height - 1.0)};
  cell.unitRays = plan.settings.morph == Morph::paper;
  cell.detail = shader::kFinerDetail / float(plan.settings.textureScale);
  cell.table = item.table;
  cell.opacity = item.opacity;
  cell.noise = noiseOffset(plan, view);
  return cell;
}

shader::CellExposure cellExposure(const FramePlan& plan, const DrawItem& item) noexcept {
  shader::CellExposure cell{};
  for (std::size_t i = 0; i < item.mesh->gains.size(); ++i) {
    const glm::dvec3 gain =
        plan.settings.exposure == Exposure::off ? glm::dvec3(1.0) : plan.exposure * item.mesh->gains[i];
    cell.member[i] = {gain, glm::pow(gain, glm::dvec3(1 / 2.4))};
  }
  return cell;
}

}  // namespace ibr
