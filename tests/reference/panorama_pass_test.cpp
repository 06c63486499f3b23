// SPDX-License-Identifier: Apache-2.0
// Panoramas on the GPU ([T] eq. 5, fig. 1; property N10): the seam, the poles, the axes, mixed cells.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "ibr/metrics.h"
#include "reference/compare_pictures.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kPi = std::numbers::pi;

Camera panoramaAt(glm::dvec3 position, glm::dquat rotation = {1, 0, 0, 0}, int width = 512, int height = 256) {
  return {{CameraModel::equirectangular, width, height}, {position, rotation}};
}

glm::dquat turned(double angle, glm::dvec3 axis) {
  return glm::angleAxis(angle, glm::normalize(axis));
}

/// A room around d panoramas of different sizes. The second is turned and tilted, the third has its poles at the
/// horizon, the fourth is upside down.
SyntheticOptions room(std::size_t members) {
  SyntheticOptions options;
  options.cameras = {panoramaAt({0, 0, 0}), panoramaAt({1, 0, 0.1}, turned(2.0, {0.2, 1, 0.1}), 640, 320),
                     panoramaAt({0.4, 0.1, 0.9}, turned(kPi / 2, {0, 0, 1}), 400, 200),
                     panoramaAt({0.5, 0.7, 0.4}, turned(3.0, {1, 0.1, 0}))};
  options.cameras.resize(members);
  options.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  options.surfaceStep = 0.8;
  options.samplesPerAxis = 2;
  return options;
}

constexpr glm::dvec3 kX{1, 0, 0}, kY{0, 1, 0};

/// Views along the axes and between them. Two views see a pole of most panoramas, one sees the seam of the first.
Camera viewAlong(int way, glm::dvec3 position, int width = 160, int height = 121, double fovY = 1.3) {
  Camera view = cameraAt(position, 0, 0, width, height, fovY);
  const glm::dquat rotations[] = {
      {1, 0, 0, 0},         turned(kPi, kY),     turned(kPi / 2, kX),
      turned(-kPi / 2, kX), turned(kPi / 2, kY), turned(-kPi / 2, kY) * turned(0.7, kX),
  };
  view.pose.rotation = rotations[way];
  return view;
}
constexpr int kWays = 6;

double coverage(const Image8& picture) {
  std::size_t drawn = 0;
  for (std::size_t i = 3; i < picture.values.size(); i += 4) drawn += picture.values[i] != 0;
  return double(drawn) / double(picture.values.size() / 4);
}

/// Samples the panorama as a pinhole at its centre: bilinear, across the seam.
glm::dvec3 resampled(const Image8& panorama, glm::dvec2 pixel) {
  const double x = pixel.x - 0.5, y = pixel.y - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  glm::dvec3 sum(0.0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto texel =
          panorama.pixel((x0 + i + panorama.width) % panorama.width, std::clamp(y0 + j, 0, panorama.height - 1));
      for (int c = 0; c < 3; ++c)
        sum[c] += (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0)) * texel[std::size_t(c)];
    }
  return sum;
}

}  // namespace

TEST_CASE("panoramas equal the reference implementation in every direction, without holes", "[P9]") {
  for (std::size_t members : {2u, 3u, 4u}) {
    const Stage stage(testDevice(), makeScene(room(members)));
    for (int way = 0; way < kWays; ++way)
      for (const glm::dvec3 position : {glm::dvec3(0.45, 0.1, 0.3), glm::dvec3(1.3, -0.4, 0.5)}) {
        RenderSettings settings = withTiers();
        settings.blend = way % 2 ? BlendMode::dither : BlendMode::blend;
        INFO(members << " members, view " << way << " from x = " << position.x);
        compareWithReference(stage, stage.plan(viewAlong(way, position), settings), 1.0);
        settings.morph = Morph::paper;
        compareWithReference(stage, stage.plan(viewAlong(way, position), settings), 0.5);
      }
  }
}

TEST_CASE("a pinhole view at a panorama's centre equals the resampled panorama") {
  const Stage stage(testDevice(), makeScene(room(3)));
  for (std::size_t i = 0; i < 3; ++i)
    for (int way = 0; way < kWays; ++way)
      for (Morph morph : {Morph::ours, Morph::paper}) {
        const Camera& member = stage.scene().nodes[i].camera;
        // A finer resolution than the panorama's, so that level 0 is shown.
        const Camera view = viewAlong(way, member.pose.position, 161, 121, 0.6);
        RenderSettings settings = withTiers();
        settings.morph = morph;
        const Image8 picture = stage.render(view, settings);
        CHECK(coverage(picture) == 1.0);
        const Image8& photograph = stage.place().photographs[i];
        double worst = 0;
        for (int y = 0; y < picture.height; ++y)
          for (int x = 0; x < picture.width; ++x) {
            const glm::dvec3 ray = glm::conjugate(member.pose.rotation) *
                                   (view.pose.rotation * unproject(view.intrinsics, {x + 0.5, y + 0.5}));
            // Around the poles a pixel averages several columns. Only the reference implementation checks this region.
            if (std::hypot(ray.x, ray.z) < 0.7) continue;
            const glm::dvec3 expected = resampled(photograph, *project(member.intrinsics, ray));
            for (int c = 0; c < 3; ++c)
              worst = std::max(worst, std::abs(picture.pixel(x, y)[std::size_t(c)] - expected[c]));
          }
        INFO("member " << i << ", view " << way << ", morph " << int(morph));
        CHECK(worst <= 1.5);
      }
}

TEST_CASE("panoramas show six colours on six axes", "[N10][T19]") {
  // Painted pixel by pixel from the axis conventions, without use of project().
  const glm::ivec3 kForward(200, 40, 40), kBack(40, 200, 200), kRight(40, 200, 40), kLeft(200, 40, 200),
      kUp(60, 60, 220), kDown(220, 220, 60);
  SyntheticScene place = makeScene(room(2));
  for (Node& node : place.scene.nodes) node.camera.pose.rotation = {1, 0, 0, 0};
  SyntheticOptions upright = room(2);
  for (Camera& camera : upright.cameras) camera.pose.rotation = {1, 0, 0, 0};
  place = makeScene(upright);
  for (Image8& photograph : place.photographs)
    for (int y = 0; y < photograph.height; ++y)
      for (int x = 0; x < photograph.width; ++x) {
        const double turn = (x + 0.5) / photograph.width, fall = (y + 0.5) / photograph.height;
        glm::ivec3 colour = turn < 0.125 || turn >= 0.875 ? kBack
                            : turn < 0.375                ? kLeft
                            : turn < 0.625                ? kForward
                                                          : kRight;
        if (fall < 0.25) colour = kUp;
        if (fall > 0.75) colour = kDown;
        for (int c = 0; c < 3; ++c) photograph.pixel(x, y)[std::size_t(c)] = std::uint8_t(colour[c]);
      }
  const Stage stage(testDevice(), place);
  struct Row {
    glm::dquat rotation;
    glm::ivec3 colour;
  };
  for (const Row& row :
       {Row{{1, 0, 0, 0}, kForward}, Row{turned(kPi, kY), kBack}, Row{turned(-kPi / 2, kY), kRight},
        Row{turned(kPi / 2, kY), kLeft}, Row{turned(kPi / 2, kX), kUp}, Row{turned(-kPi / 2, kX), kDown}})
    for (const std::size_t member : {0u, 1u}) {
      Camera view = cameraAt(stage.scene().nodes[member].camera.pose.position, 0, 0, 41, 41, 0.4);
      view.pose.rotation = row.rotation;
      const Image8 picture = stage.render(view, withTiers());
      bool same = true;
      for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 41; ++x)
          for (int c = 0; c < 3; ++c) same &= std::abs(picture.pixel(x, y)[std::size_t(c)] - row.colour[c]) <= 1;
      INFO("(" << row.colour.x << ", " << row.colour.y << ", " << row.colour.z << ")");
      CHECK(same);
    }
}

TEST_CASE("a panorama's seam is invisible: content behind the camera looks like content in front", "[N10]") {
  // The same room with panoramas turned by a quarter: columns move by exactly a quarter of the width.
  SyntheticOptions options = room(3);
  for (Camera& camera : options.cameras) {
    camera.intrinsics = {CameraModel::equirectangular, 512, 256};
    camera.pose.rotation = {1, 0, 0, 0};
  }
  for (TexturedPlane& plane : options.planes)
    plane.wavelength = 0.05;  // as fine as a texel, so that a visible seam would stand out
  const Stage seam(testDevice(), makeScene(options));
  for (Camera& camera : options.cameras) camera.pose.rotation = turned(kPi / 2, kY);
  const Stage quarter(testDevice(), makeScene(options));
  for (const glm::dvec3 position : {glm::dvec3(0, 0, 0), glm::dvec3(0.45, 0.03, 0.3)})
    for (BlendMode blend : {BlendMode::blend, BlendMode::dither})
      for (double fov : {0.5, 1.0, 1.8}) {  // magnified, about 1:1, three levels down
        RenderSettings settings = withTiers();
        settings.blend = blend;
        const Camera view = viewAlong(1, position, 161, 121, fov);
        const Image8 a = seam.render(view, settings), b = quarter.render(view, settings);
        INFO("fov " << fov << ", blend " << int(blend));
        CHECK(coverage(a) == 1.0);
        CHECK(difference(a, b, 1).shareAbove < 2e-3);
        CHECK(difference(a, b, 1).largest <= 3);
      }
}

TEST_CASE("poles are neither blurred nor aliased") {
  SyntheticOptions options = room(2);
  for (TexturedPlane& plane : options.planes) plane.wavelength = 0.12;
  options.samplesPerAxis = 3;
  for (Camera& camera : options.cameras) {
    camera.intrinsics = {CameraModel::equirectangular, 512, 256};
    camera.pose.rotation = {1, 0, 0, 0};
  }
  const Stage pole(testDevice(), makeScene(options));
  for (Camera& camera : options.cameras) camera.pose.rotation = turned(kPi / 2, kX);
  const Stage equator(testDevice(), makeScene(options));
  for (double fov : {0.5, 1.0, 1.8})
    for (const int way : {2, 3}) {
      double sharp = 0, atPole = 0;
      // The view moves by fractions of a pixel, so that sparkling pixels differ from the truth in some steps.
      for (int step = 0; step < 4; ++step) {
        Camera view = viewAlong(way, {0.37, 0.02, 0.04}, 121, 121, fov);
        view.pose.rotation = view.pose.rotation * turned(0.29 * step * fov / 121, {1, 0.6, 0});
        const Image8 truth = renderTruth(pole.place(), view);
        const Image8 a = pole.render(view, withTiers()), b = equator.render(view, withTiers());
        CHECK(coverage(a) == 1.0);
        atPole += psnr(a, truth);
        sharp += psnr(b, truth);
      }
      INFO("fov " << fov << ", view " << way);
      CHECK(atPole / 4 > sharp / 4 - 1.3);
      CHECK(atPole / 4 > 34);
    }
}

TEST_CASE("moving and turning the world does not change images of panoramas", "[P6]") {
  const SyntheticScene here = makeScene(room(3));
  const glm::dvec3 offset(1e7, -8e6, 3e6);
  const glm::dquat turn = turned(2.1, {1, -2, 0.5});
  auto moved = [&](Camera camera) {
    camera.pose = {offset + turn * camera.pose.position, glm::normalize(turn * camera.pose.rotation)};
    return camera;
  };
  SyntheticScene there = here;
  for (Node& node : there.scene.nodes) node.camera = moved(node.camera);
  const Stage a(testDevice(), here), b(testDevice(), there);
  for (int way = 0; way < kWays; ++way) {
    const Camera view = viewAlong(way, {0.42, 0.07, 0.33});
    const Image8 expected = a.render(view, withTiers()), picture = b.render(moved(view), withTiers());
    CHECK(difference(picture, expected, 1).shareAbove < 2e-3);
    CHECK(psnr(picture, expected) > 50);
  }
}

TEST_CASE("our morph is closer to the truth than the paper's between panoramas and beyond") {
  const Stage stage(testDevice(), makeScene(room(3)));
  for (const glm::dvec3 position : {glm::dvec3(0.45, 0.03, 0.3), glm::dvec3(1.4, 0.3, -0.2)})
    for (int way = 0; way < kWays; ++way) {
      const Camera view = viewAlong(way, position);
      RenderSettings settings = withTiers();
      const Image8 truth = renderTruth(stage.place(), view, 2), ours = stage.render(view, settings);
      settings.morph = Morph::paper;
      const Image8 paper = stage.render(view, settings);
      INFO("view " << way << " from x = " << position.x);
      CHECK(psnr(ours, truth) > 35);
      if (position.x > 1) CHECK(psnr(ours, truth) > psnr(paper, truth) + 8);
    }
}

TEST_CASE("a cell of a panorama and a pinhole equals the reference implementation") {
  SyntheticOptions options = room(3);
  for (const std::size_t pinhole : {0u, 1u, 2u}) {
    SyntheticOptions mixed = options;
    Camera& camera = mixed.cameras[pinhole];
    camera = cameraAt(camera.pose.position, 0.3, -0.1, 300, 220, 1.5);
    mixed.surfaceStep = 0.3;
    mixed.cells = {{0, 1, 2}, {0, 1}};
    const Stage stage(testDevice(), makeScene(mixed));
    for (const glm::dvec3 position : {glm::dvec3(0.45, 0.03, 0.3), glm::dvec3(-0.3, 0.2, 0.1)})
      for (BlendMode blend : {BlendMode::blend, BlendMode::dither}) {
        RenderSettings settings = withTiers();
        settings.blend = blend;
        compareWithReference(stage, stage.plan(cameraAt(position, 0.3, -0.1, 160, 121, 1.2), settings), 0.5);
      }
    RenderSettings alone = withTiers();
    alone.maxCells = 1;
    const Image8 back = stage.render(stage.scene().nodes[pinhole].camera, alone);
    const Image8& photograph = stage.place().photographs[pinhole];
    std::size_t drawn = 0, wrong = 0;
    for (int y = 0; y < back.height; ++y)
      for (int x = 0; x < back.width; ++x) {
        if (back.pixel(x, y)[3] == 0) continue;
        ++drawn;
        for (std::size_t c = 0; c < 3; ++c) wrong += std::abs(back.pixel(x, y)[c] - photograph.pixel(x, y)[c]) > 1;
      }
    CHECK(drawn > back.values.size() / 4 * 6 / 10);
    CHECK(wrong == 0);
  }
}

TEST_CASE("a cell of panoramas is never culled by direction and has rotational distance 0") {
  const Stage stage(testDevice(), makeScene(room(3)));
  for (int way = 0; way < kWays; ++way) {
    const FramePlan plan = stage.plan(viewAlong(way, {0.4, 0.05, 0.3}));
    REQUIRE(plan.cells.size() == 1);
    CHECK(plan.culledByFrustum == 0);
    CHECK(plan.cells[0].rotationalDistance == 0);
  }
}
