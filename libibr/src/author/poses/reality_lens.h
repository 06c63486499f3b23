// SPDX-License-Identifier: Apache-2.0
// Cameras of RealityScan and RealityCapture. Lengths are in units of the longer side, from the image's centre; the
// focal length is that of a 36 mm wide film. T1 and T2 are OpenCV's p2 and p1, as camorph and AliceVision read them.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "author/poses/pose_source.h"

namespace ibr {

struct RealityLens {
  double focal35mm = 0;  // mm
  double principalU = 0, principalV = 0;
  std::array<double, 6> terms{};  // k1, k2, k3, k4, t1, t2
};

/// Throws through `fault` with the name of a term that no lens of libibr has.
void setRealityLens(PosedImage& image, const ImageSize& size, const RealityLens& lens, Border border,
                    const std::function<void(ErrorCode, const std::string&)>& fault);

}  // namespace ibr
