// SPDX-License-Identifier: Apache-2.0
#include "optimise/judge.h"

#include <algorithm>
#include <cmath>

#include "optimise/row_sums.h"

namespace ibr {
namespace {

using shader::EccEdge;
using shader::EccMap;
using shader::EccTarget;

struct Corner {
  glm::ivec2 source, target;
  glm::ivec2 mean() const { return source + target; }  // 2⁻⁸ px
};

RunSource runAt(const EccMap& map, const Texels& texels, glm::ivec2 origin, int column, int row) {
  constexpr std::int64_t kTexel = std::int64_t(1) << shader::kEccCoordinateBits;
  constexpr int kDropped = shader::kEccCoordinateBits - shader::kEccRunBits;
  const std::int64_t x = shader::eccAt(map.originX, map.xByX, map.xByY, origin, column, row);
  const std::int64_t y = shader::eccAt(map.originY, map.yByX, map.yByY, origin, column, row);
  return {texels.at(int(x >> shader::kEccCoordinateBits), int(y >> shader::kEccCoordinateBits)),
          texels.stride,
          std::int32_t((x & (kTexel - 1)) >> kDropped),
          std::int32_t((y & (kTexel - 1)) >> kDropped),
          std::int32_t(map.xByX >> kDropped),
          std::int32_t(map.yByX >> kDropped)};
}

// A triangle of one pair, whole or in every step-th row.
class PairSums {
 public:
  PairSums(const Texels& source, const Texels& target, RowChoice rows, const RunAdder& runs, EccTarget& sums)
      : source_(source), target_(target), rows_(rows), runs_(runs), sums_(sums) {}
  PairSums(const PairSums&) = delete;
  ~PairSums() { runs_.finish(sums_, lanes_); }

  /// False where it cannot be judged.
  bool add(const Corner& a, const Corner& b, const Corner& c) {
    const glm::ivec2 ma = a.mean(), mb = b.mean(), mc = c.mean();
    const std::int64_t area = shader::eccArea(ma, mb, mc);
    if (area <= 0 || !shader::eccSmall(ma, mb, mc)) return false;
    fromSource_ = shader::eccMap(ma, mb, mc, a.source, b.source, c.source, area);
    fromTarget_ = shader::eccMap(ma, mb, mc, a.target, b.target, c.target, area);
    if (!shader::eccGentle(fromSource_) || !shader::eccGentle(fromTarget_)) return false;
    origin_ = ma;
    std::array<glm::ivec2, 3> byRow{ma, mb, mc};
    std::ranges::sort(byRow, {}, &glm::ivec2::y);
    half(byRow[0], byRow[1], byRow[0], byRow[2]);
    half(byRow[1], byRow[2], byRow[0], byRow[2]);
    return true;
  }

 private:
  // The rows of the edge top–bottom, which the edge first–last spans, too.
  void half(glm::ivec2 top, glm::ivec2 bottom, glm::ivec2 first, glm::ivec2 last) {
    const int behind = shader::eccFirstRow(bottom.y);
    int row = shader::eccFirstRow(top.y);
    row += ((rows_.phase - row) % rows_.step + rows_.step) % rows_.step;
    if (row >= behind) return;
    EccEdge near = shader::eccEdge(top, bottom, row, rows_.step), far = shader::eccEdge(first, last, row, rows_.step);
    for (; row < behind; row += rows_.step) {
      addRow(int(std::min(near.column, far.column)), int(std::max(near.column, far.column)), row);
      shader::eccNextRow(near);
      shader::eccNextRow(far);
    }
  }

  void addRow(int from, int behind, int row) {
    for (; from < behind; from += shader::kEccRun)
      runs_.add(runAt(fromSource_, source_, origin_, from, row), runAt(fromTarget_, target_, origin_, from, row),
                std::min(behind - from, shader::kEccRun), sums_, lanes_);
  }

  const Texels& source_;
  const Texels& target_;
  RowChoice rows_;
  const RunAdder& runs_;
  EccTarget& sums_;
  RunLanes lanes_;
  EccMap fromSource_{}, fromTarget_{};
  glm::ivec2 origin_{0};
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
      result.whole = sums.add(a, b, c) && result.whole;
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
    score = shader::eccPlus(score, targets[std::size_t(t)]);
    all = shader::eccSum(all, targets[std::size_t(t)]);
  }
  return shader::eccFinished(score, all,
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
