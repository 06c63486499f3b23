// SPDX-License-Identifier: Apache-2.0
// A file of poses, as its reader gets it, and what the readers share. Readers leave images in any order and with the
// file's names: readPoseFile() matches the names with photographs, and sorts. Faults are Error or JsonFault.
#pragma once

#include <array>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "author/poses/photograph_finder.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "scene/json_check.h"

namespace ibr {

/// A fault at a place in the file, such as a JSON pointer; readPoseFile() puts the file before it.
class PoseFault : public std::runtime_error {
 public:
  PoseFault(ErrorCode code, std::string at, const std::string& message)
      : std::runtime_error(message), code_(code), at_(std::move(at)) {}
  ErrorCode code() const noexcept { return code_; }
  const std::string& at() const noexcept { return at_; }

 private:
  ErrorCode code_;
  std::string at_;
};

struct ImageSize {
  int width, height;  // px
};

struct PoseSource {
  std::filesystem::path path;
  std::string text;     // of a file; empty for a folder
  nlohmann::json json;  // of a JSON file; null for others
  PhotographFinder photographs;
  LogCallback log;
  Border border = Border::crop;

  std::vector<std::string> missing;  // photographs that sizeOf() did not find

  /// Size of a photograph as stored, for formats without sizes; sought in the file's folder if that of the photographs
  /// is not known. A missing photograph gets a small size: readPoseFile() reports all missing ones in one Error.
  ImageSize sizeOf(const std::string& name);

  void warn(const std::string& message) const {
    if (log) log(LogLevel::warning, path.string() + ": " + message);
  }
};

PosedModel readTransforms(PoseSource& source);
PosedModel readPanoramas(PoseSource& source);
PosedModel readBundler(PoseSource& source);
PosedModel readNvm(PoseSource& source);
PosedModel readOpenMvg(PoseSource& source);
PosedModel readOpenSfm(PoseSource& source);
PosedModel readMetashape(PoseSource& source);
PosedModel readRealityCsv(PoseSource& source);
PosedModel readRealityXmp(PoseSource& source);
/// True for the start of a file that the reader reads.
bool isMetashape(const PoseSource& source);
bool isRealityCsv(const PoseSource& source);
/// True for a folder with an XMP file of RealityScan.
bool isRealityXmp(const PoseSource& source);

inline constexpr int kMaxPoseImageSide = 1 << 16;  // px

/// Gives `image` a lens, and the pinhole of its undistorted photograph. Throws Error{invalidInput} without a location.
void setLens(PosedImage& image, LensModel model, int width, int height, const std::vector<double>& parameters,
             Border border);

/// Brown's terms in OpenCV's order: x gets 2·p1·xy + p2·(r² + 2x²).
struct BrownTerms {
  double k1 = 0, k2 = 0, k3 = 0, p1 = 0, p2 = 0;
};
struct PinholeTerms {
  double fx, fy, cx, cy;  // px
};
void setBrownLens(PosedImage& image, int width, int height, const PinholeTerms& pinhole, const BrownTerms& terms,
                  Border border);

/// A panorama must be twice as wide as high. Throws Error{unsupported} without a location.
void setPanorama(PosedImage& image, int width, int height);

/// Size of the photograph, not of its undistorted image.
ImageSize sizeAsStored(const PosedImage& image);

/// Adds an observation at a pixel of the photograph as stored, distortion included; leaves out one outside the
/// undistorted image, and a second one in the same image.
void observe(Track& track, const PosedModel& model, std::uint32_t image, glm::dvec2 pixel);

/// The fault of a matrix that should be a rotation; nullopt if it is one, to 1e-3.
std::optional<std::string> rotationFault(const glm::dmat3& matrix);

/// Rotation by the matrix with these rows, normalised. Precondition: rotationFault() has none.
glm::dquat rotationOf(const glm::dmat3& matrix);

/// GLM's matrix (columns) of nine numbers in rows.
glm::dmat3 matrixOfRows(const std::array<double, 9>& rows);

}  // namespace ibr
