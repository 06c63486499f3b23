// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/court.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "base/check.h"
#include "base/random.h"

namespace ibr {
namespace {

// Lengths in metres.
constexpr double kSpacing = 0.45;  // along the walk
constexpr double kBack = 0.6;      // the back row is this much further behind, and higher
constexpr double kDistance = 4;    // of the walk's front row from the wall
constexpr double kPanel = 2;       // about; side of a square of wall with its own texture and board
constexpr double kWallHeight = 6, kEyes = 1.6;
constexpr double kFovY = 0.9;                        // rad
constexpr int kTracksAcross = 14, kTracksDown = 10;  // begun by each photograph
constexpr std::uint32_t kReach = 12;                 // neighbours before and after that may see a track, too

// A wall of the court seen from inside: its corner, its direction, and the direction into the court.
struct Wall {
  glm::dvec3 corner, along, inward;
};

std::array<Wall, 4> wallsOf(double side) {
  const double h = side / 2;
  return {{{{-h, 0, -h}, {1, 0, 0}, {0, 0, 1}},
           {{h, 0, -h}, {0, 0, 1}, {-1, 0, 0}},
           {{h, 0, h}, {-1, 0, 0}, {0, 0, -1}},
           {{-h, 0, h}, {0, 0, -1}, {1, 0, 0}}}};
}

glm::dquat facing(glm::dvec3 direction) {
  const glm::dvec3 back = -glm::normalize(direction), right = glm::normalize(glm::cross({0, 1, 0}, back));
  return glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back));
}

double sideOf(int photographs) {
  return photographs * kSpacing / 4 + 2 * kDistance;
}

// A pose in the front row. In a corner the walk turns from one wall to the next.
Pose poseAt(double side, double at) {
  const double way = 4 * (at - std::floor(at));
  const auto walls = wallsOf(side);
  const auto& [corner, along, inward] = walls[std::size_t(way) % 4];
  const double walked = way - std::floor(way), inner = side - 2 * kDistance;
  const double turn = std::max(0.0, (walked - 0.75) / 0.25) * std::numbers::pi / 2;
  const glm::dvec3 look = -inward * std::cos(turn) + along * std::sin(turn);
  return {corner + along * (kDistance + inner * walked) + inward * kDistance + glm::dvec3(0, kEyes, 0), facing(look)};
}

// True if the plane's circumscribed sphere may be visible: tests the half-space and the cone of the camera.
bool mayShow(const Camera& camera, const TexturedPlane& plane) {
  const Intrinsics& k = camera.intrinsics;
  const double radius = 0.5 * std::hypot(plane.extentU, plane.extentV);
  const glm::dvec3 to = plane.origin - camera.pose.position;
  const double distance = glm::length(to);
  if (distance <= radius) return true;
  const double cone =
      std::atan(std::hypot(std::max(k.cx, k.width - k.cx) / k.fx, std::max(k.cy, k.height - k.cy) / k.fy));
  const double angle = std::acos(std::clamp(glm::dot(to, viewAxis(camera.pose)) / distance, -1.0, 1.0));
  return angle <= cone + std::asin(radius / distance);
}

SyntheticScene visibleTo(const Court& court, const Camera& camera) {
  SyntheticScene scene;
  std::ranges::copy_if(court.planes, std::back_inserter(scene.planes),
                       [&](const TexturedPlane& plane) { return mayShow(camera, plane); });
  return scene;
}

// Pixel of the point, if nothing hides the point from the camera.
std::optional<glm::dvec2> seenAt(const SyntheticScene& shown, const Camera& camera, glm::dvec3 point) {
  const glm::dvec3 to = point - camera.pose.position;
  const auto pixel = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * to);
  const Intrinsics& k = camera.intrinsics;
  if (!pixel || !(pixel->x > 0 && pixel->y > 0 && pixel->x < k.width && pixel->y < k.height)) return std::nullopt;
  const auto first = distanceAlong(shown, camera.pose.position, to);
  return first && *first > 1 - 1e-6 ? pixel : std::nullopt;
}

}  // namespace

Court makeCourt(int photographs, int width, int height, std::uint64_t seed) {
  check(photographs >= 2, ErrorCode::invalidInput, "court: {} photographs are fewer than 2", photographs);
  Random random(seed);
  const double side = sideOf(photographs);
  Court court;
  const auto add = [&](glm::dvec3 origin, glm::dvec3 u, glm::dvec3 v, double extentU, double extentV,
                       double wavelength) {
    court.planes.push_back({origin, u, v, extentU, extentV, seed * 1000 + court.planes.size(), wavelength});
  };
  const glm::dvec3 up(0, 1, 0);
  add({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, side, side, 0.12);
  for (const auto& [corner, along, inward] : wallsOf(side)) {
    const double panels = std::round(side / kPanel), wide = side / panels;
    for (double p = 0.5; p < panels; ++p) {
      const glm::dvec3 foot = corner + along * (p * wide);
      for (double middle = kPanel / 2; middle < kWallHeight; middle += kPanel)
        add(foot + up * middle, along, up, wide, kPanel, random.uniform(0.05, 0.1));
      const double before = random.uniform(0.2, 1.3), turned = random.uniform(-0.4, 0.4);
      const glm::dvec3 u = along * std::cos(turned) + inward * std::sin(turned);
      const double top = random.uniform(1.2, 2.6), board = random.uniform(0.5, 1.2);
      add(foot + along * random.uniform(-0.4, 0.4) + inward * before + up * (top / 2), u, up, board, top,
          random.uniform(0.04, 0.08));
    }
  }
  const Intrinsics intrinsics = pinholeFromFov(width, height, kFovY);
  for (int i = 0; i < photographs; ++i) {
    Pose pose = poseAt(side, double(i) / photographs);
    if (i % 2) pose.position += -kBack * viewAxis({{}, pose.rotation}) + glm::dvec3(0, 0.3, 0);
    const glm::dquat shaken = glm::angleAxis(random.uniform(-0.03, 0.03), up) *
                              glm::angleAxis(random.uniform(-0.03, 0.03), pose.rotation * glm::dvec3(1, 0, 0));
    pose.rotation = glm::normalize(shaken * pose.rotation);
    court.cameras.push_back({intrinsics, pose});
  }
  return court;
}

Camera cameraInCourt(const Court& court, double at) {
  return {court.cameras[0].intrinsics, poseAt(sideOf(int(court.cameras.size())), at)};
}

Image8 photograph(const Court& court, const Camera& camera, int samplesPerAxis) {
  return renderTruth(visibleTo(court, camera), camera, samplesPerAxis);
}

std::vector<CourtTrack> tracksOf(const Court& court, std::uint64_t seed) {
  Random random(seed + 1);
  const auto count = std::uint32_t(court.cameras.size());
  std::vector<SyntheticScene> shown;
  for (const Camera& camera : court.cameras) shown.push_back(visibleTo(court, camera));
  std::vector<CourtTrack> tracks;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Camera& camera = court.cameras[i];
    const double width = camera.intrinsics.width, height = camera.intrinsics.height;
    std::vector<std::uint32_t> near;  // cameras that may see the point, too
    for (std::uint32_t j = 0; j < count; ++j)
      if (const std::uint32_t apart = i < j ? j - i : i - j; std::min(apart, count - apart) <= kReach)
        near.push_back(j);
    for (int y = 0; y < kTracksDown; ++y)
      for (int x = 0; x < kTracksAcross; ++x) {
        const glm::dvec2 pixel(width * (x + random.uniform(0, 1)) / kTracksAcross,
                               height * (y + random.uniform(0, 1)) / kTracksDown);
        const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, pixel);
        const auto distance = distanceAlong(shown[i], camera.pose.position, ray);
        if (!distance) continue;
        CourtTrack track{camera.pose.position + *distance * ray, {}};
        for (const std::uint32_t j : near)
          if (const auto at = seenAt(shown[j], court.cameras[j], track.position)) track.seen.push_back({j, *at});
        if (track.seen.size() >= 2) tracks.push_back(std::move(track));
      }
  }
  return tracks;
}

}  // namespace ibr
