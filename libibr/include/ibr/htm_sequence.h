// SPDX-License-Identifier: Apache-2.0
// 3D video ([H] §4): a folder of harmonised models, one a frame, and an index; played with the next frames loaded
// ahead.
//
//   sequence.json   {"version": 1, "fps": 25, "frames": ["frame0000", "frame0001", …]}   folders of models beside it
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

inline constexpr const char* kHtmSequenceFileName = "sequence.json";

struct HtmSequenceIndex {
  double fps = 25;                            // > 0, at most 1000
  std::vector<std::filesystem::path> frames;  // relative to the index's folder and inside it; at least one
};

/// Reads FOLDER/sequence.json or the file itself; models are not looked at. Throws Error{io}, or Error{invalidInput}
/// with file and JSON pointer.
HtmSequenceIndex loadHtmSequence(const std::filesystem::path& path);

/// Writes FOLDER/sequence.json. Throws Error{invalidInput} for what loadHtmSequence would refuse, Error{io}.
void saveHtmSequence(const HtmSequenceIndex& index, const std::filesystem::path& folder);

/// Every fault of the index and of its models' files, at most `limit`; `field` is a JSON pointer of the index, for a
/// model's faults that of its frame, with file and place in the message.
std::vector<Fault> validateHtmSequenceFiles(const std::filesystem::path& path, std::size_t limit = 100);

struct HtmFrame {
  HtmModel model;
  std::vector<HtmPicture> pictures;  // by camera
  double loadMilliseconds = 0;       // that loading it took
  std::uint64_t bytes() const;       // of memory, about
};

/// The model of a folder, with its pictures by `pictures`; none: they are left empty. Throws what loadHtmModel and
/// `pictures` throw.
HtmFrame loadHtmFrame(const std::filesystem::path& model, const HtmPictureSource& pictures);

struct HtmSequenceOptions {
  std::size_t ahead = 8;  // frames after the current one that are loaded in the background
  /// Of the frames kept, the current one and those ahead; fewer are kept where they do not fit, but always the current
  /// one. While a frame is loaded it is counted with the size of the largest so far. What the caller holds is not
  /// counted.
  std::uint64_t budgetBytes = std::uint64_t(2) << 30;
  bool loop = true;  // the first frame comes after the last one
};

/// A sequence that is being played. One thread of its own loads models and calls `pictures`; calls may come from any
/// thread and wait for one another. The destructor waits for the frame that is being loaded.
class HtmSequence {
 public:
  /// Reads the index. Throws what loadHtmSequence throws.
  HtmSequence(const std::filesystem::path& path, HtmPictureSource pictures, const HtmSequenceOptions& options = {});
  HtmSequence(const HtmSequence&) = delete;
  HtmSequence& operator=(const HtmSequence&) = delete;
  ~HtmSequence();

  std::size_t frameCount() const noexcept;
  double fps() const noexcept;
  double duration() const noexcept { return double(frameCount()) / fps(); }  // seconds

  /// The frame that is shown at a time: frame k from k / fps on. Beyond the ends the sequence repeats, or stays at its
  /// first or last frame; 0 for what is no number.
  std::size_t frameAt(double seconds) const noexcept;

  /// The frame becomes the current one: it is loaded next, then those after it; others are let go. `frame` waits for
  /// it; `tryFrame` gives nullptr while it is not there yet, and goes on playing. Both throw what loading the frame
  /// threw (once: the next call tries again), Error{invalidInput} where there is no such frame.
  std::shared_ptr<const HtmFrame> frame(std::size_t index);
  std::shared_ptr<const HtmFrame> tryFrame(std::size_t index);

  struct Counts {
    std::size_t kept = 0;     // frames
    std::uint64_t bytes = 0;  // of them
    std::size_t loads = 0;    // tried since the beginning
  };
  Counts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
