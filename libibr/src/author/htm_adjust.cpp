// SPDX-License-Identifier: Apache-2.0
#include "author/htm_adjust.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <opencv2/calib3d.hpp>

#include "author/world_to_camera.h"

namespace ibr {
namespace {

struct Points {
  std::vector<cv::Point3f> world;  // relative to `origin`: floats hold no large coordinates
  std::vector<cv::Point2f> pixel;
  glm::dvec3 origin{0.0};
};

double rms(const PinholeView& view, const Points& points) {
  double sum = 0;
  for (std::size_t k = 0; k < points.world.size(); ++k) {
    const cv::Point3f& p = points.world[k];
    const auto seen = view.seen(points.origin + glm::dvec3(p.x, p.y, p.z));
    if (!seen) return INFINITY;
    const glm::dvec2 off = seen->pixel - glm::dvec2(points.pixel[k].x, points.pixel[k].y);
    sum += glm::dot(off, off);
  }
  return std::sqrt(sum / double(points.world.size()));
}

AdjustedCamera adjusted(const Camera& camera, const Points& points) {
  constexpr std::size_t kLeastPoints = 40;
  AdjustedCamera result{camera, 0, 0, false};
  if (points.world.size() < kLeastPoints) return result;
  result.beforePx = result.afterPx = rms(PinholeView(camera), points);
  const Intrinsics& k = camera.intrinsics;
  // OpenCV's axes: y down, z forward; pixel centres at whole numbers.
  const glm::dquat halfTurnAboutX(0.0, 1.0, 0.0, 0.0);
  const glm::dquat toCamera = glm::conjugate(camera.pose.rotation * halfTurnAboutX);
  const glm::dvec3 shift = toCamera * (points.origin - camera.pose.position);
  const glm::dmat3 turn = glm::mat3_cast(toCamera);
  cv::Mat matrix = (cv::Mat_<double>(3, 3) << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  cv::Mat rotation(3, 3, CV_64F), vector, translation = (cv::Mat_<double>(3, 1) << shift.x, shift.y, shift.z);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rotation.at<double>(row, column) = turn[column][row];
  cv::Rodrigues(rotation, vector);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-9);
  Camera better = camera;
  try {
    // The pose, then the focal length by the remaining scale about the principal point, in turn.
    for (int turnNumber = 0; turnNumber < 10; ++turnNumber) {
      cv::solvePnPRefineLM(points.world, points.pixel, matrix, cv::noArray(), vector, translation, until);
      std::vector<cv::Point2f> seen;
      cv::projectPoints(points.world, vector, translation, matrix, cv::noArray(), seen);
      double wanted = 0, have = 0;
      for (std::size_t p = 0; p < seen.size(); ++p) {
        const cv::Point2d principal(k.cx, k.cy), a = cv::Point2d(seen[p]) - principal, b = cv::Point2d(points.pixel[p]) - principal;
        wanted += a.dot(b), have += a.dot(a);
      }
      if (!(have > 0) || !(wanted > 0)) return result;
      matrix.at<double>(0, 0) *= wanted / have;
      matrix.at<double>(1, 1) *= wanted / have;
    }
    cv::Rodrigues(vector, rotation);
  } catch (const cv::Exception&) {
    return result;  // a singular system: the camera stays
  }
  glm::dmat3 found;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) found[column][row] = rotation.at<double>(row, column);
  const glm::dquat q = glm::normalize(glm::quat_cast(found));
  const glm::dvec3 t(translation.at<double>(0), translation.at<double>(1), translation.at<double>(2));
  better.pose = poseFromWorldToCamera(q, t);
  better.pose.position += points.origin;
  better.intrinsics.fx = matrix.at<double>(0, 0);
  better.intrinsics.fy = matrix.at<double>(1, 1);
  const double after = rms(PinholeView(better), points);
  if (!(after < result.beforePx)) return result;
  return {better, result.beforePx, after, true};
}

}  // namespace

std::vector<AdjustedCamera> adjustedCameras(const TriangleMesh& mesh, std::span<const HtmView> views,
                                            std::span<const CameraSet> members, std::span<const glm::vec2> offsets) {
  const std::size_t n = mesh.positions.size();
  std::vector<AdjustedCamera> cameras;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PinholeView view(views[i].camera);
    Points points;
    std::size_t count = 0;
    for (std::size_t v = 0; v < n; ++v)
      if (members[v] >> i & 1) points.origin += mesh.positions[v], ++count;
    if (count > 0) points.origin /= double(count);
    for (std::size_t v = 0; v < n; ++v) {
      const auto seen = members[v] >> i & 1 ? view.seen(mesh.positions[v]) : std::nullopt;
      if (!seen) continue;
      const glm::dvec3 p = mesh.positions[v] - points.origin;
      const glm::dvec2 at = seen->pixel + glm::dvec2(offsets[i * n + v]);
      points.world.emplace_back(float(p.x), float(p.y), float(p.z));
      points.pixel.emplace_back(float(at.x), float(at.y));
    }
    cameras.push_back(adjusted(views[i].camera, points));
  }
  return cameras;
}

}  // namespace ibr
