// SPDX-License-Identifier: Apache-2.0
// Capture settings that a camera recorded with a photograph (EXIF 2.32 §4.6).
#pragma once

#include <cmath>
#include <optional>
#include <string>

namespace ibr {

/// Capture settings of a photograph. 0 or empty: not recorded. Other numbers are finite and positive. Texts from EXIF
/// are printable ASCII.
struct CaptureMetadata {
  double exposureTime = 0;   // exposure time, s
  double fNumber = 0;        // N, focal length over aperture
  double iso = 0;            // sensitivity, linear
  double focalLength = 0;    // focal length, mm
  double focalLength35 = 0;  // mm, 35 mm equivalent: same field of view on 36 mm × 24 mm
  std::string maker, model;  // names of the camera's maker and model
  std::string lens;          // name of the lens

  bool operator==(const CaptureMetadata&) const = default;
};

/// Where a camera was (WGS 84), in degrees north and east, and metres above sea level.
struct GeoLocation {
  double latitude = 0, longitude = 0;  // latitude: degrees north; longitude: degrees east
  std::optional<double> altitude;      // metres above sea level; nullopt: not recorded

  bool operator==(const GeoLocation&) const = default;
};

/// Returns a photograph's exposure relative to other photographs of the same camera: exposure time × ISO / N². nullopt
/// where a factor is unknown.
inline std::optional<double> relativeExposure(const CaptureMetadata& metadata) {
  const double exposure = metadata.exposureTime * metadata.iso / (metadata.fNumber * metadata.fNumber);
  if (!(exposure > 0) || !std::isfinite(exposure)) return std::nullopt;
  return exposure;
}

}  // namespace ibr
