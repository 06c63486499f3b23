// SPDX-License-Identifier: Apache-2.0
#include "author/match/match_homographic.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "author/match/plane_labels.h"
#include "author/match/plane_patch.h"
#include "author/match/track_mesh.h"
#include "author/mesh/mesh.h"
#include "author/sweep/homographies.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// A wall 5 units and, on its left, a board 2.6 units in front of the cameras.
struct Stage {
  std::vector<Camera> cameras;
  SyntheticScene scene;
  std::vector<MatchView> views;
};
Stage makeStage(std::size_t members) {
  Stage stage;
  stage.cameras = {lookingAlong({0, 0, 0}, {0, 1, 0}, 320, 240), lookingAlong({0.4, 0, 0.05}, {0, 1, 0}, 320, 240),
                   lookingAlong({0.15, 0.05, 0.35}, {0, 1, 0}, 320, 240)};
  stage.cameras.resize(members);
  SyntheticOptions options;
  options.cameras = stage.cameras;
  options.planes = {{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.12},
                    {{-0.6, 2.6, 0.1}, {1, 0, 0}, {0, 0, 1}, 1.2, 1.2, 2, 0.06}};
  options.samplesPerAxis = 2;
  stage.scene = makeScene(options);
  for (std::size_t i = 0; i < members; ++i) stage.views.push_back({stage.cameras[i], stage.scene.photographs[i]});
  return stage;
}

glm::dvec2 seenAt(const Camera& camera, glm::dvec3 point) {
  return *project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position));
}

// Returns the point of the plane y = depth that a camera sees at a pixel.
glm::dvec3 pointOn(const Camera& camera, glm::dvec2 pixel, double depth) {
  const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, pixel);
  return camera.pose.position + ray * ((depth - camera.pose.position.y) / ray.y);
}

double worstOff(const Stage& stage, const MatchedVertices& vertices, std::size_t v, double depth) {
  const glm::dvec3 point = pointOn(stage.cameras[0], vertices.matched[0][v], depth);
  double worst = 0;
  for (std::size_t i = 1; i < stage.cameras.size(); ++i)
    worst = std::max(worst, glm::distance(seenAt(stage.cameras[i], point), glm::dvec2(vertices.matched[i][v])));
  return worst;
}

// Tracks on two planes, y = 5 (x > 0) and y = 2.6 (x < 0), as three cameras see them, followed by random tracks.
std::vector<PlaneTrack> twoPlanes(const std::vector<Camera>& cameras, std::size_t each, std::size_t noise) {
  std::mt19937 random(9);
  const auto place = [&](double low, double high) { return low + (high - low) * double(random() % 10'000) / 10'000; };
  std::vector<PlaneTrack> tracks;
  for (std::size_t k = 0; k < 2 * each + noise; ++k) {
    PlaneTrack track;
    const bool wall = k % 2;
    const glm::dvec3 point(wall ? place(0.1, 2) : place(-1, -0.05), wall ? 5 : 2.6, place(-0.8, 0.8));
    for (std::size_t i = 0; i < cameras.size(); ++i)
      track.at[i] = k < 2 * each ? seenAt(cameras[i], point) : glm::dvec2(place(0, 320), place(0, 240));
    tracks.push_back(track);
  }
  return tracks;
}

}  // namespace

TEST_CASE("two planes give two labels with their exact maps, and parallax gives inhomogeneous triangles") {
  const Stage stage = makeStage(3);
  const bool posed = GENERATE(true, false);
  std::vector<MatchView> views = stage.views;
  if (!posed)
    for (MatchView& view : views) view.camera.pose = {};
  const DenseMatch match = matchByHomographies(views, {posed, posed});
  REQUIRE(match.vertices);
  const MatchedVertices& vertices = *match.vertices;
  REQUIRE(vertices.frame.size() > 150);
  REQUIRE(vertices.planes.size() == vertices.frame.size());

  std::size_t near = 0, board = 0;
  std::vector<std::uint16_t> onWall, onBoard;
  for (std::size_t v = 0; v < vertices.frame.size(); ++v) {
    const double wallOff = worstOff(stage, vertices, v, 5), boardOff = worstOff(stage, vertices, v, 2.6);
    near += std::min(wallOff, boardOff) < 0.4;
    board += boardOff < wallOff;
    for (int k = 0; k < 4; ++k)
      if (vertices.planes[v][k]) (boardOff < wallOff ? onBoard : onWall).push_back(vertices.planes[v][k]);
  }
  CHECK(double(near) > 0.95 * double(vertices.frame.size()));
  CHECK(board > 20);
  const auto share = [](const std::vector<std::uint16_t>& labels) {
    std::size_t most = 0;
    for (const std::uint16_t l : labels) most = std::max(most, std::size_t(std::ranges::count(labels, l)));
    return double(most) / double(labels.size());
  };
  CHECK(share(onWall) > 0.8);
  CHECK(share(onBoard) > 0.8);

  // A triangle that spans board and wall is inhomogeneous; a triangle on either one nearly always has one plane.
  std::vector<glm::dvec2> places(vertices.frame.begin(), vertices.frame.end());
  std::vector<PlaneTrack> tracks(places.size());
  for (std::size_t v = 0; v < places.size(); ++v) tracks[v].at[0] = places[v];
  std::size_t across = 0, acrossHomogeneous = 0, within = 0, withinHomogeneous = 0;
  for (const glm::uvec3& t : trackTriangles(tracks)) {
    int boards = 0;
    for (int k = 0; k < 3; ++k) boards += worstOff(stage, vertices, t[k], 2.6) < worstOff(stage, vertices, t[k], 5);
    const bool same = homogeneous(vertices.planes, t);
    (boards % 3 ? across : within) += 1;
    (boards % 3 ? acrossHomogeneous : withinHomogeneous) += same;
  }
  CHECK(across > 10);
  CHECK(double(acrossHomogeneous) < 0.05 * double(across));
  CHECK(double(withinHomogeneous) > 0.9 * double(within));

  const CellMesh cell = buildMesh(stage.cameras, views, match);
  CHECK(cell.quality.coverage > 0.4);
  const DenseMatch again = matchByHomographies(views, {posed, posed});
  CHECK(again.vertices->matched == vertices.matched);
  CHECK(again.vertices->planes == vertices.planes);
  CHECK(again.good == match.good);
}

TEST_CASE("homographies find the planes in any order of the members") {
  const Stage stage = makeStage(3);
  for (const auto& order : {std::array<std::size_t, 3>{0, 1, 2}, {2, 0, 1}}) {
    std::vector<MatchView> views;
    for (const std::size_t i : order) views.push_back(stage.views[i]);
    const DenseMatch match = matchByHomographies(views, {true, true});
    REQUIRE(match.vertices->frame.size() > 150);
    std::size_t near = 0;
    for (std::size_t v = 0; v < match.vertices->frame.size(); ++v) {
      double least = 1e9;
      for (const double depth : {5.0, 2.6}) {
        const glm::dvec3 point = pointOn(views[0].camera, match.vertices->matched[0][v], depth);
        double worst = 0;
        for (std::size_t i = 1; i < 3; ++i)
          worst =
              std::max(worst, glm::distance(seenAt(views[i].camera, point), glm::dvec2(match.vertices->matched[i][v])));
        least = std::min(least, worst);
      }
      near += least < 0.4;
    }
    CHECK(double(near) > 0.95 * double(match.vertices->frame.size()));
  }
}

TEST_CASE("two equal images give the identity") {
  Stage stage = makeStage(2);
  stage.views[1] = stage.views[0];
  const DenseMatch match = matchByHomographies(stage.views);
  REQUIRE(match.vertices->frame.size() > 150);
  for (std::size_t v = 0; v < match.vertices->frame.size(); ++v) {
    CHECK(glm::distance(match.vertices->matched[1][v], match.vertices->frame[v]) < 0.05f);
    CHECK(match.vertices->planes[v].x == 1);
  }
}

TEST_CASE("images without features, tiny images and unrelated images give no matches") {
  Stage stage = makeStage(3);
  const bool posed = GENERATE(true, false);
  for (const glm::ivec2 size : {glm::ivec2(320, 240), glm::ivec2(20, 17), glm::ivec2(1, 1)}) {
    std::vector<MatchView> views;
    for (Camera camera : stage.cameras) {
      camera.intrinsics = resized(camera.intrinsics, size.x, size.y);
      views.push_back({camera, Image8(size.x, size.y, 3, 128)});
    }
    const DenseMatch match = matchByHomographies(views, {posed, posed});
    CHECK(match.vertices->frame.empty());
    CHECK(std::ranges::count(match.good.values, 1) == 0);
    const CellMesh cell = buildMesh(stage.cameras, views, match);
    CHECK(cell.mesh.triangles.empty());
    CHECK(cell.quality.coverage == 0);
  }
  std::mt19937 random(3);
  for (std::uint8_t& value : stage.views[1].picture.values) value = std::uint8_t(random() & 255);
  CHECK(matchByHomographies(stage.views, {posed, posed}).vertices->frame.size() < 20);
}

TEST_CASE("the largest plane is found first, then the other, then none") {
  const Stage stage = makeStage(3);
  const bool posed = GENERATE(true, false);
  std::vector<PlaneTrack> tracks = twoPlanes(stage.cameras, 60, 40);
  for (std::size_t t = 0; t < 20; ++t)
    tracks[2 * t].at[2] += glm::dvec2(15 + 7 * double(t % 5), -10 - 9 * double(t % 3));  // fewer tracks on the board
  const PlaneFitter fit(stage.cameras, posed);
  std::vector<PlaneMaps> planes;
  REQUIRE(sealLargestPlane(fit, tracks, planes, 1));
  REQUIRE(sealLargestPlane(fit, tracks, planes, 2));
  CHECK_FALSE(sealLargestPlane(fit, tracks, planes, 3));
  for (std::size_t t = 0; t < 120; ++t) {
    const bool wall = t % 2, spoilt = !wall && t < 40;
    CHECK(tracks[t].plane == (spoilt ? -1 : wall ? 0 : 1));
  }
  CHECK(std::count_if(tracks.begin() + 120, tracks.end(), [](const PlaneTrack& t) { return t.plane >= 0; }) < 3);
  for (const auto& [plane, depth] : {std::pair(0, 5.0), {1, 2.6}})
    for (const glm::dvec2 pixel : {glm::dvec2(100, 100), glm::dvec2(220, 60)}) {
      const auto at = planes[std::size_t(plane)](pixel);
      REQUIRE(at);
      for (std::size_t i = 0; i < 3; ++i)
        CHECK(glm::distance((*at)[i], seenAt(stage.cameras[i], pointOn(stage.cameras[0], pixel, depth))) < 0.01);
    }
}

TEST_CASE("no plane is fitted to too few tracks, to tracks on a line, or to a mirrored image") {
  const Stage stage = makeStage(2);
  const bool posed = GENERATE(true, false);
  const PlaneFitter fit(stage.cameras, posed);
  CHECK_FALSE(fit({}));
  std::vector<PlaneTrack> tracks = twoPlanes(stage.cameras, 8, 0);
  std::vector<const PlaneTrack*> list;
  for (std::size_t t = 1; t < tracks.size(); t += 2) list.push_back(&tracks[t]);
  CHECK(fit(list));
  CHECK_FALSE(fit(std::span(list).first(fit.minTracks() - 1)));
  std::vector<PlaneTrack> line = tracks;
  for (std::size_t t = 0; t < line.size(); ++t)
    for (std::size_t i = 0; i < 2; ++i) line[t].at[i] = seenAt(stage.cameras[i], {0.1 * double(t), 5, 0});
  std::vector<const PlaneTrack*> onLine;
  for (const PlaneTrack& t : line) onLine.push_back(&t);
  CHECK_FALSE(fit(std::span(onLine).first(fit.minTracks())));
  if (posed) return;
  for (PlaneTrack& track : tracks) track.at[1].x = 320 - track.at[1].x;
  CHECK_FALSE(fit(list));
}

TEST_CASE("patches move to where members match, on their epipolar lines if poses are exact") {
  const Stage stage = makeStage(3);
  const bool posed = GENERATE(true, false);
  std::vector<ImageF> grey;
  for (const MatchView& view : stage.views) {
    ImageF& g = grey.emplace_back(view.picture.width, view.picture.height, 1);
    for (std::size_t p = 0; p < g.values.size(); ++p) g.values[p] = float(view.picture.values[3 * p + 1]);
  }
  std::vector<PlaneTrack> tracks = twoPlanes(stage.cameras, 40, 0);
  std::vector<const PlaneTrack*> wall;
  for (std::size_t t = 1; t < tracks.size(); t += 2) wall.push_back(&tracks[t]);
  const PlaneMaps plane = *PlaneFitter(stage.cameras, posed)(wall);
  const PlanePatches patches(grey, stage.cameras, posed);
  std::vector<glm::dvec2> truth(3), start(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 point(0.6, 5, 0.2), before(0.6 * 0.98, 4.9, 0.2 * 0.98);  // both project to one pixel of member 0
    truth[i] = seenAt(stage.cameras[i], point);
    start[i] = posed ? seenAt(stage.cameras[i], before) : truth[i] + double(i) * glm::dvec2(0.4, -0.3);
  }
  std::vector<glm::dvec2> at = start;
  const double before = patches.correlation(plane, at), after = patches.align(plane, at, 3);
  CHECK(after > before);
  CHECK(after > 0.9);
  for (std::size_t i = 0; i < 3; ++i) CHECK(glm::distance(at[i], truth[i]) < 0.15);
  std::vector<glm::dvec2> outside{{1, 1}, {1, 1}, {1, 1}};
  CHECK(patches.correlation(plane, outside) == -1);
}

TEST_CASE("a triangle has the plane that all of its corners share") {
  using Set = glm::u16vec4;
  CHECK(commonPlane(Set(1, 0, 0, 0), Set(1, 2, 0, 0), Set(1, 3, 0, 0)) == 1);
  CHECK(commonPlane(Set(1, 2, 0, 0), Set(2, 3, 0, 0), Set(1, 2, 3, 0)) == 2);
  CHECK(commonPlane(Set(1, 2, 0, 0), Set(2, 3, 0, 0), Set(1, 3, 0, 0)) == 0);
  CHECK(commonPlane(Set(0), Set(0), Set(0)) == 0);
  CHECK(homogeneous({}, {0, 1, 2}));
}

TEST_CASE("matches that contradict their neighbours or flip triangles are dropped") {
  const Stage stage = makeStage(2);
  std::vector<PlaneTrack> tracks;
  const auto add = [&](glm::dvec2 at, glm::dvec2 shift) {
    PlaneTrack track;
    track.at[0] = at;
    track.at[1] = at + shift;
    track.plane = 0;
    tracks.push_back(track);
  };
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) add({20.0 * x + y, 20.0 * y}, {7, 0});
  const std::vector<PlaneMaps> planes{{{glm::dmat3(1.0), glm::dmat3(1, 0, 0, 0, 1, 0, 7, 0, 1)}}};
  tracks[12].at[1] += glm::dvec2(9, 0);
  dropContradicted(tracks, planes, 4);
  CHECK(tracks.size() == 24);
  tracks[7].at[1] += glm::dvec2(0, 45);
  dropFolded(tracks, 2);
  CHECK(tracks.size() < 24);
  CHECK(tracks.size() >= 20);
}
