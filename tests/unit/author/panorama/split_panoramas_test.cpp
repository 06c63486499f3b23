// SPDX-License-Identifier: Apache-2.0
// Splitting panoramas into pinhole pictures, with input and output as COLMAP models.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <random>

#include "author/panorama/panorama_faces.h"
#include "base/file.h"
#include "ibr/author/panorama.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;
namespace fs = std::filesystem;

namespace {

constexpr double kPi = std::numbers::pi;

Intrinsics sphere(int width, int height) {
  return {CameraModel::equirectangular, width, height};
}

Image8 painted(int width, int height, const std::function<glm::dvec3(glm::dvec3)>& colour) {
  Image8 panorama(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 c = colour(unproject(sphere(width, height), {x + 0.5, y + 0.5}));
      for (int i = 0; i < 3; ++i) panorama.pixel(x, y)[i] = std::uint8_t(std::lround(c[i]));
    }
  return panorama;
}

Image8 noise(int width, int height, int channels, unsigned seed = 1) {
  std::mt19937 random(seed);
  Image8 image(width, height, channels);
  for (auto& v : image.values) v = std::uint8_t(random() >> 24);
  return image;
}

Image8 channel(const Image8& image, int c) {
  Image8 one(image.width, image.height, 1);
  for (std::size_t i = 0; i < one.values.size(); ++i) one.values[i] = image.values[i * image.channels + c];
  return one;
}

std::vector<PanoramaFace> manyFaces() {
  std::vector<PanoramaFace> faces = cubeFaces();
  for (PanoramaFace& face : horizonFaces(7)) faces.push_back(face);
  faces.push_back({"tilted", glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2))});
  return faces;
}

ErrorCode codeOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    INFO(error.what());
    return error.code();
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace

TEST_CASE("a panorama with a colour on each axis is split into faces of those colours", "[N10][T19]") {
  const auto axisOf = [](glm::dvec3 d) {
    const glm::dvec3 a = glm::abs(d);
    const int c = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    glm::dvec3 colour(40);
    colour[c] = d[c] > 0 ? 250 : 140;
    return colour;
  };
  const PanoramaSampler sampler(painted(512, 256, axisOf));
  for (const PanoramaFace& face : cubeFaces()) {
    const Intrinsics k = faceIntrinsics(101, 105 * kPi / 180);
    const Image8 picture = sampler.view(k, face.rotation);
    int checked = 0;
    for (int y = 0; y < k.height; ++y)
      for (int x = 0; x < k.width; ++x) {
        const glm::dvec3 d = face.rotation * unproject(k, {x + 0.5, y + 0.5}), a = glm::abs(d);
        const double most = std::max({a.x, a.y, a.z}), least = std::min({a.x, a.y, a.z});
        if (most - (a.x + a.y + a.z - most - least) < 0.06) continue;  // near an edge of the cube
        const glm::dvec3 expected = axisOf(d);
        for (int c = 0; c < 3; ++c) REQUIRE(picture.pixel(x, y)[c] == std::uint8_t(expected[c]));
        ++checked;
      }
    CHECK(checked > 7500);
  }
}

TEST_CASE("a face has the panorama's colour in each direction, at the seam, at the poles and for any rotation") {
  const auto colour = [](glm::dvec3 d) {
    return 127.5 + 80.0 * d + 40.0 * glm::dvec3(d.y * d.z, d.x * d.z, d.x * d.y);
  };
  const PanoramaSampler sampler(painted(1024, 512, colour));
  for (const PanoramaFace& face : manyFaces())
    for (const double fov : {30.0, 105.0, 170.0}) {
      const Intrinsics k = faceIntrinsics(97, fov * kPi / 180);
      const Image8 picture = sampler.view(k, face.rotation);
      double worst = 0;
      for (int y = 0; y < k.height; ++y)
        for (int x = 0; x < k.width; ++x) {
          const glm::dvec3 expected = colour(face.rotation * unproject(k, {x + 0.5, y + 0.5}));
          for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(picture.pixel(x, y)[c] - expected[c]));
        }
      INFO(face.name << " " << fov);
      // Both pictures are rounded, each by half a level; the widest views have pixels of up to 13°.
      CHECK(worst < (fov > 160 ? 2.2 : 1.1));
    }
}

TEST_CASE("a uniform panorama gives uniform faces, of every size and channel count") {
  for (const int value : {0, 1, 127, 254, 255})
    for (const int channels : {1, 2, 3, 4}) {
      const PanoramaSampler sampler(Image8(64, 32, channels, std::uint8_t(value)));
      for (const PanoramaFace& face : cubeFaces())
        for (const int size : {1, 5, 70}) {
          const Image8 picture = sampler.view(faceIntrinsics(size, 1.9), face.rotation);
          REQUIRE(picture == Image8(size, size, channels, std::uint8_t(value)));
        }
    }
}

TEST_CASE("a magnified pixel of the panorama keeps its colour") {
  const int width = 64, height = 32;
  const Image8 panorama = noise(width, height, 3);
  const PanoramaSampler sampler(panorama);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 d = unproject(sphere(width, height), {x + 0.5, y + 0.5});
      const glm::dquat turn = glm::angleAxis(std::atan2(-d.x, -d.z), glm::dvec3(0, 1, 0)) *
                              glm::angleAxis(std::asin(d.y), glm::dvec3(1, 0, 0));
      const Image8 picture = sampler.view({CameraModel::pinhole, 1, 1, 1e5, 1e5, 0.5, 0.5}, turn);
      for (int c = 0; c < 3; ++c) REQUIRE(std::abs(picture.pixel(0, 0)[c] - panorama.pixel(x, y)[c]) <= 1);
    }
}

TEST_CASE("channels are resampled independently") {
  const Image8 three = noise(90, 45, 3), four = noise(90, 45, 4, 2);
  for (const PanoramaFace& face : manyFaces()) {
    const Intrinsics k = faceIntrinsics(53, 1.8);  // 53 is not a multiple of the row's run length
    for (const Image8* panorama : {&three, &four}) {
      const Image8 picture = PanoramaSampler(*panorama).view(k, face.rotation);
      for (int c = 0; c < panorama->channels; ++c)
        REQUIRE(channel(picture, c) == PanoramaSampler(channel(*panorama, c)).view(k, face.rotation));
    }
  }
}

TEST_CASE("detail finer than a pixel is averaged, also near the poles") {
  Image8 stripes(1024, 512, 1);
  for (std::size_t i = 0; i < stripes.values.size(); ++i) stripes.values[i] = i % 2 ? 255 : 0;
  const PanoramaSampler sampler(stripes);
  for (const PanoramaFace& face : cubeFaces()) {
    const Image8 small = sampler.view(faceIntrinsics(40, kPi / 2), face.rotation);
    for (const std::uint8_t v : small.values) REQUIRE(std::abs(v - 127.5) < 40);
  }
  const int size = faceSize(1024, kPi / 2);
  for (const std::size_t pole : {4, 5}) {
    const Image8 full = sampler.view(faceIntrinsics(size, kPi / 2), cubeFaces()[pole].rotation);
    for (int y = size * 2 / 5; y < size * 3 / 5; ++y)
      for (int x = size * 2 / 5; x < size * 3 / 5; ++x) REQUIRE(std::abs(full.pixel(x, y)[0] - 127.5) < 50);
  }
}

TEST_CASE("views around the horizon turn right in equal steps, and four of them are the sides of the cube") {
  const auto four = horizonFaces(4), cube = cubeFaces();
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(std::abs(glm::dot(four[i].rotation, cube[i].rotation)) == Approx(1).margin(1e-12));
  REQUIRE(horizonFaces(1).size() == 1);
  CHECK(horizonFaces(1)[0].rotation == glm::dquat(1, 0, 0, 0));
  CHECK(horizonFaces(12)[3].name == "view03");
  CHECK(horizonFaces(360)[359].name == "view359");
  for (const int count : {0, -1, 361}) CHECK(codeOf([&] { horizonFaces(count); }) == ErrorCode::invalidInput);
}

TEST_CASE("the smallest panoramas are split, and invalid ones are rejected") {
  Image8 two(2, 1, 3);  // left half black, right half white
  for (int c = 0; c < 3; ++c) two.pixel(1, 0)[c] = 255;
  const PanoramaSampler sampler(two);
  CHECK(sampler.view(faceIntrinsics(1, 1.0), cubeRotations()[1]).pixel(0, 0)[0] == 255);
  CHECK(sampler.view(faceIntrinsics(1, 1.0), cubeRotations()[3]).pixel(0, 0)[0] == 0);
  CHECK(std::abs(sampler.view(faceIntrinsics(1, 1.0), cubeRotations()[0]).pixel(0, 0)[0] - 128) <= 1);
  CHECK(PanoramaSampler(Image8(1, 1, 3, 9)).view(faceIntrinsics(3, 3.0), {1, 0, 0, 0}) == Image8(3, 3, 3, 9));
  CHECK(codeOf([] { PanoramaSampler{Image8()}; }) == ErrorCode::invalidInput);
  CHECK(codeOf([] { PanoramaSampler{Image8(2, 1, 5)}; }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] { sampler.view(sphere(4, 2), {1, 0, 0, 0}); }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] {
          sampler.view({CameraModel::pinhole, 4, 4, 0, 1, 2, 2}, {1, 0, 0, 0});
        }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] {
          sampler.view({CameraModel::pinhole, 4, 4, 1, 1, NAN, 2}, {1, 0, 0, 0});
        }) == ErrorCode::invalidInput);
}

TEST_CASE("a COLMAP model round trips through its files") {
  const TemporaryFolder folder;
  PosedModel model = modelOf({lookingAlong({1, 2, 3}, {1, 0.2, 0.1}), lookingAlong({-1, 2.5, 3}, {1, 0, 0.3}, 64, 48),
                              lookingAlong({0, 0, 1}, {0.7, 0.7, 0})},
                             pointsAround({6, 2, 3}, 2, 40));
  model.images[1].name = "a folder/with blanks.png";
  model.images[2].camera.intrinsics = sphere(200, 100);
  REQUIRE(!model.tracks.empty());
  writeColmapModel(model, folder / "made/here");
  const PosedModel read = readColmapModel(folder / "made/here");
  REQUIRE(read.images.size() == 3);
  std::map<std::string, std::uint32_t> number;
  for (std::uint32_t i = 0; i < 3; ++i) number[read.images[i].name] = i;
  for (const PosedImage& image : model.images) {
    const Camera& back = read.images[number.at(image.name)].camera;
    CHECK(back.intrinsics == image.camera.intrinsics);
    CHECK(glm::distance(back.pose.position, image.camera.pose.position) < 1e-12);
    CHECK(std::abs(glm::dot(back.pose.rotation, image.camera.pose.rotation)) == Approx(1).margin(1e-12));
  }
  REQUIRE(read.tracks.size() == model.tracks.size());
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    CHECK(read.tracks[t].position == model.tracks[t].position);
    std::map<std::uint32_t, glm::dvec2> seen;
    for (const TrackObservation& o : read.tracks[t].observations) seen[o.image] = o.pixel;
    REQUIRE(seen.size() == model.tracks[t].observations.size());
    for (const TrackObservation& o : model.tracks[t].observations)
      CHECK(seen.at(number.at(model.images[o.image].name)) == o.pixel);
  }

  for (const char* bad : {"", " a.png", "a.png\t", "a\nb.png"}) {
    PosedModel wrong = model;
    wrong.images[0].name = bad;
    CHECK(codeOf([&] { writeColmapModel(wrong, folder / "wrong"); }) == ErrorCode::invalidInput);
  }
  model.tracks[0].observations[0].image = 3;
  CHECK(codeOf([&] { writeColmapModel(model, folder / "wrong"); }) == ErrorCode::invalidInput);
  CHECK(!fs::exists(folder / "wrong"));
}

TEST_CASE("all posed panoramas of a folder are split, with the points they share") {
  const TemporaryFolder folder;
  std::vector<Camera> cameras;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {1, 0, 0.2}})
    cameras.push_back({sphere(128, 64), {place, glm::normalize(glm::dquat(1, 0.1, place.x, -0.05))}});
  cameras.push_back(lookingAlong({0, 1, 0}, {1, 0, 0}));
  PosedModel model = modelOf(cameras, pointsAround({0.4, 0, 0}, 3, 50));
  model.images[0].name = "all/first.png";
  model.images[1].name = "all/below/second.png";
  for (const int i : {0, 1}) {
    const fs::path file = folder / "photos" / model.images[i].name;
    fs::create_directories(file.parent_path());
    writeImage(file, noise(128, 64, 3, unsigned(i)));
  }
  writeColmapModel(model, folder / "sparse");

  SplitOptions options;
  options.input = folder / "photos";
  options.model = folder / "sparse";
  options.output = folder / "split";
  options.threads = 1;
  const SplitReport report = splitPanoramas(options);
  CHECK(report.panoramas == 2);
  CHECK(report.pictures == 12);
  CHECK(report.size == faceSize(128, 105 * kPi / 180));
  CHECK(report.skipped == std::vector<std::string>{"002.png"});

  const PosedModel split = readColmapModel(folder / "split/sparse");
  REQUIRE(split.images.size() == 12);
  CHECK(split.images[0].name == "below/second_back.png");
  CHECK(split.images[11].name == "first_up.png");
  for (const PosedImage& image : split.images) {
    const Image8 picture = readImage(folder / "split/images" / image.name);
    CHECK(picture.width == image.camera.intrinsics.width);
  }
  REQUIRE(split.tracks.size() == model.tracks.size());
  std::size_t observations = 0;
  for (const Track& track : split.tracks)
    for (const TrackObservation& o : track.observations) {
      const auto& [k, pose] = split.images[o.image].camera;
      const auto at = project(k, glm::conjugate(pose.rotation) * (track.position - pose.position));
      REQUIRE(at);
      CHECK(glm::distance(*at, o.pixel) < 1e-6);
      ++observations;
    }
  CHECK(observations == report.observations);
  CHECK(observations >= 2 * model.tracks.size());  // faces overlap and leave no direction uncovered

  SplitOptions again = options;
  again.threads = 3;
  again.output = folder / "again";
  splitPanoramas(again);
  for (const auto& entry : fs::recursive_directory_iterator(options.output))
    if (entry.is_regular_file())
      CHECK(readFile(entry.path()) == readFile(again.output / entry.path().lexically_relative(options.output)));

  SECTION("invalid options and missing files are reported") {
    SplitOptions wrong = options;
    for (const double fov : {0.0, -1.0, 180.0, 400.0, double(NAN)}) {
      wrong.fovDegrees = fov;
      CHECK(codeOf([&] { splitPanoramas(wrong); }) == ErrorCode::invalidInput);
    }
    wrong = options;
    wrong.fovDegrees = 179.9999;
    CHECK(codeOf([&] { splitPanoramas(wrong); }) == ErrorCode::invalidInput);
    wrong = options;
    wrong.model.clear();
    CHECK(codeOf([&] { splitPanoramas(wrong); }) == ErrorCode::invalidInput);
    wrong.input = folder / "nothing.png";
    CHECK(codeOf([&] { splitPanoramas(wrong); }) == ErrorCode::io);
    fs::remove(folder / "photos/all/first.png");
    CHECK(codeOf([&] { splitPanoramas(options); }) == ErrorCode::io);
  }
  SECTION("a cancelled split leaves no model") {
    SplitOptions stopped = options;
    stopped.output = folder / "stopped";
    CHECK(codeOf([&] { splitPanoramas(stopped, [](const Progress& p) { return p.done < 7; }); }) ==
          ErrorCode::cancelled);
    CHECK(!fs::exists(stopped.output / "sparse"));
  }
}

TEST_CASE("a single panorama is placed at the origin, unrotated") {
  const TemporaryFolder folder;
  writeImage(folder / "pano.jpg", Image8(60, 30, 3, 200));
  SplitOptions options;
  options.input = folder / "pano.jpg";
  options.output = folder / "split";
  options.views = 3;
  options.poles = true;
  options.size = 9;
  options.fovDegrees = 120;
  splitPanoramas(options);
  const PosedModel split = readColmapModel(folder / "split/sparse");
  REQUIRE(split.images.size() == 5);
  CHECK(split.images[0].name == "pano_down.jpg");
  CHECK(split.images[2].name == "pano_view00.jpg");
  CHECK(glm::distance(viewAxis(split.images[2].camera.pose), {0, 0, -1}) < 1e-12);
  for (const PosedImage& image : split.images) {
    CHECK(glm::length(image.camera.pose.position) < 1e-12);
    CHECK(image.camera.intrinsics == faceIntrinsics(9, 120 * kPi / 180));
  }
}
