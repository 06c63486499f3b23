// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_adjust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <opencv2/core.hpp>

namespace ibr {
namespace {

struct Points {
  std::vector<glm::dvec3> world;  // relative to `origin`
  std::vector<glm::dvec2> pixel;
  glm::dvec3 origin{0.0};
};

// A camera relative to the points' origin: p has the coordinates turn · p + shift, with the axes of a Pose.
struct Placed {
  Intrinsics k;
  glm::dquat turn;
  glm::dvec3 shift;
};

constexpr int kUnknowns = 7;  // small rotation, shift relative to the distance, logarithm of the focal length
using Row = std::array<double, kUnknowns>;
using Matrix = std::array<Row, kUnknowns>;

struct NormalEquations {
  Matrix matrix{};
  Row side{};
  double squares = 0;  // infinite if a point is not in front of the camera

  void add(const Row& row, double residual) {
    for (std::size_t a = 0; a < kUnknowns; ++a) {
      side[a] += row[a] * residual;
      for (std::size_t b = 0; b < kUnknowns; ++b) matrix[a][b] += row[a] * row[b];
    }
  }
};

NormalEquations normalEquations(const Placed& camera, const Points& points) {
  NormalEquations sum;
  const double distance = glm::length(camera.shift);
  for (std::size_t p = 0; p < points.world.size(); ++p) {
    const glm::dvec3 turned = camera.turn * points.world[p], q = turned + camera.shift;
    if (!(q.z < 0)) {
      sum.squares = std::numeric_limits<double>::infinity();
      return sum;
    }
    const Intrinsics& k = camera.k;
    const glm::dvec2 off(-k.fx * q.x / q.z, k.fy * q.y / q.z);  // from the principal point
    const glm::dvec2 residual = points.pixel[p] - glm::dvec2(k.cx, k.cy) - off;
    const std::array<glm::dvec3, 2> pointJacobian{glm::dvec3(-k.fx / q.z, 0, -off.x / q.z),
                                                  glm::dvec3(0, k.fy / q.z, -off.y / q.z)};
    for (int axis = 0; axis < 2; ++axis) {
      const glm::dvec3 g = pointJacobian[std::size_t(axis)], byTurn = glm::cross(turned, g);
      sum.add({byTurn.x, byTurn.y, byTurn.z, distance * g.x, distance * g.y, distance * g.z, off[axis]},
              residual[axis]);
    }
    sum.squares += glm::dot(residual, residual);
  }
  return sum;
}

Placed moved(Placed camera, const Row& by) {
  const glm::dvec3 turn(by[0], by[1], by[2]);
  if (const double angle = glm::length(turn); angle > 0)
    camera.turn = glm::normalize(glm::angleAxis(angle, turn / angle) * camera.turn);
  camera.shift += glm::length(camera.shift) * glm::dvec3(by[3], by[4], by[5]);
  camera.k.fx *= std::exp(by[6]);
  camera.k.fy *= std::exp(by[6]);
  return camera;
}

// Levenberg-Marquardt over all unknowns together: alternating between focal length and distance, which compensate each
// other, converges too slowly.
Placed fitted(Placed camera, const Points& points) {
  NormalEquations now = normalEquations(camera, points);
  double damping = 1e-4;
  for (int step = 0; step < 60 && damping < 1e8; ++step) {
    Matrix matrix = now.matrix;
    Row by{};
    // The second term keeps unknowns that no point constrains.
    for (std::size_t a = 0; a < kUnknowns; ++a)
      matrix[a][a] += damping * matrix[a][a] + 1e-9 * now.matrix[6][6] + 1e-12;
    if (!cv::solve(cv::Mat(kUnknowns, kUnknowns, CV_64F, matrix.data()), cv::Mat(kUnknowns, 1, CV_64F, now.side.data()),
                   cv::Mat(kUnknowns, 1, CV_64F, by.data()), cv::DECOMP_CHOLESKY)) {
      damping *= 10;
      continue;
    }
    const Placed next = moved(camera, by);
    const NormalEquations there = normalEquations(next, points);
    if (!(there.squares < now.squares)) {
      damping *= 10;
      continue;
    }
    const bool done = there.squares > (1 - 1e-9) * now.squares;
    camera = next;
    now = there;
    damping = std::max(1e-12, damping / 10);
    if (done) break;
  }
  return camera;
}

double rms(double squares, const Points& points) {
  return std::sqrt(squares / double(points.world.size()));
}

AdjustedCamera adjusted(const Camera& camera, const Points& points) {
  constexpr std::size_t kMinVertices = 40;
  AdjustedCamera result{camera};
  if (points.world.empty()) return result;
  const glm::dquat turn = glm::conjugate(camera.pose.rotation);
  const Placed before{camera.intrinsics, turn, turn * (points.origin - camera.pose.position)};
  result.beforePx = result.afterPx = rms(normalEquations(before, points).squares, points);
  result.known = points.world.size() >= kMinVertices;
  if (!result.known) return result;
  const Placed after = fitted(before, points);
  const double afterPx = rms(normalEquations(after, points).squares, points);
  if (!(afterPx < result.beforePx)) return result;
  const glm::dquat rotation = glm::conjugate(after.turn);
  return {{after.k, {points.origin - rotation * after.shift, rotation}}, result.beforePx, afterPx, true, true};
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
      points.world.push_back(mesh.positions[v] - points.origin);
      points.pixel.push_back(seen->pixel + glm::dvec2(offsets[i * n + v]));
    }
    cameras.push_back(adjusted(views[i].camera, points));
  }
  return cameras;
}

}  // namespace ibr
