// SPDX-License-Identifier: Apache-2.0
#include "batch/build/pose_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "ibr/author/poses.h"

namespace ibr::app {

PoseErrors poseErrors(const PosedModel& model, const PosedModel& truth) {
  std::vector<Pose> are, should;
  std::vector<double> focals;
  PoseErrors errors;
  for (const PosedImage& image : model.images) {
    const auto exact = std::ranges::find(truth.images, image.name, &PosedImage::name);
    if (exact == truth.images.end() || image.camera.intrinsics.model != CameraModel::pinhole) continue;
    are.push_back(image.camera.pose);
    should.push_back(exact->camera.pose);
    focals.push_back(exact->camera.intrinsics.fx);
    const double widths = double(exact->camera.intrinsics.width) / image.camera.intrinsics.width;
    errors.focalFactor += image.camera.intrinsics.fx * widths / focals.back() - 1;
  }
  errors.photographs = are.size();
  if (are.empty()) return errors;
  const SimilarityTransform onto = estimateSimilarity(are, should);
  const double n = double(are.size());
  for (std::size_t i = 0; i < are.size(); ++i) {
    const Pose pose = onto(are[i]);
    const double rotationPx = angleBetween(pose.rotation, should[i].rotation) * focals[i];
    const double shift = glm::distance(pose.position, should[i].position);
    errors.rotationPx += rotationPx * rotationPx / n;
    errors.shift += shift * shift / n;
    errors.maxRotationPx = std::max(errors.maxRotationPx, rotationPx);
    errors.maxShift = std::max(errors.maxShift, shift);
  }
  errors.rotationPx = std::sqrt(errors.rotationPx);
  errors.shift = std::sqrt(errors.shift);
  errors.focalFactor = 1 + (errors.focalFactor - 1) / n;
  return errors;
}

nlohmann::ordered_json json(const PoseErrors& errors) {
  return {{"photographs", errors.photographs},     {"rotationPx", errors.rotationPx},
          {"maxRotationPx", errors.maxRotationPx}, {"shift", errors.shift},
          {"maxShift", errors.maxShift},           {"focalFactor", errors.focalFactor}};
}

std::string text(const PoseErrors& errors) {
  return fmt::format(
      "rotation error {:.3f} px RMS (at most {:.3f}), position error {:.6f} RMS (at most {:.6f}), focal lengths × "
      "{:.5f}",
      errors.rotationPx, errors.maxRotationPx, errors.shift, errors.maxShift, errors.focalFactor);
}

}  // namespace ibr::app
