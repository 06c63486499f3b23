// SPDX-License-Identifier: Apache-2.0
// Masks of photographs: read from files, and found for moving objects.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core/version.hpp>

#include "author/build/find_movers.h"
#include "author/depth/photograph_sweep.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"
#include "author/match/match.h"
#include "author/match/matcher_choice.h"
#include "author/mesh/mesh.h"
#include "author/movers/movers.h"
#include "author/movers/settle_movers.h"
#include "author/photographs/masks.h"
#include "base/file.h"
#include "ibr/author/photographs.h"
#include "ibr/texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/error_of.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

// Three cameras, a wall, and a static board in front of the wall's left half.
struct Place {
  SyntheticScene scene;
  std::vector<Camera> cameras;
  std::vector<MatchView> views;
  std::vector<glm::dvec3> points;

  Place() {
    for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {0.5, 0, 0.05}, {0.2, 0.05, 0.35}})
      cameras.push_back(lookingAlong(at, {0, 1, 0}, 320, 240));
    SyntheticOptions options;
    options.cameras = cameras;
    options.planes = {{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.16},
                      {{-0.7, 3.2, 0.1}, {1, 0, 0}, {0, 0, 1}, 0.9, 1.2, 2, 0.08}};
    options.samplesPerAxis = 3;
    scene = makeScene(options);
    for (std::size_t i = 0; i < 3; ++i) views.push_back({cameras[i], scene.photographs[i]});
    for (int i = 0; i < 120; ++i) points.emplace_back(-1.2 + 0.02 * i, i % 3 ? 5.0 : 3.2, 0.01 * i - 0.6);
  }
  std::vector<MatchView> othersOf(std::size_t i) const {
    std::vector<MatchView> others;
    for (std::size_t j = 0; j < 3; ++j)
      if (j != i) others.push_back(views[j]);
    return others;
  }
};

constexpr int kLeft = 200, kTop = 90, kRight = 250, kBottom = 200;  // box of the person in the first photograph, px

// Draws a person with patterned clothes, `shift` px from the person's position in the first photograph.
void plant(Image8& picture, glm::ivec2 shift = {0, 0}) {
  const TexturedPlane clothes{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 10, 10, 77, 0.1};
  for (int y = kTop; y < kBottom; ++y)
    for (int x = kLeft; x < kRight; ++x) {
      const glm::dvec3 colour = textureColour(clothes, glm::dvec2(x, y) / 80.0);
      for (std::size_t c = 0; c < 3; ++c)
        picture.pixel(x + shift.x, y + shift.y)[c] = std::uint8_t(c == 0 ? 40 + colour.x / 2 : colour[int(c)] / 3);
    }
}

std::vector<ImageF> sweptDepths(const Place& place) {
  std::vector<SweepView> views;
  for (const MatchView& view : place.views) {
    SweepView& half = views.emplace_back();
    half.camera = {resized(view.camera.intrinsics, 160, 120), view.camera.pose};
    const Image8 grey = toGrey(downscaled(view.picture, 160, 120));
    half.grey = ImageF(160, 120, 1);
    std::ranges::copy(grey.values, half.grey.values.begin());
  }
  std::vector<ImageF> result;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<SweepView> others;
    for (std::size_t j = 0; j < views.size(); ++j)
      if (j != i) others.push_back(views[j]);
    std::vector<double> tracks;
    for (const glm::dvec3& point : place.points) tracks.push_back(inverseDepth(views[i].camera, point));
    result.push_back(sweptDepth(views[i], others, sweepRange(tracks)).inverseDepth);
  }
  return result;
}

std::vector<BitMask> moversIn(const Place& place) {
  std::vector<ComparedView> judged;
  const std::vector<ImageF> depths = sweptDepths(place);
  for (std::uint32_t i = 0; i < 3; ++i) {
    DifferingRegions found = differingRegions(place.views[i], place.othersOf(i), depths[i]);
    const Camera& camera = place.cameras[i];
    judged.push_back({{resized(camera.intrinsics, found.width, found.height), camera.pose},
                      {(i == 0) ? 1u : 0u, (i == 2) ? 1u : 2u},
                      std::move(found)});
  }
  return resolveMoverMasks(judged);
}

Photograph photographOf(const fs::path& file, int width, int height) {
  writeImage(file, Image8(width, height, 3, 90));
  return findPhotograph(file.parent_path(), {file.filename().string(), {pinholeFromFov(width, height, 0.9), {}}}, 0);
}

}  // namespace

TEST_CASE("masks are found by COLMAP's file names, and must have the photograph's size") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "masks/a");
  writeImage(folder / "masks/a/one.jpg.png", Image8(8, 6, 1, 255));
  writeImage(folder / "masks/a/two.png", Image8(8, 6, 1, 255));
  CHECK(findMaskFile(folder / "masks", "a/one.jpg") == folder / "masks/a/one.jpg.png");
  CHECK(findMaskFile(folder / "masks", "a/two.jpg") == folder / "masks/a/two.png");
  CHECK(findMaskFile(folder / "masks", "a/three.jpg") == std::nullopt);

  const Photograph photo = photographOf(folder / "three.png", 8, 8);
  const Error wrong = errorOf([&] { loadMask(photo, folder / "masks/a/two.png"); });
  CHECK(wrong.code() == ErrorCode::invalidInput);
  CHECK_THAT(wrong.what(), Contains("two.png") && Contains("three.png") && Contains("8 × 6") && Contains("8 × 8"));
  writeFile(folder / "masks/three.png", std::string_view("no picture"));
  CHECK_THAT(errorOf([&] { loadMask(photo, folder / "masks/three.png"); }).what(), Contains("three.png"));
}

TEST_CASE("pixels whose mask is not 0 are used, at any size") {
  const TemporaryFolder folder;
  Photograph photo = photographOf(folder / "photo.png", 64, 48);
  Image8 labels(64, 48, 1, 1);  // 0 and 1, as segmentation tools write labels
  for (int y = 8; y < 24; ++y)
    for (int x = 16; x < 32; ++x) labels.pixel(x, y)[0] = 0;
  writeImage(folder / "mask.png", labels);
  CHECK(ignoredShare(loadMask(photo, folder / "mask.png")) == Approx(256.0 / (64 * 48)));
  photo.camera.intrinsics = resized(photo.camera.intrinsics, 32, 24);
  const Image8 half = loadMask(photo, folder / "mask.png");
  REQUIRE(half.width == 32);
  CHECK(ignoredShare(half) == Approx(64.0 / (32 * 24)));
  CHECK(isIgnored(half, {8.5f, 4.5f}));
  CHECK_FALSE(isIgnored(half, {7.5f, 4.5f}));
  CHECK_FALSE(isIgnored(half, {-100.0f, 1000.0f}));
  CHECK_FALSE(isIgnored({}, {3, 3}));
  // A reduced pixel is masked from a quarter of its area on: four of 16 pixels suffice, one does not.
  Image8 few(64, 48, 1, 255);
  few.pixel(5, 5)[0] = 0;
  CHECK(ignoredShare(few) == Approx(1.0 / (64 * 48)));
  CHECK(ignoredShare(resizedMask(few, 16, 12)) == 0);
  CHECK(ignoredShare(widenedMask(few, 2)) == Approx(25.0 / (64 * 48)));
  few.pixel(6, 5)[0] = few.pixel(5, 6)[0] = few.pixel(6, 6)[0] = 0;
  CHECK(ignoredShare(resizedMask(few, 16, 12)) == Approx(1.0 / (16 * 12)));
}

TEST_CASE("a texture has surrounding colours under its mask, and is unchanged elsewhere") {
  Image8 picture(61, 40, 3);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 61; ++x) picture.pixel(x, y)[0] = 100, picture.pixel(x, y)[1] = std::uint8_t(x);
  const Image8 before = picture;
  Image8 mask(61, 40, 1, 255);
  for (int y = 10; y < 25; ++y)
    for (int x = 20; x < 40; ++x) {
      mask.pixel(x, y)[0] = 0;
      picture.pixel(x, y)[0] = picture.pixel(x, y)[2] = 255;
    }
  const Image8 masked = withMask(picture, mask);
  std::size_t other = 0, garish = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 61; ++x) {
      const bool gone = !mask.pixel(x, y)[0];
      other += masked.pixel(x, y)[3] != (gone ? 0 : 255);
      for (std::size_t c = 0; c < 3; ++c)
        if (!gone) other += masked.pixel(x, y)[c] != before.pixel(x, y)[c];
      garish += std::abs(masked.pixel(x, y)[0] - 100) > 3 || masked.pixel(x, y)[2] > 3;
    }
  CHECK(other == 0);
  CHECK(garish == 0);
  const Image8 all(61, 40, 1, 0);
  CHECK((withMask(picture, all).pixel(5, 5)[3] == 0));  // all pixels masked: no colour to extend
}

TEST_CASE("observations under masks are dropped, and so are tracks without observations") {
  PosedModel model = modelOf({lookingAlong({0, 0, 0}, {0, 1, 0}, 64, 48), lookingAlong({1, 0, 0}, {0, 1, 0}, 64, 48)},
                             {{0.5, 4, 0}, {0.2, 4, 0.3}});
  REQUIRE(model.tracks.size() == 2);
  const glm::dvec2 first = model.tracks[0].observations[0].pixel;
  Image8 mask(128, 96, 1, 255);  // twice the camera's size
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) mask.pixel(int(2 * first.x) + x, int(2 * first.y) + y)[0] = 0;
  std::vector<std::vector<std::uint32_t>> tracksOf = tracksOfImages(model);
  dropMaskedObservations(model, 0, tracksOf[0], mask);
  dropMaskedObservations(model, 1, tracksOf[1], {});
  dropUnobservedTracks(model);
  REQUIRE(model.tracks.size() == 2);
  CHECK(model.tracks[0].observations.size() == 1);
  CHECK(model.tracks[1].observations.size() == 2);
  tracksOf = tracksOfImages(model);
  for (std::uint32_t i = 0; i < 2; ++i) dropMaskedObservations(model, i, tracksOf[i], Image8(64, 48, 1, 0));
  dropUnobservedTracks(model);
  CHECK(model.tracks.empty());
}

TEST_CASE("where one member is masked the other two are matched, where two are masked nothing is") {
  Place place;
  plant(place.views[0].picture);
  const auto goodIn = [&](const DenseMatch& match) {  // of the pixels that show the person
    double good = 0, all = 0;
    for (int y = 0; y < match.good.height; ++y)
      for (int x = 0; x < match.good.width; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(match.good.width) + std::size_t(x);
        const float u = match.position[0].values[2 * at], v = match.position[0].values[2 * at + 1];
        if (u < kLeft + 6 || u > kRight - 6 || v < kTop + 6 || v > kBottom - 6) continue;
        all += 1;
        good += match.good.values[at];
      }
    REQUIRE(all > 1000);
    return good / all;
  };
  CHECK(goodIn(matchViews(place.views, place.points)) < 0.3);
  Image8 mask(320, 240, 1, 255);
  for (int y = kTop; y < kBottom; ++y)
    for (int x = kLeft; x < kRight; ++x) mask.pixel(x, y)[0] = 0;
  place.views[0].mask = mask;
  const bool refine = GENERATE(false, true);
  const DenseMatch match = matchViews(place.views, place.points, {refine});
  CHECK(goodIn(match) > 0.9);
  const CellMesh cell = buildMesh(place.cameras, place.views, match);
  double agreeing = 0;
  for (std::size_t t = 0; t < cell.mesh.triangles.size(); ++t) {
    const glm::uvec3 v = cell.mesh.triangles[t];
    const glm::vec2 centre = (cell.mesh.match[0][v.x] + cell.mesh.match[0][v.y] + cell.mesh.match[0][v.z]) / 3.0f;
    if (centre.x < kLeft + 6 || centre.x > kRight - 6 || centre.y < kTop + 6 || centre.y > kBottom - 6) continue;
    agreeing += cell.mesh.tier[t] == kTierConsistent ? 1 : -4;
  }
  CHECK(agreeing > 0);  // at least four of five triangles agree
  place.views[1].mask = Image8(320, 240, 1, 0);
  CHECK(goodIn(matchViews(place.views, place.points)) == 0);
}

TEST_CASE("flow and homographies ignore masked pixels") {
  const MatchMethod method = GENERATE(MatchMethod::flow, MatchMethod::homographic);
  INFO(matchMethodName(method));
  Place place;
  const auto goodIn = [&] {  // of pixels of the second photograph with the person; the first photograph is the frame
    CellMatchOptions options;
    options.matcher = method;
    const DenseMatch match = matchCell(place.views, place.points, options);
    double good = 0, all = 0;
    for (int y = 0; y < match.good.height; ++y)
      for (int x = 0; x < match.good.width; ++x) {
        const auto at = match.position[1].pixel(x, y);
        if (at[0] < kLeft + 8 || at[0] > kRight - 8 || at[1] < kTop + 8 || at[1] > kBottom - 8) continue;
        good += match.good.pixel(x, y)[0];
        all += 1;
      }
    REQUIRE(all > 1000);
    return good / all;
  };
  const bool flow = method == MatchMethod::flow;
  // OpenCV 4.10's flow finds 0.40 of them, 4.6's 0.99.
  constexpr double kFlow = 100 * CV_VERSION_MAJOR + CV_VERSION_MINOR >= 410 ? 0.35 : 0.9;
  CHECK(goodIn() > (flow ? kFlow : 0.9));
  plant(place.views[1].picture);
  CHECK(goodIn() < (flow ? 0.1 : 0.3));
  place.views[1].mask = Image8(320, 240, 1, 255);
  for (int y = kTop; y < kBottom; ++y)
    for (int x = kLeft; x < kRight; ++x) place.views[1].mask.pixel(x, y)[0] = 0;
  CHECK(goodIn() > (flow ? 0.8 : 0.3));  // the others agree; tracks need all members
  place.views[0].mask = Image8(320, 240, 1, 0);
  CHECK(goodIn() == 0);
}

TEST_CASE("a person in one photograph alone is found, and nothing is found without a person") {
  Place place;
  for (const BitMask& mask : moversIn(place)) CHECK(mask.empty());
  plant(place.views[0].picture);
  const std::vector<BitMask> masks = moversIn(place);
  REQUIRE(masks[0].width() == 160);
  const Image8 mask = maskOf(masks[0], 160, 120);
  double inside = 0, found = 0, beside = 0;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      const bool gone = !mask.pixel(x, y)[0];
      const bool inPerson = 2 * x >= kLeft && 2 * x < kRight && 2 * y >= kTop && 2 * y < kBottom;
      const bool near = 2 * x >= kLeft - 12 && 2 * x < kRight + 12 && 2 * y >= kTop - 12 && 2 * y < kBottom + 12;
      inside += inPerson;
      found += inPerson && gone;
      beside += !near && gone;
    }
  CHECK(found / inside > 0.97);
  CHECK(beside / inside < 0.05);
  // The other photographs are not masked.
  CHECK(masks[1].empty());
  CHECK(masks[2].empty());
}

TEST_CASE("a static person is no moving object, although the depth is that of the wall behind") {
  constexpr double kPerson = 3.2, kWall = 5;  // units in front of the cameras
  Place place;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 at = place.cameras[i].pose.position;
    const double px = place.cameras[i].intrinsics.fx / kPerson;
    plant(place.views[i].picture, {int(std::lround(-px * at.x)), int(std::lround(px * at.z))});
  }
  const auto regionsUpTo = [&](double inverseDepth) {
    ImageF depth(160, 120, 1, float(1 / kWall));
    depth.values[0] = float(inverseDepth);
    return differingRegions(place.views[0], place.othersOf(0), depth).regions.size();
  };
  CHECK(regionsUpTo(1.2 / kPerson) == 0);
  CHECK(regionsUpTo(1 / kWall) > 0);  // no depth as near as the person is tried
  // The share that looks alike at the person's depth decides.
  ImageF depth(160, 120, 1, float(1 / kWall));
  depth.values[0] = float(1.2 / kPerson);
  CHECK_FALSE(differingRegions(place.views[0], place.othersOf(0), depth, {.maxStaticShare = 1}).regions.empty());
}

TEST_CASE("a region outside the limits of difference and area is no moving object") {
  Place place;
  plant(place.views[0].picture);
  const ImageF depth = sweptDepths(place)[0];
  const auto regions = [&](const MoverParameters& parameters) {
    return differingRegions(place.views[0], place.othersOf(0), depth, parameters).regions.size();
  };
  CHECK(regions({}) > 0);
  CHECK(regions({.minDifference = 255}) == 0);
  CHECK(regions({.minCoreDifference = 255}) == 0);
  CHECK(regions({.minArea = 0.5}) == 0);
  CHECK(regions({.maxArea = 0.001}) == 0);  // so much moves that no photograph can judge
}
