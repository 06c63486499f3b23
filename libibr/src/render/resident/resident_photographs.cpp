// SPDX-License-Identifier: Apache-2.0
#include "render/resident/resident_photographs.h"

#include <algorithm>
#include <utility>

#include "base/check.h"
#include "render/resident/photograph_classes.h"
#include "render/resident/read_in_order.h"
#include "render/resident/stream_log.h"

namespace ibr {
namespace {

constexpr std::uint32_t kMaxStandInSide = 64;     // maximum side of a stand-in, px
constexpr std::uint64_t kStandInShare = 4;        // inverse of the stand-ins' maximum share of the textures' budget
constexpr std::uint64_t kMinPhotographs = 16;     // photographs of a class that the budget should hold at once
constexpr std::uint64_t kMinArraysInBudget = 16;  // arrays are so small that memory can move between classes

}  // namespace

Photographs::Photographs(const Device& device, const Scene& scene, const GpuSceneOptions& options,
                         const std::vector<std::uint32_t>& nodes, std::uint64_t meshBytes, Uploader& uploader,
                         JobQueue& jobs)
    : device_(&device),
      scene_(&scene),
      loader_(scene, options.source),
      log_(options.log),
      classes_(classify(device, scene, loader_, nodes, jobs, options.stop)),
      budget_(options.budgetBytes),
      meshBytes_(meshBytes) {
  decodeBlocks(device, options, meshBytes, classes_);
  // The sum alone decides most cases, and requests no image that the device cannot have.
  const bool streams = budget_ > 0 && (meshBytes + totalBytes(classes_) > budget_ ||
                                       meshBytes + FixedTextureArrays::bytes(device, classes_) > budget_);
  if (streams) {
    setUpStreaming(options, uploader, jobs);
  } else {
    fixed_ = FixedTextureArrays(device, classes_, scene.nodes.size());
    fill(classes_, uploader, jobs, options.stop);
  }
}

// Divides the budget: small images of all photographs first, which stand in while a photograph is not resident; the
// rest for arrays of streamed photographs.
void Photographs::setUpStreaming(const GpuSceneOptions& options, Uploader& uploader, JobQueue& jobs) {
  const std::uint64_t smallest = meshBytes_ + FixedTextureArrays::bytes(*device_, reduced(classes_, 1));
  check(budget_ >= smallest, ErrorCode::outOfMemory,
        "a budget of {} bytes is too small: this scene needs {} bytes even at one pixel per photograph, {} bytes of "
        "them for meshes",
        budget_, smallest, meshBytes_);
  const std::uint64_t forTextures = budget_ - meshBytes_;
  std::uint32_t side = kMaxStandInSide;
  std::vector<TextureArrayClass> standIns = reduced(classes_, side);
  while (side > 1 && FixedTextureArrays::bytes(*device_, standIns) > forTextures / kStandInShare)
    standIns = reduced(classes_, side /= 2);
  fixed_ = FixedTextureArrays(*device_, standIns, scene_->nodes.size());
  fill(standIns, uploader, jobs, options.stop);

  const std::uint64_t rest = forTextures - fixed_.allocatedBytes();
  say(log_, LogLevel::info,
      "photographs are streamed: {:.1f} MB of textures, a budget of {:.1f} MB, {:.1f} MB of it for stand-ins of {} px",
      megabytes(totalBytes(classes_)), megabytes(budget_), megabytes(fixed_.allocatedBytes()), side);
  if (side < kMaxStandInSide)
    say(log_, LogLevel::warning,
        "stand-ins of photographs have {} px instead of {}: the budget of {:.1f} MB is too small", side,
        kMaxStandInSide, megabytes(budget_));

  streamed_ =
      std::make_unique<StreamedPhotographs>(*device_, jobs, loader_, setUpResidency(standIns, rest, options), log_);
}

// Chooses the levels and the arrays that fit into `budget` bytes.
StreamedPhotographs::Setup Photographs::setUpResidency(std::span<const TextureArrayClass> standIns,
                                                       std::uint64_t budget, const GpuSceneOptions& options) {
  StreamedPhotographs::Setup setup{
      .budget = budget, .otherBytes = budget_ - budget, .stagingBytes = options.stagingBytes};
  setup.classOf.assign(scene_->nodes.size(), Residency::kNone);
  std::uint64_t minLayerBytes = ~std::uint64_t(0);
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    TextureArrayClass& arrayClass = classes_[c];
    const std::uint64_t least = std::min<std::uint64_t>(kMinPhotographs, arrayClass.nodes.size());
    while (arrayClass.firstLevel < standIns[c].firstLevel && arrayClass.layerBytes() * least > budget)
      ++arrayClass.firstLevel;
    if (arrayClass.firstLevel > 0)
      say(log_, LogLevel::warning,
          "{} are shown at 1/{} of their size or less: a budget of {:.1f} MB does not hold {} of them{}",
          arrayClass.text(), 1u << arrayClass.firstLevel, megabytes(budget_), least,
          arrayClass.format == TextureFormat::bc1 ? "" : "; bc1 textures take less memory");
    const std::uint32_t layers =
        layersWithin(*device_, arrayClass, std::min<std::uint64_t>(kMaxArrayBytes, budget / kMinArraysInBudget));
    const std::uint64_t arrayBytes = allocationBytes(*device_, arrayInfo(arrayClass, layers), arrayClass.text());
    setup.residencyClasses.push_back({arrayBytes, layers});
    minLayerBytes = std::min(minLayerBytes, arrayBytes / layers);
    if (arrayClass.firstLevel < standIns[c].firstLevel)
      for (const std::uint32_t node : arrayClass.nodes) setup.classOf[node] = std::uint32_t(c);
  }
  maxResident_ = std::size_t(budget / std::max<std::uint64_t>(minLayerBytes, 1));
  setup.classes = classes_;
  return setup;
}

void Photographs::fill(std::span<const TextureArrayClass> classes, Uploader& uploader, JobQueue& jobs,
                       const std::stop_token& stop) {
  for (const GpuImage& array : fixed_.arrays()) uploader.beginImage(array);
  std::vector<std::pair<const TextureArrayClass*, std::uint32_t>> all;  // class and node
  for (const TextureArrayClass& arrayClass : classes)
    for (const std::uint32_t node : arrayClass.nodes) all.emplace_back(&arrayClass, node);
  readInOrder<Texture>(
      jobs, all.size(), stop,
      [&](std::size_t i, const std::stop_token& reading) {
        return loader_.load(all[i].second, *all[i].first, reading);
      },
      [&](std::size_t i, const Texture& texture) {
        const auto& [arrayClass, node] = all[i];
        for (std::uint32_t l = 0; l < arrayClass->levels(); ++l) {
          const VkExtent2D extent{std::uint32_t(std::max(1, texture.width >> l)),
                                  std::uint32_t(std::max(1, texture.height >> l))};
          uploader.image(fixed_.image(node), fixed_.layer(node), l, extent, texture.levels[l]);
        }
      });
}

Photographs::Sampled Photographs::at(std::uint32_t node) const {
  if (streamed_)
    if (const auto resident = streamed_->at(node)) return *resident;
  return {fixed_.image(node).view(), fixed_.layer(node)};
}

std::uint64_t Photographs::allocatedBytes() const noexcept {
  return fixed_.allocatedBytes() + (streamed_ ? streamed_->allocatedBytes() : 0);
}

}  // namespace ibr
