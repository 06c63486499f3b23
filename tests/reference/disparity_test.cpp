// SPDX-License-Identifier: Apache-2.0
// Disparity between the images of two eyes ([T] §2.5.4) against exact geometry. Photographs encode positions on a
// plane: two channels hold a wave along one axis as sine and cosine, so that each pixel gives its surface
// position to a small part of a pixel. The paper's morph is measured beside ours; the paper's morph keeps no
// depth.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kIpd = 0.064;  // m
constexpr int kWidth = 800, kHeight = 720;
constexpr double kBorderPx = 32;  // margin for one square of the mesh in the eyes' images
constexpr double kTwoPi = 2 * std::numbers::pi;

struct Hit {
  std::size_t plane;
  glm::dvec2 at;  // along u and v, world units
};

// Returns the nearest plane on a camera's ray through a pixel.
std::optional<Hit> hitOf(const std::vector<TexturedPlane>& planes, const Camera& camera, glm::dvec2 pixel) {
  const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, pixel);
  std::optional<Hit> hit;
  double nearest = 1e300;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const TexturedPlane& plane = planes[p];
    const glm::dvec3 normal = glm::cross(plane.u, plane.v), away = plane.origin - camera.pose.position;
    const double distance = glm::dot(away, normal) / glm::dot(ray, normal);
    const glm::dvec3 on = distance * ray - away;
    const glm::dvec2 at(glm::dot(on, plane.u), glm::dot(on, plane.v));
    if (!(distance > 0) || distance >= nearest || std::abs(at.x) > plane.extentU / 2 ||
        std::abs(at.y) > plane.extentV / 2)
      continue;
    nearest = distance;
    hit = Hit{p, at};
  }
  return hit;
}

glm::dvec3 pointOf(const std::vector<TexturedPlane>& planes, const Hit& hit) {
  return planes[hit.plane].origin + hit.at.x * planes[hit.plane].u + hit.at.y * planes[hit.plane].v;
}

std::optional<glm::dvec2> pixelOf(const Camera& camera, glm::dvec3 point) {
  return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
}

// Wavelength of a plane's encoded position, world units.
double lengthOf(const TexturedPlane& plane) {
  return 2 * plane.wavelength;
}

// Encodes the position along u, modulo the wavelength, in red and green; blue identifies the plane.
void encode(SyntheticScene& place) {
  for (std::size_t n = 0; n < place.photographs.size(); ++n) {
    Image8& photograph = place.photographs[n];
    for (int y = 0; y < photograph.height; ++y)
      for (int x = 0; x < photograph.width; ++x) {
        const auto hit = hitOf(place.planes, place.scene.nodes[n].camera, {x + 0.5, y + 0.5});
        const double phase = hit ? kTwoPi * hit->at.x / lengthOf(place.planes[hit->plane]) : 0;
        photograph.pixel(x, y)[0] = std::uint8_t(std::lround(127.5 + 120 * std::sin(phase)));
        photograph.pixel(x, y)[1] = std::uint8_t(std::lround(127.5 + 120 * std::cos(phase)));
        photograph.pixel(x, y)[2] = std::uint8_t(hit ? 60 * (hit->plane + 1) : 0);
      }
  }
}

// Decoded value at a position between pixel centres whose four neighbours are all of tier 0.
struct Seen {
  bool onPlane = true;  // all neighbours have the plane's colour
  double phase = 0;
};
std::optional<Seen> seenAt(const Image8& picture, glm::dvec2 pixel, std::size_t plane) {
  const glm::dvec2 corner = glm::floor(pixel - 0.5), share = pixel - 0.5 - corner;
  if (corner.x < 2 || corner.y < 2 || corner.x + 3 >= picture.width || corner.y + 3 >= picture.height)
    return std::nullopt;
  Seen seen;
  glm::dvec2 sum(0);
  for (int j = -2; j < 4; ++j)
    for (int i = -2; i < 4; ++i) {
      const auto value = picture.pixel(int(corner.x) + i, int(corner.y) + j);
      if (value[3] != 255) return std::nullopt;
      seen.onPlane &= std::abs(value[2] - int(60 * (plane + 1))) <= 2;
      if (i < 0 || i > 1 || j < 0 || j > 1) continue;
      sum += (i ? share.x : 1 - share.x) * (j ? share.y : 1 - share.y) * glm::dvec2(value[0] - 127.5, value[1] - 127.5);
    }
  seen.phase = std::atan2(sum.x, sum.y);
  return seen;
}

// Returns whether the plane, by exact geometry, fills the neighbourhood of `px` pixels.
bool isAround(const std::vector<TexturedPlane>& planes, const Camera& eye, glm::dvec2 pixel, std::size_t plane,
              double px) {
  for (const double dy : {-px, 0.0, px})
    for (const double dx : {-px, 0.0, px}) {
      const auto hit = hitOf(planes, eye, pixel + glm::dvec2(dx, dy));
      if (!hit || hit->plane != plane) return false;
    }
  return true;
}

struct Errors {
  std::vector<double> px;  // absolute disparity errors
  std::size_t seen = 0;    // pixels of the left image that show tier 0
  std::size_t wrong = 0;   // seen pixels that show the wrong plane, although no border is within kBorderPx

  double quantile(double share) {
    std::ranges::sort(px);
    return px.empty() ? 0 : px[std::size_t(share * double(px.size() - 1))];
  }
};

std::vector<Camera> eyesOf(const Camera& head) {
  std::vector<Camera> eyes(2, head);
  const glm::dvec3 half = head.pose.rotation * glm::dvec3(0.5 * kIpd, 0, 0);
  eyes[0].pose.position -= half;
  eyes[1].pose.position += half;
  eyes[0].intrinsics = pinholeFromTangents(kWidth, kHeight, -0.72, 0.48, 0.5, -0.58);
  eyes[1].intrinsics = pinholeFromTangents(kWidth, kHeight, -0.48, 0.72, 0.5, -0.58);
  return eyes;
}

// Measures the disparity error of each left pixel: the difference of the decoded positions, divided by the change of
// position per pixel along a row.
Errors measure(const Stage& stage, const Camera& head, Morph morph) {
  RenderSettings settings;
  settings.morph = morph;
  settings.maxTier = kTierConsistent;
  settings.alpha = AlphaContent::tier;
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {eyesOf(head), settings});
  const std::vector<Image8> pictures = stage.renderViews(plan);
  const std::vector<TexturedPlane>& planes = stage.place().planes;
  Errors errors;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      errors.seen += pictures[0].pixel(x, y)[3] == 255;
      const auto hit = hitOf(planes, plan.views[0], {x + 0.5, y + 0.5});
      if (!hit) continue;
      const glm::dvec3 point = pointOf(planes, *hit);
      const auto right = pixelOf(plan.views[1], point);
      if (!right) continue;
      const glm::dvec2 left(x + 0.5, y + 0.5);
      const auto a = seenAt(pictures[0], left, hit->plane), b = seenAt(pictures[1], *right, hit->plane);
      if (!a || !b || !isAround(planes, plan.views[1], *right, hit->plane, 1)) continue;
      if (!a->onPlane || !b->onPlane) {
        errors.wrong += isAround(planes, plan.views[0], left, hit->plane, kBorderPx) &&
                        isAround(planes, plan.views[1], *right, hit->plane, kBorderPx);
        continue;
      }
      const auto at = [&](double dx) { return hitOf(planes, plan.views[1], *right + glm::dvec2(dx, 0))->at.x; };
      const double along = kTwoPi * (at(0.5) - at(-0.5)) / lengthOf(planes[hit->plane]);  // phase change per px
      errors.px.push_back(std::abs(std::remainder(b->phase - a->phase, kTwoPi) / along));
    }
  return errors;
}

SyntheticOptions corridor(glm::dvec3 origin) {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2, 3}};
  options.gridStep = 8;
  // A wall, a board in front of the wall, and a ground plane seen at all slants.
  options.planes.push_back({{0, -1.4, -7}, {1, 0, 0}, {0, 0, -1}, 40, 20, 3, 0.5});
  for (Camera& camera : options.cameras) camera.pose.position += origin;
  for (TexturedPlane& plane : options.planes) plane.origin += origin;
  return options;
}

}  // namespace

TEST_CASE("stereo disparity of both eyes matches depth to half a pixel") {
  struct Row {
    const char* name;
    glm::dvec3 head;
    double yaw, pitch, roll;
    glm::dvec3 origin{0};
  };
  const std::vector<Row> rows{{"between the photographs", {0.45, 0.25, 0.2}, 0.06, -0.05, 0},
                              {"the head turned and tilted", {0.55, 0.3, 0.25}, -0.12, 0.02, 0.35},
                              {"a metre outside", {1.4, 0.9, -0.6}, 0.1, -0.05, -0.1},
                              {"far from the world's origin", {0.45, 0.25, 0.2}, 0.06, -0.05, 0, {4e5, -2e3, 7e5}}};
  std::printf("px of %dx%d eyes %.0f mm apart:%21s of tier 0     p50     p99     max\n", kWidth, kHeight, 1e3 * kIpd,
              "compared");
  for (const Row& row : rows) {
    SyntheticScene made = makeScene(corridor(row.origin));
    encode(made);
    const Stage stage(testDevice(), std::move(made));
    Camera head = cameraAt(row.head + row.origin, row.yaw, row.pitch);
    head.pose.rotation *= glm::angleAxis(row.roll, glm::dvec3(0, 0, 1));
    for (const Morph morph : {Morph::ours, Morph::paper}) {
      Errors errors = measure(stage, head, morph);
      std::printf("  %-28s %-6s %15zu  %9zu  %6.3f  %6.3f  %6.3f\n", row.name, morph == Morph::ours ? "ours" : "paper",
                  errors.px.size(), errors.seen, errors.quantile(0.5), errors.quantile(0.99), errors.quantile(1));
      if (morph == Morph::paper) continue;
      INFO(row.name);
      CHECK(errors.px.size() > std::size_t(kWidth * kHeight / 3));
      CHECK(errors.px.size() > errors.seen / 2);
      CHECK(errors.wrong == 0);
      CHECK(errors.quantile(1) <= 0.5);
    }
  }
}
