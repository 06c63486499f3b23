// SPDX-License-Identifier: Apache-2.0
// Photographs as cameras store them when held upright, sideways or upside down.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <glm/vec2.hpp>
#include <string>

#include "base/file.h"
#include "io/image_file.h"

namespace ibr::test {

/// Returns the picture as a camera stores it that writes this orientation. Source: the table of row 0 and column 0 in
/// EXIF 2.32 §4.6.5.
inline Image8 storedAs(int orientation, const Image8& upright) {
  const int w = upright.width, h = upright.height;
  Image8 stored(orientation < 5 ? w : h, orientation < 5 ? h : w, 3);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int r = w - 1 - x, b = h - 1 - y;  // from the right, from the bottom
      const glm::ivec2 at[] = {{}, {x, y}, {r, y}, {r, b}, {x, b}, {y, x}, {y, r}, {b, r}, {b, x}};
      const glm::ivec2 to = at[orientation];
      std::ranges::copy(upright.pixel(x, y), stored.pixel(to.x, to.y).begin());
    }
  return stored;
}

/// Writes a JPEG of best quality with this EXIF orientation; the camera's maker is "Ab".
inline void writeTurned(const std::filesystem::path& file, const Image8& stored, int orientation) {
  std::filesystem::create_directories(file.parent_path());
  writeImage(file, stored, 100);
  std::string bytes = readTextFile(file);
  const char exif[] = {'\xff',
                       '\xe1',
                       0,
                       46,
                       'E',
                       'x',
                       'i',
                       'f',
                       0,
                       0,
                       'I',
                       'I',
                       42,
                       0,
                       8,
                       0,
                       0,
                       0,
                       2,
                       0,
                       15,
                       1,
                       2,
                       0,
                       3,
                       0,
                       0,
                       0,
                       'A',
                       'b',
                       0,
                       0,
                       18,
                       1,
                       3,
                       0,
                       1,
                       0,
                       0,
                       0,
                       char(orientation),
                       0,
                       0,
                       0,
                       0,
                       0,
                       0,
                       0};
  bytes.insert(2, std::string(exif, sizeof exif));
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace ibr::test
