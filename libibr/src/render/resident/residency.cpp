// SPDX-License-Identifier: Apache-2.0
#include "render/resident/residency.h"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace ibr {

Residency::Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::uint64_t budgetBytes)
    : classes_(std::move(classes)), photographs_(classOf.size()), budget_(budgetBytes) {
  std::vector<std::size_t> counts(classes_.size(), 0);
  for (std::size_t p = 0; p < classOf.size(); ++p) {
    photographs_[p].classIndex = classOf[p];
    if (classOf[p] != kNone) ++counts[classOf[p]];
  }
  for (std::uint32_t c = 0; c < classes_.size(); ++c) {
    const std::size_t layers = classes_[c].layersPerArray, most = (counts[c] + layers - 1) / layers;
    for (std::size_t a = 0; a < most; ++a)
      arrays_.push_back({.classIndex = c, .layers = std::vector<std::uint32_t>(layers, kNone)});
  }
  wanted_.reserve(classOf.size());
  busy_.reserve(arrays_.size());
}

void Residency::begin(std::span<const std::uint32_t> wanted, std::size_t needed, std::uint64_t frame,
                      std::uint64_t completed) {
  assert(frame >= frame_ && completed < frame && needed <= wanted.size());
  for (const std::uint32_t p : wanted_) photographs_[p].rank = kNone;
  wanted_.assign(wanted.begin(), wanted.end());
  needed_ = needed;
  cursor_ = 0;
  frame_ = frame;
  completed_ = completed;
  for (std::size_t rank = 0; rank < wanted_.size(); ++rank) {
    Photograph& photograph = photographs_[wanted_[rank]];
    assert(photograph.rank == kNone);
    photograph.rank = std::uint32_t(rank);
    photograph.refused = false;
    if (photograph.state == State::evicting && photograph.claimedFrame < frame_)
      photograph.state = State::here;  // claim has lapsed
  }
}

std::optional<Residency::Step> Residency::next(bool mayMakeArray) {
  for (; cursor_ < wanted_.size(); ++cursor_) {
    const std::uint32_t p = wanted_[cursor_];
    Photograph& urgent = photographs_[p];
    if (urgent.classIndex == kNone || urgent.state != State::absent) continue;
    if (const auto step = layerFor(p)) return step;
    if (usedBytes_ + classes_[urgent.classIndex].arrayBytes <= budget_) {
      if (!mayMakeArray) return std::nullopt;
      return makeArray(urgent.classIndex);
    }
    std::uint32_t found = kNone;
    const Room victim = findVictim(urgent, found);
    if (victim == Room::found) {
      const Photograph left = photographs_[found];
      remove(found);
      return load(p, left.array, left.layer);
    }
    const Room freed = findArrayToFree(urgent, found);
    if (freed == Room::found) {
      if (!mayMakeArray) return std::nullopt;
      for (const std::uint32_t other : arrays_[found].layers)
        if (other != kNone) remove(other);
      usedBytes_ -= classes_[arrays_[found].classIndex].arrayBytes;
      arrays_[found].exists = false;
      return Step{.kind = Step::Kind::freeArray, .array = found};
    }
    urgent.refused = victim == Room::none && freed == Room::none;
    if (cursor_ >= needed_) break;  // less urgent photographs find no room either, or wait
  }
  cursor_ = wanted_.size();
  return std::nullopt;
}

std::optional<Residency::Step> Residency::layerFor(std::uint32_t photograph) {
  for (std::uint32_t array = 0; array < arrays_.size(); ++array) {
    if (!arrays_[array].exists || arrays_[array].classIndex != photographs_[photograph].classIndex) continue;
    const auto free = std::ranges::find(arrays_[array].layers, kNone);
    if (free != arrays_[array].layers.end())
      return load(photograph, array, std::uint32_t(free - arrays_[array].layers.begin()));
  }
  return std::nullopt;
}

Residency::Step Residency::load(std::uint32_t photograph, std::uint32_t array, std::uint32_t layer) {
  Photograph& p = photographs_[photograph];
  p.state = State::loading;
  p.array = array;
  p.layer = layer;
  arrays_[array].layers[layer] = photograph;
  return {.kind = Step::Kind::load, .array = array, .photograph = photograph, .layer = layer};
}

// There is an array that does not exist: all photographs of the class would fit into those that do.
Residency::Step Residency::makeArray(std::uint32_t classIndex) {
  const auto unused = std::ranges::find_if(
      arrays_, [&](const TextureArray& array) { return !array.exists && array.classIndex == classIndex; });
  assert(unused != arrays_.end());
  unused->exists = true;
  unused->lastFrame = frame_;
  usedBytes_ += classes_[classIndex].arrayBytes;
  return {
      .kind = Step::Kind::makeArray, .array = std::uint32_t(unused - arrays_.begin()), .photographClass = classIndex};
}

// Finds the least urgent photograph of the same class; among equals, the one not shown for the longest time.
// Photographs that no frame in flight uses are preferred.
Residency::Room Residency::findVictim(const Photograph& urgent, std::uint32_t& victim) {
  std::uint32_t idle = kNone, busy = kNone;
  const auto worth = [&](std::uint32_t p) { return std::tuple(~photographs_[p].rank, photographs_[p].lastFrame, p); };
  for (const TextureArray& array : arrays_) {
    if (!array.exists || array.classIndex != urgent.classIndex) continue;
    for (const std::uint32_t p : array.layers) {
      if (p == kNone || photographs_[p].rank <= urgent.rank || photographs_[p].claimedFrame == frame_) continue;
      const bool free = photographs_[p].state != State::loading && photographs_[p].lastFrame <= completed_;
      std::uint32_t& best = free ? idle : busy;
      if (best == kNone || worth(p) < worth(best)) best = p;
    }
  }
  victim = idle;
  if (idle != kNone) return Room::found;
  if (busy == kNone) return Room::none;
  claim(busy);
  return Room::claimed;
}

// Finds the array not used for the longest time. Frees an array only if enough arrays can be freed for the new array.
Residency::Room Residency::findArrayToFree(const Photograph& urgent, std::uint32_t& best) {
  std::uint64_t now = 0, later = 0;  // bytes that can be freed at once, and when frames have finished
  busy_.clear();
  best = kNone;
  for (std::uint32_t array = 0; array < arrays_.size(); ++array) {
    const TextureArray& candidate = arrays_[array];
    if (!candidate.exists || candidate.classIndex == urgent.classIndex) continue;
    bool lessUrgent = true, idle = candidate.lastFrame <= completed_;
    for (const std::uint32_t p : candidate.layers)
      if (p != kNone) {
        lessUrgent &= photographs_[p].rank > urgent.rank && photographs_[p].claimedFrame < frame_;
        idle &= photographs_[p].state != State::loading;
      }
    if (!lessUrgent) continue;
    (idle ? now : later) += classes_[candidate.classIndex].arrayBytes;
    if (!idle)
      busy_.push_back(array);
    else if (best == kNone || candidate.lastFrame < arrays_[best].lastFrame)
      best = array;
  }
  const std::uint64_t wanted = usedBytes_ + classes_[urgent.classIndex].arrayBytes;
  if (wanted <= budget_ + now) return Room::found;
  if (wanted > budget_ + now + later) return Room::none;
  for (const std::uint32_t array : busy_) {
    for (const std::uint32_t p : arrays_[array].layers)
      if (p != kNone) claim(p);
    now += classes_[arrays_[array].classIndex].arrayBytes;
    if (wanted <= budget_ + now) break;
  }
  return Room::claimed;
}

void Residency::claim(std::uint32_t photograph) {
  Photograph& p = photographs_[photograph];
  p.claimedFrame = frame_;
  if (p.state == State::here) p.state = State::evicting;
}

void Residency::remove(std::uint32_t photograph) {
  Photograph& p = photographs_[photograph];
  arrays_[p.array].layers[p.layer] = kNone;
  p.state = State::absent;
  p.array = p.layer = kNone;
}

void Residency::arrayMade(std::uint32_t array) {
  arrays_[array].lastFrame = frame_;
}

void Residency::allocationFailed(std::uint32_t array) {
  for (const std::uint32_t p : arrays_[array].layers)
    if (p != kNone) remove(p);
  usedBytes_ -= classes_[arrays_[array].classIndex].arrayBytes;
  arrays_[array].exists = false;
  budget_ = usedBytes_;
}

void Residency::finishLoad(std::uint32_t photograph) {
  Photograph& p = photographs_[photograph];
  assert(p.state == State::loading);
  p.state = State::here;
  p.lastFrame = arrays_[p.array].lastFrame = frame_;
}

void Residency::cancel(std::uint32_t photograph) {
  assert(photographs_[photograph].state == State::loading);
  remove(photograph);
}

void Residency::failed(std::uint32_t photograph) {
  arrays_[photographs_[photograph].array].lastFrame = frame_;  // the frame may contain some of its commands
  remove(photograph);
  photographs_[photograph].state = State::failed;
}

std::optional<Residency::Slot> Residency::slot(std::uint32_t photograph) const {
  const Photograph& p = photographs_[photograph];
  if (p.state != State::here) return std::nullopt;
  return Slot{p.array, p.layer};
}

Residency::Counts Residency::endFrame() {
  Counts counts{.needed = std::uint32_t(needed_)};
  for (std::size_t i = 0; i < needed_; ++i) {
    Photograph& p = photographs_[wanted_[i]];
    if (p.classIndex == kNone) continue;
    if (p.state == State::here) {
      p.lastFrame = frame_;
      arrays_[p.array].lastFrame = frame_;
    } else if (p.state == State::failed) {
      ++counts.failed;
    } else {
      ++(p.refused ? counts.overBudget : counts.waiting);
    }
  }
  return counts;
}

}  // namespace ibr
