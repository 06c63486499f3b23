// SPDX-License-Identifier: Apache-2.0
// Photographs from videos: frames that are sharp and far enough apart to show parallax, whatever their times. Needs
// ibr::author, and the programs ffmpeg and ffprobe.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/capture.h"
#include "ibr/log.h"

namespace ibr {

/// Properties of a video.
struct VideoInfo {
  int width = 0, height = 0;            // size of a frame, px, upright, with square pixels
  int rotation = 0;                     // degrees that players turn the stored frames clockwise: 0, 90, 180 or 270
  double seconds = 0;                   // duration; 0: unknown
  double framesPerSecond = 0;           // mean rate of the frames
  bool variableRate = false;            // true: frames are not evenly spaced in time
  bool hdr = false;                     // true: high dynamic range, PQ or HLG
  CaptureMetadata capture;              // capture settings: maker and model only
  std::optional<GeoLocation> location;  // start of the recording; nullopt: not recorded
  std::vector<std::string> ignored;     // other streams but sound, for people: "data gpmd (GoPro MET)"
};

/// Reads a video's properties with the program ffprobe. Throws Error: io if the program or the file cannot be read,
/// invalidInput if the file has no video.
VideoInfo probeVideo(const std::filesystem::path& video, const std::string& ffprobe = "ffprobe");

/// Options of extractFrames().
struct VideoOptions {
  std::filesystem::path video;      // file of the video
  std::filesystem::path folder;     // folder of the frames; created if missing
  std::string ffmpeg = "ffmpeg";    // program ffmpeg, looked up in PATH unless it contains a folder
  std::string ffprobe = "ffprobe";  // program ffprobe, looked up in the same way
  bool keepMetadata = true;         // frames get EXIF of the camera and the location
  std::size_t frames = 0;           // number of frames to choose, about; 0: by motion, 40 to 80 a minute while the
                                    // camera moves
};

/// Result of extractFrames().
struct VideoFrames {
  /// A chosen frame.
  struct Frame {
    std::string name;        // name of the JPEG file in the folder: the video's stem and the frame's number
    std::size_t number = 0;  // number in the video, from 0
    double sharpness = 0;    // 0 to 1, relative to the frames around it
  };
  VideoInfo info;             // properties of the video
  std::size_t decoded = 0;    // number of frames of the video
  std::vector<Frame> chosen;  // chosen frames, ascending by number
};

/// Chooses frames, and writes them as JPEG files of quality 95: upright, sRGB (HDR is compressed as by readImage), with
/// EXIF of VideoInfo::capture and location. A frame follows the one before where the points that both show have moved
/// enough, by parallax or together; of the frames about there, the sharpest is chosen. A blurred frame is chosen only
/// where no sharp one shows its part of the way. Frames are those that ffmpeg decodes, of constant or variable rate.
/// A folder that holds the frames of the same file and options is left as it is; frames of another choice are removed
/// from it by their names, other files are kept. Same file and programs: same frames.
/// Throws Error: io, invalidInput, cancelled.
VideoFrames extractFrames(const VideoOptions& options, const ProgressCallback& progress = {},
                          const LogCallback& log = {});

}  // namespace ibr
