// SPDX-License-Identifier: Apache-2.0
#include "ibr/htm_sequence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "base/check.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

std::uint64_t bytesOf(const HtmSurface& surface) {
  return surface.mesh.positions.size() * (sizeof(glm::dvec3) + sizeof(CameraSet)) +
         surface.mesh.triangles.size() * sizeof(glm::uvec3);
}

}  // namespace

std::uint64_t HtmFrame::bytes() const {
  std::uint64_t sum = sizeof *this + bytesOf(model.surface) + model.complements.size() * sizeof(glm::vec2);
  if (model.source) sum += bytesOf(*model.source);
  for (const HtmImage& picture : pictures) {
    sum += picture.photograph.values.size() + picture.visibility.values.size();
    if (!picture.levels) continue;
    for (const Image8& level : *picture.levels) sum += level.values.size();
  }
  return sum;
}

HtmFrame loadHtmFrame(const fs::path& model, const HtmImageSource& pictures) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  HtmFrame frame{loadHtmModel(model), {}};
  for (std::size_t i = 0; i < frame.model.cameras.size(); ++i)
    frame.pictures.push_back(pictures ? pictures(frame.model, i) : HtmImage{});
  frame.loadMilliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return frame;
}

struct HtmSequence::State {
  // State of a frame: loaded, failed, or neither yet.
  struct Entry {
    std::shared_ptr<const HtmFrame> frame;
    std::exception_ptr error;
    std::uint64_t bytes = 0;
  };

  State(const fs::path& path, HtmImageSource source, const HtmSequenceOptions& wanted)
      : index(loadHtmSequence(path)), pictures(std::move(source)), options(wanted) {
    std::error_code ignored;
    folder = fs::is_directory(path, ignored) ? path : path.parent_path();
    thread = std::thread([this] { work(); });
  }
  ~State() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    thread.join();
  }

  // Number of frames from the current one to `frame`; nullopt if the sequence does not reach it.
  std::optional<std::size_t> framesUntil(std::size_t frame) const {
    if (frame >= current) return frame - current;
    if (!options.loop) return std::nullopt;
    return frame + index.frames.size() - current;
  }

  void makeCurrent(std::size_t frame) {
    check(frame < index.frames.size(), ErrorCode::invalidInput, "frame {} is beyond the {} frames of the sequence",
          frame, index.frames.size());
    current = frame;
    started = true;
    for (auto entry = entries.begin(); entry != entries.end();) {
      const auto steps = framesUntil(entry->first);
      entry = steps && *steps <= options.framesAhead ? std::next(entry) : entries.erase(entry);
    }
    changed.notify_all();
  }

  std::uint64_t cachedBytes() const {
    std::uint64_t sum = 0;
    for (const auto& [frame, entry] : entries) sum += entry.bytes;
    return sum;
  }

  // The next frame to load.
  std::optional<std::size_t> nextToLoad() const {
    if (!started) return std::nullopt;
    if (!entries.contains(current)) return current;
    for (std::size_t steps = 1; steps <= options.framesAhead && steps < index.frames.size(); ++steps) {
      std::size_t frame = current + steps;
      if (frame >= index.frames.size()) {
        if (!options.loop) return std::nullopt;
        frame -= index.frames.size();
      }
      if (entries.contains(frame)) continue;
      std::uint64_t nearer = 0;
      for (const auto& [other, entry] : entries)
        if (framesUntil(other) < steps) nearer += entry.bytes;
      if (nearer + largest > options.budgetBytes) return std::nullopt;
      return frame;
    }
    return std::nullopt;
  }

  // Removes the frames furthest ahead first.
  void evictFor(std::size_t frame) {
    while (!entries.empty() && cachedBytes() + largest > options.budgetBytes &&
           framesUntil(furthestEntry()->first) > framesUntil(frame))
      entries.erase(furthestEntry());
  }

  Entry load(std::size_t frame) const {
    Entry entry;
    try {
      auto loaded = std::make_shared<HtmFrame>(loadHtmFrame(folder / index.frames[frame], pictures));
      entry.bytes = loaded->bytes();
      entry.frame = std::move(loaded);
    } catch (...) {
      entry.error = std::current_exception();
    }
    return entry;
  }

  void work() {
    std::unique_lock lock(mutex);
    for (;;) {
      std::optional<std::size_t> frame;
      changed.wait(lock, [&] { return stopping || (frame = nextToLoad()).has_value(); });
      if (stopping) return;
      ++loads;
      evictFor(*frame);
      lock.unlock();
      Entry entry = load(*frame);
      lock.lock();
      largest = std::max(largest, entry.bytes);
      // The current frame may have changed during the load.
      if (const auto steps = framesUntil(*frame); steps && *steps <= options.framesAhead) {
        entries[*frame] = std::move(entry);
        evictBeyondBudget();
      }
      changed.notify_all();
    }
  }

  // A frame larger than all earlier ones may exceed the reserved memory.
  void evictBeyondBudget() {
    while (entries.size() > 1 && cachedBytes() > options.budgetBytes) entries.erase(furthestEntry());
  }

  std::map<std::size_t, Entry>::iterator furthestEntry() {
    return std::max_element(entries.begin(), entries.end(),
                            [&](const auto& a, const auto& b) { return framesUntil(a.first) < framesUntil(b.first); });
  }

  std::shared_ptr<const HtmFrame> take(std::size_t frame) {
    const auto found = entries.find(frame);
    if (found == entries.end()) return nullptr;
    if (found->second.error) {
      const std::exception_ptr error = found->second.error;
      entries.erase(found);
      changed.notify_all();
      std::rethrow_exception(error);
    }
    return found->second.frame;
  }

  HtmSequenceIndex index;
  fs::path folder;
  HtmImageSource pictures;
  HtmSequenceOptions options;

  std::mutex calls;  // held during calls that request a frame
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::map<std::size_t, Entry> entries;
  std::size_t current = 0, loads = 0;
  std::uint64_t largest = 0;  // maximum size of a frame so far, bytes
  bool started = false, stopping = false;
  std::thread thread;
};

HtmSequence::HtmSequence(const fs::path& path, HtmImageSource pictures, const HtmSequenceOptions& options)
    : state_(std::make_unique<State>(path, std::move(pictures), options)) {}
HtmSequence::~HtmSequence() = default;

std::size_t HtmSequence::frameCount() const noexcept {
  return state_->index.frames.size();
}

double HtmSequence::fps() const noexcept {
  return state_->index.fps;
}

std::size_t HtmSequence::frameAt(double seconds) const noexcept {
  constexpr double kRounding = 1e-6;  // of a frame, so that k / fps is frame k
  const double count = double(frameCount()), frame = std::floor(seconds * fps() + kRounding);
  if (std::isnan(frame)) return 0;
  if (!state_->options.loop) return std::size_t(std::clamp(frame, 0.0, count - 1));
  if (std::isinf(frame)) return 0;
  const double inside = frame - count * std::floor(frame / count);
  return std::size_t(std::clamp(inside, 0.0, count - 1));
}

std::shared_ptr<const HtmFrame> HtmSequence::frame(std::size_t index) {
  const std::lock_guard call(state_->calls);
  std::unique_lock lock(state_->mutex);
  state_->makeCurrent(index);
  for (;;) {
    if (auto frame = state_->take(index)) return frame;
    state_->changed.wait(lock);
  }
}

std::shared_ptr<const HtmFrame> HtmSequence::tryFrame(std::size_t index) {
  const std::lock_guard call(state_->calls);
  const std::lock_guard lock(state_->mutex);
  state_->makeCurrent(index);
  return state_->take(index);
}

HtmSequence::Counts HtmSequence::counts() const {
  const std::lock_guard lock(state_->mutex);
  Counts counts{0, state_->cachedBytes(), state_->loads};
  for (const auto& [index, entry] : state_->entries) counts.cachedFrames += entry.frame != nullptr;
  return counts;
}

}  // namespace ibr
