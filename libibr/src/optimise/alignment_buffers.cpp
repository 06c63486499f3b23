// SPDX-License-Identifier: Apache-2.0
#include "optimise/alignment_buffers.h"

#include <array>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"

namespace ibr {
namespace {

using namespace shader;

AlignmentMesh describe(const StarMesh& mesh, std::span<const Texels> pictures) {
  AlignmentMesh described{};
  described.members = std::uint32_t(mesh.memberCount());
  described.points = std::uint32_t(mesh.vertexCount());
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    described.pictures[i] = {mesh.size[i], first, std::uint32_t(pictures[i].stride)};
    first += std::uint32_t(pictures[i].words.size());
  }
  return described;
}

std::vector<glm::uvec3> keptOf(const StarMesh& mesh) {
  std::vector<glm::uvec3> kept;
  for (std::size_t k = 0; k < mesh.kept.values.size(); ++k)
    kept.push_back({mesh.kept.values[k], mesh.keptWhere.values[k]});
  return kept;
}

std::vector<glm::uvec3> bordersOf(const StarMesh& mesh) {
  static_assert(kBorderInterior == std::uint32_t(BorderKind::interior) &&
                kBorderSlides == std::uint32_t(BorderKind::slides) && kBorderFixed == std::uint32_t(BorderKind::fixed));
  std::vector<glm::uvec3> borders;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p)
    borders.push_back({mesh.chord[p], std::uint32_t(mesh.border[p])});
  return borders;
}

template <class T>
std::span<const T> mappedAs(const Buffer& buffer) {
  return {reinterpret_cast<const T*>(buffer.mapped().data()), buffer.size() / sizeof(T)};
}

// Copies the output of shaders to the same offset of the host's buffer.
void copyToHost(VkCommandBuffer commands, const Buffer& from, const Buffer& to, VkDeviceSize offset,
                VkDeviceSize bytes) {
  const VkBufferCopy region{offset, offset, bytes};
  bufferBarrier(commands, use::kComputeReadWrite, use::kTransferRead);
  vkCmdCopyBuffer(commands, from.get(), to.get(), 1, &region);
  bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
}

}  // namespace

AlignmentBuffers::AlignmentBuffers(const Device& device, const StarMesh& mesh, std::span<const Texels> pictures,
                                   const Positions& starts, Uploader& uploader) {
  check(device.supportsInt64(), ErrorCode::unsupported, "{}: shaderInt64 is not supported; align with method cpu",
        device.name());
  const std::size_t n = mesh.vertexCount(), d = mesh.memberCount();
  std::size_t texels = 0;
  for (const Texels& picture : pictures) texels += picture.words.size();
  check(texels * sizeof(std::uint32_t) <= device.properties().limits.maxStorageBufferRange, ErrorCode::unsupported,
        "{}: images of {} MiB in total do not fit into a storage buffer; align with method cpu", device.name(),
        texels >> 18);

  const std::size_t moving = std::max<std::size_t>(mesh.colours.values.size(), 1);
  const auto make = [&](int binding, std::size_t bytes, const char* name) {
    buffers_[std::size_t(binding)] =
        Buffer(device, std::max<std::size_t>(bytes, 16),
               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
               MemoryKind::device, name);
  };
  buffers_.resize(kAlignmentBindings);
  const auto fill = [&](int binding, std::span<const std::byte> bytes, const char* name) {
    make(binding, bytes.size(), name);
    uploader.buffer(buffers_[std::size_t(binding)], 0, bytes);
  };
  const AlignmentMesh described = describe(mesh, pictures);
  const std::vector<glm::uvec3> kept = keptOf(mesh), borders = bordersOf(mesh);
  fill(kBindingAlignment, std::as_bytes(std::span(&described, 1)), "alignment");
  fill(kBindingStarFirst, std::as_bytes(std::span(mesh.star.first)), "first edges of stars");
  fill(kBindingStarEdges, std::as_bytes(std::span(mesh.star.values)), "edges of stars");
  fill(kBindingKeptFirst, std::as_bytes(std::span(mesh.kept.first)), "first edges kept");
  fill(kBindingKeptEdges, std::as_bytes(std::span(kept)), "edges kept");
  fill(kBindingBorder, std::as_bytes(std::span(borders)), "borders");
  fill(kBindingPoints, std::as_bytes(std::span(mesh.colours.values)), "movable points");
  make(kBindingTexels, texels * sizeof(std::uint32_t), "images to align");
  for (std::size_t i = 0; i < d; ++i)
    uploader.buffer(buffers_[kBindingTexels], VkDeviceSize(described.pictures[i].firstTexel) * sizeof(std::uint32_t),
                    std::as_bytes(std::span(pictures[i].words)));
  make(kBindingPositions, d * n * sizeof(glm::ivec2), "positions");
  make(kBindingStarts, d * n * sizeof(glm::ivec2), "initial positions");
  upload(starts, kBindingStarts, uploader);
  make(kBindingOutcomes, d * moving * sizeof(AlignmentOutcome), "outcomes");
  make(kBindingJudgements, d * n * sizeof(AlignmentJudgement), "judgements");
  const auto host = [&](int binding, const char* name) {
    return Buffer(device, buffers_[std::size_t(binding)].size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback,
                  name);
  };
  hostPositions_ = host(kBindingPositions, "positions readback");
  hostOutcomes_ = host(kBindingOutcomes, "outcomes readback");
  hostJudgements_ = host(kBindingJudgements, "judgements readback");

  std::array<VkDescriptorSetLayoutBinding, kAlignmentBindings> bindings;
  for (std::uint32_t b = 0; b < bindings.size(); ++b)
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                   VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  layout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kAlignmentBindings};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  set_ = allocateSet(device, pool_.get(), layout_.get());
  for (std::uint32_t b = 0; b < bindings.size(); ++b) writeStorageBuffer(device, set_, b, buffers_[b].get());
}

void AlignmentBuffers::upload(const Device& device, const Positions& at) {
  Uploader uploader(device, nullptr, kSmallStagingBytes);
  upload(at, uploader);
  uploader.flush();
}

void AlignmentBuffers::upload(const Positions& at, int binding, Uploader& uploader) {
  VkDeviceSize offset = 0;
  for (const auto& member : at) {
    const auto bytes = std::as_bytes(std::span(member));
    uploader.buffer(buffers_[std::size_t(binding)], offset, bytes);
    offset += bytes.size();
  }
}

void AlignmentBuffers::recordPositionReadback(VkCommandBuffer commands) const noexcept {
  copyToHost(commands, buffers_[kBindingPositions], hostPositions_, 0, hostPositions_.size());
}

void AlignmentBuffers::recordOutcomeReadback(VkCommandBuffer commands, std::uint32_t first,
                                             std::uint32_t count) const noexcept {
  constexpr VkDeviceSize kBytes = sizeof(AlignmentOutcome);
  if (count > 0) copyToHost(commands, buffers_[kBindingOutcomes], hostOutcomes_, first * kBytes, count * kBytes);
}

void AlignmentBuffers::recordJudgementReadback(VkCommandBuffer commands) const noexcept {
  copyToHost(commands, buffers_[kBindingJudgements], hostJudgements_, 0, hostJudgements_.size());
}

std::span<const glm::ivec2> AlignmentBuffers::positions() const noexcept {
  return mappedAs<glm::ivec2>(hostPositions_);
}
std::span<const AlignmentOutcome> AlignmentBuffers::outcomes() const noexcept {
  return mappedAs<AlignmentOutcome>(hostOutcomes_);
}
std::span<const AlignmentJudgement> AlignmentBuffers::judgements() const noexcept {
  return mappedAs<AlignmentJudgement>(hostJudgements_);
}

}  // namespace ibr
