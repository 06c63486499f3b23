// SPDX-License-Identifier: Apache-2.0
#include "render/cell_parameters.h"

#include <glm/gtc/quaternion.hpp>

namespace ibr {

shader::CellParameters cellParameters(const FramePlan& plan, std::size_t view, const Step& step) noexcept {
  const Camera& eye = plan.views[view];
  const glm::dquat toView = glm::conjugate(eye.pose.rotation);
  shader::CellParameters cell{};
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < step.mesh->cameras.size(); ++i) {
    const Camera& camera = step.mesh->cameras[i];
    const Intrinsics& k = camera.intrinsics;
    shader::CellMember& member = cell.member[i];
    member.toView = glm::mat3(glm::mat3_cast(toView * camera.pose.rotation));
    member.focal = {float(k.fx / k.width), float(k.fy / k.height)};
    member.principal = {float(k.cx / k.width), float(k.cy / k.height)};
    member.position = float(step.weights.position[i]);
    member.blend = float(step.weights.blend[i]);
    member.layer = step.mesh->layers[i];
    shift += step.weights.position[i] * (camera.pose.position - eye.pose.position);
  }
  cell.shift = glm::vec3(toView * shift);
  cell.nearDistance = float(plan.nearDistance);
  const Intrinsics& k = eye.intrinsics;
  // Vulkan's clip space: x right, y down, both −1 to 1 over the picture.
  cell.projection = {float(2.0 * k.fx / k.width), float(2.0 * k.cx / k.width - 1.0), float(-2.0 * k.fy / k.height),
                     float(2.0 * k.cy / k.height - 1.0)};
  cell.unitRays = plan.settings.morph == Morph::paper && step.tier != kTierBackdrop;
  cell.detail = float(1.0 / plan.settings.textureScale);
  cell.alpha = (255.0f - 64.0f * float(step.tier)) / 255.0f;
  cell.table = step.table;
  cell.opacity = step.opacity;
  return cell;
}

}  // namespace ibr
