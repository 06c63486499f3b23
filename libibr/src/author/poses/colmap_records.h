// SPDX-License-Identifier: Apache-2.0
// Records of a COLMAP model's files as read; readColmapModel() checks and converts them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author/lens.h"

namespace ibr::colmap {

/// Position of a record in a file, for messages.
struct RecordLocation {
  const std::filesystem::path* file;
  std::uint64_t at;  // line (from 1) of a text file, byte of a binary one
  bool text;

  std::string describe() const;  // "…/images.txt:12" or "…/images.bin: byte 24"
};

struct ModelKind {
  std::int32_t number;  // in binary files
  const char* name;
  std::size_t parameters;
};
/// Camera models of COLMAP 3.8 (src/base/camera_models.h), and the panorama model of COLMAP 4.1, whose parameters
/// repeat width and height. Older text models leave these parameters out.
inline constexpr std::array<ModelKind, 12> kModelKinds{{{0, "SIMPLE_PINHOLE", 3},
                                                        {1, "PINHOLE", 4},
                                                        {2, "SIMPLE_RADIAL", 4},
                                                        {3, "RADIAL", 5},
                                                        {4, "OPENCV", 8},
                                                        {5, "OPENCV_FISHEYE", 8},
                                                        {6, "FULL_OPENCV", 12},
                                                        {7, "FOV", 5},
                                                        {8, "SIMPLE_RADIAL_FISHEYE", 4},
                                                        {9, "RADIAL_FISHEYE", 5},
                                                        {10, "THIN_PRISM_FISHEYE", 12},
                                                        {17, "EQUIRECTANGULAR", 2}}};
inline constexpr std::size_t kEquirectangular = kModelKinds.size() - 1;
static_assert(kEquirectangular == kLensModelCount);  // those before it are in LensModel's order

inline constexpr std::uint64_t kNoPoint = ~std::uint64_t(0);  // an observation without a point
inline constexpr std::uint64_t kNoCamera = 0xffffffff;        // an image that was never registered

struct CameraRecord {
  RecordLocation location;
  std::uint64_t id;
  std::size_t kind;  // index into kModelKinds
  std::uint64_t width, height;
  std::vector<double> parameters;  // as many as the model requires; an EQUIRECTANGULAR may have none
};
struct ObservationRecord {
  double x, y;
  std::uint64_t point;  // kNoPoint: none
};
struct ImageRecord {
  RecordLocation location;
  std::uint64_t id;
  std::array<double, 4> quaternion;   // w, x, y, z; world to camera
  std::array<double, 3> translation;  // world to camera
  std::uint64_t camera;               // kNoCamera: none
  std::string name;
  std::vector<ObservationRecord> observations;
};
struct PointRecord {
  RecordLocation location;
  std::uint64_t id;
  std::array<double, 3> position;
};

/// All numbers are finite; nothing else is guaranteed.
struct Records {
  Records() = default;
  Records(const Records&) = delete;  // the RecordLocations point into it
  Records& operator=(const Records&) = delete;

  std::filesystem::path camerasFile, imagesFile, pointsFile;  // the RecordLocations point to these
  std::vector<CameraRecord> cameras;
  std::vector<ImageRecord> images;
  std::vector<PointRecord> points;
};

/// Fill `records`, whose three file names are set (empty pointsFile: none). Throw Error that names the position.
void readText(Records& records);
void readBinary(Records& records);

}  // namespace ibr::colmap
