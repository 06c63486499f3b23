// SPDX-License-Identifier: Apache-2.0
// Frames of a video as the program ffmpeg decodes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ibr/author/video.h"
#include "ibr/image.h"
#include "io/colour_code.h"

namespace ibr {

/// A video's stream, with what decoding needs beyond VideoInfo.
struct VideoStream {
  VideoInfo info;
  int index = 0;  // of the stream in the file
  bool squarePixels = true;
  io::ColourCode colour;  // of HDR
  std::string matrix;     // of YCbCr, if the file does not state it: ffmpeg's name
};

/// Reads what ffprobe prints of a file as JSON. Throws Error{invalidInput} with `name`.
VideoStream streamOf(const std::string& probed, const std::string& name);

VideoStream probeStream(const std::filesystem::path& video, const std::string& ffprobe);

class VideoFile {
 public:
  VideoFile(std::filesystem::path video, VideoStream stream, std::string ffmpeg)
      : video_(std::move(video)), stream_(std::move(stream)), ffmpeg_(std::move(ffmpeg)) {}

  /// Decodes all frames as grey, scaled to a size. `frame` is called in order with the rows of each; returning false
  /// cancels. Returns the number of frames. Throws Error (io, cancelled).
  std::size_t greyFrames(int width, int height, const std::function<bool(std::size_t, const Image8&)>& frame) const;

  /// Decodes frames by their numbers, ascending: sRGB, of the video's size.
  void colourFrames(std::span<const std::size_t> numbers,
                    const std::function<bool(std::size_t, const Image8&)>& frame) const;

 private:
  std::size_t decode(const std::string& filter, const std::string& format, std::size_t frameBytes,
                     const std::function<bool(std::span<const std::uint8_t>)>& frame) const;

  std::filesystem::path video_;
  VideoStream stream_;
  std::string ffmpeg_;
};

}  // namespace ibr
