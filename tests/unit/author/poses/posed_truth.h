// SPDX-License-Identifier: Apache-2.0
// Exact cameras of a generated scene, for tests of pose files: their projections by the textbook's formulas, which
// share no code with libibr's lenses.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "ibr/author/poses.h"
#include "io/image_file.h"

namespace ibr::test {

/// OpenCV's axes: x right, y down, z forward; camera = R·(world − centre).
struct ExactCamera {
  std::string name;
  glm::dquat toCamera;
  glm::dvec3 centre;
  int width = 640, height = 480;
  double fx = 500, fy = 500, cx = 320, cy = 240;
  enum { perspective, fisheye, spherical } kind = perspective;
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0, p1 = 0, p2 = 0, s1 = 0, s2 = 0;
  double division = 0;  // radial term of the division model

  glm::dvec3 translation() const { return -(toCamera * centre); }
  /// Row i, column j of R.
  double r(int i, int j) const { return glm::mat3_cast(toCamera)[j][i]; }
  std::string rows(const char* between) const {
    std::string text;
    for (int i = 0; i < 9; ++i) text += (i == 0 ? "" : between) + fmt::format("{}", r(i / 3, i % 3));
    return text;
  }

  glm::dvec2 pixel(glm::dvec3 world) const {
    const glm::dvec3 p = toCamera * (world - centre);
    if (kind == spherical) {
      const double perRadian = width / (2 * std::numbers::pi);
      return {0.5 * width + perRadian * std::atan2(p.x, p.z),
              0.5 * height + perRadian * std::atan2(p.y, std::hypot(p.x, p.z))};
    }
    const double across = std::hypot(p.x, p.y);
    const double scale = kind == perspective ? 1 / p.z : std::atan2(across, p.z) / across;
    const double x = scale * p.x, y = scale * p.y, rr = x * x + y * y;
    const double radial = (1 + rr * (k1 + rr * (k2 + rr * (k3 + rr * k4)))) / (1 + division * rr);
    return {fx * (x * radial + 2 * p1 * x * y + p2 * (rr + 2 * x * x) + s1 * rr) + cx,
            fy * (y * radial + p1 * (rr + 2 * y * y) + 2 * p2 * x * y + s2 * rr) + cy};
  }

  /// World points that the camera sees; of spherical cameras in all directions.
  std::vector<glm::dvec3> seenPoints(int count) const {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<glm::dvec3> points;
    while (int(points.size()) < count) {
      const glm::dvec3 d(unit(random), unit(random), kind == spherical ? unit(random) : 0.2 + std::abs(unit(random)));
      const glm::dvec3 world = centre + glm::conjugate(toCamera) * (8.0 * d);
      const glm::dvec2 at = pixel(world);
      if (kind == perspective && !(std::hypot(d.x, d.y) < 0.9 * d.z)) continue;  // where the lens folds back
      if (at.x > 0 && at.y > 0 && at.x < width && at.y < height) points.push_back(world);
    }
    return points;
  }
};

/// Three cameras that differ in position and rotation in all axes.
inline std::vector<ExactCamera> exactCameras() {
  const auto turned = [](double angle, glm::dvec3 axis) { return glm::angleAxis(angle, glm::normalize(axis)); };
  return {{"sub/a.png", turned(0.4, {1, 2, 3}), {1, -2, 0.5}},
          {"b.png", turned(-2.1, {3, -1, 0.5}), {-0.7, 0.3, 4}},
          {"c.png", turned(1.3, {-1, 1, -2}), {12.25, 3, -6}}};
}

/// Largest distance between exact projections and those of the model's images of the same names, px.
inline double projectionError(const PosedModel& model, const std::vector<ExactCamera>& truth) {
  double largest = 0;
  for (const ExactCamera& exact : truth) {
    const auto found = std::ranges::find(model.images, exact.name, &PosedImage::name);
    if (found == model.images.end()) return std::numeric_limits<double>::infinity();
    const Camera& camera = found->camera;
    for (const glm::dvec3& world : exact.seenPoints(200)) {
      const glm::dvec3 direction = glm::conjugate(camera.pose.rotation) * (world - camera.pose.position);
      const auto seen = found->lens ? found->lens->project(direction) : project(camera.intrinsics, direction);
      if (!seen) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, glm::distance(*seen, exact.pixel(world)));
    }
  }
  return largest;
}

/// Largest reprojection error of the tracks, px.
inline double trackError(const PosedModel& model) {
  double largest = 0;
  for (const Track& track : model.tracks)
    for (const TrackObservation& o : track.observations) {
      const Camera& camera = model.images[o.image].camera;
      const auto seen =
          project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (track.position - camera.pose.position));
      largest = std::max(largest, seen ? glm::distance(*seen, o.pixel) : std::numeric_limits<double>::infinity());
    }
  return largest;
}

/// Writes a photograph of each camera's size.
inline void writePhotographs(const std::filesystem::path& folder, const std::vector<ExactCamera>& cameras) {
  for (const ExactCamera& camera : cameras) {
    std::filesystem::create_directories((folder / camera.name).parent_path());
    writeImage(folder / camera.name, Image8(camera.width, camera.height, 3, 90));
  }
}

}  // namespace ibr::test
