// SPDX-License-Identifier: Apache-2.0
// The star of a point at one of its candidates, judged on the processor ([T] §3.6): sums over all pixel centres of the
// means with each target. What shaders/shared/ecc.h says, row by row; shaders/optimise/ecc.comp does the same.
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
  std::array<shader::EccTarget, 3> targets{};  // in the order of the pictures, without the source
  int count = 0;                               // of targets
  bool whole = true;  // false: a triangle is too large or too steep to be judged, nothing is said
  std::uint64_t pixels() const;
  /// `cost` (eccToll) is of the definition `channels`, as the floor is.
  shader::EccScore score(EccDefinition definition, double varianceFloor, std::int64_t cost = 0) const;
};

/// grey² as scores have them: of a variance floor, of rigidity.
std::int64_t scoreUnits(double squaredGrey);

/// value of a score, within [−1, 1]; 0 where undefined.
double eccOf(const shader::EccScore& score);

/// Everything that stays the same while points move.
struct JudgeInput {
  const StarMesh& mesh;
  std::span<const Texels> pictures;  // d
};

/// Precondition: fits(mesh, at, point, member, offset).
Judgement judge(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                glm::ivec2 offset, RowChoice rows = {});

/// Any triangles, in the mean of two pictures.
Judgement judgeTriangles(std::span<const Texels> pictures, const Positions& at, std::span<const glm::uvec3> triangles,
                         std::size_t member);

}  // namespace ibr
