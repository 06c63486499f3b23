// SPDX-License-Identifier: Apache-2.0
// Reads transforms.json of nerfstudio and instant-ngp. libibr's axes: x right, y up, looks along −z; camera to world.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <set>
#include <string>

#include "author/poses/pose_source.h"
#include "base/check.h"
#include "io/image_file.h"

namespace ibr {
namespace {

constexpr double kRounding = 1e-3;  // tolerance for rotations

Pose poseOf(const JsonValue& matrix) {
  if (matrix.size() != 4 && matrix.size() != 3) matrix.fault(fmt::format("has {} rows, not 4", matrix.size()));
  double rows[4][4] = {{}, {}, {}, {0, 0, 0, 1}};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    const JsonValue row = matrix.at(i);
    if (row.size() != 4) row.fault(fmt::format("has {} numbers, not 4", row.size()));
    for (std::size_t j = 0; j < 4; ++j) rows[i][j] = row.at(j).number();
  }
  for (int j = 0; j < 4; ++j)
    if (!(std::abs(rows[3][j] - (j == 3)) <= kRounding)) matrix.at(3).fault("is not 0 0 0 1: not a rigid transform");
  glm::dmat3 turn;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn[j][i] = rows[i][j];
  for (int j = 0; j < 3; ++j)
    if (!(std::abs(glm::length(turn[j]) - 1.0) <= kRounding))
      matrix.fault(fmt::format("is not a rigid transform: column {} has length {}, not 1 (scaled axes)", j,
                               glm::length(turn[j])));
  for (int j = 0; j < 3; ++j)
    if (!(std::abs(glm::dot(turn[j], turn[(j + 1) % 3])) <= kRounding))
      matrix.fault(fmt::format("is not a rigid transform: columns {} and {} are not perpendicular (sheared axes)", j,
                               (j + 1) % 3));
  if (!(glm::determinant(turn) > 0)) matrix.fault("is a reflection, not a rigid transform: its determinant is -1");
  return {{rows[0][3], rows[1][3], rows[2][3]}, glm::normalize(glm::quat_cast(turn))};
}

// Looks a field up in a frame, then in the file, which holds for all frames.
class Fields {
 public:
  Fields(const JsonValue& file, const JsonValue& frame) : file_(file), frame_(frame) {}

  std::optional<JsonValue> find(const char* key) const {
    if (frame_.has(key)) return frame_[key];
    if (file_.has(key)) return file_[key];
    return std::nullopt;
  }
  double number(const char* key, double otherwise) const {
    const auto value = find(key);
    return value ? value->number() : otherwise;
  }
  const JsonValue& frame() const { return frame_; }

 private:
  JsonValue file_, frame_;
};

// Accepts whole numbers written as 800.0.
std::optional<int> sizeOf(const Fields& fields, const char* key) {
  const auto value = fields.find(key);
  if (!value) return std::nullopt;
  const double size = value->number();
  if (!(size >= 1 && size <= kMaxPoseImageSide && size == std::floor(size)))
    value->fault(fmt::format("{} is not a whole number from 1 to {}", size, kMaxPoseImageSide));
  return int(size);
}

double focalOf(const Fields& fields, const char* focal, const char* angle, int size, double otherwise) {
  if (const auto value = fields.find(focal)) {
    if (!(value->number() > 0)) value->fault(fmt::format("{} is not positive", value->number()));
    return value->number();
  }
  const auto value = fields.find(angle);
  if (!value) return otherwise;
  const double radians = value->number();
  if (!(radians > 0 && radians < 3.14))
    value->fault(fmt::format("{} is not an angle between 0 and π radians", radians));
  return 0.5 * size / std::tan(0.5 * radians);
}

void demandZero(const Fields& fields, std::initializer_list<const char*> keys, const std::string& model) {
  for (const char* key : keys)
    if (const auto value = fields.find(key); value && value->number() != 0)
      value->fault(fmt::format("is not 0, but this term is not supported for camera model {}", model));
}

void setCamera(PosedImage& image, const Fields& fields, int width, int height, Border border) {
  const auto named = fields.find("camera_model");
  const auto fisheye = fields.find("is_fisheye");
  const std::string model = named                                                              ? named->string()
                            : fisheye && fisheye->raw().is_boolean() && fisheye->raw() == true ? "OPENCV_FISHEYE"
                                                                                               : "OPENCV";
  Intrinsics& k = image.camera.intrinsics;
  if (model == "EQUIRECTANGULAR") {
    k = {CameraModel::equirectangular, width, height, 0, 0, 0, 0};
    return;
  }
  const double fx = focalOf(fields, "fl_x", "camera_angle_x", width, 0);
  const double fy = focalOf(fields, "fl_y", "camera_angle_y", height, fx);
  if (fx == 0 && fy == 0)
    fields.frame().fault("has no focal length: set fl_x or camera_angle_x in the frame or in the file");
  const std::array c{fields.number("cx", 0.5 * width), fields.number("cy", 0.5 * height)};
  k = {CameraModel::pinhole, width, height, fx > 0 ? fx : fy, fy, c[0], c[1]};
  const auto n = [&](const char* key) { return fields.number(key, 0); };
  LensModel lensModel = LensModel::pinhole;
  std::vector<double> parameters{k.fx, k.fy, k.cx, k.cy};
  if (model == "OPENCV_FISHEYE") {
    demandZero(fields, {"p1", "p2"}, model);
    lensModel = LensModel::opencvFisheye;
    parameters.insert(parameters.end(), {n("k1"), n("k2"), n("k3"), n("k4")});
  } else if (model == "PINHOLE" || model == "SIMPLE_PINHOLE") {
    demandZero(fields, {"k1", "k2", "k3", "k4", "p1", "p2"}, model);
  } else if (model == "OPENCV" || model == "FULL_OPENCV" || model == "SIMPLE_RADIAL" || model == "RADIAL") {
    demandZero(fields, {"k4", "k5", "k6"}, model);
    lensModel = LensModel::fullOpencv;
    parameters.insert(parameters.end(), {n("k1"), n("k2"), n("p1"), n("p2"), n("k3"), 0.0, 0.0, 0.0});
  } else {
    named->fault(
        fmt::format("\"{}\" is none of PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, "
                    "OPENCV_FISHEYE, EQUIRECTANGULAR",
                    model));
  }
  try {
    setLens(image, lensModel, width, height, parameters, border);
  } catch (const Error& e) {
    fields.frame().fault(e.what());
  }
}

}  // namespace

PosedModel readTransforms(PoseSource& source) {
  const JsonValue json(source.json);
  const JsonValue frames = json["frames"];
  if (frames.size() == 0) frames.fault("has no frame");
  PosedModel model;
  std::set<std::string> names;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JsonValue frame = frames.at(i);
    const Fields fields(json, frame);
    const JsonValue path = frame["file_path"];
    if (path.string().empty()) path.fault("is empty");
    PosedImage image;
    image.name = path.string();
    if (!names.insert(plainName(image.name)).second) path.fault(fmt::format("\"{}\" appears twice", image.name));
    auto width = sizeOf(fields, "w"), height = sizeOf(fields, "h");
    if ((!width || !height) && !source.photographs.folder().empty()) {
      const auto name = source.photographs.find(image.name);
      if (!name)
        path.fault(
            fmt::format("\"{}\": no such photograph in {}", path.string(), source.photographs.folder().string()));
      const ImageFileInfo info = probeImage(source.photographs.folder() / *name);
      width = width.value_or(info.width);
      height = height.value_or(info.height);
    }
    if (!width || !height) frame.fault("has no size: set w and h in the frame or in the file");
    image.camera.pose = poseOf(frame["transform_matrix"]);
    setCamera(image, fields, *width, *height, source.border);
    model.images.push_back(std::move(image));
  }
  return model;
}

}  // namespace ibr
