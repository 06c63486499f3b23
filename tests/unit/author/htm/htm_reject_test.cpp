// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_reject.h"

#include <bit>
#include <catch2/catch.hpp>
#include <random>

#include "htm_object.h"

namespace ibr {
namespace {

float scoreOf(CameraSet set, const std::vector<float>& scores) {
  float sum = 0;
  for (std::size_t k = 0; k < scores.size(); ++k)
    if (set >> k & 1) sum += scores[k];
  return sum;
}
bool isClique(CameraSet set, const std::vector<CameraSet>& joined) {
  for (std::size_t k = 0; k < joined.size(); ++k)
    if ((set >> k & 1) && (set & ~joined[k]) != CameraSet(1) << k) return false;
  return true;
}

struct Graph {
  std::vector<CameraSet> joined;
  std::vector<float> scores;
};
Graph randomGraph(std::size_t nodes, double density, std::mt19937& random) {
  Graph graph{std::vector<CameraSet>(nodes, 0), {}};
  std::uniform_real_distribution<float> share(0, 1);
  for (std::size_t a = 0; a < nodes; ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (share(random) < density) graph.joined[a] |= CameraSet(1) << b, graph.joined[b] |= CameraSet(1) << a;
  for (std::size_t a = 0; a < nodes; ++a) graph.scores.push_back(std::round(8 * share(random)) / 8);
  return graph;
}

}  // namespace

TEST_CASE("the largest clique is found, and the best-scored one of equal size") {
  std::mt19937 random(1);
  for (int run = 0; run < 400; ++run) {
    const std::size_t nodes = 1 + std::size_t(run % 12);
    const Graph graph = randomGraph(nodes, 0.2 + 0.6 * (run % 7) / 6.0, random);
    const CameraSet all = (CameraSet(1) << nodes) - 1, among = run % 3 == 0 ? all & random() : all;
    const CameraSet found = largestClique(among, graph.joined, graph.scores);
    CHECK((found & ~among) == 0);
    REQUIRE(isClique(found, graph.joined));
    int most = 0;
    float best = 0;
    for (CameraSet set = 0; set <= all; ++set) {
      if ((set & ~among) || !isClique(set, graph.joined)) continue;
      const float score = scoreOf(set, graph.scores);
      if (std::popcount(set) > most || (std::popcount(set) == most && score > best))
        most = std::popcount(set), best = score;
    }
    CHECK(std::popcount(found) == most);
    CHECK(scoreOf(found, graph.scores) == best);
  }
}

TEST_CASE("the clique search ends for the maximum number of cameras") {
  std::mt19937 random(2);
  for (const double density : {0.0, 0.5, 0.9, 0.95, 1.0}) {
    const Graph graph = randomGraph(64, density, random);
    const CameraSet found = largestClique(~CameraSet(0), graph.joined, graph.scores);
    CHECK(isClique(found, graph.joined));
    CHECK(std::popcount(found) >= (density == 1 ? 64 : density > 0.4 ? 5 : 1));
  }
  CHECK(largestClique(0, randomGraph(4, 1, random).joined, std::vector<float>(4)) == 0);
  // Complete graph minus 32 disjoint edges: 2³² largest cliques.
  Graph pairs{std::vector<CameraSet>(64, ~CameraSet(0)), std::vector<float>(64, 1)};
  for (std::size_t k = 0; k < 64; ++k) pairs.joined[k] &= ~(CameraSet(3) << (k & ~std::size_t(1)));
  const CameraSet found = largestClique(~CameraSet(0), pairs.joined, pairs.scores);
  CHECK(isClique(found, pairs.joined));
  CHECK(std::popcount(found) == 32);
}

TEST_CASE("the largest set of agreeing cameras is kept, and unknown pairs do not disagree") {
  constexpr std::size_t kCameras = 4;
  const std::vector<CameraSet> members{0b1111, 0b0111, 0b1000, 0};
  const std::size_t n = members.size();
  std::vector<CameraAgreement> known(kCameras * kCameras * n);
  const std::vector<float> scores(kCameras * n, 0.5f);
  const auto agreeing = [&] { return agreeingMembers(kCameras, members, known, scores, {}); };
  const auto at = [&](std::size_t i, std::size_t j, std::size_t v) -> CameraAgreement& {
    return known[(i * kCameras + j) * n + v];
  };
  CHECK(agreeing() == members);
  for (std::size_t j = 0; j < 3; ++j) at(3, j, 0) = {90, 0.1f, true};  // 3 disagrees with all; known in one direction
  CHECK(agreeing() == std::vector<CameraSet>{0b0111, 0b0111, 0b1000, 0});
  for (std::size_t j = 0; j < 3; ++j) at(3, j, 0).known = false, at(j, 3, 0) = {90, 0.1f, true};
  CHECK(agreeing()[0] == 0b0111);
  for (std::size_t j = 0; j < 3; ++j) at(j, 3, 0).correlation = 0.8f;  // as under different light
  CHECK(agreeing()[0] == 0b1111);
  for (std::size_t j = 0; j < 3; ++j) at(j, 3, 0) = {10, -1.0f, true};
  CHECK(agreeing()[0] == 0b1111);
  at(0, 1, 1) = {90, 0, true};
  at(0, 2, 1) = {90, 0, true};
  CHECK(agreeing()[1] == 0b0110);
  // All pairs disagree: the camera with the best view is kept.
  std::vector<float> better = scores;
  better[1 * n + 1] = 0.9f;
  at(1, 2, 1) = {90, 0, true};
  CHECK(agreeingMembers(kCameras, members, known, better, {})[1] == 0b0010);
}

TEST_CASE("a camera with an unrelated image is rejected") {
  test::BumpyOptions options;
  options.cameras = 10;
  options.disagreement = 0;
  test::BumpyModel bumpy = test::bumpyModel(options);
  const TriangleMesh& mesh = bumpy.model.surface.mesh;
  std::vector<HtmView> views = test::viewsOf(bumpy);
  const auto& members = bumpy.model.surface.members;
  const auto meanOf = [&](std::size_t i, std::size_t j) {
    const auto projected = projectedMeshes(mesh, views);
    const auto all = agreements(mesh, projected, members, {}, {}, 1);
    CHECK(all.size() == 100 * members.size());
    double difference = 0, correlation = 0;
    int count = 0;
    for (std::size_t v = 0; v < members.size(); ++v) {
      const CameraAgreement& a = all[(i * 10 + j) * members.size() + v];
      CHECK(std::isfinite(a.difference));
      CHECK(std::abs(a.correlation) <= 1.0001f);
      if (!a.known) continue;
      CHECK((members[v] >> i & members[v] >> j & 1) == 1);
      difference += a.difference, correlation += a.correlation, ++count;
    }
    REQUIRE(count > 5);
    return std::pair(difference / count, correlation / count);
  };
  CHECK(meanOf(0, 1).first < 12);
  CHECK(meanOf(0, 1).second > 0.9);
  CHECK(meanOf(1, 0).first < 12);
  std::mt19937 random(3);
  for (std::uint8_t& value : views[1].picture.values) value = std::uint8_t(random());
  CHECK(meanOf(0, 1).first > 30);
  CHECK(meanOf(0, 1).second < 0.3);
  const std::vector<float> scores(10 * members.size(), 1.0f);
  const auto left =
      agreeingMembers(10, members, agreements(mesh, projectedMeshes(mesh, views), members, {}, {}, 2), scores, {});
  std::size_t wrong = 0, right = 0, had = 0, others = 0;
  for (std::size_t v = 0; v < members.size(); ++v) {
    if (std::popcount(members[v]) < 3) continue;
    wrong += left[v] >> 1 & 1, had += members[v] >> 1 & 1;
    right += std::size_t(std::popcount(left[v] & ~CameraSet(2))),
        others += std::size_t(std::popcount(members[v] & ~CameraSet(2)));
  }
  REQUIRE(had > 20);
  CHECK(double(wrong) < 0.1 * double(had));
  CHECK(double(right) > 0.95 * double(others));
}

}  // namespace ibr
