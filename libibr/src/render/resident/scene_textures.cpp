// SPDX-License-Identifier: Apache-2.0
#include "render/resident/scene_textures.h"

#include <algorithm>
#include <utility>

#include "base/check.h"
#include "render/resident/read_in_order.h"
#include "render/resident/stream_log.h"
#include "render/resident/texture_classes.h"

namespace ibr {
namespace {

constexpr std::uint32_t kMaxStandInSide = 64;     // maximum side of a stand-in, px
constexpr std::uint64_t kStandInShare = 4;        // inverse of the stand-ins' maximum share of the textures' budget
constexpr std::uint64_t kMinPhotographs = 16;     // photographs of a class that the budget should hold at once
constexpr std::uint64_t kMinArraysInBudget = 16;  // arrays are so small that memory can move between classes

}  // namespace

SceneTextures::SceneTextures(const Device& device, const GpuSceneOptions& options, const TextureLoader& loader,
                             std::vector<TextureArrayClass> classes, std::uint64_t otherBytes, Uploader& uploader,
                             JobQueue& jobs)
    : device_(&device),
      loader_(&loader),
      log_(options.log),
      classes_(std::move(classes)),
      budget_(options.budgetBytes),
      otherBytes_(otherBytes) {
  // The sum alone decides most cases, and requests no image that the device cannot have.
  const bool streams = budget_ > 0 && (otherBytes + totalBytes(classes_) > budget_ ||
                                       otherBytes + FixedTextureArrays::bytes(device, classes_) > budget_);
  if (streams) {
    setUpStreaming(options, uploader, jobs);
  } else {
    fixed_ = FixedTextureArrays(device, classes_, loader.items().count());
    fill(classes_, uploader, jobs, options.stop);
  }
}

std::uint64_t SceneTextures::minBytes(const Device& device, const std::vector<TextureArrayClass>& classes) {
  return FixedTextureArrays::bytes(device, reduced(classes, 1));
}

// Divides the budget: small images of all textures first, which stand in while a texture is not resident; the rest for
// arrays of streamed textures.
void SceneTextures::setUpStreaming(const GpuSceneOptions& options, Uploader& uploader, JobQueue& jobs) {
  const std::uint64_t smallest = otherBytes_ + minBytes(*device_, classes_);
  check(budget_ >= smallest, ErrorCode::outOfMemory,
        "a budget of {} bytes is too small: this scene needs {} bytes even at one pixel per photograph, {} bytes of "
        "them for meshes",
        budget_, smallest, otherBytes_);
  const std::uint64_t forTextures = budget_ - otherBytes_;
  std::uint32_t side = kMaxStandInSide;
  std::vector<TextureArrayClass> standIns = reduced(classes_, side);
  while (side > 1 && FixedTextureArrays::bytes(*device_, standIns) > forTextures / kStandInShare)
    standIns = reduced(classes_, side /= 2);
  fixed_ = FixedTextureArrays(*device_, standIns, loader_->items().count());
  fill(standIns, uploader, jobs, options.stop);

  const std::uint64_t rest = forTextures - fixed_.allocatedBytes();
  say(log_, LogLevel::info,
      "photographs are streamed: {:.1f} MB of textures, a budget of {:.1f} MB, {:.1f} MB of it for stand-ins of {} px",
      megabytes(totalBytes(classes_)), megabytes(budget_), megabytes(fixed_.allocatedBytes()), side);
  if (side < kMaxStandInSide)
    say(log_, LogLevel::warning,
        "stand-ins of photographs have {} px instead of {}: the budget of {:.1f} MB is too small", side,
        kMaxStandInSide, megabytes(budget_));
  setUpResidency(standIns, rest);
}

// Chooses the levels and the arrays that fit into `budget` bytes.
void SceneTextures::setUpResidency(std::span<const TextureArrayClass> standIns, std::uint64_t budget) {
  streamed_.emplace().budget = budget;
  streamed_->classOf.assign(loader_->items().count(), Residency::kNone);
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    TextureArrayClass& arrayClass = classes_[c];
    const std::uint64_t least = std::min<std::uint64_t>(kMinPhotographs, arrayClass.items.size());
    while (arrayClass.firstLevel < standIns[c].firstLevel && arrayClass.layerBytes() * least > budget)
      ++arrayClass.firstLevel;
    if (arrayClass.firstLevel > 0)
      say(log_, LogLevel::warning,
          "{} are shown at 1/{} of their size or less: a budget of {:.1f} MB does not hold {} of them{}",
          arrayClass.text(), 1u << arrayClass.firstLevel, megabytes(budget_), least,
          arrayClass.format == TextureFormat::bc1 || arrayClass.isDepth() ? "" : "; bc1 textures take less memory");
    const std::uint32_t layers =
        layersWithin(*device_, arrayClass, std::min<std::uint64_t>(kMaxArrayBytes, budget / kMinArraysInBudget));
    const std::uint64_t arrayBytes = allocationBytes(*device_, arrayInfo(arrayClass, layers), arrayClass.text());
    streamed_->residencyClasses.push_back({arrayBytes, layers});
    if (arrayClass.firstLevel < standIns[c].firstLevel)
      for (const std::uint32_t item : arrayClass.items) streamed_->classOf[item] = std::uint32_t(c);
  }
}

void SceneTextures::fill(std::span<const TextureArrayClass> classes, Uploader& uploader, JobQueue& jobs,
                         const std::stop_token& stop) {
  for (const GpuImage& array : fixed_.arrays()) uploader.beginImage(array);
  std::vector<std::pair<const TextureArrayClass*, std::uint32_t>> all;  // class and item
  for (const TextureArrayClass& arrayClass : classes)
    for (const std::uint32_t item : arrayClass.items) all.emplace_back(&arrayClass, item);
  readInOrder<Texture>(
      jobs, all.size(), stop,
      [&](std::size_t i, const std::stop_token& reading) {
        return loader_->load(all[i].second, *all[i].first, reading);
      },
      [&](std::size_t i, const Texture& texture) {
        const auto& [arrayClass, item] = all[i];
        for (std::uint32_t l = 0; l < arrayClass->levels(); ++l) {
          const VkExtent2D extent{std::uint32_t(std::max(1, texture.width >> l)),
                                  std::uint32_t(std::max(1, texture.height >> l))};
          uploader.image(fixed_.image(item), fixed_.layer(item), l, extent, texture.levels[l]);
        }
      });
}

SceneTextures::Sampled SceneTextures::at(std::uint32_t item) const {
  if (streamer_)
    if (const auto resident = streamer_->texture(item)) return *resident;
  return {fixed_.image(item).view(), fixed_.layer(item)};
}

std::uint64_t SceneTextures::depthBytes() const noexcept {
  return fixed_.depthBytes() + (streamer_ ? streamer_->depthBytes() : 0);
}

std::uint64_t SceneTextures::allocatedBytes() const noexcept {
  return fixed_.allocatedBytes() + (streamer_ ? streamer_->allocatedBytes() : 0);
}

}  // namespace ibr
