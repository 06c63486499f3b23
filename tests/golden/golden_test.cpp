// SPDX-License-Identifier: Apache-2.0
// A few small images that must not change unnoticed. Other tests prove their content (tests/reference); golden images
// catch unforeseen changes.
//
// If an image differs, the image and the difference are written into the build folder (golden/actual) for inspection.
// With IBR_UPDATE_GOLDEN=1 in the environment, the expected images are replaced instead.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

#include "ibr/metrics.h"
#include "io/image_file.h"
#include "reference/stage.h"
#include "support/gpu.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

namespace {

Image8 withoutAlpha(const Image8& rgba) {
  Image8 rgb(rgba.width, rgba.height, 3);
  for (std::size_t i = 0, o = 0; i < rgba.values.size(); i += 4)
    for (std::size_t c = 0; c < 3; ++c) rgb.values[o++] = rgba.values[i + c];
  return rgb;
}

// Tolerance for other devices' filtering and rounding: 4 levels, except for a few pixels on edges.
void compare(const std::string& name, const Image8& rgba) {
  const fs::path expectedFile = fs::path(IBR_GOLDEN_EXPECTED) / (name + ".png");
  const Image8 actual = withoutAlpha(rgba);
  if (std::getenv("IBR_UPDATE_GOLDEN")) {
    writeImage(expectedFile, actual);
    CHECK(fs::file_size(expectedFile) < 64 * 1024);
    return;
  }
  const Image8 expected = readImage(expectedFile);
  const Difference d = difference(actual, expected, 4);
  INFO(name << ": " << 100 * d.shareAbove << " % of pixels differ by more than 4 levels, see " << IBR_GOLDEN_ACTUAL);
  if (d.shareAbove > 0.004) {
    fs::create_directories(IBR_GOLDEN_ACTUAL);
    Image8 shown = actual;
    for (std::size_t i = 0; i < shown.values.size(); ++i)
      shown.values[i] = std::uint8_t(std::min(255, 16 * std::abs(actual.values[i] - expected.values[i])));
    writeImage(fs::path(IBR_GOLDEN_ACTUAL) / (name + ".png"), actual);
    writeImage(fs::path(IBR_GOLDEN_ACTUAL) / (name + ".difference.png"), shown);
  }
  CHECK(d.shareAbove <= 0.004);
  CHECK(d.meanAbsolute < 0.5);
}

Camera small(glm::dvec3 position, double yaw) {
  return cameraAt(position, yaw, 0, 192, 144);
}

}  // namespace

TEST_CASE("a blended triangle seen from inside matches its golden image") {
  compare("blend_inside", Stage(testDevice(), makeScene(place(3))).render(small({0.4, 0.3, 0.1}, 0.02)));
}

TEST_CASE("a dithered tetrahedron seen from outside matches its golden image") {
  RenderSettings settings;
  settings.blend = BlendMode::dither;
  compare("dither_outside", Stage(testDevice(), makeScene(place(4))).render(small({1.2, -0.3, 0.3}, 0.1), settings));
}

TEST_CASE("the paper's morph and draw order of two cells match their golden image") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  RenderSettings settings;
  settings.morph = Morph::paper;
  settings.order = DrawOrder::paper;
  settings.background = {0.2f, 0.3f, 0.4f};
  compare("paper_two_cells", Stage(testDevice(), makeScene(options)).render(small({0.6, 0.4, 0.2}, -0.1), settings));
}
