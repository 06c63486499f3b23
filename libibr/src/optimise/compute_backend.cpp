// SPDX-License-Identifier: Apache-2.0
// Method `compute`: submits all classes of an image at once, or one class at a time with a guard to call in between.
#include <vector>

#include "base/vulkan/submit.h"
#include "optimise/alignment_backend.h"
#include "optimise/alignment_pass.h"

namespace ibr {
namespace {

class ComputeBackend final : public AlignmentBackend {
 public:
  ComputeBackend(const BackendInput& input, const Device& device, Uploader&& uploader)
      : input_(input),
        device_(device),
        pass_(device, input.mesh, input.pictures, input.alignment.position, input.options, uploader),
        submission_(device) {
    uploader.flush();
  }

  CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) override {
    CycleCounts counts;
    pass_.upload(device_, at);
    const std::uint32_t classes = pass_.classCount(), together = input_.options.guard ? 1 : classes;
    const std::vector<std::uint32_t>& first = input_.mesh.colours.first;
    for (std::uint32_t member = 0; member < at.size(); ++member)
      for (std::uint32_t c = 0; c < classes; c += together) {
        submission_.run([&](VkCommandBuffer commands) {
          for (std::uint32_t k = c; k < c + together; ++k)
            pass_.recordMove(commands, {member, k, request.radius, request.seed});
          pass_.buffers().recordOutcomeReadback(commands, pass_.firstOutcome(member) + first[c],
                                                first[c + together] - first[c]);
        });
        take(first[c], first[c + together], member, at, counts);
        keepGoing();
      }
    return counts;
  }

  std::vector<Judgement> judgeAll(const Positions& at) override {
    pass_.upload(device_, at);
    submission_.run([&](VkCommandBuffer commands) {
      pass_.recordEvaluation(commands);
      pass_.buffers().recordJudgementReadback(commands);
    });
    return pass_.judgements();
  }

 private:
  // Reads back the moves of points [first, last) of the list in this image.
  void take(std::size_t first, std::size_t last, std::uint32_t member, Positions& at, CycleCounts& counts) {
    std::vector<Moved> moved;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t point = input_.mesh.colours.values[i];
      const shader::AlignmentOutcome& outcome = pass_.buffers().outcomes()[pass_.firstOutcome(member) + i];
      counts.mutations += outcome.mutations;
      counts.pixels += std::uint64_t(outcome.pixels);
      if (outcome.offset == glm::ivec2(0)) continue;
      moved.push_back({point, at[member][point]});
      at[member][point] += outcome.offset;
    }
    const std::size_t refused = counts.refused;
    applyGuard(input_.options.guard, moved, member, at, counts);
    if (counts.refused != refused) pass_.upload(device_, at);
  }

  const BackendInput input_;
  const Device& device_;
  AlignmentPass pass_;
  Submission submission_;
};

}  // namespace

std::unique_ptr<AlignmentBackend> makeComputeBackend(const BackendInput& input, const Device& device) {
  return std::make_unique<ComputeBackend>(input, device, Uploader(device));
}

}  // namespace ibr
