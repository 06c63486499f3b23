// SPDX-License-Identifier: Apache-2.0
// Judges the star of a point at one candidate on the CPU ([T] §3.6): sums over all pixel centres of the means with each
// target. Implements shaders/shared/ecc.h row by row; shaders/optimise/ecc_judge.comp computes the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "optimise/star_mesh.h"
#include "optimise/texels.h"
#include "optimise/triangle_rows.h"
#include "shared/ecc.h"

namespace ibr {

struct Judgement {
  std::array<shader::EccTarget, 3> targets{};  // in the order of the images, without the source
  int count = 0;                               // number of targets
  bool whole = true;                           // false: a triangle is too large or too steep to be judged; no result
  std::uint64_t pixels() const;
  /// `cost` (eccAddedCost) belongs to EccDefinition::channels, as the floor does.
  shader::EccScore score(EccDefinition definition, double varianceFloor, std::int64_t cost = 0) const;
};

/// Converts grey² (variance floor, rigidity) to the unit of scores.
std::int64_t scoreUnits(double squaredGrey);

/// ECC of a score, within [−1, 1]; 0 if undefined.
double eccOf(const shader::EccScore& score);

/// Inputs that do not change while points move.
struct JudgeInput {
  const StarMesh& mesh;
  std::span<const Texels> pictures;  // d
};

/// Judges a candidate. Precondition: fits(mesh, at, point, member, offset).
Judgement judge(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                glm::ivec2 offset, RowChoice rows = {});

/// Judges any triangles, in the mean of two images.
Judgement judgeTriangles(std::span<const Texels> pictures, const Positions& at, std::span<const glm::uvec3> triangles,
                         std::size_t member);

}  // namespace ibr
