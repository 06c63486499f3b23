// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_complements.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "author/htm/htm_consensus.h"
#include "htm_object.h"
#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::lookingAt;
using test::plainView;

constexpr std::size_t kSide = 9;  // vertices along each side of the grid

struct Field {
  TriangleMesh mesh = test::flatGrid(kSide - 1);
  std::size_t n = mesh.positions.size();
  std::vector<CameraSet> members = std::vector<CameraSet>(n, 3);
  std::vector<VertexMatch> matches = std::vector<VertexMatch>(4 * n);
  VertexMatch* pair() { return &matches[n]; }  // match 0 ← 1
  std::vector<glm::vec2> solved(double smoothness = 1, double outlierPx = 2) {
    const auto all = complementsOf(mesh, 2, members, matches, {smoothness, outlierPx, 1});
    for (std::size_t v = 0; v < n; ++v) CHECK((all[v] == glm::vec2(0) && all[3 * n + v] == glm::vec2(0)));
    return {all.begin() + std::ptrdiff_t(n), all.begin() + std::ptrdiff_t(2 * n)};
  }
};

double farthest(const std::vector<glm::vec2>& field, glm::vec2 from) {
  double most = 0;
  for (const glm::vec2& c : field) most = std::max(most, double(glm::distance(c, from)));
  return most;
}

// Measurement across stripes: only the displacement along `angle` is known.
VertexMatch stripes(double angle, glm::dvec2 truly, double worth) {
  const glm::dvec2 d(std::cos(angle), std::sin(angle));
  return {glm::vec2(d * glm::dot(d, truly)), glm::vec3(worth * glm::dvec3(d.x * d.x, d.x * d.y, d.y * d.y)), 0};
}

}  // namespace

TEST_CASE("without smoothness, complements equal the matches") {
  Field field;
  for (std::size_t v = 0; v < field.n; ++v) field.pair()[v] = {glm::vec2(v, 1), glm::vec3(v % 3, 0, 1), 0};
  field.members[5] = 1;
  const auto solved = field.solved(0);
  for (std::size_t v = 0; v < field.n; ++v) CHECK(solved[v] == (v == 5 ? glm::vec2(0) : field.pair()[v].displacement));
}

TEST_CASE("a constant field is kept, holes are filled, and outliers are ignored") {
  const glm::vec2 wanted(3.25f, -4.5f);
  Field field;
  for (std::size_t v = 0; v < field.n; ++v) field.pair()[v] = {wanted, glm::vec3(20, 3, 10), 0};
  CHECK(farthest(field.solved(), wanted) < 1e-5);
  CHECK(farthest(field.solved(1000), wanted) < 1e-5);
  for (const std::size_t v : {30u, 31u, 40u, 41u, 0u}) field.pair()[v] = {};
  CHECK(farthest(field.solved(), wanted) < 0.01);
  for (const double smoothness : {1e-9, 1e-3, 30.0}) {
    INFO(smoothness);
    CHECK(farthest(field.solved(smoothness), wanted) < 0.1);
  }
  field.pair()[60] = {wanted + glm::vec2(12, 9), glm::vec3(40, 0, 40), 0};
  field.pair()[20] = {wanted + glm::vec2(-40, 0), glm::vec3(40, 0, 40), 0};
  CHECK(farthest(field.solved(), wanted) < 0.3);
  // Vertices that one camera sees do not take part.
  field.members[10] = 1;
  field.members[70] = 0;
  const auto solved = field.solved();
  CHECK(solved[10] == glm::vec2(0));
  CHECK(solved[70] == glm::vec2(0));
  CHECK(glm::distance(solved[11], wanted) < 0.3);
}

TEST_CASE("the prior shortens complements of weak matches, and keeps those of strong matches") {
  Field field;
  const glm::vec2 wanted(0.6f, -0.8f);
  const auto length = [&](double information, double px, double smoothness = 10) {
    for (std::size_t v = 0; v < field.n; ++v) field.pair()[v] = {wanted, glm::vec3(information, 0, information), 0};
    const auto all = complementsOf(field.mesh, 2, field.members, field.matches, {smoothness, 2, 1, px});
    for (std::size_t v = 1; v < field.n; ++v) CHECK(glm::distance(all[field.n + v], all[field.n]) < 1e-4);
    CHECK(all[field.n].x / all[field.n].y == Approx(wanted.x / wanted.y));
    return glm::length(all[field.n]);
  };
  CHECK(length(12, 0.5) == Approx(12.0 / (12 + 4)).epsilon(0.02));
  CHECK(length(1000, 0.5) == Approx(1).epsilon(0.01));
  CHECK(length(0.1, 0.5) < 0.05);
  CHECK(length(12, 0) == Approx(1));
  CHECK(length(12, 1e6) == Approx(1));
  CHECK(length(12, 1e-9) < 1e-6);
  CHECK(length(12, 0.5, 0) == Approx(1));  // with the paper's linear measure
}

TEST_CASE("directions without information do not make a match an outlier") {
  const glm::dvec2 truly(9, 7);
  Field field;
  for (std::size_t v = 0; v < field.n; ++v) field.pair()[v] = stripes(double(v % 4) * 0.785, truly, 20);
  CHECK(farthest(field.solved(), glm::vec2(truly)) < 0.1);
  // Full and stripe matches alternate: they differ by 0.6 px along the gradient; the displacement across is 12 px.
  const auto zigzag = [](std::size_t v) { return glm::dvec2(v % 2 ? 0.3 : -0.3, 12); };
  for (std::size_t v = 0; v < field.n; ++v) {
    field.pair()[v] = {glm::vec2(zigzag(v)), glm::vec3(40, 0, 40), 0};
    if (v % 2) field.pair()[v] = stripes(0, zigzag(v), 40);
  }
  const auto solved = field.solved();
  for (std::size_t v = 0; v < field.n; ++v) CHECK(glm::distance(glm::dvec2(solved[v]), zigzag(v)) < 0.25);
}

TEST_CASE("complements follow a curved field") {
  Field field;
  const auto bent = [&](std::size_t v) {
    return glm::vec2(0.3 * double(v % kSide), 0.02 * std::pow(double(v / kSide), 2));
  };
  for (std::size_t v = 0; v < field.n; ++v) field.pair()[v] = {bent(v), glm::vec3(40, 0, 40), 0};
  const auto solved = field.solved();
  for (std::size_t v = 0; v < field.n; ++v) CHECK(glm::distance(solved[v], bent(v)) < 0.05);
}

TEST_CASE("meshes without matches or faces are solved") {
  Field field;
  CHECK(farthest(field.solved(), {0, 0}) == 0);
  CHECK(complementsOf({}, 3, {}, {}, {}).empty());
  TriangleMesh lonely;
  lonely.positions.resize(2);
  const std::vector<CameraSet> members(2, 3);
  std::vector<VertexMatch> matches(8);
  matches[2] = {glm::vec2(1, 2), glm::vec3(5, 0, 5), 0};
  const auto solved = complementsOf(lonely, 2, members, matches, {});
  CHECK(glm::distance(solved[2], glm::vec2(1, 2)) < 1e-6);
  CHECK(solved[3] == glm::vec2(0));
}

namespace {

// A wall before three cameras with planted offsets b; the matches are c_ij = b_i − J_ij b_j.
struct Planted {
  TriangleMesh mesh;
  std::vector<HtmView> views;
  std::vector<CameraSet> members;
  std::vector<glm::vec2> offsets, complements;
  std::vector<VertexMatch> matches;

  explicit Planted(glm::dvec3 middle = glm::dvec3(0))
      : mesh(test::moved(test::flatGrid(8), middle + glm::dvec3(-4, -4, 0))) {
    for (const glm::dvec3& from : {glm::dvec3(-3, 0, 9), {0.3, 2, 10}, {4, -1, 8}})
      views.push_back(plainView(lookingAt(middle + from, middle, 200, 150)));
    const std::size_t n = mesh.positions.size();
    members.assign(n, 7);
    offsets.resize(3 * n);
    for (std::size_t v = 0; v < n; ++v) {
      const double x = double(v % 9), y = double(v / 9);
      offsets[v] = glm::vec2(1.5 + 0.02 * x, -1);
      offsets[n + v] = glm::vec2(-1, 0.5 + 0.01 * y);
      offsets[2 * n + v] = glm::vec2(-0.4, 0.6 - 0.01 * x);
    }
    complements = consistentComplements(mesh, views, members, offsets);
    for (const glm::vec2& c : complements) matches.push_back({c, glm::vec3(30, 5, 20), 0});
  }
  std::size_t at(std::size_t i, std::size_t j, std::size_t v) const { return (i * 3 + j) * mesh.positions.size() + v; }
  // Maps an offset at a vertex from picture j to picture i by the wall's homography.
  glm::dvec2 through(std::size_t j, std::size_t i, std::size_t v, glm::dvec2 offset) const {
    const PinholeView from(views[j].camera), into(views[i].camera);
    const glm::dvec2 pixel = from.seen(mesh.positions[v])->pixel + offset;
    const glm::dvec3 along = from.point(pixel, 1) - from.centre();
    const glm::dvec3 point = from.centre() + along * ((mesh.positions[v].z - from.centre().z) / along.z);
    return into.seen(point)->pixel - into.seen(mesh.positions[v])->pixel;
  }
};

}  // namespace

TEST_CASE("complements derived from offsets are consistent over cycles of cameras") {
  for (const glm::dvec3& middle : {glm::dvec3(0), glm::dvec3(1e6, 2e6, -1e6)}) {
    const Planted planted(middle);
    const std::size_t n = planted.mesh.positions.size();
    for (std::size_t v = 0; v < n; v += 5)
      for (std::size_t i = 0; i < 3; ++i) {
        CHECK(planted.complements[planted.at(i, i, v)] == glm::vec2(0));
        for (std::size_t j = 0; j < 3; ++j) {
          if (i == j) continue;
          const glm::dvec2 cij = planted.complements[planted.at(i, j, v)];
          const glm::dvec2 expected =
              glm::dvec2(planted.offsets[i * n + v]) - planted.through(j, i, v, planted.offsets[j * n + v]);
          CHECK(glm::distance(cij, expected) < 0.15);  // J is a first-order approximation of the homography
          const std::size_t k = 3 - i - j;
          const glm::dvec2 closed = cij + planted.through(j, i, v, planted.complements[planted.at(j, k, v)]);
          CHECK(glm::distance(closed, glm::dvec2(planted.complements[planted.at(i, k, v)])) < 0.15);
        }
      }
  }
}

TEST_CASE("offsets are recovered up to the freedom that matches leave") {
  for (const glm::dvec3& middle : {glm::dvec3(0), glm::dvec3(1e6, 2e6, -1e6)}) {
    Planted planted(middle);
    const std::size_t n = planted.mesh.positions.size();
    const auto offError = [&](const std::vector<VertexMatch>& matches, const std::vector<CameraSet>& members) {
      const auto offsets = consensusOffsets(planted.mesh, planted.views, members, matches, {});
      REQUIRE(offsets.size() == 3 * n);
      const auto again = consistentComplements(planted.mesh, planted.views, members, offsets);
      double most = 0;
      for (std::size_t k = 0; k < again.size(); ++k) {
        const std::size_t v = k % n, i = k / n / 3, j = k / n % 3;
        if ((members[v] >> i & members[v] >> j & 1) == 0) {
          CHECK(again[k] == glm::vec2(0));
          continue;
        }
        most = std::max(most, double(glm::distance(again[k], planted.complements[k])));
      }
      return most;
    };
    CHECK(offError(planted.matches, planted.members) < 0.1);
    // Half of the matches are missing, some are wrong.
    std::vector<VertexMatch> fewer = planted.matches;
    for (std::size_t k = 0; k < fewer.size(); k += 2) fewer[k] = {};
    for (std::size_t k = 7; k < fewer.size(); k += 41)
      if (fewer[k].information.x > 0) fewer[k].displacement += glm::vec2(15, -20);
    CHECK(offError(fewer, planted.members) < 0.3);
    // Stripe matches whose direction varies.
    std::vector<VertexMatch> aperture;
    for (std::size_t k = 0; k < planted.matches.size(); ++k)
      aperture.push_back(stripes(double(k % 5) * 0.63, planted.complements[k], 20));
    CHECK(offError(aperture, planted.members) < 0.25);
    std::vector<CameraSet> members = planted.members;
    members[40] = 3, members[41] = 1, members[42] = 0;
    CHECK(offError(planted.matches, members) < 0.1);
    const auto offsets = consensusOffsets(planted.mesh, planted.views, members, planted.matches, {});
    CHECK(offsets[n + 41] == glm::vec2(0));
    CHECK(offsets[42] == glm::vec2(0));
  }
}

TEST_CASE("without matches or displacements there are no offsets") {
  const Planted planted;
  std::vector<VertexMatch> none(planted.matches.size()), still(planted.matches.size());
  for (VertexMatch& m : still) m.information = glm::vec3(30, 0, 30);
  for (const auto* matches : {&none, &still})
    for (const glm::vec2& b : consensusOffsets(planted.mesh, planted.views, planted.members, *matches, {}))
      CHECK(b == glm::vec2(0));
  // Views from behind and edge-on have no map.
  std::vector<HtmView> turned = planted.views;
  turned[1] = plainView(lookingAt({0, 0, -9}, {0, 0, 0}));
  turned[2] = plainView(lookingAt({20, 0, 1e-3}, {0, 0, 0}));
  for (const glm::vec2& b : consensusOffsets(planted.mesh, turned, planted.members, planted.matches, {}))
    CHECK((std::isfinite(b.x) && std::isfinite(b.y)));
  for (const glm::vec2& c : consistentComplements(planted.mesh, turned, planted.members, planted.offsets))
    CHECK(c == glm::vec2(0));
}

TEST_CASE("solving for offsets reports progress, and can be cancelled") {
  const Planted planted;
  std::vector<std::size_t> reported;
  std::size_t last = 1000;
  const ProgressCallback progress = [&](const Progress& p) {
    CHECK(p.total == 120);
    reported.push_back(p.done);
    return p.done < last;
  };
  const auto offsets = [&](const ProgressCallback& to) {
    return consensusOffsets(planted.mesh, planted.views, planted.members, planted.matches, {}, to);
  };
  CHECK(offsets(progress) == offsets({}));
  CHECK(reported.size() == 120);
  CHECK(std::ranges::is_sorted(reported));
  for (const std::size_t stop : {0, 7}) {
    reported.clear();
    last = stop;
    CHECK(test::errorOf([&] { offsets(progress); }).code() == ErrorCode::cancelled);
    CHECK(reported.size() == stop + 1);
  }
}

TEST_CASE("matches of a pair count in both directions, and each alone") {
  const Planted planted;
  const std::size_t n = planted.mesh.positions.size(), v = 40;
  std::vector<CameraSet> members(n, 0);
  members[v] = 3;
  // One vertex, one match of 2 px, prior of 16 px² for each of two offsets: each offset takes its share of the match.
  const auto offsetsOf = [&](bool there, bool back) {
    std::vector<VertexMatch> matches(9 * n);
    if (there) matches[planted.at(0, 1, v)] = {glm::vec2(2, 0), glm::vec3(25, 0, 25), 0};
    if (back) matches[planted.at(1, 0, v)] = {glm::vec2(-2, 0), glm::vec3(25, 0, 25), 0};
    return consensusOffsets(planted.mesh, planted.views, members, matches, {.sweeps = 400});
  };
  for (const auto& [there, back] : {std::pair(true, false), {false, true}, {true, true}}) {
    INFO(there << " " << back);
    const std::vector<glm::vec2> b = offsetsOf(there, back);
    CHECK(b[v].x > 0.5);
    CHECK(b[n + v].x < -0.5);
    const glm::dvec2 apart = glm::dvec2(b[v]) - planted.through(1, 0, v, b[n + v]);
    CHECK(apart.x == Approx(2).margin(0.1));
    CHECK(std::abs(apart.y) < 0.03);
  }
  for (const glm::vec2& b : offsetsOf(false, false)) CHECK(b == glm::vec2(0));
}

}  // namespace ibr
