// SPDX-License-Identifier: Apache-2.0
// Reads sfm_data.json of OpenMVG, which cereal writes: an object's type stands at its first occurrence only, and a
// shared object's data likewise. Camera axes: x right, y down, z forward; camera = R·(world − centre). Pixels are taken
// as they stand.
#include <map>
#include <unordered_map>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr std::int64_t kMaxId = std::int64_t(1) << 32;
constexpr std::int64_t kFirst = std::int64_t(1) << 31;  // flag of cereal: the first occurrence of a type or an object

// Resolves the types and objects of cereal's pointers.
class Pointers {
 public:
  struct Object {
    std::string type;  // "" for objects without a type
    JsonValue data;
  };

  Object operator()(const JsonValue& value) {
    std::string type;
    if (value.has("polymorphic_name")) {
      type = value["polymorphic_name"].string();
      types_[value["polymorphic_id"].integer(0, kMaxId) % kFirst] = type;
    } else if (value.has("polymorphic_id")) {
      const auto known = types_.find(value["polymorphic_id"].integer(0, kMaxId) % kFirst);
      if (known != types_.end()) type = known->second;
    }
    const JsonValue pointer = value["ptr_wrapper"];
    const std::int64_t id = pointer["id"].integer(0, kMaxId) % kFirst;
    if (!pointer.has("data")) {
      const auto known = objects_.find(id);
      if (known == objects_.end()) pointer.fault(fmt::format("refers to an object {} that is not in the file", id));
      return {type, known->second};
    }
    objects_.emplace(id, pointer["data"]);
    return {type, pointer["data"]};
  }

 private:
  std::map<std::int64_t, std::string> types_;
  std::map<std::int64_t, JsonValue> objects_;
};

// Member of an object or of its base classes, which cereal nests as "value0".
JsonValue field(const JsonValue& data, const char* key) {
  for (JsonValue at = data;; at = at["value0"]) {
    if (at.has(key)) return at[key];
    if (!at.has("value0")) break;
  }
  return data[key];  // throws
}

glm::dvec3 vectorOf(const JsonValue& json) {
  if (json.size() != 3) json.fault(fmt::format("has {} numbers, not 3", json.size()));
  return {json.at(0).number(), json.at(1).number(), json.at(2).number()};
}

Pose poseOf(const JsonValue& value) {
  const JsonValue rotation = value["rotation"];
  if (rotation.size() != 3) rotation.fault(fmt::format("has {} rows, not 3", rotation.size()));
  std::array<double, 9> rows{};
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 row = vectorOf(rotation.at(i));
    for (int j = 0; j < 3; ++j) rows[3 * i + std::size_t(j)] = row[j];
  }
  const glm::dmat3 matrix = matrixOfRows(rows);
  if (const auto fault = rotationFault(matrix)) rotation.fault(*fault);
  const glm::dquat toCamera = rotationOf(matrix);
  return poseFromWorldToCamera(toCamera, -(toCamera * vectorOf(value["center"])));
}

struct Intrinsic {
  std::string type;
  JsonValue data;
};

std::vector<double> terms(const JsonValue& data, const char* key, std::size_t count) {
  const JsonValue list = field(data, key);
  if (list.size() != count) list.fault(fmt::format("has {} numbers, not {}", list.size(), count));
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(list.at(i).number());
  return values;
}

void setIntrinsics(PosedImage& image, const Intrinsic& intrinsic, Border border) {
  const JsonValue& data = intrinsic.data;
  const int width = int(field(data, "width").integer(1, kMaxPoseImageSide));
  const int height = int(field(data, "height").integer(1, kMaxPoseImageSide));
  try {
    if (intrinsic.type == "spherical") return setPanorama(image, width, height);
    const double focal = field(data, "focal_length").number();
    const std::vector<double> centre = terms(data, "principal_point", 2);
    const PinholeTerms pinhole{focal, focal, centre[0], centre[1]};
    BrownTerms brown;
    if (intrinsic.type == "fisheye") {
      const std::vector<double> k = terms(data, "fisheye", 4);
      setLens(image, LensModel::opencvFisheye, width, height,
              {focal, focal, centre[0], centre[1], k[0], k[1], k[2], k[3]}, border);
      return;
    }
    if (intrinsic.type == "pinhole_radial_k1") {
      brown.k1 = terms(data, "disto_k1", 1)[0];
    } else if (intrinsic.type == "pinhole_radial_k3") {
      const std::vector<double> k = terms(data, "disto_k3", 3);
      brown = {k[0], k[1], k[2], 0, 0};
    } else if (intrinsic.type == "pinhole_brown_t2") {
      const std::vector<double> k = terms(data, "disto_t2", 5);
      brown = {k[0], k[1], k[2], k[3], k[4]};
    } else if (intrinsic.type != "pinhole") {
      fail(ErrorCode::unsupported,
           "type \"{}\" is none of pinhole, pinhole_radial_k1, pinhole_radial_k3, pinhole_brown_t2, fisheye, spherical",
           intrinsic.type);
    }
    setBrownLens(image, width, height, pinhole, brown, border);
  } catch (const Error& e) {
    throw PoseFault(e.code(), data.pointer(), e.what());
  }
}

}  // namespace

PosedModel readOpenMvg(PoseSource& source) {
  const JsonValue json(source.json);
  Pointers pointers;
  PosedModel model;
  struct View {
    std::int64_t key, pose, intrinsic;
    std::string name;
    JsonValue at;
  };
  std::vector<View> views;
  for (std::size_t i = 0; i < json["views"].size(); ++i) {
    const JsonValue entry = json["views"].at(i);
    const JsonValue data = pointers(entry["value"]).data;
    const std::string folder = data.has("local_path") ? data["local_path"].string() : std::string();
    const std::string name = field(data, "filename").string();
    if (name.empty()) data["filename"].fault("is empty");
    views.push_back({entry["key"].integer(0, kMaxId), field(data, "id_pose").integer(0, kMaxId),
                     field(data, "id_intrinsic").integer(0, kMaxId), folder.empty() ? name : folder + "/" + name,
                     data});
  }
  std::map<std::int64_t, Intrinsic> intrinsics;
  for (std::size_t i = 0; i < json["intrinsics"].size(); ++i) {
    const JsonValue entry = json["intrinsics"].at(i);
    auto [type, data] = pointers(entry["value"]);
    if (!intrinsics.emplace(entry["key"].integer(0, kMaxId), Intrinsic{std::move(type), data}).second)
      entry["key"].fault("appears twice");
  }
  std::map<std::int64_t, Pose> poses;
  for (std::size_t i = 0; i < json["extrinsics"].size(); ++i) {
    const JsonValue entry = json["extrinsics"].at(i);
    if (!poses.emplace(entry["key"].integer(0, kMaxId), poseOf(entry["value"])).second)
      entry["key"].fault("appears twice");
  }
  std::unordered_map<std::int64_t, std::uint32_t> imageOf;  // by the view's key
  for (const View& view : views) {
    const auto pose = poses.find(view.pose);
    const auto intrinsic = intrinsics.find(view.intrinsic);
    if (pose == poses.end()) continue;
    if (intrinsic == intrinsics.end()) view.at.fault(fmt::format("has no intrinsic {} in the file", view.intrinsic));
    PosedImage image;
    image.name = view.name;
    image.camera.pose = pose->second;
    setIntrinsics(image, intrinsic->second, source.border);
    imageOf.emplace(view.key, std::uint32_t(model.images.size()));
    model.images.push_back(std::move(image));
  }
  if (model.images.size() < views.size())
    source.warn(fmt::format("{} of {} views have no pose", views.size() - model.images.size(), views.size()));
  if (model.images.empty()) json["views"].fault("has no view with a pose");
  if (!json.has("structure")) return model;
  const JsonValue structure = json["structure"];
  for (std::size_t p = 0; p < structure.size(); ++p) {
    const JsonValue value = structure.at(p)["value"];
    Track track{vectorOf(value["X"]), {}};
    const JsonValue observations = value["observations"];
    for (std::size_t o = 0; o < observations.size(); ++o) {
      const auto image = imageOf.find(observations.at(o)["key"].integer(0, kMaxId));
      const JsonValue pixel = observations.at(o)["value"]["x"];
      if (pixel.size() != 2) pixel.fault(fmt::format("has {} numbers, not 2", pixel.size()));
      if (image != imageOf.end()) observe(track, model, image->second, {pixel.at(0).number(), pixel.at(1).number()});
    }
    model.tracks.push_back(std::move(track));
  }
  return model;
}

}  // namespace ibr
