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

/// Writes a JPEG of best quality with this EXIF orientation and maker of the camera. Precondition: the maker has at
/// most three letters, which EXIF stores inside the entry.
inline void writeTurned(const std::filesystem::path& file, const Image8& stored, int orientation,
                        const std::string& maker = "Ab") {
  std::filesystem::create_directories(file.parent_path());
  writeImage(file, stored, 100);
  std::string bytes = readTextFile(file);
  std::string inside = maker;
  inside.resize(4);
  using namespace std::string_literals;
  const std::string exif = "\xff\xe1\0\x2e"s + "Exif\0\0"s + "II\x2a\0\x08\0\0\0"s + "\x02\0"s +  // two entries
                           "\x0f\x01\x02\0"s + char(maker.size() + 1) + "\0\0\0"s + inside +      // Make
                           "\x12\x01\x03\0\x01\0\0\0"s + char(orientation) + "\0\0\0\0\0\0\0"s;   // Orientation
  bytes.insert(2, exif);
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace ibr::test
