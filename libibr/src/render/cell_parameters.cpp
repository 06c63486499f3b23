// SPDX-License-Identifier: Apache-2.0
#include "render/cell_parameters.h"

#include <glm/gtc/quaternion.hpp>

namespace ibr {

shader::CellParameters cellParameters(const FramePlan& plan, const PlannedCell& planned,
                                      std::span<const Camera> cameras, std::span<const std::uint32_t> layers,
                                      Tier tier) noexcept {
  std::array<double, 4> position = planned.position, blend = planned.blend;
  if (tier == kTierRejected) {
    position = {};
    position[planned.best] = 1.0;
    blend = position;
  }
  shader::CellParameters cell{};
  const glm::dquat toView = glm::conjugate(plan.view.pose.rotation);
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const Intrinsics& k = camera.intrinsics;
    shader::CellMember& member = cell.member[i];
    member.toView = glm::mat3(glm::mat3_cast(toView * camera.pose.rotation));
    member.focal = {float(k.fx / k.width), float(k.fy / k.height)};
    member.principal = {float(k.cx / k.width), float(k.cy / k.height)};
    member.position = float(position[i]);
    member.blend = float(blend[i]);
    member.layer = layers[i];
    shift += position[i] * (camera.pose.position - plan.view.pose.position);
  }
  cell.shift = glm::vec3(toView * shift);
  cell.nearDistance = float(plan.nearDistance);
  const Intrinsics& k = plan.view.intrinsics;
  // Vulkan's clip space: x right, y down, both −1 to 1 over the picture.
  cell.projection = {float(2.0 * k.fx / k.width), float(2.0 * k.cx / k.width - 1.0), float(-2.0 * k.fy / k.height),
                     float(2.0 * k.cy / k.height - 1.0)};
  cell.unitRays = plan.settings.morph == Morph::paper;
  cell.dither = plan.settings.blend == BlendMode::dither;
  cell.alpha = (255.0f - 64.0f * float(tier)) / 255.0f;
  return cell;
}

}  // namespace ibr
