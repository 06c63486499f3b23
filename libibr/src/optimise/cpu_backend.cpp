// SPDX-License-Identifier: Apache-2.0
// Method `cpu`: judges the stars of a class in parallel; no point of a class moves a star of another.
#include <algorithm>
#include <array>

#include "optimise/processor.h"
#include "shared/alignment.h"

namespace ibr {
namespace {

using shader::kAlignmentSurvivors, shader::kAlignmentPruneRows;

struct Candidate {
  glm::ivec2 offset{0};
  shader::EccScore score{};
};

class CpuBackend final : public AlignmentBackend {
 public:
  explicit CpuBackend(const BackendInput& input) : input_(input), judgeInput_{input.mesh, input.pictures} {}

  CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) override {
    return runCycleOnCpu(input_, at, keepGoing, [&](std::uint32_t point, std::size_t member, const Positions& now) {
      return best(point, member, request, now);
    });
  }

  std::vector<Judgement> judgeAll(const Positions& at) override { return judgeAllOnCpu(input_, at); }

 private:
  Pick best(std::uint32_t point, std::size_t member, const CycleRequest& request, const Positions& at) const {
    Pick pick;
    const AlignmentOptions& options = input_.options;
    const int reach = maxMove(input_.mesh, at, point, member, request.radius);
    if (reach == 0) return pick;
    const std::uint32_t seed = shader::eccPointSeed(request.seed, std::uint32_t(member), point);
    const std::uint32_t instances =
        options.scaledInstances ? shader::eccCandidateCount(std::uint32_t(options.instances), reach, request.radius)
                                : std::uint32_t(options.instances);
    std::vector<Candidate> candidates(1);
    for (std::uint32_t m = 1; m < instances; ++m) {
      const glm::ivec2 offset = candidateOffset(input_.mesh, at, point, member, reach, seed, m);
      if (fits(input_.mesh, at, point, member, offset)) candidates.push_back({offset});
    }
    if (options.prune && candidates.size() > 1 + kAlignmentSurvivors) prune(candidates, point, member, seed, at, pick);
    judgeEach(candidates, point, member, {}, at, pick);
    if (candidates.size() < 2) return pick;
    const Candidate* winner = &candidates[1];
    for (const Candidate& c : std::span(candidates).subspan(2))
      if (shader::eccGreater(c.score, winner->score)) winner = &c;
    if (shader::eccWins(winner->score, candidates[0].score)) pick.offset = winner->offset;
    return pick;
  }

  // Keeps the first candidate and the best of the others, in their order.
  void prune(std::vector<Candidate>& candidates, std::uint32_t point, std::size_t member, std::uint32_t seed,
             const Positions& at, Pick& pick) const {
    judgeEach(candidates, point, member, {int(kAlignmentPruneRows), int(seed % kAlignmentPruneRows)}, at, pick);
    std::vector<std::size_t> order;
    for (std::size_t c = 1; c < candidates.size(); ++c) order.push_back(c);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
      return shader::eccGreater(candidates[a].score, candidates[b].score);
    });
    order.resize(kAlignmentSurvivors);
    std::ranges::sort(order);
    std::vector<Candidate> left{candidates[0]};
    for (const std::size_t c : order) left.push_back(candidates[c]);
    candidates = std::move(left);
  }

  void judgeEach(std::span<Candidate> candidates, std::uint32_t point, std::size_t member, RowChoice rows,
                 const Positions& at, Pick& pick) const {
    for (Candidate& c : candidates) {
      const Judgement judgement = judge(judgeInput_, at, point, member, c.offset, rows);
      const glm::ivec2 way = at[member][point] - input_.alignment.position[member][point];
      c.score = judgement.score(input_.options.definition, input_.options.varianceFloor,
                                shader::eccAddedCost(way + c.offset, way, scoreUnits(input_.options.rigidity)));
      pick.pixels += judgement.pixels();
    }
    pick.mutations += candidates.size();
  }

  const BackendInput input_;
  const JudgeInput judgeInput_;
};

}  // namespace

std::unique_ptr<AlignmentBackend> makeCpuBackend(const BackendInput& input) {
  return std::make_unique<CpuBackend>(input);
}

}  // namespace ibr
