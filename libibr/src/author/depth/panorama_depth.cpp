// SPDX-License-Identifier: Apache-2.0
#include "author/depth/panorama_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "author/backdrop/complete_depth.h"
#include "base/check.h"
#include "ibr/panorama.h"

namespace ibr {
namespace {

constexpr double kFaceFov = 96 * std::numbers::pi / 180;  // a little more than a quarter of the view

// Where a direction is seen.
struct Place {
  std::size_t face;
  int x, y;
  double along;  // share of a distance along the ray that is along the face's axis
};

Place placeOf(const std::vector<glm::dquat>& toFaces, const Intrinsics& k, glm::dvec3 direction) {
  Place place{};
  glm::dvec3 best(0);
  for (std::size_t f = 0; f < toFaces.size(); ++f)
    if (const glm::dvec3 seen = toFaces[f] * direction; - seen.z > place.along) {
      place.face = f;
      place.along = -seen.z;
      best = seen;
    }
  place.x = std::clamp(int(std::floor(k.cx + k.fx * best.x / place.along)), 0, k.width - 1);
  place.y = std::clamp(int(std::floor(k.cy - k.fy * best.y / place.along)), 0, k.height - 1);
  return place;
}

}  // namespace

std::vector<Camera> depthFaces(const Camera& panorama) {
  const Intrinsics face = faceIntrinsics(faceSize(panorama.intrinsics.width, kFaceFov), kFaceFov);
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
  MatchedDepth result{faces[0].matched, {}, {none, none, none}};
  result.matched.map = {panorama, ImageF(k.width, k.height, 1, kUnknownDepth)};
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const Place at = placeOf(toFaces, faces[0].matched.map.camera.intrinsics, unproject(k, {x + 0.5, y + 0.5}));
      const MatchedDepth& face = faces[at.face];
      const float inverse = face.matched.map.inverseDepth.pixel(at.x, at.y)[0];
      if (inverse >= 0) result.matched.map.inverseDepth.pixel(x, y)[0] = float(double(inverse) * at.along);
      const auto copy = [&](Image8 DepthEvidence::*counts) {
        (result.evidence.*counts).pixel(x, y)[0] = (face.evidence.*counts).pixel(at.x, at.y)[0];
      };
      copy(&DepthEvidence::confirmations);
      copy(&DepthEvidence::contradictions);
      copy(&DepthEvidence::witnesses);
    }
  return result;
}

}  // namespace ibr
