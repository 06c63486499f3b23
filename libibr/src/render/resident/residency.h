// SPDX-License-Identifier: Apache-2.0
// Decides which items of a scene (items, depth textures, meshes) are on the device at full size, under hard
// budgets of bytes. The owner allocates, loads and frees arrays as decided here.
//
// Memory is allocated in arrays with layers for items of one class: texture arrays for one size and format, chunks of a
// buffer for meshes of similar size. Arrays and items may take several frames until they are there. Classes belong to
// groups, each with a budget of its own. Each frame passes a list of wanted items, most urgent first. Each one that is
// not resident gets a layer, in this order:
//
//   a free layer in an array of its class; else a new array, if the group's budget has room;
//   else the layer of the least urgent item of its class, if it is less urgent and no frame in flight uses it;
//   else a new array, after freeing arrays of the group's other classes that hold only less urgent items
//
// If only frames in flight prevent this, the less urgent item is evicted: later frames do not use it, and its layer
// becomes free when the frames in flight have finished.
//
// Only the constructor allocates memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace ibr {

class Residency {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  struct Class {
    std::uint64_t arrayBytes = 0;
    std::uint32_t layersPerArray = 0;
    std::uint32_t group = 0;  // index of its budget
  };

  Residency() = default;
  /// `classOf`: the class of each item; kNone: never streamed. `budgets`: bytes of each group.
  Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::vector<std::uint64_t> budgets);

  /// Frames are numbered from 1, ascending; a number repeats if the last frame was never submitted. `wanted` has no
  /// duplicates; the frame shows the first `needed` of them. All frames up to `completed` have finished.
  void begin(std::span<const std::uint32_t> wanted, std::size_t needed, std::uint64_t frame, std::uint64_t completed);

  struct Step {
    enum class Kind { freeArray, makeArray, load } kind;
    std::uint32_t array = kNone;                // number of the array, below maxArrays(); numbers are reused
    std::uint32_t itemClass = kNone;            // for makeArray
    std::uint32_t item = kNone, layer = kNone;  // for load; not resident until finishLoad() is called
  };
  /// Returns the next step; nullopt: none in this frame. Steps must be done in order; those before a load make room for
  /// the load. An array is used by loads before it exists. Arrays and loads may last several frames; further steps may
  /// follow meanwhile. `mayMakeArray` false: there is no step where the most urgent item needs another
  /// array of group 0.
  std::optional<Step> next(bool mayMakeArray = true);
  void arrayMade(std::uint32_t array);  // its first commands are recorded in this frame
  /// The array could not be allocated: lowers the budget to the current use. Its items are absent.
  void allocationFailed(std::uint32_t array);
  void finishLoad(std::uint32_t item);  // its commands are recorded
  void cancel(std::uint32_t item);      // while loading, before any commands; tried again where wanted
  void failed(std::uint32_t item);      // while loading; not tried again

  struct Slot {
    std::uint32_t array = kNone, layer = kNone;
  };
  /// Returns nullopt while the item is not resident, or is being evicted.
  std::optional<Slot> slot(std::uint32_t item) const;

  struct Counts {
    std::uint32_t needed = 0;      // items that the frame shows, streamed or not
    std::uint32_t waiting = 0;     // of these: loading, or waiting for frames in flight
    std::uint32_t overBudget = 0;  // of these: the budget is too small
    std::uint32_t failed = 0;
  };
  /// Ends the frame: its resident items are in use until the frame has finished.
  Counts endFrame();

  /// Index in this frame's list; kNone: not wanted.
  std::uint32_t rank(std::uint32_t item) const noexcept { return items_[item].rank; }

  std::uint64_t arrayBytes(std::uint32_t group = 0) const noexcept { return groups_[group].used; }
  std::size_t maxArrays() const noexcept { return arrays_.size(); }

 private:
  enum class State : std::uint8_t { absent, loading, here, evicting, failed };
  struct Item {
    std::uint32_t classIndex = kNone;
    State state = State::absent;
    std::uint32_t array = kNone, layer = kNone;
    std::uint32_t rank = kNone;                   // index in this frame's list
    std::uint64_t lastFrame = 0;                  // last frame that shows the item
    std::uint64_t claimedFrame = 0;               // last frame in which a more urgent item claimed its layer
    bool refused = false;                         // in this frame: no room
    std::uint32_t before = kNone, after = kNone;  // in Order
  };
  // Items of a class that have a layer, the one not shown for the longest time first.
  struct Order {
    std::uint32_t first = kNone, last = kNone;
    std::uint32_t search = kNone;  // in this frame: items before are wanted or claimed
  };
  struct TextureArray {
    std::uint32_t classIndex = kNone;
    bool exists = false;  // also while it is being made
    std::uint64_t lastFrame = 0;
    std::vector<std::uint32_t> layers;  // items; kNone: free
  };
  struct Group {
    std::uint64_t budget = 0, used = 0;  // bytes
    bool full = false;                   // in this frame: less urgent items find no room either, or wait
  };
  enum class Room { none, claimed, found };  // claimed: room when frames in flight have finished

  std::optional<Step> layerFor(std::uint32_t item);
  Step makeArray(std::uint32_t classIndex);
  Room findVictim(const Item& urgent, std::uint32_t& victim);
  Room findArrayToFree(const Item& urgent, std::uint32_t& array);
  void claim(std::uint32_t item);
  void remove(std::uint32_t item);
  void removeArray(std::uint32_t array);
  void append(std::uint32_t item);
  void unlink(std::uint32_t item);
  void show(std::uint32_t item);

  Group& groupOf(const Class& itemClass) { return groups_[itemClass.group]; }

  std::vector<Class> classes_;
  std::vector<Order> orders_;            // by class
  std::vector<std::vector<Slot>> free_;  // layers without an item, by class
  std::vector<Group> groups_;
  std::vector<Item> items_;
  std::vector<TextureArray> arrays_;  // all that can exist, by class
  std::vector<std::uint32_t> wanted_;
  std::vector<std::uint32_t> busy_;  // of findArrayToFree
  std::size_t needed_ = 0, cursor_ = 0;
  std::uint64_t frame_ = 0, completed_ = 0;
};

}  // namespace ibr
