// SPDX-License-Identifier: Apache-2.0
#include "render/resident/residency.h"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace ibr {

Residency::Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::vector<std::uint64_t> budgets)
    : classes_(std::move(classes)), items_(classOf.size()) {
  for (const std::uint64_t budget : budgets) groups_.push_back({.budget = budget});
  std::vector<std::size_t> counts(classes_.size(), 0);
  for (std::size_t p = 0; p < classOf.size(); ++p) {
    items_[p].classIndex = classOf[p];
    if (classOf[p] != kNone) ++counts[classOf[p]];
  }
  for (std::uint32_t c = 0; c < classes_.size(); ++c) {
    const std::size_t layers = classes_[c].layersPerArray;
    const std::uint64_t most = std::min<std::uint64_t>((counts[c] + layers - 1) / layers,
                                                       groupOf(classes_[c]).budget / classes_[c].arrayBytes);
    for (std::size_t a = 0; a < most; ++a)
      arrays_.push_back({.classIndex = c, .layers = std::vector<std::uint32_t>(layers, kNone)});
  }
  wanted_.reserve(classOf.size());
  busy_.reserve(arrays_.size());
}

void Residency::begin(std::span<const std::uint32_t> wanted, std::size_t needed, std::uint64_t frame,
                      std::uint64_t completed) {
  assert(frame >= frame_ && completed < frame && needed <= wanted.size());
  for (const std::uint32_t p : wanted_) items_[p].rank = kNone;
  wanted_.assign(wanted.begin(), wanted.end());
  needed_ = needed;
  cursor_ = 0;
  for (Group& group : groups_) group.full = false;
  frame_ = frame;
  completed_ = completed;
  for (std::size_t rank = 0; rank < wanted_.size(); ++rank) {
    Item& item = items_[wanted_[rank]];
    assert(item.rank == kNone);
    item.rank = std::uint32_t(rank);
    item.refused = false;
    if (item.state == State::evicting && item.claimedFrame < frame_) item.state = State::here;  // claim has lapsed
  }
}

std::optional<Residency::Step> Residency::next(bool mayMakeArray) {
  for (; cursor_ < wanted_.size(); ++cursor_) {
    const std::uint32_t p = wanted_[cursor_];
    Item& urgent = items_[p];
    if (urgent.classIndex == kNone || urgent.state != State::absent) continue;
    Group& group = groupOf(classes_[urgent.classIndex]);
    if (group.full) continue;
    const bool isBlocked = !mayMakeArray && classes_[urgent.classIndex].group == 0;
    if (const auto step = layerFor(p)) return step;
    if (group.used + classes_[urgent.classIndex].arrayBytes <= group.budget) {
      if (isBlocked) return std::nullopt;
      return makeArray(urgent.classIndex);
    }
    std::uint32_t found = kNone;
    const Room victim = findVictim(urgent, found);
    if (victim == Room::found) {
      const Item left = items_[found];
      remove(found);
      return load(p, left.array, left.layer);
    }
    const Room freed = findArrayToFree(urgent, found);
    if (freed == Room::found) {
      if (isBlocked) return std::nullopt;
      for (const std::uint32_t other : arrays_[found].layers)
        if (other != kNone) remove(other);
      group.used -= classes_[arrays_[found].classIndex].arrayBytes;
      arrays_[found].exists = false;
      return Step{.kind = Step::Kind::freeArray, .array = found};
    }
    urgent.refused = victim == Room::none && freed == Room::none;
    group.full = cursor_ >= needed_;
  }
  return std::nullopt;
}

std::optional<Residency::Step> Residency::layerFor(std::uint32_t item) {
  for (std::uint32_t array = 0; array < arrays_.size(); ++array) {
    if (!arrays_[array].exists || arrays_[array].classIndex != items_[item].classIndex) continue;
    const auto free = std::ranges::find(arrays_[array].layers, kNone);
    if (free != arrays_[array].layers.end())
      return load(item, array, std::uint32_t(free - arrays_[array].layers.begin()));
  }
  return std::nullopt;
}

Residency::Step Residency::load(std::uint32_t item, std::uint32_t array, std::uint32_t layer) {
  Item& p = items_[item];
  p.state = State::loading;
  p.array = array;
  p.layer = layer;
  arrays_[array].layers[layer] = item;
  return {.kind = Step::Kind::load, .array = array, .item = item, .layer = layer};
}

// There is an array that does not exist: all items of the class would fit into those that do.
Residency::Step Residency::makeArray(std::uint32_t classIndex) {
  const auto unused = std::ranges::find_if(
      arrays_, [&](const TextureArray& array) { return !array.exists && array.classIndex == classIndex; });
  assert(unused != arrays_.end());
  unused->exists = true;
  unused->lastFrame = frame_;
  groupOf(classes_[classIndex]).used += classes_[classIndex].arrayBytes;
  return {.kind = Step::Kind::makeArray, .array = std::uint32_t(unused - arrays_.begin()), .itemClass = classIndex};
}

// Finds the least urgent item of the same class; among equals, the one not shown for the longest time.
// Items that no frame in flight uses are preferred.
Residency::Room Residency::findVictim(const Item& urgent, std::uint32_t& victim) {
  std::uint32_t idle = kNone, busy = kNone;
  const auto worth = [&](std::uint32_t p) { return std::tuple(~items_[p].rank, items_[p].lastFrame, p); };
  for (const TextureArray& array : arrays_) {
    if (!array.exists || array.classIndex != urgent.classIndex) continue;
    for (const std::uint32_t p : array.layers) {
      if (p == kNone || items_[p].rank <= urgent.rank || items_[p].claimedFrame == frame_) continue;
      const bool free = items_[p].state != State::loading && items_[p].lastFrame <= completed_;
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
Residency::Room Residency::findArrayToFree(const Item& urgent, std::uint32_t& best) {
  std::uint64_t now = 0, later = 0;  // bytes that can be freed at once, and when frames have finished
  busy_.clear();
  best = kNone;
  for (std::uint32_t array = 0; array < arrays_.size(); ++array) {
    const TextureArray& candidate = arrays_[array];
    if (!candidate.exists || candidate.classIndex == urgent.classIndex ||
        classes_[candidate.classIndex].group != classes_[urgent.classIndex].group)
      continue;
    bool lessUrgent = true, idle = candidate.lastFrame <= completed_;
    for (const std::uint32_t p : candidate.layers)
      if (p != kNone) {
        lessUrgent &= items_[p].rank > urgent.rank && items_[p].claimedFrame < frame_;
        idle &= items_[p].state != State::loading;
      }
    if (!lessUrgent) continue;
    (idle ? now : later) += classes_[candidate.classIndex].arrayBytes;
    if (!idle)
      busy_.push_back(array);
    else if (best == kNone || candidate.lastFrame < arrays_[best].lastFrame)
      best = array;
  }
  const Group& group = groupOf(classes_[urgent.classIndex]);
  const std::uint64_t wanted = group.used + classes_[urgent.classIndex].arrayBytes;
  if (wanted <= group.budget + now) return Room::found;
  if (wanted > group.budget + now + later) return Room::none;
  for (const std::uint32_t array : busy_) {
    for (const std::uint32_t p : arrays_[array].layers)
      if (p != kNone) claim(p);
    now += classes_[arrays_[array].classIndex].arrayBytes;
    if (wanted <= group.budget + now) break;
  }
  return Room::claimed;
}

void Residency::claim(std::uint32_t item) {
  Item& p = items_[item];
  p.claimedFrame = frame_;
  if (p.state == State::here) p.state = State::evicting;
}

void Residency::remove(std::uint32_t item) {
  Item& p = items_[item];
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
  Group& group = groupOf(classes_[arrays_[array].classIndex]);
  group.used -= classes_[arrays_[array].classIndex].arrayBytes;
  group.budget = group.used;
  arrays_[array].exists = false;
}

void Residency::finishLoad(std::uint32_t item) {
  Item& p = items_[item];
  assert(p.state == State::loading);
  p.state = State::here;
  p.lastFrame = arrays_[p.array].lastFrame = frame_;
}

void Residency::cancel(std::uint32_t item) {
  assert(items_[item].state == State::loading);
  remove(item);
}

void Residency::failed(std::uint32_t item) {
  arrays_[items_[item].array].lastFrame = frame_;  // the frame may contain some of its commands
  remove(item);
  items_[item].state = State::failed;
}

std::optional<Residency::Slot> Residency::slot(std::uint32_t item) const {
  const Item& p = items_[item];
  if (p.state != State::here) return std::nullopt;
  return Slot{p.array, p.layer};
}

Residency::Counts Residency::endFrame() {
  Counts counts{.needed = std::uint32_t(needed_)};
  for (std::size_t i = 0; i < needed_; ++i) {
    Item& p = items_[wanted_[i]];
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
