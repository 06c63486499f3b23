// SPDX-License-Identifier: Apache-2.0
#include "render/passes/cell_parameters.h"

#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/gtc/quaternion.hpp>

#include "render/plan/correction.h"

namespace ibr {
namespace {

// Both eyes see one pattern of noise, as if it hung infinitely far away straight ahead; otherwise it would rival. What
// is added to the second eye's pixels: the difference between where the two see the direction in their middle.
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

shader::CellParameters cellParameters(const FramePlan& plan, std::size_t view, const Step& step) noexcept {
  const Camera& eye = plan.views[view];
  const glm::dquat toView = glm::conjugate(eye.pose.rotation), turned = toView * step.correction->rotation;
  shader::CellParameters cell{};
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < step.mesh->cameras.size(); ++i) {
    const Camera& camera = step.mesh->cameras[i];
    const Intrinsics& k = camera.intrinsics;
    shader::CellMember& member = cell.member[i];
    member.toView = glm::mat3(glm::mat3_cast(turned * camera.pose.rotation));
    member.focal = {float(k.fx / k.width), float(k.fy / k.height)};
    member.principal = {float(k.cx / k.width), float(k.cy / k.height)};
    member.position = float(step.weights.position[i]);
    member.blend = float(step.weights.blend[i]);
    if (step.mesh->masked) member.blend = std::max(member.blend, shader::kLeastMaskedWeight);
    member.layer = step.mesh->layers[i];
    shift += step.weights.position[i] * (camera.pose.position - eye.pose.position);
  }
  cell.shift = glm::vec3(toView * corrected(*step.correction, shift, eye.pose.position));
  cell.nearDistance = float(plan.nearDistance);
  const Intrinsics& k = eye.intrinsics;
  // Vulkan's clip space: x right, y down, both −1 to 1 over the picture.
  cell.projection = {float(2.0 * k.fx / k.width), float(2.0 * k.cx / k.width - 1.0), float(-2.0 * k.fy / k.height),
                     float(2.0 * k.cy / k.height - 1.0)};
  cell.unitRays = plan.settings.morph == Morph::paper;
  cell.detail = shader::kFinerDetail / float(plan.settings.textureScale);
  cell.table = step.table;
  cell.opacity = step.opacity;
  cell.noise = noiseOffset(plan, view);
  return cell;
}

shader::CellExposure cellExposure(const FramePlan& plan, const Step& step) noexcept {
  shader::CellExposure cell{};
  for (std::size_t i = 0; i < step.mesh->gains.size(); ++i) {
    const glm::dvec3 gain =
        plan.settings.exposure == Exposure::off ? glm::dvec3(1.0) : plan.exposure * step.mesh->gains[i];
    cell.member[i] = {gain, glm::pow(gain, glm::dvec3(1 / 2.4))};
  }
  return cell;
}

}  // namespace ibr
