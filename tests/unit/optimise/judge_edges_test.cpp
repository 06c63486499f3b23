// SPDX-License-Identifier: Apache-2.0
// Counts of the CPU star evaluation against the reference implementation in double precision.
#include "optimise/judge.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

#include "reference/alignment/alignment_reference.h"
#include "support/planted.h"

using namespace ibr;

namespace {

struct JudgeDifference {
  int stars = 0, notWhole = 0, wrongCounts = 0;
  double ofChannels = 0, ofConcatenated = 0;  // largest difference of the ECC
};

// Compares candidates; their offsets are multiples of `grid`.
JudgeDifference compared(const Alignment& alignment, int grid, int radius, double varianceFloor, int rounds) {
  const StarMesh mesh = starMeshOf(alignment);
  std::vector<Texels> texels;
  for (const Image8* picture : alignment.pictures) texels.push_back(texelsOf(*picture));
  const JudgeInput input{mesh, texels};
  const reference::AlignedPictures referenceMesh{alignment.pictures, alignment.position, alignment.triangles};
  std::mt19937 random(4);
  JudgeDifference agreement;
  for (int round = 0; round < rounds; ++round)
    for (std::uint32_t point = 0; point < mesh.vertexCount(); ++point) {
      const std::size_t member = random() % mesh.memberCount();
      const auto way = [&] { return int(random() % std::uint32_t(2 * radius + 1)) - radius; };
      glm::ivec2 offset = glm::ivec2(way(), way()) / grid * grid;
      if (!fits(mesh, alignment.position, point, member, offset)) offset = {0, 0};
      const Judgement judgement = judge(input, alignment.position, point, member, offset);
      if (!judgement.whole) {
        ++agreement.notWhole;
        continue;
      }
      const reference::StarEcc twin = reference::starEcc(referenceMesh, point, member, offset, varianceFloor);
      ++agreement.stars;
      for (std::size_t t = 0; t < twin.targets.size(); ++t)
        agreement.wrongCounts += judgement.targets[t].n != twin.targets[t].pixels;
      const auto off = [&](EccDefinition definition, const Ecc& expected) {
        return std::abs(eccOf(judgement.score(definition, varianceFloor)) - expected.value);
      };
      agreement.ofChannels = std::max(agreement.ofChannels, off(EccDefinition::channels, twin.channels));
      agreement.ofConcatenated =
          std::max(agreement.ofConcatenated, off(EccDefinition::concatenated, twin.concatenated));
    }
  return agreement;
}

}  // namespace

TEST_CASE("stars with edges through pixel centres have the reference's pixels and ECC") {
  const auto [members, cells, floor] = GENERATE(std::tuple{2, 2, 0}, std::tuple{2, 4, 25}, std::tuple{2, 12, 0},
                                                std::tuple{3, 4, 0}, std::tuple{3, 12, 25}, std::tuple{4, 4, 25});
  const int grid = GENERATE(1, 32);  // 32 units are a quarter of a pixel: edges pass through pixel centres
  auto planted = test::planted(members, 112, cells, 16.0 / cells, 100 + std::uint32_t(cells));
  for (auto& positions : planted.alignment.position)
    for (glm::ivec2& p : positions) p = p / grid * grid;
  const JudgeDifference agreement = compared(planted.alignment, grid, 400 / cells, floor, 80 / cells);
  CAPTURE(members, cells, floor, grid, agreement.stars, agreement.notWhole, agreement.ofChannels,
          agreement.ofConcatenated);
  CHECK(agreement.stars > 200);
  CHECK(agreement.notWhole == 0);
  CHECK(agreement.wrongCounts == 0);
  CHECK(agreement.ofChannels <= 1e-5);
  CHECK(agreement.ofConcatenated <= 1e-5);
}
