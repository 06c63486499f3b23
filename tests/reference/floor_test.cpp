// SPDX-License-Identifier: Apache-2.0
// The guiding floor ([T] §2.5.4).
#include <catch2/catch.hpp>
#include <cmath>

#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kPi = std::numbers::pi;

// Grey level of the grid at a point seen from `eye`, without filtering over the pixel's footprint.
double sharp(const Floor& plane, glm::dvec3 place, glm::dvec3 eye) {
  const double distance = std::hypot(place.x - eye.x, place.z - eye.z);
  const auto onLine = [&](double x) { return std::abs(x / plane.spacing - std::round(x / plane.spacing)) < 0.015; };
  const double cover = onLine(place.x) || onLine(place.z) ? 1 : 0;
  return 0.7 * 0.6 * cover * std::max(0.0, 1 - distance / plane.fadeRadius);
}

// Same grey level, averaged over a pixel with 16 × 16 rays.
double supersampled(const Floor& plane, const Camera& view, int x, int y) {
  constexpr int kRays = 16;
  double sum = 0;
  for (int j = 0; j < kRays; ++j)
    for (int i = 0; i < kRays; ++i) {
      const glm::dvec3 ray =
          view.pose.rotation * unproject(view.intrinsics, {x + (i + 0.5) / kRays, y + (j + 0.5) / kRays});
      const double distance = (plane.height - view.pose.position.y) / ray.y;
      if (distance <= 0) continue;
      sum += sharp(plane, view.pose.position + distance * ray, view.pose.position) / (kRays * kRays);
    }
  return 255 * sum;
}

}  // namespace

TEST_CASE("the floor is a filtered, faded grid at its height from any eye position") {
  const Stage stage(testDevice(), makeScene(place(2)));
  RenderSettings settings;
  settings.floor = Floor{.height = -1.5, .spacing = 0.75, .fadeRadius = 9};
  // Views away from the photographs, where only the floor is drawn: off-centre, rolled, above and below.
  for (Camera view : {cameraAt({0.3, 0.1, 0.2}, kPi, -0.4), cameraAt({100.37, 2, -50.1}, 2.2, -0.9),
                      cameraAt({0.3, -3, 0.2}, kPi, 0.3)}) {
    view.intrinsics.cx += 20;
    view.pose.rotation *= glm::angleAxis(0.2, glm::dvec3(0, 0, 1));
    const Image8 picture = stage.render(view, settings);
    double sum = 0, largest = 0;
    std::size_t grey = 0, count = 0;
    for (int y = 1; y < picture.height; y += 5)
      for (int x = 1; x < picture.width; x += 5) {
        const double expected = supersampled(*settings.floor, view, x, y);
        const double difference = std::abs(picture.pixel(x, y)[0] - expected);
        sum += difference;
        ++count;
        grey += expected > 5;
        largest = std::max(largest, difference);
      }
    CHECK(grey > count / 20);
    CHECK(sum / double(count) < 1.5);  // the device filters lines along the axes, which is inexact for oblique lines
    CHECK(largest < 60);
  }
}

TEST_CASE("the floor is drawn over background and filled holes, but not over photographs") {
  const Stage stage(testDevice(), makeScene(place(2)));
  const Camera view = cameraAt({0.4, 0.1, 0}, 0, -0.3);
  for (const int tiers : {int(kTierCompleted), int(kTierFilled)}) {
    RenderSettings settings = withTiers();
    settings.maxTier = tiers;
    settings.background = {0.1f, 0.2f, 0.1f};
    const Image8 plain = stage.render(view, settings);
    settings.floor = Floor{.height = -1.5, .spacing = 0.5};
    const Image8 picture = stage.render(view, settings);
    std::size_t drawn = 0, changed = 0, photographed = 0, otherTier = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto before = plain.pixel(x, y), after = picture.pixel(x, y);
        const bool same = std::equal(before.begin(), before.end(), after.begin());
        const bool empty = before[3] <= 63;
        otherTier += before[3] != after[3];
        photographed += !empty && !same;
        drawn += !empty;
        changed += !same;
      }
    CHECK(otherTier == 0);
    CHECK(photographed == 0);
    CHECK(drawn > 1000);
    CHECK(changed > 1000);
  }
}
