// SPDX-License-Identifier: Apache-2.0
#include "render/resident/resident_photographs.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/submit.h"
#include "ibr/texture.h"

namespace ibr {
namespace {

constexpr std::uint32_t kStandInSide = 64;       // largest size, px
constexpr std::uint64_t kStandInShare = 4;       // inverse of their largest share of the budget
constexpr std::uint64_t kLeastPhotographs = 16;  // a budget should hold so many at the size they are streamed at
constexpr std::uint64_t kPagesInBudget = 16;     // minimum number, so that memory can move between classes

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

std::uint64_t totalBytes(std::span<const PageClass> classes) {
  std::uint64_t bytes = 0;
  for (const PageClass& pageClass : classes) bytes += pageClass.layerBytes() * pageClass.nodes.size();
  return bytes;
}

// Groups the nodes by format and size. The smallest level is enough to find a photograph's format.
std::vector<PageClass> classify(const Device& device, const Scene& scene, const TextureSource& source,
                                const std::vector<std::uint32_t>& nodes) {
  std::map<std::tuple<int, int, TextureFormat>, PageClass> classes;
  for (const std::uint32_t node : nodes) {
    const Intrinsics& k = scene.nodes[node].camera.intrinsics;
    const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
    check(std::uint32_t(std::max(k.width, k.height)) <= largest, ErrorCode::unsupported,
          "{}: {}x{} exceeds the device's maximum image size of {}; build with a smaller --max-size",
          scene.nodes[node].name, k.width, k.height, largest);
    PageClass single{.extent = {std::uint32_t(k.width), std::uint32_t(k.height)}};
    single.format = source(scene, node, int(single.levels()) - 1).format;
    classes.try_emplace({k.width, k.height, single.format}, single).first->second.nodes.push_back(node);
  }
  std::vector<PageClass> result;
  for (auto& [key, pageClass] : classes) result.push_back(std::move(pageClass));
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
                  std::vector<PageClass>& classes) {
  std::vector<PageClass> decoded = classes;
  for (PageClass& pageClass : decoded) pageClass.format = TextureFormat::rgba8;
  const std::uint64_t before = totalBytes(classes), after = totalBytes(decoded);
  const bool software = device.kind() == DeviceKind::software;
  const bool budgeted = options.budgetBytes > 0;
  const bool fits = after <= largestHeap(device) / 2 && (!budgeted || after + meshBytes <= options.budgetBytes);
  // A software device is so slow with BC7 that RGBA8 is better, even if fewer photographs are resident.
  const auto faster = [&](TextureFormat format) {
    return software && (fits || (budgeted && format == TextureFormat::bc7));
  };
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (!device.supportsBlockCompression() || options.blocks == BlockTextures::decode ||
        (options.blocks == BlockTextures::automatic && faster(classes[c].format)))
      classes[c].format = TextureFormat::rgba8;
  if (totalBytes(classes) == before) return;
  say(options.log, device.supportsBlockCompression() ? LogLevel::info : LogLevel::warning,
      "textures are decoded to RGBA8, {:.1f} MB instead of {:.1f} MB: {} {}", megabytes(totalBytes(classes)),
      megabytes(before), device.name(),
      !device.supportsBlockCompression()        ? "does not support block compression"
      : options.blocks == BlockTextures::decode ? "decodes textures as requested"
                                                : "samples RGBA8 faster");
}

// Returns the classes with photographs of at most `side` px.
std::vector<PageClass> reduced(std::vector<PageClass> classes, std::uint32_t side) {
  for (PageClass& pageClass : classes)
    while (std::max(pageClass.pageExtent().width, pageClass.pageExtent().height) > side) ++pageClass.firstLevel;
  return classes;
}

}  // namespace

Photographs::Photographs(const Device& device, const Scene& scene, const GpuSceneOptions& options,
                         const std::vector<std::uint32_t>& nodes, std::uint64_t meshBytes)
    : device_(&device),
      scene_(&scene),
      source_(options.source ? options.source : readTexture),
      log_(options.log),
      classes_(classify(device, scene, source_, nodes)),
      budget_(options.budgetBytes),
      meshBytes_(meshBytes) {
  decodeBlocks(device, options, meshBytes, classes_);
  // The sum alone decides most cases, and requests no image that the device cannot have.
  streams_ = budget_ > 0 &&
             (meshBytes + totalBytes(classes_) > budget_ || meshBytes + FixedPages::bytes(device, classes_) > budget_);
  if (streams_) {
    setUpStreaming(options.stagingBytes);
  } else {
    fixed_ = FixedPages(device, classes_, scene.nodes.size());
    fill(classes_, options.stagingBytes);
  }
}

void Photographs::setUpStreaming(std::uint64_t stagingBytes) {
  const std::uint64_t smallest = meshBytes_ + FixedPages::bytes(*device_, reduced(classes_, 1));
  check(budget_ >= smallest, ErrorCode::outOfMemory,
        "a budget of {} bytes is too small: this scene needs {} bytes even at one pixel per photograph, {} bytes of "
        "them for meshes",
        budget_, smallest, meshBytes_);
  const std::uint64_t forTextures = budget_ - meshBytes_;
  std::uint32_t side = kStandInSide;
  std::vector<PageClass> standIns = reduced(classes_, side);
  while (side > 1 && FixedPages::bytes(*device_, standIns) > forTextures / kStandInShare)
    standIns = reduced(classes_, side /= 2);
  fixed_ = FixedPages(*device_, standIns, scene_->nodes.size());
  fill(standIns, stagingBytes);

  const std::uint64_t rest = forTextures - fixed_.allocatedBytes();
  say(log_, LogLevel::info,
      "photographs are streamed: {:.1f} MB of textures, a budget of {:.1f} MB, {:.1f} MB of it for stand-ins of {} px",
      megabytes(totalBytes(classes_)), megabytes(budget_), megabytes(fixed_.allocatedBytes()), side);
  if (side < kStandInSide)
    say(log_, LogLevel::warning,
        "stand-ins of photographs have {} px instead of {}: the budget of {:.1f} MB is too small", side, kStandInSide,
        megabytes(budget_));

  std::vector<Residency::Class> residencyClasses;
  classOf_.assign(scene_->nodes.size(), Residency::kNone);
  std::uint64_t leastBytes = ~std::uint64_t(0);
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    PageClass& pageClass = classes_[c];
    const std::uint64_t least = std::min<std::uint64_t>(kLeastPhotographs, pageClass.nodes.size());
    while (pageClass.firstLevel < standIns[c].firstLevel && pageClass.layerBytes() * least > rest)
      ++pageClass.firstLevel;
    if (pageClass.firstLevel > 0)
      say(log_, LogLevel::warning,
          "{} are shown at 1/{} of their size or less: a budget of {:.1f} MB does not hold {} of them{}",
          pageClass.text(), 1u << pageClass.firstLevel, megabytes(budget_), least,
          pageClass.format == TextureFormat::bc1 ? "" : "; bc1 textures take less memory");
    const std::uint32_t layers =
        layersWithin(*device_, pageClass, std::min<std::uint64_t>(kLargestPageBytes, rest / kPagesInBudget));
    const std::uint64_t pageBytes = allocationBytes(*device_, pageInfo(pageClass, layers), pageClass.text());
    pageLayers_.push_back(layers);
    residencyClasses.push_back({pageBytes, layers});
    leastBytes = std::min(leastBytes, pageBytes / layers);
    if (pageClass.firstLevel < standIns[c].firstLevel)
      for (const std::uint32_t node : pageClass.nodes) classOf_[node] = std::uint32_t(c);
  }
  mostResident_ = std::size_t(rest / std::max<std::uint64_t>(leastBytes, 1));
  residency_ = Residency(std::move(residencyClasses), classOf_, rest);
  stream_ = PhotographStream(*device_, stagingBytes);
}

Texture Photographs::load(std::uint32_t node, const PageClass& pageClass) const {
  Texture texture = source_(*scene_, node, int(pageClass.firstLevel));
  const std::string& name = scene_->nodes[node].name;
  const VkExtent2D extent = pageClass.pageExtent();
  check(texture.levels.size() == pageClass.levels(), ErrorCode::invalidInput,
        "{}: texture has {} levels from level {} on, not {}", name, texture.levels.size(), pageClass.firstLevel,
        pageClass.levels());
  check(std::uint32_t(texture.width) == extent.width && std::uint32_t(texture.height) == extent.height,
        ErrorCode::invalidInput, "{}: texture level {} is {}x{}, not {}x{}", name, pageClass.firstLevel, texture.width,
        texture.height, extent.width, extent.height);
  for (std::uint32_t l = 0; l < pageClass.levels(); ++l) {
    const std::uint64_t bytes =
        textureBytes(texture.format, std::max(1, texture.width >> l), std::max(1, texture.height >> l));
    check(texture.levels[l].size() == bytes, ErrorCode::invalidInput, "{}: texture level {} has {} bytes, not {}", name,
          pageClass.firstLevel + l, texture.levels[l].size(), bytes);
  }
  if (texture.format != pageClass.format && pageClass.format == TextureFormat::rgba8) texture = decodeTexture(texture);
  check(texture.format == pageClass.format, ErrorCode::invalidInput,
        "{}: texture has format {} in one level, {} in another", name, textureFormatName(pageClass.format),
        textureFormatName(texture.format));
  return texture;
}

// One barrier per texture array before and after, for any number of layers: a scene may have 10,000 photographs.
void Photographs::fill(std::span<const PageClass> classes, std::uint64_t stagingBytes) {
  if (fixed_.pages().empty()) return;
  Submission submission(*device_);
  const auto moveAll = [&](ImageUse from, ImageUse to) {
    submission.run([&](VkCommandBuffer commands) {
      for (const GpuImage& page : fixed_.pages()) transition(commands, page.get(), from, to);
    });
  };
  moveAll(use::kUndefined, use::kTransferDestination);
  PhotographStream stream(*device_, stagingBytes);
  std::uint64_t frame = 1;
  const auto submit = [&] {
    submission.run([&](VkCommandBuffer commands) { stream.recordCopies(commands); });
    stream.begin(frame + 1, frame);
    ++frame;
  };
  stream.begin(frame, 0);
  for (const PageClass& pageClass : classes)
    for (const std::uint32_t node : pageClass.nodes) {
      stream.start(fixed_.image(node), fixed_.layer(node), load(node, pageClass));
      while (!stream.advance()) submit();
    }
  submit();
  moveAll(use::kTransferDestination, use::kSampled);
}

Photographs::Sampled Photographs::at(std::uint32_t node) const {
  if (streams_)
    if (const auto seat = residency_.seat(node)) return {pages_[seat->page].view(), seat->layer};
  return {fixed_.image(node).view(), fixed_.layer(node)};
}

std::uint64_t Photographs::allocatedBytes() const noexcept {
  std::uint64_t bytes = fixed_.allocatedBytes();
  for (const GpuImage& page : pages_) bytes += page.allocatedBytes();
  return bytes;
}

GpuScene::Streamed Photographs::stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                       std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                       const std::function<void(VkImageView)>& leaving) {
  assert(streams_);
  residency_.begin(wanted, needed, frame, completedFrame);
  stream_.begin(frame, completedFrame);
  runSteps(leaving);
  stream_.record(commandBuffer);
  const Residency::Counts counts = residency_.end();
  const GpuScene::Streamed streamed{.needed = std::uint32_t(needed),
                                    .waiting = counts.waiting,
                                    .withoutRoom = counts.withoutRoom,
                                    .failed = counts.failed,
                                    .uploadedBytes = stream_.frameBytes()};
  report(streamed);
  return streamed;
}

void Photographs::runSteps(const std::function<void(VkImageView)>& leaving) {
  for (;;) {
    if (stream_.busy()) {
      if (!stream_.advance()) return;
      residency_.arrived(std::exchange(loading_, Residency::kNone));
    }
    const auto step = residency_.next();
    if (!step) return;
    switch (step->kind) {
      case Residency::Step::Kind::freePage:
        leaving(pages_[step->page].view());
        pages_[step->page] = {};
        break;
      case Residency::Step::Kind::makePage:
        makePage(*step);
        break;
      case Residency::Step::Kind::load:
        beginLoad(*step);
        break;
    }
  }
}

void Photographs::makePage(const Residency::Step& step) {
  const PageClass& pageClass = classes_[step.photographClass];
  pages_.resize(std::max<std::size_t>(pages_.size(), step.page + 1));
  try {
    pages_[step.page] = GpuImage(*device_, pageInfo(pageClass, pageLayers_[step.photographClass]), pageClass.text());
    stream_.addPage(pages_[step.page]);
  } catch (const Error& e) {
    residency_.pageRefused(step.page);
    budget_ = meshBytes_ + allocatedBytes();
    say(log_, LogLevel::warning, "the budget is lowered to {:.1f} MB: {}", megabytes(budget_), e.what());
  }
}

void Photographs::beginLoad(const Residency::Step& step) {
  try {
    stream_.start(pages_[step.page], step.layer, load(step.photograph, classes_[classOf_[step.photograph]]));
    loading_ = step.photograph;
  } catch (const Error& e) {
    residency_.failed(step.photograph);
    say(log_, LogLevel::error, "a photograph cannot be loaded and keeps its stand-in: {}", e.what());
  }
}

void Photographs::report(const GpuScene::Streamed& streamed) {
  if (streamed.withoutRoom > reportedWithoutRoom_)
    say(log_, LogLevel::warning,
        "{} of the {} photographs of this view are shown as stand-ins: the budget of {:.1f} MB is full",
        streamed.withoutRoom, streamed.needed, megabytes(budget_));
  reportedWithoutRoom_ = streamed.withoutRoom;
}

}  // namespace ibr
