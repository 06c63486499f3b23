// SPDX-License-Identifier: Apache-2.0
// Which photographs are on the device at full size, under a hard budget of bytes (ARCHITECTURE §4, "Residency").
// Decides only; who owns it allocates, loads and frees as it is told.
//
// Memory comes in pages, each for some photographs of one class (size and format). A frame hands in a list of wanted
// photographs, the most urgent first. For each one that is away, in order, a layer is found:
//
//   a free one in a page of its class; else in a new page, if the budget has room;
//   else that of the least urgent photograph of its class, if it is less urgent and no frame uses it any more;
//   else in a new page, after pages of other classes, with nothing but less urgent photographs, are freed
//
// Where only frames in flight stand in the way, the less urgent photograph leaves: further frames do without it, so
// that the place is free some frames later.
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
    std::uint64_t pageBytes = 0;
    std::uint32_t pageLayers = 0;
  };

  Residency() = default;
  /// `classOf` has an entry a photograph; kNone: it is never asked for here.
  Residency(std::vector<Class> classes, std::vector<std::uint32_t> classOf, std::uint64_t budgetBytes);

  /// Frames are numbered from 1 and come in order, or again where the last one was never submitted. No photograph is
  /// twice in `wanted`; the first `needed` of them are what the frame shows.
  void begin(std::span<const std::uint32_t> wanted, std::size_t needed, std::uint64_t frame, std::uint64_t completed);

  struct Step {
    enum class Kind { freePage, makePage, load } kind;
    std::uint32_t page = kNone;                       // number of the page; those of freed ones are given out again
    std::uint32_t photographClass = kNone;            // makePage
    std::uint32_t photograph = kNone, layer = kNone;  // load; until `arrived` it is not there
  };
  /// What is to be done next, in this order; nothing: no more in this frame. A load may last for several frames, and
  /// further ones may be begun meanwhile.
  std::optional<Step> next();
  /// A page could not be made: the budget is from now on what is used.
  void pageRefused(std::uint32_t page);
  void arrived(std::uint32_t photograph);  // its commands are recorded
  void failed(std::uint32_t photograph);   // while loading; it is not tried again

  struct Seat {
    std::uint32_t page = kNone, layer = kNone;
  };
  /// nullopt while it is not there, or is leaving.
  std::optional<Seat> seat(std::uint32_t photograph) const;

  struct Counts {
    std::uint32_t needed = 0;       // photographs of the frame, whether streamed or not
    std::uint32_t waiting = 0;      // of them: on their way, or will be when frames have finished
    std::uint32_t withoutRoom = 0;  // of them: the budget holds too little
    std::uint32_t failed = 0;
  };
  /// Ends the frame: what it needs and is there is in use until the frame has finished.
  Counts end();

  std::uint64_t pageBytes() const noexcept { return usedBytes_; }

 private:
  enum class State : std::uint8_t { away, loading, here, leaving, failed };
  struct Photograph {
    std::uint32_t classIndex = kNone;
    State state = State::away;
    std::uint32_t page = kNone, layer = kNone;
    std::uint32_t rank = kNone;      // in this frame's list
    std::uint64_t lastFrame = 0;     // that shows it
    std::uint64_t claimedFrame = 0;  // in which its place was last claimed, to be taken when it is free
    bool refused = false;            // in this frame
  };
  struct Page {
    std::uint32_t classIndex = kNone;  // kNone: does not exist
    std::uint64_t lastFrame = 0;
    std::vector<std::uint32_t> layers;  // photographs; kNone: free
  };
  enum class Room { none, claimed, found };  // claimed: there will be, when frames have finished

  Step load(std::uint32_t photograph, std::uint32_t page, std::uint32_t layer);
  Step makePage(std::uint32_t classIndex);
  Room findVictim(const Photograph& urgent, std::uint32_t& victim);
  Room findPageToFree(const Photograph& urgent, std::uint32_t& page);
  void claim(std::uint32_t photograph);
  void remove(std::uint32_t photograph);

  std::vector<Class> classes_;
  std::vector<Photograph> photographs_;
  std::vector<Page> pages_;
  std::vector<std::uint32_t> wanted_;
  std::size_t needed_ = 0, cursor_ = 0;
  std::uint64_t budget_ = 0, usedBytes_ = 0, frame_ = 0, completed_ = 0;
};

}  // namespace ibr
