// SPDX-License-Identifier: Apache-2.0
#include "optimise/texels.h"

#include <algorithm>

namespace ibr {

Texels texelsOf(const Image8& picture) {
  Texels texels{picture.width + 2, {}};
  texels.words.reserve(std::size_t(texels.stride) * std::size_t(picture.height + 2) + kTexelOverrun);
  for (int y = -1; y <= picture.height; ++y)
    for (int x = -1; x <= picture.width; ++x) {
      const auto rgb = picture.pixel(std::clamp(x, 0, picture.width - 1), std::clamp(y, 0, picture.height - 1));
      texels.words.push_back((std::uint32_t(rgb[0]) | std::uint32_t(rgb[1]) << 8 | std::uint32_t(rgb[2]) << 16) ^
                             0x808080u);
    }
  texels.words.resize(texels.words.size() + kTexelOverrun, 0);
  return texels;
}

}  // namespace ibr
