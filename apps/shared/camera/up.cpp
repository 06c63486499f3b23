// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/up.h"

#include <glm/geometric.hpp>

#include "base/check.h"

namespace ibr::app {

std::optional<glm::dvec3> upOf(const std::vector<Pose>& cameras) {
  glm::dvec3 sum(0);
  for (const Pose& camera : cameras) sum += camera.rotation * glm::dvec3(0, 1, 0);
  const double length = glm::length(sum);
  if (!(length > 0.1 * double(cameras.size()))) return std::nullopt;
  return sum / length;
}

std::vector<Pose> posesOf(const Scene& scene) {
  std::vector<Pose> poses;
  for (const Node& node : scene.nodes) poses.push_back(node.camera.pose);
  return poses;
}

std::vector<Pose> posesOf(const HtmModel& model) {
  std::vector<Pose> poses;
  for (const HtmCamera& camera : model.cameras) poses.push_back(camera.camera.pose);
  return poses;
}

glm::dvec3 centreOf(const std::vector<Pose>& cameras) {
  glm::dvec3 middle(0);
  for (const Pose& pose : cameras) middle += pose.position / double(cameras.size());
  return middle;
}

Floor floorBelow(glm::dvec3 middle, glm::dvec3 up, const FloorOptions& options) {
  const double spacing = options.spacing.value_or(0.5 * options.eyeHeight);
  check(spacing > 0, ErrorCode::invalidInput, "--floor {}: a floor above the photographs requires --floor-spacing",
        options.eyeHeight);
  return {up, glm::dot(up, middle) - options.eyeHeight, spacing, 16 * spacing};
}

Floor floorBelow(const Scene& scene, const FloorOptions& options) {
  const std::vector<Pose> poses = posesOf(scene);
  const auto up = upOf(poses);
  check(up.has_value(), ErrorCode::invalidInput, "--floor: the photographs have no common up direction");
  return floorBelow(centreOf(poses), *up, options);
}

}  // namespace ibr::app
