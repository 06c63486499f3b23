// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "ibr/author/lens.h"
#include "ibr/error.h"
#include "ibr/metrics.h"

using namespace ibr;

namespace {

constexpr int kWidth = 320, kHeight = 240;

const std::vector<Lens>& lenses() {
  static const std::vector<Lens> all{
      Lens(LensModel::simpleRadial, kWidth, kHeight, std::vector<double>{250, 160, 120, -0.2}),  // barrel
      Lens(LensModel::simpleRadial, kWidth, kHeight, std::vector<double>{250, 160, 120, 0.25}),  // pincushion
      Lens(LensModel::opencv, kWidth, kHeight, std::vector<double>{250, 240, 130, 140, -0.3, 0.1, 0.01, -0.01}),
      Lens(LensModel::opencvFisheye, kWidth, kHeight, std::vector<double>{110, 110, 160, 120, 0.02, 0, 0, 0}),
      Lens(LensModel::fov, kWidth, kHeight, std::vector<double>{200, 200, 160, 120, 0.9}),
      // This lens folds back within the picture.
      Lens(LensModel::simpleRadial, kWidth, kHeight, std::vector<double>{160, 160, 120, -0.5})};
  return all;
}

// Smooth pattern over directions; its period is about 12 px at a focal length of 250 px.
double pattern(glm::dvec2 plane) {
  return 127 + 60 * std::sin(130 * plane.x + 20 * plane.y) + 60 * std::sin(110 * plane.y - 30 * plane.x);
}

template <class Ray>
Image8 pictureOf(int width, int height, Ray&& rayAt) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::optional<glm::dvec3> ray = rayAt(glm::dvec2(x + 0.5, y + 0.5));
      if (!ray || !(ray->z < 0)) continue;
      const double value = pattern({ray->x / -ray->z, -ray->y / -ray->z});
      for (int c = 0; c < 3; ++c) picture.pixel(x, y)[std::size_t(c)] = std::uint8_t(std::lround(value * (4 - c) / 4));
    }
  return picture;
}

}  // namespace

TEST_CASE("an undistorted image equals the image of a pinhole camera") {
  for (std::size_t i = 0; i < lenses().size(); ++i) {
    INFO(i);
    const Lens& lens = lenses()[i];
    const Intrinsics k = undistorted(lens);
    const Image8 taken = pictureOf(kWidth, kHeight, [&](glm::dvec2 p) { return lens.unproject(p); });
    const Image8 truth = pictureOf(k.width, k.height, [&](glm::dvec2 p) { return std::optional(unproject(k, p)); });
    const Image8 ours = undistort(taken, lens, k);
    REQUIRE(ours.width == k.width);
    // Borders do not count: edge pixels are repeated by up to half a pixel. The last two lenses fold or compress a wide
    // view into few pixels, so the photograph itself does not resolve the pattern there.
    double sum = 0;
    std::size_t count = 0;
    for (int y = 4; y < k.height - 4; ++y)
      for (int x = 4; x < k.width - 4; ++x) {
        const double e = double(ours.pixel(x, y)[0]) - truth.pixel(x, y)[0];
        sum += e * e;
        ++count;
      }
    const double psnr = 10 * std::log10(255 * 255 * double(count) / sum);
    CHECK(psnr > (i < 3 ? 40 : 15));
  }
}

TEST_CASE("a cropped rectangle is filled and maximal; one with the border contains every source pixel") {
  for (std::size_t i = 0; i < lenses().size(); ++i) {
    INFO(i);
    const Lens& lens = lenses()[i];
    const Intrinsics k = undistorted(lens);
    CHECK(k.width > 100);
    CHECK(k.height > 80);
    const auto seen = [&](double x, double y) { return photographed({x, y}, lens, k); };
    for (int s = 0; s <= 200; ++s) {
      const double x = 0.5 + (k.width - 1) * s / 200.0, y = 0.5 + (k.height - 1) * s / 200.0;
      CHECK((seen(x, 0.5) && seen(x, k.height - 0.5) && seen(0.5, y) && seen(k.width - 0.5, y)));
    }
    const double widest = std::tan(kMaxHalfFovDegrees / 180 * 3.14159265358979);
    const auto free = [&](double fromX, double fromY, double toX, double toY) {
      for (int s = 0; s <= 400; ++s) {
        const double x = std::lerp(fromX, toX, s / 400.0), y = std::lerp(fromY, toY, s / 400.0);
        if (std::abs((x - k.cx) / k.fx) > widest || std::abs((y - k.cy) / k.fy) > widest) return false;
        if (!seen(x, y)) return false;
      }
      return true;
    };
    const double w = k.width, h = k.height, out = 8;
    CHECK_FALSE(free(-out, 0, -out, h));
    CHECK_FALSE(free(w + out, 0, w + out, h));
    CHECK_FALSE(free(0, -out, w, -out));
    CHECK_FALSE(free(0, h + out, w, h + out));

    const Intrinsics all = undistorted(lens, Border::keep);
    CHECK(all.width >= k.width);
    CHECK(all.height >= k.height);
    for (int y = 1; y < kHeight; y += 7)
      for (int x = 1; x < kWidth; x += 7) {
        const auto ray = lens.unproject({x, y});
        if (!ray || !(ray->z < 0) || std::abs(ray->x / ray->z) > widest || std::abs(ray->y / ray->z) > widest) continue;
        const auto moved = undistort(glm::dvec2(x, y), lens, all);
        CHECK(moved);
        if (moved) CHECK(photographed(*moved, lens, all));
      }
  }
}

TEST_CASE("pixels outside the photograph are black and reported as not photographed") {
  const Lens& lens = lenses()[1];  // corners are pulled inwards: the source does not fill its bounding box
  const Intrinsics k = undistorted(lens, Border::keep);
  const Image8 picture = undistort(Image8(kWidth, kHeight, 3, 200), lens, k);
  std::size_t empty = 0;
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const bool seen = photographed({x + 0.5, y + 0.5}, lens, k);
      CHECK(int(picture.pixel(x, y)[1]) == (seen ? 200 : 0));
      empty += !seen;
    }
  CHECK(empty > 100);
}

TEST_CASE("undistorted pixels project to their source pixels") {
  for (const Lens& lens : lenses()) {
    const Intrinsics k = undistorted(lens);
    std::size_t moved = 0;
    for (int y = 0; y <= kHeight; y += 30)
      for (int x = 0; x <= kWidth; x += 40) {
        const auto there = undistort(glm::dvec2(x, y), lens, k);
        if (!there) continue;
        ++moved;
        const auto back = lens.project(unproject(k, *there));
        REQUIRE(back);
        CHECK(glm::distance(*back, glm::dvec2(x, y)) < 1e-6);
      }
    CHECK(moved > 12);
  }
}

TEST_CASE("an image larger than its camera is undistorted the same way") {
  const Lens& lens = lenses()[0];
  const Intrinsics k = undistorted(lens);
  const Intrinsics twice = resized(k, 2 * k.width, 2 * k.height);
  const Image8 taken = pictureOf(2 * kWidth, 2 * kHeight, [&](glm::dvec2 p) { return lens.unproject(0.5 * p); });
  const Image8 truth =
      pictureOf(twice.width, twice.height, [&](glm::dvec2 p) { return std::optional(unproject(twice, p)); });
  CHECK(psnr(undistort(taken, lens, twice), truth) > 40);
}

TEST_CASE("a lens whose image centre is far off the axis is rejected") {
  const Lens beside(LensModel::simpleRadial, kWidth, kHeight, std::vector<double>{10, 900, 120, -0.1});
  CHECK_THROWS_AS(undistorted(beside), Error);
}
