// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/baselines.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>

#include "author/backdrop/complete_depth.h"
#include "author/eval/lumigraph.h"
#include "base/srgb.h"
#include "ibr/error.h"
#include "ibr/metrics.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/exact_depth.h"
#include "support/temporary_folder.h"

using namespace ibr;

namespace {

constexpr int kWidth = 160, kHeight = 120;

Camera cameraAt(glm::dvec3 position, double yaw = 0) {
  return {pinholeFromFov(kWidth, kHeight, 0.9), {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))}};
}

const TexturedPlane kWall{.origin = {0, 0, -5}, .extentU = 24, .extentV = 16, .wavelength = 0.6};
const TexturedPlane kSign{.origin = {0.3, 0.1, -3}, .extentU = 1, .extentV = 0.8, .seed = 2, .wavelength = 0.4};

// A scene as `ibr build` writes it, with its photographs and their exact depth.
struct Place {
  explicit Place(std::vector<TexturedPlane> planes) {
    SyntheticOptions options;
    for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {0.5, 0, 0}, {0.2, 0.4, 0}})
      options.cameras.push_back(cameraAt(at));
    options.planes = std::move(planes);
    options.gridStep = 8;
    made = makeScene(options);
    made.scene.folder = folder.path();
    for (std::size_t i = 0; i < made.photographs.size(); ++i) {
      made.scene.nodes[i].imageFile = made.scene.nodes[i].name + ".png";
      writeImage(folder / made.scene.nodes[i].imageFile, made.photographs[i]);
      writeDepth(i, exactDepth(i));
    }
  }
  const Scene& scene() const { return made.scene; }
  DepthMaps exactDepth(std::size_t i) const {
    return {test::exactInverseDepth(made, made.scene.nodes[i].camera), ImageF(kWidth, kHeight, 1, 0.9f)};
  }
  void writeDepth(std::size_t i, const DepthMaps& maps) {
    Node& node = made.scene.nodes[i];
    const DepthTexture depth = depthTexture(maps, kWidth);
    node.depthFile = node.name + ".depth.ktx2";
    node.depthScale = depth.scale;
    writeKtx2(folder / node.depthFile, depth.texture);
  }

  test::TemporaryFolder folder;
  SyntheticScene made;
};

int largestDifference(const Image8& picture, const Image8& truth) {
  int largest = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        largest = std::max(largest, std::abs(picture.pixel(x, y)[c] - truth.pixel(x, y)[c]));
  return largest;
}

Image8 shown(const Image8& picture) {
  Image8 mask(picture.width, picture.height, 1);
  for (std::size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = picture.values[4 * i + 3];
  return mask;
}

double share(const Image8& mask) {
  return double(std::ranges::count_if(mask.values, [](auto v) { return v != 0; })) / double(mask.values.size());
}

DepthMap exactMap(const SyntheticScene& scene, const Camera& camera) {
  return {camera, test::exactInverseDepth(scene, camera)};
}

}  // namespace

TEST_CASE("every baseline reproduces a photograph at its own pose") {
  const Place place({kWall, kSign});
  Baselines baselines(place.scene());
  for (std::size_t i = 0; i < 3; ++i) {
    const Camera& view = place.scene().nodes[i].camera;
    CHECK(largestDifference(baselines.nearest(view), place.made.photographs[i]) <= 1);
    CHECK(largestDifference(baselines.lumigraph(view), place.made.photographs[i]) <= 1);
    std::array<double, 3> weights{};
    weights[i] = 1;
    CHECK(largestDifference(baselines.crossFade(view, place.scene().cells[0], weights), place.made.photographs[i]) <=
          1);
  }
}

TEST_CASE("baselines apply the photographs' gains if an exposure is set") {
  Place place({kWall, kSign});
  const glm::dvec3 exposure(0.9, 1, 1.1);
  for (std::size_t i = 0; i < 3; ++i) place.made.scene.nodes[i].gain = {0.7 + 0.2 * double(i), 0.8, 1.1};
  Baselines baselines(place.scene());
  for (std::size_t i = 0; i < 3; ++i) {
    const Camera& view = place.scene().nodes[i].camera;
    const Image8& photograph = place.made.photographs[i];
    std::array<double, 3> weights{};
    weights[i] = 1;
    baselines.setExposure(exposure);
    for (const Image8& picture : {baselines.nearest(view), baselines.lumigraph(view),
                                  baselines.crossFade(view, place.scene().cells[0], weights)}) {
      std::size_t compared = 0, wrong = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          if (*std::ranges::max_element(photograph.pixel(x, y)) > 225) continue;  // clipped values do not get darker
          ++compared;
          for (int c = 0; c < 3; ++c) {
            const double light = exposure[c] * place.scene().nodes[i].gain[c] *
                                 srgbToLinear(photograph.pixel(x, y)[std::size_t(c)] / 255.0);
            wrong += std::abs(picture.pixel(x, y)[std::size_t(c)] - 255 * linearToSrgb(light)) > 1.6;
          }
        }
      CHECK(compared > 10000);
      CHECK(wrong == 0);
    }
    baselines.setExposure(std::nullopt);
    CHECK(largestDifference(baselines.nearest(view), photograph) <= 1);
  }
}

TEST_CASE("every baseline is exact for a wall across the view") {
  const Place place({kWall});
  Baselines baselines(place.scene());
  const Camera view = cameraAt({0.25, 0.1, 0.1});
  const Image8 truth = renderTruth(place.made, view);
  for (const Image8& picture : {baselines.nearest(view), baselines.lumigraph(view),
                                baselines.crossFade(view, place.scene().cells[0], std::array{0.5, 0.3, 0.2})}) {
    const Image8 mask = shown(picture);
    CHECK(share(mask) > 0.9);
    CHECK(psnr(picture, truth, mask) > 33);  // resampling is the only error
  }
}

TEST_CASE("depth improves the result where an object hides a part of the wall") {
  const Place place({kWall, kSign});
  Baselines baselines(place.scene());
  const Camera view = cameraAt({0.25, 0.15, 0});
  const Image8 truth = renderTruth(place.made, view);
  const auto score = [&](const Image8& picture) { return psnr(picture, truth, shown(picture)); };
  const double lumigraph = score(baselines.lumigraph(view));
  CHECK(lumigraph > 26);
  CHECK(lumigraph > score(baselines.nearest(view)) + 3);
  CHECK(lumigraph > score(baselines.crossFade(view, place.scene().cells[0], std::array{0.4, 0.4, 0.2})) + 3);
}

TEST_CASE("the plane of the nearest photograph is fitted to matched depth, not to completed depth") {
  Place place({kWall});
  const Camera view = cameraAt({0.1, 0, 0});
  const Image8 expected = Baselines(place.scene()).nearest(view);
  DepthMaps guessed = place.exactDepth(0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth * 3 / 4; ++x) {
      guessed.inverseDepth.pixel(x, y)[0] = 0.02f;
      guessed.consensus.pixel(x, y)[0] = 0.1f;
    }
  place.writeDepth(0, guessed);
  CHECK(Baselines(place.scene()).nearest(view) == expected);
  std::ranges::fill(guessed.consensus.values, 0.9f);
  place.writeDepth(0, guessed);
  CHECK(largestDifference(Baselines(place.scene()).nearest(view), expected) > 20);
}

TEST_CASE("photographs without a depth texture are shown at infinity") {
  Place place({kWall, kSign});
  for (Node& node : place.made.scene.nodes) node.depthFile.clear();
  Baselines baselines(place.scene());
  const Camera view = cameraAt({0.1, 0, 0});  // at infinity the photograph does not shift
  CHECK(largestDifference(baselines.nearest(view), place.made.photographs[0]) <= 1);
  const Image8 picture = baselines.lumigraph(view);
  CHECK(share(shown(picture)) > 0.9);
  CHECK(psnr(picture, renderTruth(place.made, view), shown(picture)) < 26);  // depth would improve the picture
}

TEST_CASE("baselines do not depend on the cache size or the thread count") {
  const Place place({kWall, kSign});
  const Camera view = cameraAt({0.25, 0.15, 0});
  Baselines rich(place.scene(), {.threads = 3}), poor(place.scene(), {.cacheBytes = 0, .threads = 1});
  CHECK(rich.lumigraph(view) == poor.lumigraph(view));
  CHECK(rich.lumigraph(view) == rich.lumigraph(view));
  CHECK(rich.nearest(view) == poor.nearest(view));
}

TEST_CASE("pixels that no photograph sees are black and transparent") {
  const Place place({kWall});
  Baselines baselines(place.scene());
  const Camera behind = cameraAt({0, 0, 0}, 3.1), aside = cameraAt({0, 0, 0}, 0.6);
  for (const Image8& picture : {baselines.nearest(behind), baselines.lumigraph(behind)})
    CHECK(std::ranges::all_of(picture.values, [](auto v) { return v == 0; }));
  const Image8 part = baselines.lumigraph(aside);
  CHECK(share(shown(part)) > 0.1);
  CHECK(share(shown(part)) < 0.9);
  CHECK(part.pixel(0, 60)[3] == 0);
  CHECK(part.pixel(kWidth - 1, 60)[3] == 255);
}

TEST_CASE("unsupported scenes and missing photographs are reported") {
  Place place({kWall});
  std::filesystem::remove(place.folder / place.scene().nodes[0].imageFile);
  Baselines baselines(place.scene());
  CHECK_THROWS_WITH(baselines.nearest(cameraAt({0, 0, 0})), Catch::Contains("view0.png"));
  writeImage(place.folder / place.scene().nodes[0].imageFile, Image8(20, 10, 3));
  CHECK_THROWS_WITH(baselines.nearest(cameraAt({0, 0, 0})), Catch::Contains("20×10"));
  CHECK_THROWS_AS(Baselines(Scene()), Error);
  Scene panoramas = place.scene();
  panoramas.nodes[1].camera.intrinsics.model = CameraModel::equirectangular;
  CHECK_THROWS_WITH(Baselines(panoramas), Catch::Contains("view1") && Catch::Contains("panorama"));
  Scene masked = place.scene();
  masked.nodes[1].maskFile = "masks/view1.png";
  CHECK_THROWS_WITH(Baselines(masked), Catch::Contains("view1") && Catch::Contains("--baselines"));
}

TEST_CASE("a depth map that is warped to another view has that view's depth") {
  const Place place({kWall, kSign});
  const Camera view = cameraAt({0.3, 0.1, -0.2}, 0.05);
  const DepthMap from = exactMap(place.made, cameraAt({0, 0, 0}));
  const ImageF exact = exactMap(place.made, view).inverseDepth, warped = warpedDepth(view, from);
  std::size_t known = 0, right = 0;
  for (std::size_t i = 0; i < warped.values.size(); ++i) {
    if (warped.values[i] < 0) continue;
    ++known;
    right += std::abs(warped.values[i] / exact.values[i] - 1) < 0.01f;
  }
  CHECK(double(known) > 0.8 * double(warped.values.size()));
  CHECK(double(right) > 0.97 * double(known));  // all but depth edges
  // Warping a map to its own camera returns the map.
  const ImageF back = warpedDepth(from.camera, from);
  for (int y = 1; y + 1 < kHeight; y += 7)
    for (int x = 1; x + 1 < kWidth; x += 7)
      CHECK(back.pixel(x, y)[0] == Approx(from.inverseDepth.pixel(x, y)[0]).epsilon(1e-4));
}

TEST_CASE("the proxy prefers the depth of two maps to that of one, and has no holes") {
  const Place place({kWall});
  const Camera view = cameraAt({0, 0, 0});
  DepthMap right = exactMap(place.made, view), wrong = right, holed = right;
  for (float& w : wrong.inverseDepth.values) w *= 3;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 30; x < 90; ++x) holed.inverseDepth.pixel(x, y)[0] = kUnknownDepth;
  const auto worst = [&](std::vector<const DepthMap*> maps) {
    const ImageF proxy = proxyDepth(view, maps, 2);
    float largest = 0;
    for (const float w : proxy.values) largest = std::max(largest, std::abs(w - 0.2f));
    return largest;
  };
  CHECK(worst({&wrong, &right, &right}) < 1e-3f);
  CHECK(worst({&holed, &wrong, &right, &right}) < 1e-3f);
  CHECK(worst({&holed}) < 1e-3f);
  const ImageF none = proxyDepth(view, {}, 1);
  CHECK(std::ranges::all_of(none.values, [](float w) { return w == 0; }));
}

TEST_CASE("a lumigraph does not depend on the order of photographs, and hidden surfaces count least") {
  const Place place({kWall, kSign});
  const Camera view = cameraAt({0.25, 0.15, 0});
  const ImageF proxy = exactMap(place.made, view).inverseDepth;
  std::vector<DepthMap> maps;
  for (const Node& node : place.scene().nodes) maps.push_back(exactMap(place.made, node.camera));
  const auto with = [&](const std::vector<std::size_t>& order, int best) {
    LumigraphImage picture(view, proxy, {.best = best, .threads = 2});
    for (const std::size_t i : order) picture.add(maps[i].camera, place.made.photographs[i], maps[i]);
    return picture.picture();
  };
  CHECK(with({0, 1, 2}, 2) == with({2, 0, 1}, 2));
  // In the far left photograph the sign hides wall that `view` sees: its colours must yield to another photograph's.
  const Camera left = cameraAt({-1.2, 0.1, 0});
  const DepthMap leftMap = exactMap(place.made, left);
  const Image8 leftPicture = renderTruth(place.made, left), truth = renderTruth(place.made, view);
  LumigraphImage alone(view, proxy), both(view, proxy);
  alone.add(left, leftPicture, leftMap);
  both.add(left, leftPicture, leftMap);
  both.add(maps[1].camera, place.made.photographs[1], maps[1]);
  const Image8 mask = shown(alone.picture());
  CHECK(psnr(both.picture(), truth, mask) > psnr(alone.picture(), truth, mask) + 3);
}
