// SPDX-License-Identifier: Apache-2.0
#include "optimise/judge.h"

#include <algorithm>
#include <cmath>

#include "optimise/row_sums.h"

namespace ibr {
namespace {

using shader::EccTarget;

// ECC sums of triangles in one pair of images, over all rows or every step-th one.
class PairSums {
 public:
  PairSums(const Texels& source, const Texels& target, RowChoice rows, const RunAdder& runs, EccTarget& sums)
      : source_(source), target_(target), rows_(rows), runs_(runs), sums_(sums) {}
  PairSums(const PairSums&) = delete;
  ~PairSums() { runs_.finish(sums_, lanes_); }

  /// Adds the pixels of a triangle; returns false if the triangle is too large or too steep to be evaluated.
  bool addTriangle(const Corner& a, const Corner& b, const Corner& c) {
    TriangleMaps maps;
    if (!maps.set(a, b, c)) return false;
    forEachRun(a.mean(), b.mean(), c.mean(), rows_, [&](int column, int row, int pixels) {
      runs_.add(runAt(maps.source, source_, maps.origin, column, row),
                runAt(maps.target, target_, maps.origin, column, row), pixels, sums_, lanes_);
    });
    return true;
  }

 private:
  const Texels& source_;
  const Texels& target_;
  RowChoice rows_;
  const RunAdder& runs_;
  EccTarget& sums_;
  RunLanes lanes_;
};

template <class Triangles>
Judgement judged(std::span<const Texels> pictures, const Positions& at, std::size_t member, RowChoice rows,
                 const Triangles& forEachTriangle) {
  static const RunAdder& runs = fastestRunAdder();
  Judgement result;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (k == member) continue;
    PairSums sums(pictures[member], pictures[k], rows, runs, result.targets[std::size_t(result.count++)]);
    const auto corner = [&](std::uint32_t p) { return Corner{at[member][p], at[k][p]}; };
    forEachTriangle(corner, [&](const Corner& a, const Corner& b, const Corner& c) {
      result.whole = sums.addTriangle(a, b, c) && result.whole;
    });
  }
  return result;
}

}  // namespace

std::uint64_t Judgement::pixels() const {
  std::uint64_t n = 0;
  for (const EccTarget& t : targets) n += std::uint64_t(t.n);
  return n;
}

shader::EccScore Judgement::score(EccDefinition definition, double varianceFloor, std::int64_t cost) const {
  if (!whole) return {};
  shader::EccScore score{};
  EccTarget all{};
  for (int t = 0; t < count; ++t) {
    score = shader::eccAdd(score, targets[std::size_t(t)]);
    all = shader::eccSum(all, targets[std::size_t(t)]);
  }
  return shader::eccFinalScore(score, all,
                               definition == EccDefinition::channels ? shader::kEccChannels : shader::kEccConcatenated,
                               scoreUnits(varianceFloor), cost);
}

std::int64_t scoreUnits(double squaredGrey) {
  return std::lround(squaredGrey * 65536.0);
}

double eccOf(const shader::EccScore& score) {
  if (!shader::eccDefined(score)) return 0;
  const double value = double(score.covariance) / std::sqrt(double(score.varianceX) * double(score.varianceY));
  return std::clamp(value, -1.0, 1.0);
}

Judgement judge(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                glm::ivec2 offset, RowChoice rows) {
  return judged(input.pictures, at, member, rows, [&](const auto& corner, const auto& add) {
    Corner centre = corner(point);
    centre.source += offset;
    for (const glm::uvec2& edge : input.mesh.star[point]) add(centre, corner(edge.x), corner(edge.y));
  });
}

Judgement judgeTriangles(std::span<const Texels> pictures, const Positions& at, std::span<const glm::uvec3> triangles,
                         std::size_t member) {
  return judged(pictures, at, member, {}, [&](const auto& corner, const auto& add) {
    for (const glm::uvec3& t : triangles) add(corner(t.x), corner(t.y), corner(t.z));
  });
}

}  // namespace ibr
