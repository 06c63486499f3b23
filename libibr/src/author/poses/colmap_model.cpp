// SPDX-License-Identifier: Apache-2.0
// Converts a COLMAP model to libibr's conventions. COLMAP: world to camera, x right, y down, looks along +z; pixel
// centres at .5.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "author/geometry/world_to_camera.h"
#include "author/poses/colmap_records.h"
#include "base/check.h"
#include "ibr/author/poses.h"

namespace ibr {
namespace fs = std::filesystem;

std::string colmap::RecordLocation::describe() const {
  return text ? fmt::format("{}:{}", file->string(), at) : fmt::format("{}: byte {}", file->string(), at);
}

namespace {

using colmap::CameraRecord;
using colmap::ImageRecord;
using colmap::Records;

void readRecords(const fs::path& folder, const LogCallback& log, Records& records) {
  if (log)
    for (const char* name : {"rigs.bin", "frames.bin", "rigs.txt", "frames.txt"})
      if (fs::exists(folder / name))
        log(LogLevel::info, fmt::format("{}: ignored; poses are read from the images file", (folder / name).string()));
  for (const bool binary : {true, false}) {
    const std::string extension = binary ? ".bin" : ".txt";
    records.camerasFile = folder / ("cameras" + extension);
    records.imagesFile = folder / ("images" + extension);
    if (!fs::exists(records.camerasFile) || !fs::exists(records.imagesFile)) continue;
    if (fs::exists(folder / ("points3D" + extension)))
      records.pointsFile = folder / ("points3D" + extension);
    else if (log)
      log(LogLevel::warning, fmt::format("{}: has no points3D{}", folder.string(), extension));
    return binary ? readBinary(records) : readText(records);
  }
  fail(ErrorCode::io, "{}: holds neither cameras.bin and images.bin nor cameras.txt and images.txt", folder.string());
}

struct ModelCamera {
  Intrinsics intrinsics;  // undistorted
  std::optional<Lens> lens;
};

ModelCamera toCamera(const CameraRecord& camera, Border border) {
  const std::string at = camera.location.describe();
  constexpr std::uint64_t kMaxSizePx = 1 << 16;
  check(camera.width >= 1 && camera.height >= 1 && camera.width <= kMaxSizePx && camera.height <= kMaxSizePx,
        ErrorCode::invalidInput, "{}: size {}x{} of camera {} is not within 1 to {}", at, camera.width, camera.height,
        camera.id, kMaxSizePx);
  const std::vector<double>& p = camera.parameters;
  const int width = int(camera.width), height = int(camera.height);
  if (camera.kind == colmap::kEquirectangular) {
    check(p.empty() || (p[0] == double(camera.width) && p[1] == double(camera.height)), ErrorCode::unsupported,
          "{}: camera {} is a panorama of {}x{} px in an image of {}x{} px; partial panoramas are not supported", at,
          camera.id, p.empty() ? 0 : p[0], p.empty() ? 0 : p[1], camera.width, camera.height);
    return {{CameraModel::equirectangular, width, height, 0, 0, 0, 0}, std::nullopt};
  }
  try {
    const Lens lens(LensModel(camera.kind), width, height, p);
    if (lens.distorts()) return {undistorted(lens, border), lens};
    const glm::dvec2 f = lens.focal(), c = lens.centre();
    return {{CameraModel::pinhole, width, height, f.x, f.y, c.x, c.y}, std::nullopt};
  } catch (const Error& e) {
    fail(e.code(), "{}: camera {}: {}", at, camera.id, e.what());
  }
}

Pose toPose(const ImageRecord& image) {
  const auto& q = image.quaternion;
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  check(std::abs(length - 1.0) <= 1e-3, ErrorCode::invalidInput,
        "{}: quaternion ({}, {}, {}, {}) of image {} has length {}, not 1", image.location.describe(), q[0], q[1], q[2],
        q[3], image.id, length);
  const glm::dquat toCamera(q[0] / length, q[1] / length, q[2] / length, q[3] / length);
  return poseFromWorldToCamera(toCamera, {image.translation[0], image.translation[1], image.translation[2]});
}

}  // namespace

PosedModel readColmapModel(const fs::path& folder, const LogCallback& log, Border border) {
  Records records;
  readRecords(folder, log, records);

  std::map<std::uint64_t, ModelCamera> cameras;
  for (const CameraRecord& camera : records.cameras)
    check(cameras.emplace(camera.id, toCamera(camera, border)).second, ErrorCode::invalidInput,
          "{}: CAMERA_ID {} appears twice", camera.location.describe(), camera.id);

  std::set<std::uint64_t> imageIds;
  for (const ImageRecord& image : records.images)
    check(imageIds.insert(image.id).second, ErrorCode::invalidInput, "{}: IMAGE_ID {} appears twice",
          image.location.describe(), image.id);
  std::erase_if(records.images, [&](const ImageRecord& image) {
    if (image.camera != colmap::kNoCamera) return false;
    if (log) log(LogLevel::warning, fmt::format("{}: {} is not registered", image.location.describe(), image.name));
    return true;
  });
  std::sort(records.images.begin(), records.images.end(),
            [](const ImageRecord& a, const ImageRecord& b) { return a.name < b.name; });

  PosedModel model;
  for (const ImageRecord& image : records.images) {
    const std::string at = image.location.describe();
    check(!image.name.empty(), ErrorCode::invalidInput, "{}: image {} has no NAME", at, image.id);
    check(model.images.empty() || model.images.back().name != image.name, ErrorCode::invalidInput,
          "{}: NAME \"{}\" appears twice", at, image.name);
    const auto camera = cameras.find(image.camera);
    check(camera != cameras.end(), ErrorCode::invalidInput, "{}: CAMERA_ID {} of image {} is not in {}", at,
          image.camera, image.id, records.camerasFile.filename().string());
    model.images.push_back({image.name, {camera->second.intrinsics, toPose(image)}, camera->second.lens});
  }

  std::sort(records.points.begin(), records.points.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  std::unordered_map<std::uint64_t, std::size_t> trackOf;
  trackOf.reserve(records.points.size());
  for (const colmap::PointRecord& point : records.points) {
    check(trackOf.emplace(point.id, model.tracks.size()).second, ErrorCode::invalidInput,
          "{}: POINT3D_ID {} appears twice", point.location.describe(), point.id);
    model.tracks.push_back({{point.position[0], point.position[1], point.position[2]}, {}});
  }
  std::size_t lost = 0;
  for (std::size_t i = 0; i < records.images.size(); ++i)
    for (const colmap::ObservationRecord& observation : records.images[i].observations) {
      if (observation.point == colmap::kNoPoint) continue;
      const auto found = trackOf.find(observation.point);
      if (found == trackOf.end()) {
        ++lost;
        continue;
      }
      auto& track = model.tracks[found->second].observations;
      if (!track.empty() && track.back().image == i) continue;  // COLMAP may join two features of one image
      const PosedImage& image = model.images[i];
      std::optional<glm::dvec2> pixel = glm::dvec2(observation.x, observation.y);
      if (image.lens) pixel = undistort(*pixel, *image.lens, image.camera.intrinsics);
      if (pixel) track.push_back({std::uint32_t(i), *pixel});
    }
  if (lost > 0 && log)
    log(LogLevel::warning,
        fmt::format("{}: {} observations of missing points are ignored", records.imagesFile.string(), lost));
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
  return model;
}

}  // namespace ibr
