// SPDX-License-Identifier: Apache-2.0
// Feature detection, guided matching and track building.
#include "author/features/tracks.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include "author/features/feature_cache.h"
#include "author/geometry/posed_model.h"
#include "base/file.h"
#include "ibr/error.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

namespace {

// Three cameras before a textured wall and a panel in front.
SyntheticScene wallSeenBy(const std::vector<Camera>& cameras) {
  SyntheticOptions options;
  options.cameras = cameras;
  options.cells = {{0, 1}};  // not used
  options.planes = {{{0, 4, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.2},
                    {{0.2, 3, 0.1}, {1, 0, 0}, {0, 0, 1}, 1, 1, 2, 0.15}};
  options.samplesPerAxis = 2;
  return makeScene(options);
}

std::vector<Camera> threeCameras() {
  return {lookingAlong({0, 0, 0}, {0, 1, 0}, 256, 192), lookingAlong({0.4, 0, 0.05}, {-0.1, 1, 0}, 256, 192),
          lookingAlong({0.1, 0.1, 0.4}, {0, 1, -0.1}, 256, 192)};
}

double depthAt(glm::dvec3 point) {
  return point.y;
}

struct Made {
  PosedModel model;
  std::vector<ImagePair> pairs;
  OwnTracksInput input;
};

Made inputFor(const SyntheticScene& scene, const std::vector<Camera>& cameras, const fs::path& cacheFolder) {
  Made made{modelOf(cameras, {}), {}, {}};
  made.pairs = pairsWithoutTracks(made.model);
  made.input.view = [&scene, cameras](std::size_t i) { return MatchView{cameras[i], scene.photographs[i]}; };
  made.input.cameras = cameras;
  for (std::uint64_t i = 0; i < cameras.size(); ++i) made.input.hashes.push_back(i + 1);
  made.input.cacheFolder = cacheFolder;
  return made;
}

void runOneByOne(std::string_view, std::size_t count, double, const std::function<void(std::size_t)>& job) {
  for (std::size_t i = 0; i < count; ++i) job(i);
}

Features randomFeatures(std::size_t count, int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Features features;
  for (std::size_t i = 0; i < count; ++i) {
    features.at.push_back({float(random() % unsigned(width * 8)) / 8, float(random() % unsigned(height * 8)) / 8});
    auto& d = features.descriptor.emplace_back();
    for (auto& v : d) v = std::int16_t(random() % 90);
    features.first.push_back(features.first.back() + 1);
  }
  return features;
}

}  // namespace

TEST_CASE("a blob of any size is located to a tenth of a pixel") {
  for (const double sigma : {2.5, 3.0, 4.0})
    for (const glm::dvec2 at : {glm::dvec2(64.0, 48.0), {64.5, 48.5}, {61.3, 50.8}}) {
      Image8 picture(128, 96, 1);
      for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 128; ++x) {
          const double dx = x + 0.5 - at.x, dy = y + 0.5 - at.y;
          const double value = 40 + 180 * std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma));
          picture.pixel(x, y)[0] = std::uint8_t(std::lround(value));
        }
      const Features found = detectFeatures(picture, 1000);
      double nearest = 1e9;
      for (const glm::vec2 p : found.at) nearest = std::min(nearest, glm::distance(glm::dvec2(p), at));
      INFO(sigma << " " << at.x << " " << at.y);
      CHECK(nearest < 0.1);
    }
}

TEST_CASE("cached features are read whole or not at all") {
  const TemporaryFolder folder;
  const Features features = randomFeatures(17, 100, 100, 3);
  CHECK_FALSE(fetchFeatures(folder / "f"));
  storeFeatures(folder / "f", features);
  const auto back = fetchFeatures(folder / "f");
  REQUIRE(back);
  CHECK(back->at == features.at);
  CHECK(back->descriptor == features.descriptor);
  std::vector<std::byte> bytes = readFile(folder / "f");
  for (const std::size_t length : {std::size_t(0), std::size_t(5), bytes.size() / 2, bytes.size() - 1}) {
    writeFile(folder / "f", std::span(bytes).first(length));
    CHECK_FALSE(fetchFeatures(folder / "f"));
  }
  bytes[40] ^= std::byte(1);
  writeFile(folder / "f", bytes);
  CHECK_FALSE(fetchFeatures(folder / "f"));
  storeFeatures(folder / "f", {});
  CHECK(fetchFeatures(folder / "f")->at.empty());
}

TEST_CASE("guided matches satisfy the epipolar line, the depth sign and the ratio test") {
  const std::vector<Camera> cameras = threeCameras();
  const Camera &a = cameras[0], &b = cameras[1];
  const auto in = [](const Camera& camera, glm::dvec3 point) {
    return glm::vec2(*project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position)));
  };
  Features left = randomFeatures(200, 256, 192, 1), right = randomFeatures(200, 256, 192, 2);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 60; ++i) points.push_back({-0.6 + 0.02 * i, 3 + 0.05 * (i % 9), -0.5 + 0.02 * (i * 7 % 50)});
  for (std::size_t i = 0; i < points.size(); ++i) {
    left.at[i] = in(a, points[i]);
    right.at[199 - i] = in(b, points[i]);
    right.descriptor[199 - i] = left.descriptor[i];
    right.descriptor[199 - i][5] = std::int16_t(left.descriptor[i][5] + 6);
  }
  const auto matches = matchGuided(a, left, b, right);
  std::size_t right60 = 0, others = 0;
  for (const FeatureMatch& m : matches) (m.a < 60 && m.b == 199 - m.a ? right60 : others)++;
  CHECK(right60 == 60);
  CHECK(others == 0);
  // Matching is symmetric: exchanged inputs give the same pairs.
  auto back = matchGuided(b, right, a, left);
  for (FeatureMatch& m : back) std::swap(m.a, m.b);
  std::ranges::sort(back, {}, &FeatureMatch::a);
  REQUIRE(back.size() == matches.size());
  for (std::size_t m = 0; m < matches.size(); ++m) CHECK((back[m].a == matches[m].a && back[m].b == matches[m].b));

  SECTION("off the epipolar line") {
    right.at[199].y += 10;
    CHECK(std::ranges::none_of(matchGuided(a, left, b, right), [](const auto& m) { return m.a == 0; }));
  }
  SECTION("behind the cameras on the epipolar line") {
    // The observation lies on the epipolar line, beyond the ray's far end.
    const glm::dvec3 ray = points[0] - a.pose.position;
    right.at[199] = in(b, a.pose.position + 1e6 * ray) + (in(b, a.pose.position + 1e6 * ray) - in(b, points[0]));
    CHECK(std::ranges::none_of(matchGuided(a, left, b, right), [](const auto& m) { return m.a == 0; }));
  }
  SECTION("two similar features on the epipolar line") {
    const glm::dvec3 nearer = a.pose.position + 0.8 * (points[0] - a.pose.position);
    right.at[100] = in(b, nearer);
    right.descriptor[100] = right.descriptor[199];
    CHECK(std::ranges::none_of(matchGuided(a, left, b, right), [](const auto& m) { return m.a == 0; }));
    // A similar feature off the epipolar line is no obstacle.
    right.at[100] = in(b, nearer) + glm::vec2(0, 20);
    CHECK(std::ranges::any_of(matchGuided(a, left, b, right), [](const auto& m) { return m.a == 0; }));
  }
}

TEST_CASE("matches are joined to tracks with one feature per photograph, most similar first") {
  const std::vector<ImagePair> pairs{{0, 1}, {0, 2}, {1, 2}};
  // 0:5 – 1:6 – 2:7 join by small distances; 0:5 – 2:9 would then add a second feature of photograph 2.
  const std::vector<std::vector<FeatureMatch>> matches{{{5, 6, 10}}, {{5, 9, 30}, {1, 1, 5}}, {{6, 7, 20}}};
  using Set = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  const auto joined = joinMatches(pairs, matches);
  CHECK(joined == std::vector<Set>{{{0, 1}, {2, 1}}, {{0, 5}, {1, 6}, {2, 7}}});
  CHECK(joinMatches({}, {}).empty());
}

TEST_CASE("triangulation is exact for exact pixels and fails without parallax or for diverging rays") {
  const std::vector<Camera> cameras = threeCameras();
  const glm::dvec3 point(0.1, 3.5, 0.2);
  std::vector<glm::dvec2> pixels;
  for (const Camera& c : cameras)
    pixels.push_back(*project(c.intrinsics, glm::inverse(c.pose.rotation) * (point - c.pose.position)));
  CHECK(glm::distance(triangulate(cameras, pixels).value(), point) < 1e-9);
  // The result minimises squared distances in pixels: no step to another position reduces their sum.
  pixels[0].x += 1;
  pixels[2].y -= 0.7;
  const glm::dvec3 best = triangulate(cameras, pixels).value();
  const auto error = [&](glm::dvec3 p) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Camera& c = cameras[i];
      const auto seen = *project(c.intrinsics, glm::inverse(c.pose.rotation) * (p - c.pose.position));
      sum += glm::dot(seen - pixels[i], seen - pixels[i]);
    }
    return sum;
  };
  for (const glm::dvec3 aside : {glm::dvec3(1e-3, 0, 0), {0, 1e-3, 0}, {0, 0, 1e-3}}) {
    CHECK(error(best + aside) > error(best));
    CHECK(error(best - aside) > error(best));
  }
  const std::vector<Camera> same{cameras[0], cameras[0]};
  CHECK_FALSE(triangulate(same, std::vector<glm::dvec2>{{10, 10}, {10, 10}}));
  // The rays diverge; their closest point is behind the cameras.
  CHECK_FALSE(triangulate(std::vector<Camera>{cameras[0], cameras[1]}, std::vector<glm::dvec2>{{10, 96}, {250, 96}}));
}

TEST_CASE("pairs to match are near each other, look in similar directions and lack tracks") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 30; ++i) cameras.push_back(lookingAlong({double(i), 0, 0}, {0, 1, 0}));
  cameras.push_back(lookingAlong({0.5, 0, 0}, {0, -1, 0}));
  cameras.push_back(lookingAlong({3, 0, 0}, {0.1, 1, 0}));  // a second camera at the same position
  PosedModel model = modelOf(cameras, {});
  const auto pairs = pairsWithoutTracks(model, {.neighbours = 4});
  CHECK(std::ranges::is_sorted(pairs));
  CHECK(pairs.size() < 100);
  for (const auto& [a, b] : pairs) {
    CHECK(a < b);
    CHECK((a != 30 && b != 30));
    CHECK_FALSE((a == 3 && b == 31));
  }
  for (std::uint32_t i = 0; i + 1 < 30; ++i) CHECK(std::ranges::count(pairs, ImagePair(i, i + 1)) == 1);
  for (int t = 0; t < 5; ++t) model.tracks.push_back({{10, 4, 0}, {{10, {1, 1}}, {11, {1, 1}}}});
  CHECK(std::ranges::count(pairsWithoutTracks(model, {.enough = 6}), ImagePair(10, 11)) == 1);
  CHECK(std::ranges::count(pairsWithoutTracks(model, {.enough = 5}), ImagePair(10, 11)) == 0);
  model.images[10].camera.intrinsics.model = CameraModel::equirectangular;
  CHECK(std::ranges::none_of(pairsWithoutTracks(model), [](auto p) { return p.first == 10 || p.second == 10; }));
}

TEST_CASE("photographs with poses and no tracks get tracks on the surfaces that they show") {
  const TemporaryFolder folder;
  const std::vector<Camera> cameras = threeCameras();
  const SyntheticScene scene = wallSeenBy(cameras);
  const Made made = inputFor(scene, cameras, folder.path());
  REQUIRE(made.pairs.size() == 3);
  const std::vector<Track> tracks = makeTracks(made.model, made.pairs, made.input, runOneByOne);
  REQUIRE(tracks.size() > 100);
  std::size_t right = 0, three = 0;
  for (const Track& track : tracks) {
    const double depth = depthAt(track.position);
    right += std::abs(depth - 4) < 0.1 || std::abs(depth - 3) < 0.1;
    three += track.observations.size() == 3;
    CHECK(track.observations.size() >= 2);
    std::set<std::uint32_t> images;
    for (const TrackObservation& o : track.observations) images.insert(o.image);
    CHECK(images.size() == track.observations.size());
  }
  CHECK(double(right) > 0.97 * double(tracks.size()));
  CHECK(three > tracks.size() / 5);
  PosedModel model = made.model;
  model.tracks = tracks;
  CHECK(reprojectionError(model) < 0.2);

  // Cached features and matches give the same tracks, also if the jobs run in reverse order.
  OwnTracksInput kept = made.input;
  std::atomic<int> looked = 0;
  kept.view = [&](std::size_t i) {
    ++looked;
    return MatchView{cameras[i], Image8(256, 192, 3)};  // a black picture has no features
  };
  const auto backwards = [](std::string_view, std::size_t count, double, const std::function<void(std::size_t)>& job) {
    for (std::size_t i = count; i-- > 0;) job(i);
  };
  const auto again = makeTracks(made.model, made.pairs, kept, backwards);
  CHECK(looked == 0);  // all features come from the cache
  REQUIRE(again.size() == tracks.size());
  for (std::size_t t = 0; t < tracks.size(); ++t) CHECK(again[t].position == tracks[t].position);
}
