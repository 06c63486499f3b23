// SPDX-License-Identifier: Apache-2.0
// Descriptor sets by their contents. A set is never written while a frame may use the set.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/device.h"

namespace ibr {

/// `Key`: contents of a set, ordered. Allocates memory only where it grows: until then, sets of finished frames are
/// reused where no other is left.
template <class Key>
class SetCache {
 public:
  /// Adds unused sets.
  void grow(const std::vector<VkDescriptorSet>& sets) {
    entries_.reserve(entries_.size() + sets.size());
    order_.reserve(entries_.capacity());
    unused_.reserve(entries_.capacity());
    for (const VkDescriptorSet set : sets) {
      unused_.push_back(entries_.size());
      entries_.push_back({.set = set});
    }
  }

  /// Returns the set with these contents for use in `frame`; null: there is none.
  VkDescriptorSet find(const Key& key, std::uint64_t frame) {
    const auto found = lowerBound(key);
    if (found == order_.end() || entries_[*found].key != key) return VK_NULL_HANDLE;
    entries_[*found].lastFrame = frame;
    return entries_[*found].set;
  }

  /// Returns a set that no frame after `completedFrame` uses, for the caller to write; null: there is none.
  /// Precondition: find(key) is null.
  VkDescriptorSet add(const Key& key, std::uint64_t frame, std::uint64_t completedFrame) {
    if (unused_.empty() && frame > 0) removeIf([&](const Entry& entry) { return entry.lastFrame <= completedFrame; });
    if (unused_.empty()) return VK_NULL_HANDLE;
    const std::size_t index = unused_.back();
    unused_.pop_back();
    entries_[index].key = key;
    entries_[index].lastFrame = frame;
    order_.insert(lowerBound(key), index);
    return entries_[index].set;
  }

  /// Drops the sets with contents for which `uses(key)` is true. Frames that used them must have finished.
  template <class Uses>
  void forget(const Uses& uses) {
    removeIf([&](const Entry& entry) { return uses(entry.key); });
  }

  std::size_t count() const noexcept { return order_.size(); }  // sets with contents

 private:
  struct Entry {
    Key key = {};
    VkDescriptorSet set = VK_NULL_HANDLE;
    std::uint64_t lastFrame = 0;
  };

  std::vector<std::size_t>::iterator lowerBound(const Key& key) {
    return std::ranges::lower_bound(order_, key, {},
                                    [&](std::size_t index) -> const Key& { return entries_[index].key; });
  }

  template <class Condition>
  void removeIf(const Condition& condition) {
    std::erase_if(order_, [&](std::size_t index) {
      const bool remove = condition(entries_[index]);
      if (remove) unused_.push_back(index);
      return remove;
    });
  }

  std::vector<Entry> entries_;
  std::vector<std::size_t> order_, unused_;  // indices of entries: with contents by their order, and without
};

}  // namespace ibr
