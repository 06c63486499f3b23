// SPDX-License-Identifier: Apache-2.0
#include "ibr/ecc_pass.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "optimise/alignment_pass.h"

namespace ibr {
namespace {

std::vector<Texels> texelsOf(const Alignment& alignment) {
  std::vector<Texels> texels;
  for (const Image8* picture : alignment.pictures) texels.push_back(texelsOf(*picture));
  return texels;
}

const AlignmentOptions& checked(const AlignmentOptions& options) {
  const std::string fault = firstInvalidOption(options);
  check(fault.empty(), ErrorCode::invalidInput, "alignment: {}", fault);
  return options;
}

}  // namespace

struct EccPass::State {
  State(const Device& device, const Alignment& alignment, const AlignmentOptions& options, Uploader&& uploader)
      : mesh(starMeshOf(alignment)),
        pass(device, mesh, texelsOf(alignment), alignment.position, checked(options), uploader),
        floor(options.varianceFloor) {
    pass.upload(alignment.position, uploader);
    uploader.flush();
  }
  StarMesh mesh;
  AlignmentPass pass;
  double floor;
};

EccPass::EccPass(const Device& device, const Alignment& alignment, const AlignmentOptions& options, Uploads* uploads)
    : state_(std::make_unique<State>(device, alignment, options, Uploader(device, uploads))) {}
EccPass::EccPass(EccPass&&) noexcept = default;
EccPass& EccPass::operator=(EccPass&&) noexcept = default;
EccPass::~EccPass() = default;

std::uint32_t EccPass::classCount() const noexcept {
  return state_->pass.classCount();
}

void EccPass::recordMove(VkCommandBuffer commands, const EccMove& move) const noexcept {
  const int radius = std::max(int(move.radiusPx * kAlignmentUnitsPerPixel), 1);
  state_->pass.recordMove(commands, {move.picture, move.pointClass, radius, move.seed});
}

void EccPass::recordEvaluation(VkCommandBuffer commands) const noexcept {
  state_->pass.recordEvaluation(commands);
}

void EccPass::recordReadback(VkCommandBuffer commands) const noexcept {
  state_->pass.buffers().recordPositionReadback(commands);
  state_->pass.buffers().recordJudgementReadback(commands);
}

Positions EccPass::positions() const {
  const std::size_t n = state_->mesh.vertexCount();
  Positions at;
  for (std::size_t i = 0; i < state_->mesh.memberCount(); ++i) {
    const auto member = state_->pass.buffers().positions().subspan(i * n, n);
    at.emplace_back(member.begin(), member.end());
  }
  return at;
}

std::vector<std::vector<EccStar>> EccPass::stars() const {
  const std::size_t n = state_->mesh.vertexCount();
  const std::vector<Judgement> judgements = state_->pass.judgements();
  std::vector<std::vector<EccStar>> stars(state_->mesh.memberCount());
  for (std::size_t i = 0; i < judgements.size(); ++i)
    stars[i / n].push_back({eccOf(judgements[i].score(EccDefinition::channels, state_->floor)),
                            eccOf(judgements[i].score(EccDefinition::concatenated, 0)), judgements[i].pixels()});
  return stars;
}

}  // namespace ibr
