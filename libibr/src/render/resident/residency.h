// SPDX-License-Identifier: Apache-2.0
// Decides which photographs are on the device at full size, under a hard budget of bytes. The owner allocates, loads
// and frees texture arrays as decided here.
//
// Memory is allocated in arrays: texture arrays for photographs of one class (size and format). Arrays and photographs
// may take several frames until they are there. Each frame passes a list of wanted photographs, most urgent first. Each
// one that is not resident gets a layer, in this order:
//
//   a free layer in an array of its class; else a new array, if the budget has room;
//   else the layer of the least urgent photograph of its class, if it is less urgent and no frame in flight uses it;
//   else a new array, after freeing arrays of other classes that hold only less urgent photographs
//
// If only frames in flight prevent this, the less urgent photograph is evicted: later frames do not use it, and its
// layer becomes free when the frames in flight have finished.
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
  };

  Residency() = default;
  /// `classOf`: the class of each photograph; kNone: never streamed.
  Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::uint64_t budgetBytes);

  /// Frames are numbered from 1, ascending; a number repeats if the last frame was never submitted. `wanted` has no
  /// duplicates; the frame shows the first `needed` of them. All frames up to `completed` have finished.
  void begin(std::span<const std::uint32_t> wanted, std::size_t needed, std::uint64_t frame, std::uint64_t completed);

  struct Step {
    enum class Kind { freeArray, makeArray, load } kind;
    std::uint32_t array = kNone;                      // number of the array, below maxArrays(); numbers are reused
    std::uint32_t photographClass = kNone;            // for makeArray
    std::uint32_t photograph = kNone, layer = kNone;  // for load; not resident until finishLoad() is called
  };
  /// Returns the next step; nullopt: none in this frame. Steps must be done in order; those before a load make room for
  /// the load. An array is used by loads before it exists. Arrays and loads may last several frames; further steps may
  /// follow meanwhile. `mayMakeArray` false: there is no step where the most urgent photograph needs another array.
  std::optional<Step> next(bool mayMakeArray = true);
  void arrayMade(std::uint32_t array);  // its first commands are recorded in this frame
  /// The array could not be allocated: lowers the budget to the current use. Its photographs are absent.
  void allocationFailed(std::uint32_t array);
  void finishLoad(std::uint32_t photograph);  // its commands are recorded
  void cancel(std::uint32_t photograph);      // while loading, before any commands; tried again where wanted
  void failed(std::uint32_t photograph);      // while loading; not tried again

  struct Slot {
    std::uint32_t array = kNone, layer = kNone;
  };
  /// Returns nullopt while the photograph is not resident, or is being evicted.
  std::optional<Slot> slot(std::uint32_t photograph) const;

  struct Counts {
    std::uint32_t needed = 0;      // photographs that the frame shows, streamed or not
    std::uint32_t waiting = 0;     // of these: loading, or waiting for frames in flight
    std::uint32_t overBudget = 0;  // of these: the budget is too small
    std::uint32_t failed = 0;
  };
  /// Ends the frame: its resident photographs are in use until the frame has finished.
  Counts endFrame();

  /// Index in this frame's list; kNone: not wanted.
  std::uint32_t rank(std::uint32_t photograph) const noexcept { return photographs_[photograph].rank; }

  std::uint64_t arrayBytes() const noexcept { return usedBytes_; }
  std::size_t maxArrays() const noexcept { return arrays_.size(); }

 private:
  enum class State : std::uint8_t { absent, loading, here, evicting, failed };
  struct Photograph {
    std::uint32_t classIndex = kNone;
    State state = State::absent;
    std::uint32_t array = kNone, layer = kNone;
    std::uint32_t rank = kNone;      // index in this frame's list
    std::uint64_t lastFrame = 0;     // last frame that shows the photograph
    std::uint64_t claimedFrame = 0;  // last frame in which a more urgent photograph claimed its layer
    bool refused = false;            // in this frame: no room
  };
  struct TextureArray {
    std::uint32_t classIndex = kNone;
    bool exists = false;  // also while it is being made
    std::uint64_t lastFrame = 0;
    std::vector<std::uint32_t> layers;  // photographs; kNone: free
  };
  enum class Room { none, claimed, found };  // claimed: room when frames in flight have finished

  Step load(std::uint32_t photograph, std::uint32_t array, std::uint32_t layer);
  std::optional<Step> layerFor(std::uint32_t photograph);
  Step makeArray(std::uint32_t classIndex);
  Room findVictim(const Photograph& urgent, std::uint32_t& victim);
  Room findArrayToFree(const Photograph& urgent, std::uint32_t& array);
  void claim(std::uint32_t photograph);
  void remove(std::uint32_t photograph);

  std::vector<Class> classes_;
  std::vector<Photograph> photographs_;
  std::vector<TextureArray> arrays_;  // all that can exist, by class
  std::vector<std::uint32_t> wanted_;
  std::vector<std::uint32_t> busy_;  // of findArrayToFree
  std::size_t needed_ = 0, cursor_ = 0;
  std::uint64_t budget_ = 0, usedBytes_ = 0, frame_ = 0, completed_ = 0;
};

}  // namespace ibr
