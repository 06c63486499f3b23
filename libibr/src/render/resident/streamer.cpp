// SPDX-License-Identifier: Apache-2.0
#include "render/resident/streamer.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "render/resident/stream_log.h"

namespace ibr {
namespace {

using Phase = StreamLoad::Phase;

constexpr std::uint64_t kMinStagingBytes = std::uint64_t(1) << 20;

}  // namespace

Streamer::Streamer(const Device& device, JobQueue& jobs, const TextureLoader& loader, const SceneMeshes& meshes,
                   Setup setup, LogCallback log)
    : device_(&device),
      jobs_(&jobs),
      loader_(&loader),
      meshes_(&meshes),
      classes_(setup.classes),
      residencyClasses_(std::move(setup.textures.residencyClasses)),
      classOf_(std::move(setup.textures.classOf)),
      otherBytes_(setup.otherBytes),
      stagingBytes_(std::max(setup.stagingBytes, kMinStagingBytes)),
      log_(std::move(log)),
      loadCount_(maxLoads(jobs.threads())),
      loads_(std::make_unique<StreamLoad[]>(loadCount_)),
      budget_(setup.otherBytes + setup.textures.budget) {
  const StreamItems& items = loader.items();
  classOf_.resize(items.count(), Residency::kNone);
  std::uint64_t poolBytes = 0;
  if (meshes.streams()) {
    for (std::uint32_t m = 0; m < items.cells + items.backdrops; ++m)
      if (meshes.classOf(m) != Residency::kNone)
        classOf_[items.mesh(m)] = std::uint32_t(classes_.size()) + meshes.classOf(m);
    const std::vector<Residency::Class> chunks = meshes.classes(kMeshes);
    residencyClasses_.insert(residencyClasses_.end(), chunks.begin(), chunks.end());
    poolBytes = meshes.chunkCount() * chunks[0].arrayBytes;
  }
  const std::vector<std::uint64_t> budgets{setup.textures.budget, poolBytes};
  for (std::uint32_t group = 0; group < budgets.size(); ++group) {
    std::uint64_t smallest = budgets[group] + 1;
    for (const Residency::Class& of : residencyClasses_)
      if (of.group == group) smallest = std::min(smallest, of.arrayBytes / of.layersPerArray);
    maxResident_ += std::size_t(budgets[group] / std::max<std::uint64_t>(smallest, 1));
  }
  residency_.emplace(residencyClasses_, classOf_, budgets);
  arrays_.resize(residency_->maxArrays());
  chunkOf_.resize(residency_->maxArrays());
  freeChunks_.resize(meshes.chunkCount());
  std::iota(freeChunks_.begin(), freeChunks_.end(), 0u);
  for (std::uint32_t item = 0; item < classOf_.size(); ++item)  // any item must fit
    if (isStreamed(item)) stagingBytes_ = std::max(stagingBytes_, bytesOf(item));
  for (StreamLoad& load : loads()) {
    load.loader = &loader;
    load.meshes = &meshes;
  }
  arrayWork_.device = &device;
  arrayWork_.retired.reserve(arrays_.size());
}

void Streamer::startStreaming() {
  copies_ = StreamCopies(*device_, stagingBytes_, loadCount_);
}

std::uint64_t Streamer::bytesOf(std::uint32_t item) const {
  return isMeshClass(classOf_[item]) ? meshes_->bytes(loader_->items().meshIndex(item))
                                     : classes_[classOf_[item]].layerBytes();
}

std::optional<Streamer::Sampled> Streamer::texture(std::uint32_t item) const {
  const auto slot = residency_->slot(item);
  if (!slot) return std::nullopt;
  return Sampled{arrays_[slot->array].view(), slot->layer};
}

VkDeviceSize Streamer::meshOffset(std::uint32_t item, std::uint32_t array, std::uint32_t slot) const {
  return meshes_->slotOffset(chunkOf_[array], classOf_[item] - std::uint32_t(classes_.size()), slot);
}

MeshPlace Streamer::mesh(std::uint32_t mesh) const {
  const std::uint32_t item = loader_->items().mesh(mesh);
  const auto slot = residency_->slot(item);
  return slot ? meshes_->place(mesh, meshOffset(item, slot->array, slot->layer)) : meshes_->place(mesh);
}

GpuScene::StreamStatus Streamer::stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                        std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                        const std::function<void(VkImageView)>& evicting) {
  residency_->begin(wanted, needed, frame, completedFrame);
  copies_.begin(frame, completedFrame);
  collectArray();
  updateLoads();
  do copyReady();
  while (request(evicting));
  copies_.record(commandBuffer);
  return endFrame();
}

void Streamer::collectArray() {
  if (!arrayWork_.isActive || !isDone(arrayWork_)) return;
  arrayWork_.isActive = false;
  const std::uint32_t array = arrayWork_.array;
  if (!arrayWork_.error) {
    arrays_[array] = std::move(arrayWork_.made);
    residency_->arrayMade(array);
    copies_.addArray(arrays_[array]);
    return;
  }
  for (StreamLoad& load : loads())
    if (load.phase == Phase::loading && load.array == array) drop(load);
  residency_->allocationFailed(array);
  budget_ = otherBytes_ + residency_->arrayBytes(kTextures);
  say(log_, LogLevel::warning, "the budget is lowered to {:.1f} MB: {}", megabytes(budget_),
      messageOf(arrayWork_.error));
}

// Frees a load whose result is not needed, at once or when its job is done.
void Streamer::drop(StreamLoad& load) {
  load.phase = Phase::dropped;
  if (!jobs_->withdraw(load) && !isDone(load)) return;
  copies_.staging().release(load.piece);
  load.phase = Phase::free;
}

// Takes back loads that have not begun: request() queues the most urgent ones of this frame. Drops those that have
// begun and are not wanted any more.
void Streamer::updateLoads() {
  for (StreamLoad& load : loads()) {
    if (load.phase == Phase::loading) {
      const bool withdrawn = jobs_->withdraw(load);
      if (withdrawn || residency_->rank(load.item) == Residency::kNone) {
        residency_->cancel(load.item);
        drop(load);
      }
    } else if (load.phase == Phase::dropped) {
      drop(load);
    }
  }
}

// Copies items that have been loaded.
void Streamer::copyReady() {
  while (copies_.hasRoom()) {
    StreamLoad* const load = nextReady();
    if (!load) return;
    if (load->error) {
      fail(*load);
      continue;
    }
    if (load->arrayClass)
      copies_.copyTexture(arrays_[load->array], load->layer, load->piece);
    else
      copies_.copyMesh(meshes_->vertices(), meshOffset(load->item, load->array, load->layer), load->piece);
    residency_->finishLoad(load->item);
    load->phase = Phase::free;
  }
}

void Streamer::fail(StreamLoad& load) {
  const StreamItems& items = loader_->items();
  residency_->failed(load.item);
  copies_.staging().release(load.piece);
  load.phase = Phase::free;
  say(log_, LogLevel::error, "a {} cannot be loaded, and its stand-in is shown: {}",
      items.isMesh(load.item)    ? "mesh"
      : items.isDepth(load.item) ? "depth texture"
                                 : "photograph",
      messageOf(load.error));
}

// Returns the most urgent item that has been loaded and whose array exists.
StreamLoad* Streamer::nextReady() {
  StreamLoad* best = nullptr;
  for (StreamLoad& load : loads()) {
    const bool hasArray = !load.arrayClass || !arrayWork_.isActive || arrayWork_.array != load.array;
    if (load.phase == Phase::loading && hasArray && isDone(load) &&
        (!best || residency_->rank(load.item) < residency_->rank(best->item)))
      best = &load;
  }
  return best;
}

// Requests items in order of urgency. Returns true if one has been loaded at once.
bool Streamer::request(const std::function<void(VkImageView)>& evicting) {
  while (StreamLoad* const load = unused()) {
    const auto step = residency_->next(!arrayWork_.isActive);
    if (!step) return false;
    switch (step->kind) {
      case Residency::Step::Kind::freeArray:
        freeArray(step->array, evicting);
        break;
      case Residency::Step::Kind::makeArray:
        makeArray(*step);
        break;
      case Residency::Step::Kind::load:
        if (!beginLoad(*load, *step)) return false;
        if (jobs_->threads() == 0) return true;
        break;
    }
  }
  return false;
}

StreamLoad* Streamer::unused() {
  const auto found = std::ranges::find(loads(), Phase::free, &StreamLoad::phase);
  return found == loads().end() ? nullptr : &*found;
}

void Streamer::freeArray(std::uint32_t array, const std::function<void(VkImageView)>& evicting) {
  if (!arrays_[array].view()) return freeChunks_.push_back(chunkOf_[array]);
  evicting(arrays_[array].view());
  arrayWork_.retired.push_back(std::move(arrays_[array]));
}

void Streamer::makeArray(const Residency::Step& step) {
  if (isMeshClass(step.itemClass)) {
    chunkOf_[step.array] = freeChunks_.back();
    freeChunks_.pop_back();
    return;
  }
  arrayWork_.isActive = true;
  arrayWork_.array = step.array;
  arrayWork_.arrayClass = &classes_[step.itemClass];
  arrayWork_.layers = residencyClasses_[step.itemClass].layersPerArray;
  jobs_->add(arrayWork_, 0);
  collectArray();
}

// Returns false where staging memory has no room: loads that are under way have to be copied first.
bool Streamer::beginLoad(StreamLoad& load, const Residency::Step& step) {
  const auto piece = copies_.staging().take(bytesOf(step.item));
  if (!piece) {
    residency_->cancel(step.item);
    return false;
  }
  load.item = step.item;
  load.arrayClass = isMeshClass(classOf_[step.item]) ? nullptr : &classes_[classOf_[step.item]];
  load.array = step.array;
  load.layer = step.layer;
  load.piece = *piece;
  load.phase = Phase::loading;
  jobs_->add(load, 1 + std::uint64_t(residency_->rank(load.item)));
  return true;
}

GpuScene::StreamStatus Streamer::endFrame() {
  const Residency::Counts counts = residency_->endFrame();
  GpuScene::StreamStatus status{.needed = counts.needed,
                                .waiting = counts.waiting,
                                .overBudget = counts.overBudget,
                                .failed = counts.failed,
                                .uploadedBytes = copies_.frameBytes()};
  for (const StreamLoad& load : loads())
    if (load.phase == Phase::loading)
      ++(jobs_->state(load) == JobQueue::JobState::queued ? status.queued : status.reading);
  if (status.overBudget > reportedWithoutRoom_)
    say(log_, LogLevel::warning, "{} of the {} {} of this view are shown as stand-ins: the budget of {:.1f} MB is full",
        status.overBudget, status.needed, meshes_->streams() ? "photographs and meshes" : "photographs",
        megabytes(budget_));
  reportedWithoutRoom_ = status.overBudget;
  return status;
}

void Streamer::finishJob() {
  if (arrayWork_.isActive && !isDone(arrayWork_)) return jobs_->finish(arrayWork_);
  StreamLoad* urgent = nullptr;
  for (StreamLoad& load : loads())
    if (load.phase == Phase::loading && !isDone(load) &&
        (!urgent || residency_->rank(load.item) < residency_->rank(urgent->item)))
      urgent = &load;
  if (urgent) jobs_->finish(*urgent);
}

}  // namespace ibr
