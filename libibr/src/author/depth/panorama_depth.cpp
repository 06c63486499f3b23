// SPDX-License-Identifier: Apache-2.0
#include "author/depth/panorama_depth.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "author/backdrop/complete_depth.h"
#include "base/check.h"
#include "ibr/author/panorama.h"

namespace ibr {
namespace {

constexpr double kFaceFov = 96 * std::numbers::pi / 180;  // a little more than the 90° of a cube's face

// The face that sees a direction farthest from its edges.
struct FaceSample {
  std::size_t face;
  glm::dvec3 direction;  // in the face's axes
};

FaceSample faceSampleAt(const std::vector<glm::dquat>& toFaces, glm::dvec3 direction) {
  FaceSample best{};
  for (std::size_t f = 0; f < toFaces.size(); ++f)
    if (const glm::dvec3 seen = toFaces[f] * direction; seen.z < best.direction.z) best = {f, seen};
  return best;
}

// Pixel of a direction in front of the face.
glm::ivec2 pixelOf(const Intrinsics& k, glm::dvec3 direction) {
  const glm::dvec2 at(k.cx - k.fx * direction.x / direction.z, k.cy + k.fy * direction.y / direction.z);
  return glm::clamp(glm::ivec2(glm::floor(at)), glm::ivec2(0), glm::ivec2(k.width, k.height) - 1);
}

}  // namespace

int depthFaceSize(int panoramaWidth) {
  return faceSize(panoramaWidth, kFaceFov);
}

std::vector<Camera> depthFaces(const Camera& panorama) {
  const Intrinsics face = faceIntrinsics(depthFaceSize(panorama.intrinsics.width), kFaceFov);
  std::vector<Camera> cameras;
  for (const PanoramaFace& one : cubeFaces())
    cameras.push_back({face, {panorama.pose.position, panorama.pose.rotation * one.rotation}});
  return cameras;
}

MatchedDepth onSphere(const Camera& panorama, std::span<const MatchedDepth> faces) {
  std::vector<glm::dquat> toFaces;
  for (const PanoramaFace& face : cubeFaces()) toFaces.push_back(glm::conjugate(face.rotation));
  check(faces.size() == toFaces.size(), ErrorCode::invalidInput, "a panorama has {} faces, not {}", toFaces.size(),
        faces.size());
  const Intrinsics& k = panorama.intrinsics;
  const Image8 none(k.width, k.height, 1, 0);
  const bool hasSky = std::ranges::any_of(faces, [](const MatchedDepth& face) { return !face.sky.empty(); });
  MatchedDepth result{faces[0].matched, hasSky ? none : Image8(), {none, none, none}};
  result.matched.map = {panorama, ImageF(k.width, k.height, 1, kUnknownDepth)};
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const FaceSample seen = faceSampleAt(toFaces, unproject(k, {x + 0.5, y + 0.5}));
      const MatchedDepth& face = faces[seen.face];
      const glm::ivec2 at = pixelOf(face.matched.map.camera.intrinsics, seen.direction);
      const float inverse = face.matched.map.inverseDepth.pixel(at.x, at.y)[0];
      if (inverse >= 0) result.matched.map.inverseDepth.pixel(x, y)[0] = float(double(inverse) * -seen.direction.z);
      if (!face.sky.empty()) result.sky.pixel(x, y)[0] = face.sky.pixel(at.x, at.y)[0];
      const auto copy = [&](Image8 DepthEvidence::*counts) {
        (result.evidence.*counts).pixel(x, y)[0] = (face.evidence.*counts).pixel(at.x, at.y)[0];
      };
      copy(&DepthEvidence::confirmations);
      copy(&DepthEvidence::contradictions);
      copy(&DepthEvidence::usableSources);
    }
  return result;
}

}  // namespace ibr
