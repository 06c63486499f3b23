// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include "author/pixels/cv_view.h"
#include "base/parallel.h"

namespace ibr {
namespace {

constexpr double kMinCosine = 0.1;  // between normal and direction to the camera; flatter faces have no usable pixels
constexpr double kMinVisibleShare = 0.25;
constexpr double kSamplePx = 4;
constexpr int kMaxSamples = 8;  // maximum along a side

// Counts of samples at the centres of n² equal parts of the face.
struct Shares {
  int samples = 0, visible = 0, hidden = 0;
};
Shares sharesOf(const std::array<glm::dvec3, 3>& corner, const ProjectedMesh& view, int n) {
  Shares shares;
  const auto sample = [&](double b, double c) {
    const glm::dvec3 point = corner[0] + (corner[1] - corner[0]) * b + (corner[2] - corner[0]) * c;
    ++shares.samples;
    const auto seen = view.view.seen(point);
    if (!seen || !view.view.inside(seen->pixel)) return;
    if (!view.raster.shows(seen->pixel, seen->depth))
      ++shares.hidden;
    else if (view.masked(seen->pixel))
      ++shares.visible;
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      sample((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
      if (i + j + 1 < n) sample((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
    }
  return shares;
}

void judge(const std::array<glm::dvec3, 3>& corner, const ProjectedMesh& view, CameraSet camera,
           FaceVisibility& result) {
  const glm::dvec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
  const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  const glm::dvec3 towards = view.view.centre() - middle;
  if (!(glm::dot(normal, towards) > kMinCosine * glm::length(normal) * glm::length(towards))) return;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = view.view.seen(corner[k]), b = view.view.seen(corner[(k + 1) % 3]);
    if (!a || !b) return;
    longest = std::max(longest, glm::distance(a->pixel, b->pixel));
  }
  const double pieces = std::clamp(longest / kSamplePx, 2.0, double(kMaxSamples));  // any length, also infinite
  const Shares shares = sharesOf(corner, view, int(std::ceil(pieces)));
  if (shares.visible < kMinVisibleShare * shares.samples) return;
  result.seen |= camera;
  if (shares.hidden > 0) result.partly |= camera;
}

}  // namespace

std::vector<FaceVisibility> faceVisibility(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                           int threads) {
  std::vector<FaceVisibility> faces(mesh.triangles.size());
  constexpr std::size_t kBlock = 512;
  runJobs((faces.size() + kBlock - 1) / kBlock, threadsFor(threads, 1e6),
          [&](std::size_t block) {
            for (std::size_t f = block * kBlock; f < std::min(faces.size(), (block + 1) * kBlock); ++f) {
              const glm::uvec3 t = mesh.triangles[f];
              const std::array corner{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
              for (std::size_t i = 0; i < views.size(); ++i) judge(corner, views[i], CameraSet(1) << i, faces[f]);
            }
          },
          [](std::size_t) { return true; });
  return faces;
}

std::vector<CameraSet> vertexVisibility(const TriangleMesh& mesh, std::span<const FaceVisibility> faces) {
  std::vector<CameraSet> members(mesh.positions.size(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) members[mesh.triangles[f][k]] |= faces[f].seen;
  return members;
}

namespace {

// Returns 255 at depth steps that no slanted surface explains, else 0.
Image8 depthEdges(const ImageF& depth) {
  constexpr float kStep = 0.01f;  // relative to the depth
  Image8 edges(depth.width, depth.height, 1);
  for (int y = 1; y + 1 < depth.height; ++y)
    for (int x = 1; x + 1 < depth.width; ++x) {
      const float here = depth.pixel(x, y)[0];
      if (!std::isfinite(here)) continue;
      for (int axis = 0; axis < 2; ++axis) {
        const int dx = 1 - axis, dy = axis;
        const float before = depth.pixel(x - dx, y - dy)[0], after = depth.pixel(x + dx, y + dy)[0];
        if (!std::isfinite(before) || !std::isfinite(after)) continue;  // a silhouette
        const float forward = after - here, backward = here - before;
        const bool stepsForward = std::abs(forward) > kStep * here && std::abs(forward) > 3 * std::abs(backward);
        const bool stepsBackward = std::abs(backward) > kStep * here && std::abs(backward) > 3 * std::abs(forward);
        if (stepsForward || stepsBackward) edges.pixel(x, y)[0] = 255;
      }
    }
  return edges;
}

// Distances to the nearest pixel of `zero` that is 0, px.
cv::Mat distancesTo(const Image8& zero) {
  cv::Mat distances;
  cv::distanceTransform(cvView(zero), distances, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distances;
}

}  // namespace

Image8 softVisibility(const ProjectedMesh& view, double softPx) {
  const ImageF& depth = view.raster.depth;
  Image8 object = *view.mask;
  if (object.empty()) {
    object = Image8(depth.width, depth.height, 1);
    for (std::size_t p = 0; p < object.values.size(); ++p) object.values[p] = std::isfinite(depth.values[p]) ? 255 : 0;
  }
  cv::threshold(cvView(object), cvView(object), 127, 255, cv::THRESH_BINARY);
  Image8 apart = depthEdges(depth);
  for (std::uint8_t& value : apart.values) value = std::uint8_t(255 - value);
  const cv::Mat toBackground = distancesTo(object), toEdge = distancesTo(apart);
  Image8 soft(depth.width, depth.height, 1);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const double nearest = std::min(toBackground.at<float>(y, x), toEdge.at<float>(y, x));
      const bool inside = object.pixel(x, y)[0] != 0;
      soft.pixel(x, y)[0] = std::uint8_t(std::lround(std::clamp(255 * nearest / softPx, inside ? 1.0 : 0.0, 255.0)));
    }
  return soft;
}

}  // namespace ibr
