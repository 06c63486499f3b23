// SPDX-License-Identifier: Apache-2.0
// Method `gradient`: each point takes the step of forward-additive ECC (ecc_step.h), or a fraction of the step, if its
// star's exact ECC rises. The stars of a class are judged in parallel, as in `cpu`.
//
// A few random candidates are judged before the step, so that the step may start in another basin.
//
// Departures: [T] §3.7 has only random candidates; the first cycles may use blurred images (coarse to fine).
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/check.h"
#include "optimise/blurred.h"
#include "optimise/ecc_step.h"
#include "optimise/processor.h"

namespace ibr {
namespace {

constexpr std::array<double, 3> kFractions{1, 0.5, 0.25};  // of a step

struct ScoredPick : Pick {
  shader::EccScore score{};  // at the pick's offset
};

void checkEpipolar(const Alignment& a) {
  check(a.epipolar.empty() || a.epipolar.size() == a.position.size(), ErrorCode::invalidInput,
        "alignment.epipolar: {} lists for {} pictures", a.epipolar.size(), a.position.size());
  for (std::size_t i = 0; i < a.epipolar.size(); ++i)
    check(a.epipolar[i].size() == a.position[i].size(), ErrorCode::invalidInput,
          "alignment.epipolar[{}]: {} directions for {} points", i, a.epipolar[i].size(), a.position[i].size());
}

class GradientBackend final : public AlignmentBackend {
 public:
  explicit GradientBackend(const BackendInput& input) : input_(input) {
    checkEpipolar(input.alignment);
    judgeInputs_.push_back({input.mesh, input.pictures});
    blurred_.reserve(std::size_t(input.options.levels));
    for (int level = 1; level < input.options.levels; ++level) {
      std::vector<Texels> pictures;
      for (const Texels& before : judgeInputs_.back().pictures)
        pictures.push_back(blurred(before, level, input.options.threads));
      blurred_.push_back(std::move(pictures));
      judgeInputs_.push_back({input.mesh, blurred_.back()});
    }
  }

  int coarseCycles() const override { return input_.options.levels - 1; }

  CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) override {
    level_ = level_ < 0 ? input_.options.levels - 1 : std::max(level_ - 1, 0);
    return runCycleOnCpu(input_, at, keepGoing, [&](std::uint32_t point, std::size_t member, const Positions& now) {
      return Pick(best(point, member, request, now));
    });
  }

  std::vector<Judgement> judgeAll(const Positions& at) override { return judgeAllOnCpu(input_, at); }

 private:
  // A point in one image, with its reach and prior there.
  struct MovingPoint {
    std::uint32_t point;
    std::size_t member;
    const Positions& at;
    int reach;
    DisplacementPrior prior;
  };

  ScoredPick best(std::uint32_t point, std::size_t member, const CycleRequest& request, const Positions& at) const {
    ScoredPick pick;
    const MovingPoint place{point, member, at, maxMove(input_.mesh, at, point, member, request.radius),
                            displacementPrior(point, member)};
    if (place.reach == 0) return pick;
    pick.score = scoreAt(place, pick.offset, pick);
    const std::uint32_t seed = shader::eccPointSeed(request.seed, std::uint32_t(member), point);
    for (std::uint32_t m = 1; m <= std::uint32_t(input_.options.escape); ++m)
      take(place, candidateOffset(input_.mesh, at, point, member, place.reach, seed, m), pick);
    const glm::dvec2 step = stepFrom(place, pick.offset), from(pick.offset);
    for (const double fraction : kFractions)
      if (take(place, glm::ivec2(glm::round(from + step * fraction)), pick)) break;
    return pick;
  }

  // Makes the candidate the pick if its ECC, less the cost of its displacement, is higher.
  bool take(const MovingPoint& place, glm::ivec2 offset, ScoredPick& pick) const {
    if (offset == pick.offset || !fits(input_.mesh, place.at, place.point, place.member, offset)) return false;
    const shader::EccScore score = scoreAt(place, offset, pick);
    if (!shader::eccWins(score, pick.score)) return false;
    pick.offset = offset;
    pick.score = score;
    return true;
  }

  // 1/128 px, ending within the reach; along the chord for a point that slides.
  glm::dvec2 stepFrom(const MovingPoint& place, glm::ivec2 offset) const {
    std::optional<glm::dvec2> chord;
    if (input_.mesh.border[place.point] == BorderKind::slides) {
      const glm::uvec2 ends = input_.mesh.chord[place.point];
      chord = glm::dvec2(place.at[place.member][ends.y] - place.at[place.member][ends.x]);
      if (*chord == glm::dvec2(0)) return glm::dvec2(0);
      *chord = glm::normalize(*chord);
    }
    const GradientSums sums = gradientSums(judgeInputs_[std::size_t(level_)], place.at, place.point, place.member,
                                           offset, input_.options.definition, input_.options.varianceFloor, rows());
    const auto step = eccStep(sums, place.prior, movedBy(place, offset), chord);
    if (!step) return glm::dvec2(0);
    const glm::dvec2 units = *step * double(kAlignmentUnitsPerPixel);
    const double most = double(place.reach) - glm::length(glm::dvec2(offset)), length = glm::length(units);
    return most <= 0 ? glm::dvec2(0) : length > most ? units * (most / length) : units;
  }

  RowChoice rows() const { return {1 << level_, 0}; }

  shader::EccScore scoreAt(const MovingPoint& place, glm::ivec2 offset, ScoredPick& pick) const {
    const Judgement judgement =
        judge(judgeInputs_[std::size_t(level_)], place.at, place.point, place.member, offset, rows());
    ++pick.mutations;
    pick.pixels += judgement.pixels();
    return judgement.score(input_.options.definition, input_.options.varianceFloor,
                           std::max(costAt(place, offset) - costAt(place, glm::ivec2(0)), std::int64_t(0)));
  }

  glm::dvec2 movedBy(const MovingPoint& place, glm::ivec2 offset) const {
    const std::vector<glm::ivec2>& start = input_.alignment.position[place.member];
    return glm::dvec2(place.at[place.member][place.point] + offset - start[place.point]) /
           double(kAlignmentUnitsPerPixel);
  }

  // Cost by displacementPrior, in integers.
  std::int64_t costAt(const MovingPoint& place, glm::ivec2 offset) const {
    const glm::ivec2 way =
        place.at[place.member][place.point] + offset - input_.alignment.position[place.member][place.point];
    const std::int64_t cost = shader::eccCost(way, scoreUnits(input_.options.rigidity));
    const glm::dvec2 along = epipolarDirection(place.point, place.member);
    const int off = int(std::lround(along.x * way.y - along.y * way.x));
    return cost + shader::eccCost(glm::ivec2(off, 0), scoreUnits(input_.options.epipolarWeight));
  }

  // Quadratic cost of a displacement: rigidity in all directions, epipolarWeight across the epipolar line. Zero for
  // other definitions of ECC than `channels`, whose costs are in integers (costAt).
  DisplacementPrior displacementPrior(std::uint32_t point, std::size_t member) const {
    if (input_.options.definition != EccDefinition::channels) return {};
    const glm::dvec2 along = epipolarDirection(point, member), across(-along.y, along.x);
    return {glm::dmat2(input_.options.rigidity) + input_.options.epipolarWeight * glm::outerProduct(across, across)};
  }

  // Epipolar direction; (0, 0): any direction.
  glm::dvec2 epipolarDirection(std::uint32_t point, std::size_t member) const {
    const auto& epipolar = input_.alignment.epipolar;
    return epipolar.empty() ? glm::dvec2(0) : glm::dvec2(epipolar[member][point]);
  }

  const BackendInput input_;
  std::vector<std::vector<Texels>> blurred_;  // from level 1 on
  std::vector<JudgeInput> judgeInputs_;       // of each level
  int level_ = -1;                            // of the current cycle; −1 before the first
};

}  // namespace

std::unique_ptr<AlignmentBackend> makeGradientBackend(const BackendInput& input) {
  return std::make_unique<GradientBackend>(input);
}

}  // namespace ibr
