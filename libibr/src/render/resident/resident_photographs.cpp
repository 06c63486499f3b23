// SPDX-License-Identifier: Apache-2.0
#include "render/resident/resident_photographs.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "ibr/texture.h"

namespace ibr {
namespace {

constexpr std::uint32_t kMaxStandInSide = 64;     // maximum side of a stand-in, px
constexpr std::uint64_t kStandInShare = 4;        // inverse of the stand-ins' maximum share of the textures' budget
constexpr std::uint64_t kMinPhotographs = 16;     // photographs of a class that the budget should hold at once
constexpr std::uint64_t kMinArraysInBudget = 16;  // arrays are so small that memory can move between classes

template <class... Arguments>
void say(const LogCallback& log, LogLevel level, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (log) log(level, fmt::format(format, std::forward<Arguments>(arguments)...));
}

double megabytes(std::uint64_t bytes) {
  return double(bytes) / 1e6;
}

Texture readTexture(const Scene& scene, std::size_t node, int firstLevel) {
  return readKtx2(scene.folder / scene.nodes[node].textureFile, firstLevel);
}

std::uint64_t totalBytes(std::span<const TextureArrayClass> classes) {
  std::uint64_t bytes = 0;
  for (const TextureArrayClass& arrayClass : classes) bytes += arrayClass.layerBytes() * arrayClass.nodes.size();
  return bytes;
}

// Groups the nodes by format and size. The smallest level is enough to find a photograph's format.
std::vector<TextureArrayClass> classify(const Device& device, const Scene& scene, const TextureSource& source,
                                        const std::vector<std::uint32_t>& nodes) {
  std::map<std::tuple<int, int, TextureFormat>, TextureArrayClass> classes;
  for (const std::uint32_t node : nodes) {
    const Intrinsics& k = scene.nodes[node].camera.intrinsics;
    const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
    check(std::uint32_t(std::max(k.width, k.height)) <= largest, ErrorCode::unsupported,
          "{}: {}x{} exceeds the device's maximum image size of {}; build with a smaller --max-size",
          scene.nodes[node].name, k.width, k.height, largest);
    TextureArrayClass single{.extent = {std::uint32_t(k.width), std::uint32_t(k.height)}};
    single.format = source(scene, node, int(single.levels()) - 1).format;
    classes.try_emplace({k.width, k.height, single.format}, single).first->second.nodes.push_back(node);
  }
  std::vector<TextureArrayClass> result;
  for (auto& [key, arrayClass] : classes) result.push_back(std::move(arrayClass));
  return result;
}

std::uint64_t largestHeap(const Device& device) {
  std::uint64_t bytes = 0;
  const VkPhysicalDeviceMemoryProperties& memory = device.memoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    bytes = std::max<std::uint64_t>(bytes, memory.memoryHeaps[i].size);
  return bytes;
}

void decodeBlocks(const Device& device, const GpuSceneOptions& options, std::uint64_t meshBytes,
                  std::vector<TextureArrayClass>& classes) {
  std::vector<TextureArrayClass> decoded = classes;
  for (TextureArrayClass& arrayClass : decoded) arrayClass.format = TextureFormat::rgba8;
  const std::uint64_t before = totalBytes(classes), after = totalBytes(decoded);
  const bool software = device.kind() == DeviceKind::software;
  const bool budgeted = options.budgetBytes > 0;
  const bool fits = after <= largestHeap(device) / 2 && (!budgeted || after + meshBytes <= options.budgetBytes);
  // A software device is so slow with BC7 that RGBA8 is better, even if fewer photographs are resident.
  const auto faster = [&](TextureFormat format) {
    return software && (fits || (budgeted && format == TextureFormat::bc7));
  };
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (!device.supportsBlockCompression() || options.blocks == BlockTextureMode::decode ||
        (options.blocks == BlockTextureMode::automatic && faster(classes[c].format)))
      classes[c].format = TextureFormat::rgba8;
  if (totalBytes(classes) == before) return;
  say(options.log, device.supportsBlockCompression() ? LogLevel::info : LogLevel::warning,
      "textures are decoded to RGBA8, {:.1f} MB instead of {:.1f} MB: {} {}", megabytes(totalBytes(classes)),
      megabytes(before), device.name(),
      !device.supportsBlockCompression()           ? "does not support block compression"
      : options.blocks == BlockTextureMode::decode ? "decodes textures as requested"
                                                   : "samples RGBA8 faster");
}

// Returns the classes with photographs of at most `side` px.
std::vector<TextureArrayClass> reduced(std::vector<TextureArrayClass> classes, std::uint32_t side) {
  for (TextureArrayClass& arrayClass : classes)
    while (std::max(arrayClass.arrayExtent().width, arrayClass.arrayExtent().height) > side) ++arrayClass.firstLevel;
  return classes;
}

}  // namespace

Photographs::Photographs(const Device& device, const Scene& scene, const GpuSceneOptions& options,
                         const std::vector<std::uint32_t>& nodes, std::uint64_t meshBytes, Uploader& uploader)
    : device_(&device),
      scene_(&scene),
      source_(options.source ? options.source : readTexture),
      log_(options.log),
      classes_(classify(device, scene, source_, nodes)),
      budget_(options.budgetBytes),
      meshBytes_(meshBytes) {
  decodeBlocks(device, options, meshBytes, classes_);
  // The sum alone decides most cases, and requests no image that the device cannot have.
  streams_ = budget_ > 0 && (meshBytes + totalBytes(classes_) > budget_ ||
                             meshBytes + FixedTextureArrays::bytes(device, classes_) > budget_);
  if (streams_) {
    setUpStreaming(uploader);
  } else {
    fixed_ = FixedTextureArrays(device, classes_, scene.nodes.size());
    fill(classes_, uploader);
  }
}

// Divides the budget: small images of all photographs first, which stand in while a photograph is not resident; the
// rest for arrays of streamed photographs.
void Photographs::setUpStreaming(Uploader& uploader) {
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
  fill(standIns, uploader);

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
void Photographs::setUpResidency(std::span<const TextureArrayClass> standIns, std::uint64_t budget) {
  std::vector<Residency::Class> residencyClasses;
  classOf_.assign(scene_->nodes.size(), Residency::kNone);
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
    layersPerArray_.push_back(layers);
    residencyClasses.push_back({arrayBytes, layers});
    minLayerBytes = std::min(minLayerBytes, arrayBytes / layers);
    if (arrayClass.firstLevel < standIns[c].firstLevel)
      for (const std::uint32_t node : arrayClass.nodes) classOf_[node] = std::uint32_t(c);
  }
  maxResident_ = std::size_t(budget / std::max<std::uint64_t>(minLayerBytes, 1));
  residency_ = Residency(std::move(residencyClasses), classOf_, budget);
}

Texture Photographs::load(std::uint32_t node, const TextureArrayClass& arrayClass) const {
  Texture texture = source_(*scene_, node, int(arrayClass.firstLevel));
  const std::string& name = scene_->nodes[node].name;
  const VkExtent2D extent = arrayClass.arrayExtent();
  check(texture.levels.size() == arrayClass.levels(), ErrorCode::invalidInput,
        "{}: texture has {} levels from level {} on, not {}", name, texture.levels.size(), arrayClass.firstLevel,
        arrayClass.levels());
  check(std::uint32_t(texture.width) == extent.width && std::uint32_t(texture.height) == extent.height,
        ErrorCode::invalidInput, "{}: texture level {} is {}x{}, not {}x{}", name, arrayClass.firstLevel, texture.width,
        texture.height, extent.width, extent.height);
  for (std::uint32_t l = 0; l < arrayClass.levels(); ++l) {
    const std::uint64_t bytes =
        textureBytes(texture.format, std::max(1, texture.width >> l), std::max(1, texture.height >> l));
    check(texture.levels[l].size() == bytes, ErrorCode::invalidInput, "{}: texture level {} has {} bytes, not {}", name,
          arrayClass.firstLevel + l, texture.levels[l].size(), bytes);
  }
  if (texture.format != arrayClass.format && arrayClass.format == TextureFormat::rgba8)
    texture = decodeTexture(texture);
  check(texture.format == arrayClass.format, ErrorCode::invalidInput,
        "{}: texture has format {} in one level, {} in another", name, textureFormatName(arrayClass.format),
        textureFormatName(texture.format));
  return texture;
}

void Photographs::fill(std::span<const TextureArrayClass> classes, Uploader& uploader) {
  for (const GpuImage& array : fixed_.arrays()) uploader.beginImage(array);
  for (const TextureArrayClass& arrayClass : classes)
    for (const std::uint32_t node : arrayClass.nodes) {
      const Texture texture = load(node, arrayClass);
      for (std::uint32_t l = 0; l < arrayClass.levels(); ++l) {
        const VkExtent2D extent{std::uint32_t(std::max(1, texture.width >> l)),
                                std::uint32_t(std::max(1, texture.height >> l))};
        uploader.image(fixed_.image(node), fixed_.layer(node), l, extent, texture.levels[l]);
      }
    }
}

Photographs::Sampled Photographs::at(std::uint32_t node) const {
  if (streams_)
    if (const auto slot = residency_.slot(node)) return {arrays_[slot->array].view(), slot->layer};
  return {fixed_.image(node).view(), fixed_.layer(node)};
}

std::uint64_t Photographs::allocatedBytes() const noexcept {
  std::uint64_t bytes = fixed_.allocatedBytes();
  for (const GpuImage& array : arrays_) bytes += array.allocatedBytes();
  return bytes;
}

GpuScene::StreamStatus Photographs::stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                           std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                           const std::function<void(VkImageView)>& evicting) {
  assert(streams_);
  residency_.begin(wanted, needed, frame, completedFrame);
  stream_.begin(frame, completedFrame);
  runSteps(evicting);
  stream_.record(commandBuffer);
  const Residency::Counts counts = residency_.endFrame();
  const GpuScene::StreamStatus streamed{.needed = std::uint32_t(needed),
                                        .waiting = counts.waiting,
                                        .overBudget = counts.overBudget,
                                        .failed = counts.failed,
                                        .uploadedBytes = stream_.frameBytes()};
  report(streamed);
  return streamed;
}

void Photographs::runSteps(const std::function<void(VkImageView)>& evicting) {
  for (;;) {
    if (stream_.busy()) {
      if (!stream_.advance()) return;
      residency_.finishLoad(std::exchange(loading_, Residency::kNone));
    }
    const auto step = residency_.next();
    if (!step) return;
    switch (step->kind) {
      case Residency::Step::Kind::freeArray:
        evicting(arrays_[step->array].view());
        arrays_[step->array] = {};
        break;
      case Residency::Step::Kind::makeArray:
        makeArray(*step);
        break;
      case Residency::Step::Kind::load:
        beginLoad(*step);
        break;
    }
  }
}

void Photographs::makeArray(const Residency::Step& step) {
  const TextureArrayClass& arrayClass = classes_[step.photographClass];
  arrays_.resize(std::max<std::size_t>(arrays_.size(), step.array + 1));
  try {
    arrays_[step.array] =
        GpuImage(*device_, arrayInfo(arrayClass, layersPerArray_[step.photographClass]), arrayClass.text());
    stream_.addArray(arrays_[step.array]);
  } catch (const Error& e) {
    residency_.allocationFailed(step.array);
    budget_ = meshBytes_ + allocatedBytes();
    say(log_, LogLevel::warning, "the budget is lowered to {:.1f} MB: {}", megabytes(budget_), e.what());
  }
}

void Photographs::beginLoad(const Residency::Step& step) {
  try {
    stream_.start(arrays_[step.array], step.layer, load(step.photograph, classes_[classOf_[step.photograph]]));
    loading_ = step.photograph;
  } catch (const Error& e) {
    residency_.failed(step.photograph);
    say(log_, LogLevel::error, "a photograph cannot be loaded and keeps its stand-in: {}", e.what());
  }
}

void Photographs::report(const GpuScene::StreamStatus& streamed) {
  if (streamed.overBudget > reportedWithoutRoom_)
    say(log_, LogLevel::warning,
        "{} of the {} photographs of this view are shown as stand-ins: the budget of {:.1f} MB is full",
        streamed.overBudget, streamed.needed, megabytes(budget_));
  reportedWithoutRoom_ = streamed.overBudget;
}

}  // namespace ibr
