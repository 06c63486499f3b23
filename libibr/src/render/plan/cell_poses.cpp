// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_poses.h"

#include <algorithm>
#include <tuple>

namespace ibr {

CellPoses cellPoses(const Scene& scene, const Cell& cell) {
  CellPoses poses;
  for (const std::uint32_t member : cell.members) {
    const Camera& camera = scene.nodes[member].camera;
    const bool isPanorama = camera.intrinsics.model == CameraModel::equirectangular;
    poses.panoramas |= std::uint8_t(unsigned(isPanorama) << poses.count);
    poses.pose[poses.count++] = camera.pose;
  }
  const auto position = [&](std::uint8_t member) {
    const glm::dvec3& at = poses.pose[member].position;
    return std::tuple(at.x, at.y, at.z);
  };
  std::ranges::stable_sort(std::span(poses.byPosition).first(poses.count), {}, position);
  return poses;
}

}  // namespace ibr
