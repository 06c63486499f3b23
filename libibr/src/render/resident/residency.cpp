// SPDX-License-Identifier: Apache-2.0
#include "render/resident/residency.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace ibr {

Residency::Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::vector<std::uint64_t> budgets)
    : classes_(std::move(classes)), orders_(classes_.size()), free_(classes_.size()), items_(classOf.size()) {
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
    free_[c].reserve(most * layers);
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
  for (Order& order : orders_) order.search = order.first;
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
      remove(found);
      return layerFor(p);
    }
    const Room freed = findArrayToFree(urgent, found);
    if (freed == Room::found) {
      if (isBlocked) return std::nullopt;
      removeArray(found);
      return Step{.kind = Step::Kind::freeArray, .array = found};
    }
    urgent.refused = victim == Room::none && freed == Room::none;
    group.full = cursor_ >= needed_;
  }
  return std::nullopt;
}

std::optional<Residency::Step> Residency::layerFor(std::uint32_t item) {
  Item& p = items_[item];
  std::vector<Slot>& free = free_[p.classIndex];
  if (free.empty()) return std::nullopt;
  p.state = State::loading;
  p.array = free.back().array;
  p.layer = free.back().layer;
  free.pop_back();
  arrays_[p.array].layers[p.layer] = item;
  append(item);
  return Step{.kind = Step::Kind::load, .array = p.array, .item = item, .layer = p.layer};
}

// There is an array that does not exist: all items of the class would fit into those that do.
Residency::Step Residency::makeArray(std::uint32_t classIndex) {
  const auto unused = std::ranges::find_if(
      arrays_, [&](const TextureArray& array) { return !array.exists && array.classIndex == classIndex; });
  assert(unused != arrays_.end());
  unused->exists = true;
  unused->lastFrame = frame_;
  groupOf(classes_[classIndex]).used += classes_[classIndex].arrayBytes;
  const auto array = std::uint32_t(unused - arrays_.begin());
  for (std::uint32_t layer = classes_[classIndex].layersPerArray; layer-- > 0;)
    free_[classIndex].push_back({array, layer});
  return {.kind = Step::Kind::makeArray, .array = array, .itemClass = classIndex};
}

// Finds the least urgent item of the same class; among unwanted ones, the one not shown for the longest time. Items
// that no frame in flight uses are preferred.
Residency::Room Residency::findVictim(const Item& urgent, std::uint32_t& victim) {
  std::uint32_t busy = kNone;
  const auto isFound = [&](std::uint32_t candidate) {
    const Item& item = items_[candidate];
    victim = candidate;
    if (item.state != State::loading && item.lastFrame <= completed_) return true;
    if (busy == kNone) busy = candidate;
    return false;
  };
  Order& order = orders_[urgent.classIndex];
  for (std::uint32_t p = order.search; p != kNone; p = items_[p].after) {
    if (items_[p].rank != kNone || items_[p].claimedFrame == frame_) {
      if (order.search == p) order.search = items_[p].after;
    } else if (isFound(p)) {
      return Room::found;
    } else if (items_[p].lastFrame > completed_) {
      break;  // so are those behind
    }
  }
  for (std::size_t rank = wanted_.size(); rank-- > std::size_t(urgent.rank) + 1;) {
    const Item& item = items_[wanted_[rank]];
    if (item.layer != kNone && item.classIndex == urgent.classIndex && item.claimedFrame != frame_ &&
        isFound(wanted_[rank]))
      return Room::found;
  }
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
  unlink(item);
  free_[p.classIndex].push_back({p.array, p.layer});
  arrays_[p.array].layers[p.layer] = kNone;
  p.state = State::absent;
  p.array = p.layer = kNone;
}

void Residency::removeArray(std::uint32_t array) {
  const std::uint32_t classIndex = arrays_[array].classIndex;
  for (const std::uint32_t p : arrays_[array].layers)
    if (p != kNone) remove(p);
  std::erase_if(free_[classIndex], [&](Slot slot) { return slot.array == array; });
  groupOf(classes_[classIndex]).used -= classes_[classIndex].arrayBytes;
  arrays_[array].exists = false;
}

void Residency::append(std::uint32_t item) {
  Order& order = orders_[items_[item].classIndex];
  items_[item].before = order.last;
  items_[item].after = kNone;
  (order.last == kNone ? order.first : items_[order.last].after) = item;
  order.last = item;
}

void Residency::unlink(std::uint32_t item) {
  const Item& p = items_[item];
  Order& order = orders_[p.classIndex];
  if (order.search == item) order.search = p.after;
  (p.before == kNone ? order.first : items_[p.before].after) = p.after;
  (p.after == kNone ? order.last : items_[p.after].before) = p.before;
}

// This frame shows the item.
void Residency::show(std::uint32_t item) {
  items_[item].lastFrame = arrays_[items_[item].array].lastFrame = frame_;
  unlink(item);
  append(item);
}

void Residency::arrayMade(std::uint32_t array) {
  arrays_[array].lastFrame = frame_;
}

void Residency::allocationFailed(std::uint32_t array) {
  removeArray(array);
  Group& group = groupOf(classes_[arrays_[array].classIndex]);
  group.budget = group.used;
}

void Residency::finishLoad(std::uint32_t item) {
  Item& p = items_[item];
  assert(p.state == State::loading);
  p.state = State::here;
  show(item);
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
      show(wanted_[i]);
    } else if (p.state == State::failed) {
      ++counts.failed;
    } else {
      ++(p.refused ? counts.overBudget : counts.waiting);
    }
  }
  return counts;
}

}  // namespace ibr
