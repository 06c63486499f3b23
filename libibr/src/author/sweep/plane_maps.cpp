// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/plane_maps.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace ibr {
namespace {

constexpr double kMaxScale = 8;

// Returns the growth of areas at a pixel under a homography; negative if mirrored.
double growth(const glm::dmat3& h, glm::dvec2 pixel) {
  const double w = h[0].z * pixel.x + h[1].z * pixel.y + h[2].z;
  return glm::determinant(h) / (w * w * w);
}

bool plausible(const PlaneMaps& plane, std::span<const PlaneTrack* const> tracks) {
  for (const glm::dmat3& h : plane.to)
    for (const PlaneTrack* track : tracks) {
      const glm::dvec3 q = h * glm::dvec3(track->at[0], 1.0);
      const double area = growth(h, track->at[0]);
      if (!(q.z > 0) || !(area > 1 / (kMaxScale * kMaxScale)) || !(area < kMaxScale * kMaxScale)) return false;
    }
  return true;
}

glm::dmat3 fromCv(const cv::Mat& m) {
  glm::dmat3 result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) result[column][row] = m.at<double>(row, column);
  return result;
}

}  // namespace

std::optional<std::array<glm::dvec2, kMaxMembers>> PlaneMaps::operator()(glm::dvec2 pixel) const {
  std::array<glm::dvec2, kMaxMembers> result{};
  for (std::size_t i = 0; i < to.size(); ++i) {
    const glm::dvec3 q = to[i] * glm::dvec3(pixel, 1.0);
    if (!(q.z > 0)) return std::nullopt;
    result[i] = glm::dvec2(q) / q.z;
  }
  return result;
}

double PlaneMaps::error(const PlaneTrack& track) const {
  double square = 0;
  for (std::size_t i = 1; i < to.size(); ++i) {
    const glm::dvec3 q = to[i] * glm::dvec3(track.at[0], 1.0);
    if (!(q.z > 0)) return std::numeric_limits<double>::infinity();
    const glm::dvec2 off = glm::dvec2(q) / q.z - track.at[i];
    square = std::max(square, glm::dot(off, off));
  }
  return std::sqrt(square);
}

PlaneFitter::PlaneFitter(std::span<const Camera> cameras, bool posed)
    : posed_(posed),
      centre_(0.5 * cameras[0].intrinsics.width, 0.5 * cameras[0].intrinsics.height),
      unit_(std::max(1, cameras[0].intrinsics.width)) {
  for (const Camera& camera : cameras) maps_.push_back(frameToMember(cameras[0], camera));
}

std::optional<PlaneMaps> PlaneFitter::operator()(std::span<const PlaneTrack* const> tracks) const {
  if (tracks.size() < minTracks()) return std::nullopt;
  std::optional<PlaneMaps> plane = posed_ ? withPoses(tracks) : withoutPoses(tracks);
  if (plane && !plausible(*plane, tracks)) return std::nullopt;
  return plane;
}

std::optional<PlaneMaps> PlaneFitter::withPoses(std::span<const PlaneTrack* const> tracks) const {
  glm::dmat3 normal(0.0);
  glm::dvec3 right(0.0);
  for (const PlaneTrack* track : tracks) {
    const glm::dvec3 row((track->at[0] - centre_) / unit_, 1.0);
    for (std::size_t i = 1; i < maps_.size(); ++i) {
      // As in depthFromPositions: a track's position is linear in its inverse depth.
      const glm::dvec3 infinite = maps_[i].homogeneous(track->at[0], 0);
      if (!(infinite.z > 0)) return std::nullopt;
      const glm::dvec2 slope = (glm::dvec2(maps_[i].b) - track->at[i] * maps_[i].b.z) / infinite.z;
      const glm::dvec2 side = track->at[i] - glm::dvec2(infinite) / infinite.z;
      normal += glm::dot(slope, slope) * glm::outerProduct(row, row);
      right += glm::dot(slope, side) * row;
    }
  }
  const double scale = normal[2][2];
  if (!(std::abs(glm::determinant(normal)) > 1e-15 * scale * scale * scale)) return std::nullopt;
  const glm::dvec3 local = glm::inverse(normal) * right;
  const glm::dvec3 n(local.x / unit_, local.y / unit_, local.z - glm::dot(glm::dvec2(local), centre_) / unit_);
  PlaneMaps plane{{glm::dmat3(1.0)}};
  for (std::size_t i = 1; i < maps_.size(); ++i) plane.to.push_back(maps_[i].a + glm::outerProduct(maps_[i].b, n));
  return plane;
}

std::optional<PlaneMaps> PlaneFitter::withoutPoses(std::span<const PlaneTrack* const> tracks) const {
  PlaneMaps plane{{glm::dmat3(1.0)}};
  for (std::size_t i = 1; i < maps_.size(); ++i) {
    std::vector<cv::Point2f> from, to;
    for (const PlaneTrack* track : tracks) {
      from.emplace_back(float(track->at[0].x), float(track->at[0].y));
      to.emplace_back(float(track->at[i].x), float(track->at[i].y));
    }
    const cv::Mat found =
        tracks.size() == 4 ? cv::getPerspectiveTransform(from.data(), to.data()) : cv::findHomography(from, to, 0);
    if (found.empty() || !cv::checkRange(found)) return std::nullopt;
    glm::dmat3 h = fromCv(found);
    // Choose the sign that puts the tracks in front of the member.
    const double side = h[0].z * tracks[0]->at[0].x + h[1].z * tracks[0]->at[0].y + h[2].z;
    if (!(std::abs(side) > 0)) return std::nullopt;
    plane.to.push_back(side < 0 ? -h : h);
  }
  return plane;
}

}  // namespace ibr
