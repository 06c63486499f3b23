// SPDX-License-Identifier: Apache-2.0
#include "author/poses/local_adjust.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"
#include "author/match/match.h"
#include "author/match/ranges.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * double(engine_()) / 4294967295.0; }
  glm::dvec3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }

 private:
  std::mt19937 engine_;
};

std::vector<Camera> rig(std::size_t members) {
  std::vector<Camera> cameras;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {0, 1, 0.1}, {0.3, 0.4, 0.9}, {0.6, 0.6, 0.3}})
    cameras.push_back(lookingAlong(place, {1, 0.05 * place.y, 0.02}, 1200, 900, 0.8));
  cameras.resize(members);
  return cameras;
}

std::vector<glm::dvec3> points(std::size_t count, unsigned seed) {
  Random random(seed);
  std::vector<glm::dvec3> list;
  for (std::size_t i = 0; i < count; ++i) {
    const double distance = 1 / random.uniform(0.02, 0.25);
    list.push_back(distance * glm::dvec3(1, random.uniform(-0.3, 0.4), random.uniform(-0.2, 0.3)));
  }
  return list;
}

std::vector<Camera> disturbed(std::vector<Camera> cameras, double degrees, double shift, unsigned seed) {
  Random random(seed);
  for (Camera& camera : cameras) {
    const glm::dvec3 turn = random.vector(degrees * 3.14159265 / 180);
    camera.pose.rotation = glm::normalize(camera.pose.rotation * glm::dquat(1, turn / 2.0));
    camera.pose.position += random.vector(shift);
  }
  return cameras;
}

std::vector<LocalTrack> seenBy(const std::vector<Camera>& cameras, const std::vector<glm::dvec3>& list, double noise) {
  Random random(3);
  std::vector<LocalTrack> tracks;
  for (const glm::dvec3& point : list) {
    LocalTrack track{point, {}};
    for (const Camera& camera : cameras) {
      auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
      if (at) *at += glm::dvec2(random.vector(noise));
      track.pixel.push_back(at);
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

// Median distance, px, by which the rays of exact pixels miss each other under these poses.
double misses(const std::vector<Camera>& exact, const std::vector<Pose>& poses) {
  std::vector<Camera> cameras = exact;
  for (std::size_t i = 0; i < poses.size(); ++i) cameras[i].pose = poses[i];
  const Camera frame = meanFrame(cameras);
  std::vector<double> residuals;
  for (const LocalTrack& track : seenBy(exact, points(200, 99), 0)) {
    std::vector<glm::dvec2> pixels;
    for (const auto& pixel : track.pixel) pixels.push_back(*pixel);
    residuals.push_back(
        triangulate(frame, cameras, pixels, {inverseDepth(frame, track.position), 1.0}, 1.0).residualPx);
  }
  return median(residuals);
}

std::vector<Pose> posesOf(const std::vector<Camera>& cameras) {
  std::vector<Pose> poses;
  for (const Camera& camera : cameras) poses.push_back(camera.pose);
  return poses;
}

bool same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::ranges::equal(
      a, b, [](const Pose& x, const Pose& y) { return x.position == y.position && x.rotation == y.rotation; });
}

}  // namespace

TEST_CASE("inaccurate poses are corrected relative to each other despite wrong tracks") {
  for (const std::size_t members : {2, 3, 4})
    for (const double degrees : {0.03, 0.3}) {
      const std::vector<Camera> exact = rig(members), wrong = disturbed(exact, degrees, 0.005, 5);
      std::vector<LocalTrack> tracks = seenBy(exact, points(300, 1), 0.2);
      const std::vector<Pose> clean = locallyAdjusted(wrong, tracks);
      INFO(members << " members, " << degrees << " degrees, before " << misses(exact, posesOf(wrong)));
      CHECK(misses(exact, clean) < 0.1);
      CHECK(misses(exact, posesOf(wrong)) > 0.2);
      for (std::size_t t = 0; t < tracks.size(); t += 10) *tracks[t].pixel[1] += glm::dvec2(25, -40);
      CHECK(misses(exact, locallyAdjusted(wrong, tracks)) < 0.12);
      // The other members move, and only a little.
      CHECK(clean[0].position == wrong[0].pose.position);
      CHECK(clean[0].rotation == wrong[0].pose.rotation);
      for (std::size_t i = 0; i < members; ++i) CHECK(glm::distance(clean[i].position, wrong[i].pose.position) < 0.05);
      CHECK(same(clean, locallyAdjusted(wrong, seenBy(exact, points(300, 1), 0.2))));
    }
}

TEST_CASE("exact poses and poses with few tracks stay unchanged") {
  const std::vector<Camera> exact = rig(3), wrong = disturbed(exact, 0.1, 0.01, 2);
  CHECK(same(locallyAdjusted(exact, seenBy(exact, points(100, 1), 0)), posesOf(exact)));
  CHECK(same(locallyAdjusted(wrong, seenBy(exact, points(5, 1), 0)), posesOf(wrong)));
  CHECK(same(locallyAdjusted(wrong, {}), posesOf(wrong)));
  // Member 2 shares no track with the others, so it stays; the others are adjusted by their own tracks.
  std::vector<LocalTrack> apart = seenBy(exact, points(100, 1), 0);
  for (LocalTrack& track : apart) track.pixel[2].reset();
  const std::vector<Pose> moved = locallyAdjusted(wrong, apart);
  CHECK(glm::distance(moved[2].position, wrong[2].pose.position) < 1e-9);
  CHECK(misses({exact[0], exact[1]}, {moved[0], moved[1]}) < 0.05);
}

TEST_CASE("points almost at infinity or behind a member give finite poses") {
  const std::vector<Camera> exact = rig(3), wrong = disturbed(exact, 0.1, 0, 4);
  std::vector<glm::dvec3> far = points(100, 1);
  for (glm::dvec3& point : far) point *= 1e7;
  for (const Pose& pose : locallyAdjusted(wrong, seenBy(exact, far, 0.2)))
    REQUIRE(std::isfinite(glm::length(pose.position) + glm::length(pose.rotation)));
  std::vector<LocalTrack> tracks = seenBy(exact, points(100, 1), 0.2);
  for (std::size_t t = 0; t < 10; ++t) tracks[t].position *= -1.0;
  for (const Pose& pose : locallyAdjusted(wrong, tracks))
    REQUIRE(std::isfinite(glm::length(pose.position) + glm::length(pose.rotation)));
}

TEST_CASE("local tracks are shared by members, sorted by number of members and limited in number") {
  PosedModel model = modelOf(rig(4), points(3000, 6));
  for (std::size_t t = 0; t < model.tracks.size(); t += 3)
    std::erase_if(model.tracks[t].observations, [](const auto& o) { return o.image == 2; });
  const std::vector<std::uint32_t> members{2, 0, 3};
  const std::vector<LocalTrack> tracks = localTracks(model, tracksOfImages(model), members);
  REQUIRE(tracks.size() == 1000);
  std::size_t before = 3;
  for (const LocalTrack& track : tracks) {
    REQUIRE(track.pixel.size() == 3);
    const auto seen = std::size_t(std::ranges::count_if(track.pixel, [](const auto& p) { return p.has_value(); }));
    CHECK(seen >= 2);
    CHECK(seen <= before);
    before = seen;
    for (std::size_t i = 0; i < 3; ++i)
      if (track.pixel[i]) {
        const Camera& camera = model.images[members[i]].camera;
        CHECK(glm::distance(*project(camera.intrinsics,
                                     glm::conjugate(camera.pose.rotation) * (track.position - camera.pose.position)),
                            *track.pixel[i]) < 1e-9);
      }
  }
  CHECK(localTracks(model, tracksOfImages(model), std::vector<std::uint32_t>{1}).empty());
}

TEST_CASE("adjusted poses correct the matches of inaccurate poses") {
  SyntheticOptions options;
  options.planes = {{{0, 0, -6}, {1, 0, 0}, {0, 1, 0}, 20, 16, 1, 0.3}};
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {0.5, 0, 0}, {0.25, 0.4, 0}})
    options.cameras.push_back({pinholeFromFov(480, 360, 0.9), {place, {1, 0, 0, 0}}});
  options.samplesPerAxis = 2;
  const SyntheticScene scene = makeScene(options);
  std::vector<glm::dvec3> onPlane;
  for (int i = 0; i < 100; ++i) onPlane.emplace_back(-2 + 0.4 * (i % 10), -1.6 + 0.32 * (i / 10), -6);
  const std::vector<Camera> wrong = disturbed(options.cameras, 0.6, 0, 8);
  const std::vector<Pose> adjusted = locallyAdjusted(wrong, seenBy(options.cameras, onPlane, 0.1));

  // Median error of the match in member 1 for the points matched in member 0; share of matched points.
  const auto error = [&](const std::vector<Pose>& poses) {
    std::vector<MatchView> views;
    for (std::size_t i = 0; i < poses.size(); ++i)
      views.push_back({{options.cameras[i].intrinsics, poses[i]}, scene.photographs[i]});
    const DenseMatch match = matchViews(views, onPlane, {true});
    std::vector<double> errors;
    for (int y = 0; y < match.good.height; ++y)
      for (int x = 0; x < match.good.width; ++x) {
        if (!match.good.pixel(x, y)[0]) continue;
        const auto first = match.position[0].pixel(x, y), second = match.position[1].pixel(x, y);
        const Camera& camera = options.cameras[0];
        const glm::dvec3 ray = unproject(camera.intrinsics, {first[0], first[1]});
        const glm::dvec3 point = ray * (-6 / ray.z);
        const auto at = project(options.cameras[1].intrinsics, point - options.cameras[1].pose.position);
        errors.push_back(glm::distance(*at, glm::dvec2(second[0], second[1])));
      }
    const double share = double(errors.size()) / double(match.good.values.size());
    return std::pair(median(errors), share);
  };
  const auto [off, few] = error(posesOf(wrong));
  const auto [right, many] = error(adjusted);
  INFO("px " << off << " -> " << right << ", share " << few << " -> " << many);
  CHECK(right < 0.1);
  CHECK(many > 0.8);
  CHECK((off > 2 * right || few < 0.5 * many));
}
