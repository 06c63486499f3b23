// SPDX-License-Identifier: Apache-2.0
// Reads reconstruction.json of OpenSfM and ODM, and tracks.csv beside it. Camera axes: x right, y down, z forward;
// camera = R·world + t, R as an angle-axis vector. Lengths are in units of the longer side, from the image's centre.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <unordered_map>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

glm::dvec3 vectorOf(const JsonValue& json) {
  if (json.size() != 3) json.fault(fmt::format("has {} numbers, not 3", json.size()));
  return {json.at(0).number(), json.at(1).number(), json.at(2).number()};
}

double numberOr(const JsonValue& camera, const char* key, double otherwise) {
  return camera.has(key) ? camera[key].number() : otherwise;
}

void demandZero(const JsonValue& camera, std::initializer_list<const char*> keys, const std::string& type) {
  for (const char* key : keys)
    if (camera.has(key) && camera[key].number() != 0)
      throw PoseFault(ErrorCode::unsupported, camera[key].pointer(),
                      fmt::format("is not 0; no lens of libibr has this term of \"{}\"", type));
}

void setCamera(PosedImage& image, const JsonValue& camera, Border border) {
  const std::string type = camera["projection_type"].string();
  const int width = int(camera["width"].integer(1, kMaxPoseImageSide));
  const int height = int(camera["height"].integer(1, kMaxPoseImageSide));
  const double side = std::max(width, height);
  try {
    if (type == "spherical" || type == "equirectangular") return setPanorama(image, width, height);
    const auto n = [&](const char* key) { return numberOr(camera, key, 0); };
    const bool single = camera.has("focal");
    const PinholeTerms k{side * camera[single ? "focal" : "focal_x"].number(),
                         side * camera[single ? "focal" : "focal_y"].number(), 0.5 * width + side * n("c_x"),
                         0.5 * height + side * n("c_y")};
    const auto fisheye = [&] {
      setLens(image, LensModel::thinPrismFisheye, width, height,
              {k.fx, k.fy, k.cx, k.cy, n("k1"), n("k2"), n("p1"), n("p2"), n("k3"), n("k4"), n("s0"), n("s2")}, border);
    };
    bool isFisheye = type.starts_with("fisheye");
    if (type == "dual") {
      const double transition = camera["transition"].number();
      if (transition != 0 && transition != 1)
        throw PoseFault(ErrorCode::unsupported, camera["transition"].pointer(),
                        "is neither 0 (fisheye) nor 1 (perspective); no lens of libibr is between the two");
      isFisheye = transition == 0;
    }
    if (isFisheye) {
      if (type != "dual" && type != "fisheye" && type != "fisheye_opencv" && type != "fisheye62" &&
          type != "fisheye624")
        throw PoseFault(ErrorCode::unsupported, camera["projection_type"].pointer(),
                        fmt::format("\"{}\" is not a supported projection", type));
      demandZero(camera, {"k5", "k6", "s1", "s3"}, type);
      return fisheye();
    }
    if (type != "dual" && type != "perspective" && type != "simple_radial" && type != "radial" && type != "brown")
      throw PoseFault(ErrorCode::unsupported, camera["projection_type"].pointer(),
                      fmt::format("\"{}\" is none of perspective, simple_radial, radial, brown, fisheye, "
                                  "fisheye_opencv, fisheye62, fisheye624, dual, spherical, equirectangular",
                                  type));
    demandZero(camera, {"k4", "k5", "k6"}, type);
    setBrownLens(image, width, height, k, {n("k1"), n("k2"), n("k3"), n("p1"), n("p2")}, border);
  } catch (const Error& e) {
    throw PoseFault(e.code(), camera.pointer(), e.what());
  }
}

Pose poseOf(const JsonValue& shot) {
  const glm::dvec3 axis = vectorOf(shot["rotation"]);
  const double angle = glm::length(axis);
  const glm::dquat toCamera = angle > 0 ? glm::angleAxis(angle, axis / angle) : glm::dquat(1, 0, 0, 0);
  return poseFromWorldToCamera(toCamera, vectorOf(shot["translation"]));
}

// Adds the observations of tracks.csv: image, track, feature, x, y, … between tabs.
void addObservations(const fs::path& file, const std::unordered_map<std::string, std::uint32_t>& imageOf,
                     const std::unordered_map<std::string, std::size_t>& trackOf, PosedModel& model) {
  const std::string text = readTextFile(file, std::uint64_t(8) << 30);
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line(text.data() + at, end - at);
    at = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || (number == 1 && line.starts_with("OPENSFM_TRACKS_VERSION"))) continue;
    std::array<std::string_view, 5> cells;
    std::size_t from = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::size_t tab = std::min(line.find('\t', from), line.size());
      check(from <= line.size(), ErrorCode::invalidInput, "{}:{}: has fewer than 5 columns", file.string(), number);
      cells[c] = line.substr(from, tab - from);
      from = tab + 1;
    }
    const auto x = parseDouble(cells[3]), y = parseDouble(cells[4]);
    check(x && y, ErrorCode::invalidInput, "{}:{}: x \"{}\" or y \"{}\" is not a finite number", file.string(), number,
          cells[3].substr(0, 40), cells[4].substr(0, 40));
    const auto image = imageOf.find(std::string(cells[0]));
    const auto track = trackOf.find(std::string(cells[1]));
    if (image == imageOf.end() || track == trackOf.end()) continue;
    const ImageSize size = sizeAsStored(model.images[image->second]);
    const double side = std::max(size.width, size.height);
    observe(model.tracks[track->second], model, image->second,
            {0.5 * size.width + side * *x, 0.5 * size.height + side * *y});
  }
}

}  // namespace

PosedModel readOpenSfm(PoseSource& source) {
  const JsonValue json(source.json);
  std::size_t largest = 0;
  const auto shotsOf = [&](std::size_t i) {
    const JsonValue shots = json.at(i)["shots"];
    if (!shots.raw().is_object()) shots.fault("is not an object");
    return shots;
  };
  for (std::size_t i = 1; i < json.size(); ++i)
    if (shotsOf(i).raw().size() > shotsOf(largest).raw().size()) largest = i;
  const JsonValue reconstruction = json.at(largest), shots = shotsOf(largest);
  if (shots.raw().empty()) shots.fault("has no shot");
  if (json.size() > 1)
    source.warn(
        fmt::format("has {} reconstructions; the largest, of {} shots, is read", json.size(), shots.raw().size()));
  PosedModel model;
  std::unordered_map<std::string, std::uint32_t> imageOf;
  for (const auto& [name, ignored] : shots.raw().items()) {
    const JsonValue shot = shots[name.c_str()];
    PosedImage image;
    image.name = name;
    image.camera.pose = poseOf(shot);
    const std::string camera = shot["camera"].string();
    if (!reconstruction["cameras"].has(camera.c_str())) shot["camera"].fault("is no camera of the reconstruction");
    setCamera(image, reconstruction["cameras"][camera.c_str()], source.border);
    imageOf.emplace(name, std::uint32_t(model.images.size()));
    model.images.push_back(std::move(image));
  }
  const fs::path tracks = source.path.parent_path() / "tracks.csv";
  if (!fs::exists(tracks)) {
    source.warn("there is no tracks.csv beside it: points have no observations, and are not read");
    return model;
  }
  if (!reconstruction.has("points")) return model;
  const JsonValue points = reconstruction["points"];
  if (!points.raw().is_object()) points.fault("is not an object");
  std::unordered_map<std::string, std::size_t> trackOf;
  for (const auto& [id, ignored] : points.raw().items()) {
    trackOf.emplace(id, model.tracks.size());
    model.tracks.push_back({vectorOf(points[id.c_str()]["coordinates"]), {}});
  }
  addObservations(tracks, imageOf, trackOf, model);
  return model;
}

}  // namespace ibr
