// SPDX-License-Identifier: Apache-2.0
#include "render/resident/streamed_photographs.h"

#include <algorithm>
#include <utility>

#include "render/resident/stream_log.h"

namespace ibr {

using Phase = PhotographLoad::Phase;

StreamedPhotographs::StreamedPhotographs(const Device& device, JobQueue& jobs, const TextureLoader& loader, Setup setup,
                                         LogCallback log)
    : device_(&device),
      jobs_(&jobs),
      classes_(setup.classes),
      residencyClasses_(setup.residencyClasses),
      classOf_(setup.classOf),
      otherBytes_(setup.otherBytes),
      stagingBytes_(setup.stagingBytes),
      log_(std::move(log)),
      residency_(std::move(setup.residencyClasses), std::move(setup.classOf), setup.budget),
      arrays_(residency_.maxArrays()),
      minLoads_(std::max(1u, jobs.threads())),
      loadCount_(maxLoads(jobs.threads())),
      loads_(std::make_unique<PhotographLoad[]>(loadCount_)),
      budget_(setup.otherBytes + setup.budget) {
  for (PhotographLoad& load : loads()) load.loader = &loader;
  arrayWork_.device = &device;
  arrayWork_.retired.reserve(arrays_.size());
}

std::optional<StreamedPhotographs::Sampled> StreamedPhotographs::at(std::uint32_t node) const {
  const auto slot = residency_.slot(node);
  if (!slot) return std::nullopt;
  return Sampled{arrays_[slot->array].view(), slot->layer};
}

GpuScene::StreamStatus StreamedPhotographs::stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                                   std::size_t needed, std::uint64_t frame,
                                                   std::uint64_t completedFrame,
                                                   const std::function<void(VkImageView)>& evicting) {
  residency_.begin(wanted, needed, frame, completedFrame);
  stream_.begin(frame, completedFrame);
  collectArray();
  updateLoads();
  do copyReady();
  while (request(evicting));
  stream_.record(commandBuffer);
  return endFrame();
}

void StreamedPhotographs::collectArray() {
  if (!arrayWork_.isActive || !isDone(arrayWork_)) return;
  arrayWork_.isActive = false;
  const std::uint32_t array = arrayWork_.array;
  if (!arrayWork_.error) {
    arrays_[array] = std::move(arrayWork_.made);
    residency_.arrayMade(array);
    stream_.addArray(arrays_[array]);
    return;
  }
  for (PhotographLoad& load : loads())
    if (load.phase == Phase::reading && load.array == array)
      load.phase = jobs_->withdraw(load) ? Phase::free : Phase::dropped;
  residency_.allocationFailed(array);
  budget_ = otherBytes_ + residency_.arrayBytes();
  say(log_, LogLevel::warning, "the budget is lowered to {:.1f} MB: {}", megabytes(budget_),
      messageOf(arrayWork_.error));
}

// Takes back reads that have not begun: request() queues the most urgent ones of this frame. Drops those that have
// begun and are not wanted any more.
void StreamedPhotographs::updateLoads() {
  for (PhotographLoad& load : loads()) {
    if (load.phase == Phase::reading) {
      const bool withdrawn = jobs_->withdraw(load);
      if (withdrawn || residency_.rank(load.node) == Residency::kNone) {
        residency_.cancel(load.node);
        load.phase = withdrawn ? Phase::free : Phase::dropped;
      }
    }
    if (load.phase == Phase::dropped && isDone(load)) clear(load);
    if (load.phase == Phase::clearing && isDone(load)) load.phase = Phase::free;
  }
}

// Copies photographs that have been read, while the staging memory has room.
void StreamedPhotographs::copyReady() {
  for (;;) {
    if (copying_) {
      if (!stream_.advance()) return;
      residency_.finishLoad(copying_->node);
      clear(*std::exchange(copying_, nullptr));
    }
    PhotographLoad* const load = nextReady();
    if (!load) return;
    if (load->error) {
      residency_.failed(load->node);
      load->phase = Phase::free;
      say(log_, LogLevel::error, "a photograph cannot be loaded and keeps its stand-in: {}", messageOf(load->error));
      continue;
    }
    stream_.start(arrays_[load->array], load->layer, load->texture);
    load->phase = Phase::copying;
    copying_ = load;
  }
}

// Returns the most urgent photograph that has been read and whose array exists.
PhotographLoad* StreamedPhotographs::nextReady() {
  PhotographLoad* best = nullptr;
  for (PhotographLoad& load : loads()) {
    const bool hasArray = !arrayWork_.isActive || arrayWork_.array != load.array;
    if (load.phase == Phase::reading && hasArray && isDone(load) &&
        (!best || residency_.rank(load.node) < residency_.rank(best->node)))
      best = &load;
  }
  return best;
}

// Requests photographs in order of urgency. Returns true if one has been read at once.
bool StreamedPhotographs::request(const std::function<void(VkImageView)>& evicting) {
  while (PhotographLoad* const load = unused()) {
    const auto step = residency_.next(!arrayWork_.isActive);
    if (!step) return false;
    switch (step->kind) {
      case Residency::Step::Kind::freeArray:
        evicting(arrays_[step->array].view());
        arrayWork_.retired.push_back(std::move(arrays_[step->array]));
        break;
      case Residency::Step::Kind::makeArray:
        makeArray(*step);
        break;
      case Residency::Step::Kind::load:
        beginLoad(*load, *step);
        if (jobs_->threads() == 0) return true;
        break;
    }
  }
  return false;
}

// Returns null where all are in use, or their textures take more host memory than the staging memory.
PhotographLoad* StreamedPhotographs::unused() {
  PhotographLoad* found = nullptr;
  std::uint64_t bytes = 0;
  std::size_t inUse = 0;
  for (PhotographLoad& load : loads()) {
    if (load.phase == Phase::free) {
      found = &load;
    } else {
      ++inUse;
      bytes += load.bytes;
    }
  }
  return inUse >= minLoads_ && bytes >= stagingBytes_ ? nullptr : found;
}

void StreamedPhotographs::makeArray(const Residency::Step& step) {
  arrayWork_.isActive = true;
  arrayWork_.array = step.array;
  arrayWork_.arrayClass = &classes_[step.photographClass];
  arrayWork_.layers = residencyClasses_[step.photographClass].layersPerArray;
  jobs_->add(arrayWork_, 0);
  collectArray();
}

void StreamedPhotographs::beginLoad(PhotographLoad& load, const Residency::Step& step) {
  load.node = step.photograph;
  load.arrayClass = &classes_[classOf_[step.photograph]];
  load.array = step.array;
  load.layer = step.layer;
  load.bytes = load.arrayClass->layerBytes();
  load.phase = Phase::reading;
  jobs_->add(load, 1 + std::uint64_t(residency_.rank(load.node)));
}

// Freeing a large texture takes long, so that a job does it.
void StreamedPhotographs::clear(PhotographLoad& load) {
  load.phase = Phase::clearing;
  load.arrayClass = nullptr;
  jobs_->add(load, 0);
  if (isDone(load)) load.phase = Phase::free;
}

GpuScene::StreamStatus StreamedPhotographs::endFrame() {
  const Residency::Counts counts = residency_.endFrame();
  GpuScene::StreamStatus status{.needed = counts.needed,
                                .waiting = counts.waiting,
                                .overBudget = counts.overBudget,
                                .failed = counts.failed,
                                .uploadedBytes = stream_.frameBytes()};
  for (const PhotographLoad& load : loads())
    if (load.phase == Phase::reading)
      ++(jobs_->state(load) == JobQueue::JobState::queued ? status.queued : status.reading);
  if (status.overBudget > reportedWithoutRoom_)
    say(log_, LogLevel::warning,
        "{} of the {} photographs of this view are shown as stand-ins: the budget of {:.1f} MB is full",
        status.overBudget, status.needed, megabytes(budget_));
  reportedWithoutRoom_ = status.overBudget;
  return status;
}

void StreamedPhotographs::finishJob() {
  for (PhotographLoad& load : loads())
    if (load.phase == Phase::clearing) jobs_->finish(load);  // otherwise all may wait for the executor
  if (arrayWork_.isActive && !isDone(arrayWork_)) return jobs_->finish(arrayWork_);
  PhotographLoad* urgent = nullptr;
  for (PhotographLoad& load : loads())
    if (load.phase == Phase::reading && !isDone(load) &&
        (!urgent || residency_.rank(load.node) < residency_.rank(urgent->node)))
      urgent = &load;
  if (urgent) jobs_->finish(*urgent);
}

}  // namespace ibr
