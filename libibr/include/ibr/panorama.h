// SPDX-License-Identifier: Apache-2.0
// Pinhole pictures of equirectangular panoramas ([T] §4.2). Frames and the panorama's formula: conventions.h. Needs
// ibr::author.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/log.h"

namespace ibr {

/// A panorama that pictures are taken from. Immutable, hence thread-safe; holds a copy of the panorama with a border.
class PanoramaSampler {
 public:
  /// 8 bits, 1 to 4 channels, any size: its width is a whole turn, its height half a turn. Throws
  /// Error{invalidInput} where it is empty or has other channels.
  explicit PanoramaSampler(const Image8& panorama);

  /// What a pinhole at the panorama's centre sees. `rotation` (unit) maps its axes to the panorama's.
  /// Bilinear at positions rounded to 1/256 px, across the seam and over the poles. Where a pixel of the picture is
  /// wider than one of the panorama it is the mean of what it covers: of up to 16 × 16 parts of the pixel, and near the
  /// poles of up to 64 places along the parallel. Throws Error{invalidInput} where it is no pinhole with fx, fy > 0.
  Image8 view(const Intrinsics& pinhole, glm::dquat rotation) const;

 private:
  int width_, height_, channels_;       // of the panorama
  std::size_t stride_;                  // bytes from row to row of bordered_
  std::vector<std::uint8_t> bordered_;  // one pixel more on every side
};

/// One of the pinholes that a panorama is split into.
struct PanoramaFace {
  std::string name;     // "front", "view03": unique among the faces
  glm::dquat rotation;  // from the face's axes to the panorama's
};

/// front (−z), right, back, left, up and down.
std::vector<PanoramaFace> cubeFaces();

/// `count` (1 to 360) views round the horizon in equal steps to the right, the first to the front.
std::vector<PanoramaFace> horizonFaces(int count);

/// A square picture, `size` px wide, of the directions within `fovRadians`. Throws Error{invalidInput} unless
/// 0 < fov < π.
Intrinsics faceIntrinsics(int size, double fovRadians);

/// The size at which such a face has as many pixels an angle, in its middle, as a panorama `width` px wide has at its
/// equator; at least 1. Throws likewise.
int faceSize(int panoramaWidth, double fovRadians);

enum class PictureFormat : std::uint8_t { asSource, jpeg, png };  // asSource: PNG where the source is no JPEG

struct SplitOptions {
  std::filesystem::path input;  // a panorama; with poses, the folder that their names are relative to
  std::filesystem::path model;  // COLMAP model folder, or
  std::filesystem::path
      panoramas;                 // file that readPanoramas (ibr/author.h) reads; neither: one panorama, at the origin
  std::filesystem::path output;  // made if missing; gets images/ and sparse/
  int views = 0;                 // round the horizon; 0: the faces of a cube
  bool poles = false;            // up and down besides views round the horizon
  double fovDegrees = 105;       // of a face, both ways; above 90 the faces of a cube overlap
  int size = 0;                  // px, both ways; 0: faceSize()
  PictureFormat format = PictureFormat::asSource;
  int threads = 0;  // at most, 0 = all cores; the pictures do not depend on it
};

struct SplitReport {
  std::size_t panoramas = 0, pictures = 0, observations = 0;    // observations of tracks that fell into pictures
  std::vector<std::string> skipped;                             // images of the model that are no panoramas
  int size = 0;                                                 // px of the last picture
  double readSeconds = 0, sampleSeconds = 0, writeSeconds = 0;  // of the processor, added up over threads
  double seconds = 0;                                           // that passed
};

/// Writes the faces of panoramas, images/NAME_FACE.jpg or .png, and their cameras as a COLMAP text model in sparse/,
/// which is written last. NAME is the panorama's without extension and without the folders that all panoramas share.
/// Tracks of the model are carried over to the faces that see them. Holds one panorama and a face a thread at a
/// time, on no more threads than half of the machine's memory holds faces.
/// Throws Error; pictures that stand are whole.
SplitReport splitPanoramas(const SplitOptions& options, const ProgressCallback& progress = {},
                           const LogCallback& log = {});

}  // namespace ibr
