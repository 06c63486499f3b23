// SPDX-License-Identifier: Apache-2.0
// Star evaluation in integers against the reference implementation in double precision.
#include "optimise/judge.h"

#include <catch2/catch.hpp>
#include <random>

#include "reference/alignment/alignment_reference.h"
#include "support/planted.h"

using namespace ibr;

namespace {

struct Prepared {
  test::Planted planted;
  StarMesh mesh;
  std::vector<Texels> pictures;

  Prepared(int members, int side, int cells, double offPx, std::uint32_t seed)
      : planted(test::planted(members, side, cells, offPx, seed)), mesh(starMeshOf(planted.alignment)) {
    for (const Image8* picture : planted.alignment.pictures) pictures.push_back(texelsOf(*picture));
  }
  const Alignment& alignment() const { return planted.alignment; }
};

// Adds uniform noise of up to `strength` 8-bit levels to each value.
void addNoise(test::Planted& planted, int strength, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (Image8& picture : planted.pictures)
    for (auto& v : picture.values)
      v = std::uint8_t(std::min(std::max(int(v) + int(random() % unsigned(2 * strength + 1)) - strength, 0), 255));
}

}  // namespace

TEST_CASE("every candidate has the reference's pixels and its ECC to 1e-5", "[N1]") {
  const int members = GENERATE(2, 3, 4);
  const bool noisy = GENERATE(false, true);
  test::Planted planted = test::planted(members, 96, 5, 3.0, std::uint32_t(20 + members));
  if (noisy) addNoise(planted, 60, 3);
  const StarMesh mesh = starMeshOf(planted.alignment);
  std::vector<Texels> pictures;
  for (const Image8& picture : planted.pictures) pictures.push_back(texelsOf(picture));
  const Positions& at = planted.alignment.position;
  const reference::AlignedPictures twin{planted.alignment.pictures, at, planted.alignment.triangles};
  double largest = 0;
  int judgedCandidates = 0;
  for (std::uint32_t p = 0; p < mesh.vertexCount(); p += 3)
    for (std::size_t member = 0; member < at.size(); ++member) {
      const int reach = maxMove(mesh, at, p, member, 640);
      if (reach == 0) continue;
      for (std::uint32_t m = 0; m < 12; ++m) {
        const glm::ivec2 offset = m == 0 ? glm::ivec2(0) : candidateOffset(mesh, at, p, member, reach, 99, m);
        if (!fits(mesh, at, p, member, offset)) continue;
        const Judgement judged = judge({mesh, pictures}, at, p, member, offset);
        const reference::StarEcc expected = reference::starEcc(twin, p, member, offset);
        REQUIRE(judged.whole);
        for (std::size_t t = 0; t < expected.targets.size(); ++t)
          REQUIRE(judged.targets[t].n == expected.targets[t].pixels);
        largest =
            std::max(largest, std::abs(eccOf(judged.score(EccDefinition::channels, 0)) - expected.channels.value));
        largest = std::max(largest,
                           std::abs(eccOf(judged.score(EccDefinition::concatenated, 0)) - expected.concatenated.value));
        ++judgedCandidates;
      }
    }
  CAPTURE(members, noisy, judgedCandidates);
  CHECK(judgedCandidates > 100);
  CHECK(largest <= 1e-5);
}

TEST_CASE("interior points keep their number of pixels for every candidate", "[N3]") {
  const Prepared p(2, 96, 5, 3.0, 31);
  const Positions& at = p.alignment().position;
  for (std::uint32_t point = 0; point < p.mesh.vertexCount(); ++point) {
    if (p.mesh.border[point] != BorderKind::interior) continue;
    const int reach = maxMove(p.mesh, at, point, 1, 640);
    const std::uint64_t pixels = judge({p.mesh, p.pictures}, at, point, 1, glm::ivec2(0)).pixels();
    for (std::uint32_t m = 1; m < 20; ++m)
      CHECK(judge({p.mesh, p.pictures}, at, point, 1, candidateOffset(p.mesh, at, point, 1, reach, 5, m)).pixels() ==
            pixels);
  }
}

TEST_CASE("sums over all phases of pruned rows equal the full sums") {
  const Prepared p(3, 96, 4, 2.0, 32);
  const Positions& at = p.alignment().position;
  for (std::uint32_t point = 0; point < p.mesh.vertexCount(); ++point) {
    const JudgeInput input{p.mesh, p.pictures};
    const Judgement whole = judge(input, at, point, 0, glm::ivec2(0));
    for (std::size_t t = 0; t < 2; ++t) {
      shader::EccTarget sum{};
      for (int phase = 0; phase < 8; ++phase)
        sum = shader::eccSum(sum, judge(input, at, point, 0, glm::ivec2(0), {8, phase}).targets[t]);
      CHECK(sum.n == whole.targets[t].n);
      CHECK(sum.xy == whole.targets[t].xy);
      CHECK(sum.yy == whole.targets[t].yy);
      CHECK(sum.x1 == whole.targets[t].x1);
    }
  }
}

TEST_CASE("an image has ECC 1 with itself, and a constant image has none", "[N2]") {
  Prepared p(2, 64, 3, 0.0, 33);
  Alignment same = p.alignment();
  same.pictures[1] = same.pictures[0];
  same.position[1] = same.position[0];
  const StarMesh mesh = starMeshOf(same);
  const std::vector<Texels> pictures{p.pictures[0], p.pictures[0]};
  const auto score = [&](std::span<const Texels> of, double floor) {
    return judge({mesh, of}, same.position, 5, 0, glm::ivec2(0)).score(EccDefinition::channels, floor);
  };
  CHECK(eccOf(score(pictures, 0)) == 1);
  CHECK(eccOf(score(pictures, 25)) == 1);
  const Texels flat = texelsOf(Image8(64, 64, 3, 200));
  const std::vector<Texels> constant{flat, flat}, half{p.pictures[0], flat};
  CHECK_FALSE(shader::eccDefined(score(constant, 0)));
  CHECK_FALSE(shader::eccDefined(score(half, 0)));
  CHECK(eccOf(score(half, 0)) == 0);
  CHECK(eccOf(score(constant, 25)) == 1);
}
