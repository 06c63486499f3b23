// SPDX-License-Identifier: Apache-2.0
// Reads equirectangular panoramas with their poses from a JSON file. The file's axes are COLMAP's. A direction d in
// these axes is seen at x = (atan2(d.x, d.z) / 2π + ½)·width, y = (asin(d.y) / π + ½)·height. This is the mapping of
// conventions.h after half a turn about x.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <set>
#include <string>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr double kRounding = 1e-3;  // tolerance for rotations, and for redundant values in a file

glm::dvec3 vector(const JsonValue& json) {
  if (json.size() != 3) json.fault(fmt::format("has {} numbers, not 3", json.size()));
  return {json.at(0).number(), json.at(1).number(), json.at(2).number()};
}

glm::dquat rotationFromMatrix(const JsonValue& json) {
  if (json.size() != 3) json.fault(fmt::format("has {} rows, not 3", json.size()));
  glm::dmat3 transposed;  // GLM's columns are the file's rows
  for (int row = 0; row < 3; ++row) transposed[row] = vector(json.at(std::size_t(row)));
  const glm::dmat3 product = glm::transpose(transposed) * transposed;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(product[i][j] - (i == j)) <= kRounding))
        json.fault("is not a rotation: its rows are not orthonormal");
  if (!(glm::determinant(transposed) > 0)) json.fault("is a reflection, not a rotation: its determinant is -1");
  return glm::normalize(glm::quat_cast(glm::transpose(transposed)));
}

glm::dquat rotationFromQuaternion(const JsonValue& json) {
  if (json.size() != 4) json.fault(fmt::format("has {} numbers, not 4", json.size()));
  const glm::dquat q(json.at(0).number(), json.at(1).number(), json.at(2).number(), json.at(3).number());
  const double length = glm::length(q);
  if (!(std::abs(length - 1.0) <= kRounding)) json.fault(fmt::format("has length {}, not 1", length));
  return glm::normalize(q);
}

Pose poseOf(const JsonValue& entry) {
  constexpr const char *kMatrix = "R_world_to_camera", *kQuaternion = "q_world_to_camera_wxyz";
  constexpr const char *kPosition = "position", *kTranslation = "t_world_to_camera";
  if (!entry.has(kMatrix) && !entry.has(kQuaternion))
    entry.fault(fmt::format("has neither \"{}\" nor \"{}\"", kMatrix, kQuaternion));
  if (!entry.has(kPosition) && !entry.has(kTranslation))
    entry.fault(fmt::format("has neither \"{}\" nor \"{}\"", kPosition, kTranslation));
  const glm::dquat toCamera =
      entry.has(kMatrix) ? rotationFromMatrix(entry[kMatrix]) : rotationFromQuaternion(entry[kQuaternion]);
  if (entry.has(kMatrix) && entry.has(kQuaternion) &&
      !(std::abs(glm::dot(toCamera, rotationFromQuaternion(entry[kQuaternion]))) >= 1.0 - kRounding * kRounding))
    entry[kQuaternion].fault(fmt::format("does not match \"{}\"", kMatrix));
  if (!entry.has(kPosition)) return poseFromWorldToCamera(toCamera, vector(entry[kTranslation]));
  const glm::dvec3 position = vector(entry[kPosition]), translation = -(toCamera * position);
  if (entry.has(kTranslation) &&
      !(glm::distance(translation, vector(entry[kTranslation])) <= kRounding * std::max(1.0, glm::length(position))))
    entry[kTranslation].fault(fmt::format("does not match \"{}\"", kPosition));
  Pose pose = poseFromWorldToCamera(toCamera, translation);
  pose.position = position;  // exactly the file's value
  return pose;
}

}  // namespace

PosedModel readPanoramas(PoseSource& source) {
  const JsonValue json(source.json);
  Intrinsics intrinsics;
  intrinsics.model = CameraModel::equirectangular;
  intrinsics.width = int(json["width"].integer(1, kMaxPoseImageSide));
  intrinsics.height = int(json["height"].integer(1, kMaxPoseImageSide));
  const JsonValue list = json["panoramas"];
  if (list.size() == 0) list.fault("has no panorama");
  PosedModel model;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonValue entry = list.at(i);
    const std::string name = entry["name"].string();
    if (name.empty()) entry["name"].fault("is empty");
    if (!names.insert(name).second) entry["name"].fault(fmt::format("\"{}\" appears twice", name));
    model.images.push_back({name, {intrinsics, poseOf(entry)}});
  }
  if (json.has("triangles")) {
    const JsonValue triangles = json["triangles"];
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (triangles.at(t).size() != 3)
        triangles.at(t).fault(fmt::format("has {} corners, not 3", triangles.at(t).size()));
      for (std::size_t k = 0; k < 3; ++k) triangles.at(t).at(k).index(list.size());
    }
  }
  return model;
}

}  // namespace ibr
