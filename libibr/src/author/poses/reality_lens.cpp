// SPDX-License-Identifier: Apache-2.0
#include "author/poses/reality_lens.h"

#include <algorithm>

namespace ibr {

void setRealityLens(PosedImage& image, const ImageSize& size, const RealityLens& lens, Border border,
                    const std::function<void(ErrorCode, const std::string&)>& fault) {
  constexpr double kFilmWidthMm = 36;
  const double side = std::max(size.width, size.height);
  const double focal = lens.focal35mm / kFilmWidthMm * side;
  const auto& [k1, k2, k3, k4, t1, t2] = lens.terms;
  if (k4 != 0) fault(ErrorCode::unsupported, "k4 is not 0; no perspective lens of libibr has this term");
  try {
    const double cx = 0.5 * size.width + side * lens.principalU, cy = 0.5 * size.height + side * lens.principalV;
    setLens(image, LensModel::fullOpencv, size.width, size.height,
            {focal, focal, cx, cy, k1, k2, t2, t1, k3, lens.division, 0, 0}, border);
  } catch (const Error& e) {
    fault(e.code(), e.what());
  }
}

}  // namespace ibr
