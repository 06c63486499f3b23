// SPDX-License-Identifier: Apache-2.0
#include "author/steps/input_record.h"

#include <array>
#include <bit>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "author/build/stored_photographs.h"
#include "author/geometry/posed_model.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

// Fields one by one: padding has no defined bytes.
void writeIntrinsics(CacheWriter& out, const Intrinsics& k) {
  out.value(k.model);
  for (const int side : {k.width, k.height}) out.value(side);
  for (const double v : {k.fx, k.fy, k.cx, k.cy}) out.value(v);
}
Intrinsics readIntrinsics(CacheReader& in) {
  Intrinsics k;
  k.model = in.value<CameraModel>();
  for (int* side : {&k.width, &k.height}) *side = in.value<int>();
  for (double* v : {&k.fx, &k.fy, &k.cx, &k.cy}) *v = in.value<double>();
  return k;
}

void writeCamera(CacheWriter& out, const Camera& camera) {
  writeIntrinsics(out, camera.intrinsics);
  out.value(camera.pose.position);
  const glm::dquat& q = camera.pose.rotation;
  for (const double v : {q.w, q.x, q.y, q.z}) out.value(v);
}
Camera readCamera(CacheReader& in) {
  Camera camera{readIntrinsics(in), {}};
  camera.pose.position = in.value<glm::dvec3>();
  glm::dquat& q = camera.pose.rotation;
  for (double* v : {&q.w, &q.x, &q.y, &q.z}) *v = in.value<double>();
  return camera;
}

using LensBytes = std::array<std::byte, sizeof(Lens)>;

void writeLens(CacheWriter& out, const std::optional<Lens>& lens) {
  out.value(lens.has_value());
  if (lens) out.value(std::bit_cast<LensBytes>(*lens));
}
std::optional<Lens> readLens(CacheReader& in) {
  if (!in.value<bool>()) return std::nullopt;
  return std::bit_cast<Lens>(in.value<LensBytes>());
}

void writePhotograph(CacheWriter& out, const Photograph& photo, const BuildOptions& options) {
  out.text(photo.name);
  for (const bool flag : {photo.applyOrientation, photo.orientationAmbiguous, photo.copied, photo.stripped})
    out.value(flag);
  out.value(photo.sourcePixels);
  out.value(photo.sourceBytes);
  writeLens(out, photo.lens);
  writeIntrinsics(out, photo.whole);
  writeCamera(out, photo.camera);
  out.text(photo.imageFile.string());
  out.text(photo.textureFile.string());
  out.text(photo.mask.empty() ? "" : photo.mask.lexically_relative(options.masks).string());
}
// Leaves out the capture metadata, which only the last step needs.
Photograph readPhotograph(CacheReader& in, const BuildOptions& options) {
  Photograph photo;
  photo.name = in.text();
  photo.source = options.photographs / photo.name;
  for (bool* flag : {&photo.applyOrientation, &photo.orientationAmbiguous, &photo.copied, &photo.stripped})
    *flag = in.value<bool>();
  photo.sourcePixels = in.value<double>();
  photo.sourceBytes = in.value<double>();
  photo.lens = readLens(in);
  photo.whole = readIntrinsics(in);
  photo.camera = readCamera(in);
  photo.imageFile = in.text();
  photo.textureFile = in.text();
  if (const std::string mask = in.text(); !mask.empty()) photo.mask = options.masks / mask;
  return photo;
}

}  // namespace

void writeInputRecord(CacheWriter& out, const BuildInput& input, const BuildOptions& options) {
  out.value(input.refine);
  out.value(std::uint64_t(input.photographs.size()));
  for (std::size_t i = 0; i < input.photographs.size(); ++i) {
    const PosedImage& image = input.model.images[i];
    out.text(image.name);
    writeCamera(out, image.camera);
    writeLens(out, image.lens);
    writePhotograph(out, input.photographs[i], options);
  }
  out.list(input.hashes);
}

BuildInput readInputRecord(CacheReader& in, const BuildOptions& options) {
  BuildInput input;
  input.refine = in.value<bool>();
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    PosedImage image{in.text(), readCamera(in)};
    image.lens = readLens(in);
    input.model.images.push_back(std::move(image));
    input.photographs.push_back(readPhotograph(in, options));
  }
  input.hashes = in.list<std::uint64_t>();
  for (std::size_t i = 0; i < input.hashes.size(); ++i)
    if (Photograph& photo = input.photographs[i]; !photo.mask.empty())
      photo.storedMask = cachedMask(options, input.hashes[i]);
  input.tracksOf = tracksOfImages(input.model);
  return input;
}

void writeTracks(CacheWriter& out, const std::vector<Track>& tracks) {
  out.value(std::uint64_t(tracks.size()));
  for (const Track& track : tracks) {
    out.value(track.position);
    out.value(std::uint32_t(track.observations.size()));
    for (const TrackObservation& seen : track.observations) {
      out.value(seen.image);
      out.value(seen.pixel);
    }
  }
}

std::vector<Track> readTracks(CacheReader& in) {
  std::vector<Track> tracks;
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t t = 0; t < count; ++t) {
    Track track{in.value<glm::dvec3>(), {}};
    const auto observations = in.value<std::uint32_t>();
    for (std::uint32_t o = 0; o < observations; ++o) {
      const auto image = in.value<std::uint32_t>();
      track.observations.push_back({image, in.value<glm::dvec2>()});
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

void writeMemberDepth(CacheWriter& out, const MemberDepth& depth) {
  writeCamera(out, depth.camera);
  out.value(depth.step);
  out.value(depth.inverseDepth.width);
  out.value(depth.inverseDepth.height);
  out.list(depth.inverseDepth.values);
}

MemberDepth readMemberDepth(CacheReader& in) {
  MemberDepth depth{readCamera(in), {}};
  depth.step = in.value<double>();
  const int width = in.value<int>(), height = in.value<int>();
  depth.inverseDepth = ImageF(width, height, 1);
  depth.inverseDepth.values = in.list<float>();
  return depth;
}

}  // namespace ibr
