// SPDX-License-Identifier: Apache-2.0
// 3D video ([H] §4): a folder with a harmonised model per frame, and an index. Playback loads frames ahead.
//
//   sequence.json   {"version": 1, "fps": 25, "frames": ["frame0000", "frame0001", …]}   folders of models
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "ibr/export.h"
#include "ibr/htm_model.h"

namespace ibr {

/// Name of the index in a sequence's folder.
inline constexpr const char* kHtmSequenceFileName = "sequence.json";

/// Index of a sequence: its frames, at least one, and their rate.
struct HtmSequenceIndex {
  double fps = 25;                            // frames per second, > 0, at most 1000
  std::vector<std::filesystem::path> frames;  // folders of models, relative to the index's folder and inside it
};

/// Reads FOLDER/sequence.json or the file itself, but no models. Throws Error{io}, or Error{invalidInput} with file and
/// JSON pointer.
IBR_API HtmSequenceIndex loadHtmSequence(const std::filesystem::path& path);

/// Writes FOLDER/sequence.json. Throws Error{invalidInput} for an index that loadHtmSequence would reject; Error{io}.
IBR_API void saveHtmSequence(const HtmSequenceIndex& index, const std::filesystem::path& folder);

/// Faults of the index and of its models' files, at most `limit`. `field` is a JSON pointer into the index. For a
/// model's fault it points to the frame; the message names the frame's folder and the fault's JSON pointer in the
/// model.
IBR_API std::vector<Fault> validateHtmSequenceFiles(const std::filesystem::path& path, std::size_t limit = 100);

/// A loaded frame.
struct HtmFrame {
  HtmModel model;                       // the frame's model
  std::vector<HtmImage> pictures;       // pictures by camera, or empty
  double loadMilliseconds = 0;          // time that loading took
  IBR_API std::uint64_t bytes() const;  // host memory of the frame, approximately
};

/// Loads the model of a folder, and its pictures by calling `pictures`; without `pictures` they are left empty. Throws
/// what loadHtmModel and `pictures` throw.
IBR_API HtmFrame loadHtmFrame(const std::filesystem::path& model, const HtmImageSource& pictures);

/// Options of an HtmSequence.
struct HtmSequenceOptions {
  std::size_t framesAhead = 8;  // frames after the current one that are loaded in the background
  /// Limit for the cached frames, bytes, the current one and those ahead. Fewer frames ahead are cached where they do
  /// not fit; the current one always is. A frame that is being loaded counts with the size of the largest frame so far.
  /// Frames that only the caller holds are not counted.
  std::uint64_t budgetBytes = std::uint64_t(2) << 30;
  bool loop = true;  // the first frame comes after the last one
};

/// Plays a sequence. A thread of its own loads models and calls `pictures`. Any thread may call; frame() and tryFrame()
/// wait for each other. The destructor waits for the frame that is being loaded.
class IBR_API HtmSequence {
 public:
  /// Reads the index. Throws what loadHtmSequence throws.
  HtmSequence(const std::filesystem::path& path, HtmImageSource pictures, const HtmSequenceOptions& options = {});
  HtmSequence(const HtmSequence&) = delete;
  HtmSequence& operator=(const HtmSequence&) = delete;
  ~HtmSequence();  // waits for the frame that is being loaded

  std::size_t frameCount() const noexcept;                                   // number of frames, at least 1
  double fps() const noexcept;                                               // frames per second
  double duration() const noexcept { return double(frameCount()) / fps(); }  // duration of one pass, s

  /// Index of the frame at a time: frame k from k / fps on. Beyond the ends the sequence repeats if
  /// HtmSequenceOptions::loop is set, else stays at its first or last frame. 0 for NaN.
  std::size_t frameAt(double seconds) const noexcept;

  /// Makes the frame the current one: it is loaded next, then the frames after it; all others leave the cache. frame()
  /// waits until it is loaded; tryFrame() does not wait for loading and returns nullptr until then. Both throw the
  /// error of loading the frame (once: the next call tries again), and Error{invalidInput} for an index out of range.
  std::shared_ptr<const HtmFrame> frame(std::size_t index);
  std::shared_ptr<const HtmFrame> tryFrame(std::size_t index);

  /// State of the cache.
  struct Counts {
    std::size_t cachedFrames = 0;  // number of cached frames, the current one included
    std::uint64_t bytes = 0;       // host memory of the cached frames
    std::size_t loads = 0;         // attempts to load a frame since construction
  };
  Counts counts() const;  // the state at this moment

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
