// SPDX-License-Identifier: Apache-2.0
// Cameras of RealityScan and RealityCapture, after Hornacek: On the Coordinate Systems Employed in the Import,
// Estimation, and Export of Camera Geometry by RealityScan, 2026. Lengths are in units of the longer side, from the
// image's centre (eq. 31); the focal length is that of a 36 mm wide film (eq. 34). T1 and T2 are OpenCV's p2 and p1.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "author/poses/pose_source.h"

namespace ibr {

struct RealityLens {
  double focal35mm = 0;  // mm
  double principalU = 0, principalV = 0;
  std::array<double, 6> terms{};  // k1, k2, k3, k4, t1, t2 of Brown's model (eq. 47)
  double division = 0;            // k1 of the division model: x/(1 + k1·r²) of the undistorted x (eq. 49)
};

/// Throws through `fault` with the name of a term that no lens of libibr has.
void setRealityLens(PosedImage& image, const ImageSize& size, const RealityLens& lens, Border border,
                    const std::function<void(ErrorCode, const std::string&)>& fault);

}  // namespace ibr
