// SPDX-License-Identifier: Apache-2.0
// Pinhole images of equirectangular panoramas ([T] §4.2). Frames and the panorama's projection: conventions.h. Needs
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

/// Samples pinhole images from a panorama. Immutable, hence thread-safe. Holds a copy of the panorama with a border.
class PanoramaSampler {
 public:
  /// Copies a panorama of 1 to 4 channels and any size: the width spans 360°, the height 180°. Throws
  /// Error{invalidInput} for an empty panorama or another number of channels.
  explicit PanoramaSampler(const Image8& panorama);

  /// Returns the image of a pinhole at the panorama's centre. `rotation` (unit) maps the pinhole's axes to the
  /// panorama's. Samples are bilinear, across the seam and the poles too, at positions rounded to 1/256 px. A pixel
  /// wider than the panorama's is the mean of up to 16 × 16 samples. Near the poles, each of them is the mean of up to
  /// 64 samples along the parallel. Throws Error{invalidInput} unless the camera is a pinhole with fx, fy > 0.
  Image8 view(const Intrinsics& pinhole, glm::dquat rotation) const;

 private:
  int width_, height_, channels_;       // of the panorama
  std::size_t stride_;                  // bytes from row to row of bordered_
  std::vector<std::uint8_t> bordered_;  // one pixel more on every side
};

/// One of the pinholes that a panorama is split into.
struct PanoramaFace {
  std::string name;     // "front", "view03": unique among the faces
  glm::dquat rotation;  // unit; maps the face's axes to the panorama's
};

/// Returns the faces front (−z), right, back, left, up and down, in this order.
std::vector<PanoramaFace> cubeFaces();

/// Returns `count` views around the horizon, in equal steps to the right; the first looks to the front. Throws
/// Error{invalidInput} unless count is 1 to 360.
std::vector<PanoramaFace> horizonFaces(int count);

/// Returns the intrinsics of a square face, `size` px wide, with this field of view. Throws Error{invalidInput} for a
/// field of view outside (0, π).
Intrinsics faceIntrinsics(int size, double fovRadians);

/// Returns the size at which the centre of a face has the angular resolution of the panorama's equator, px; at least 1.
/// Throws as faceIntrinsics.
int faceSize(int panoramaWidth, double fovRadians);

/// Format of written images.
enum class ImageFileFormat : std::uint8_t {
  asSource,  // JPEG for a JPEG, else PNG
  jpeg,      // JPEG
  png        // PNG
};

/// Options of splitPanoramas().
struct SplitOptions {
  std::filesystem::path input;   // a panorama, placed at the origin; with model: folder of its images
  std::filesystem::path model;   // poses, for readPoseFile (ibr/author/poses.h)
  std::filesystem::path output;  // folder that gets images/ and sparse/; created if missing
  int views = 0;                 // number of views around the horizon; 0: cube faces
  bool poles = false;            // adds the faces up and down to views around the horizon
  double fovDegrees = 105;       // field of view of a face in x and in y, degrees; above 90, cube faces overlap
  int size = 0;                  // size of a face, px; 0: faceSize()
  ImageFileFormat format = ImageFileFormat::asSource;  // format of the faces' files
  int threads = 0;  // maximum number of threads; 0: all cores; the images do not depend on it
};

/// Report of splitPanoramas().
struct SplitReport {
  // panoramas: number of panoramas; pictures: number of faces; observations: number of observations in the faces
  std::size_t panoramas = 0, pictures = 0, observations = 0;
  std::vector<std::string> skipped;                             // names of the model's images that are no panoramas
  int size = 0;                                                 // size of the last panorama's faces, px
  double readSeconds = 0, sampleSeconds = 0, writeSeconds = 0;  // processor time of the stage, sum over the threads
  double seconds = 0;                                           // elapsed time
};

/// Writes the faces of panoramas as images/NAME_FACE.jpg or .png, and finally their cameras as a COLMAP text model in
/// sparse/. NAME is the panorama's name without extension, and without the folders that all panoramas share. The
/// model's tracks get observations in the faces that see them. Holds one panorama, and one face a thread; runs fewer
/// threads if the faces would take more than half of the memory that the process may have. Throws Error; images written
/// by then are complete.
SplitReport splitPanoramas(const SplitOptions& options, const ProgressCallback& progress = {},
                           const LogCallback& log = {});

}  // namespace ibr
