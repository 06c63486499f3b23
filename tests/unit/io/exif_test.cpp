// SPDX-License-Identifier: Apache-2.0
#include "io/exif.h"

#include <span>

#include "unusual_files.h"

using namespace ibr;

namespace {
int orientationOf(const test::Bytes& block) {
  return io::exifOrientation(std::as_bytes(std::span(block)));
}
}  // namespace

TEST_CASE("the orientation is found in both byte orders") {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    CHECK(orientationOf(test::exifBlock(orientation, false)) == orientation);
    CHECK(orientationOf(test::exifBlock(orientation, true)) == orientation);
  }
}

TEST_CASE("values that mean nothing mean as stored") {
  for (const int value : {0, 9, 255}) CHECK(orientationOf(test::exifBlock(value, false)) == 1);
  CHECK(orientationOf({}) == 1);
  CHECK(orientationOf({'I', 'M', 42, 0, 8, 0, 0, 0}) == 1);
  CHECK(orientationOf({'I', 'I', 43, 0, 8, 0, 0, 0}) == 1);
}

TEST_CASE("a damaged block is never read beyond its end") {
  for (const bool bigEndian : {false, true}) {
    const test::Bytes whole = test::exifBlock(6, bigEndian);
    // A copy of its own on the heap, so that a sanitizer sees a read past the end.
    for (std::size_t size = 0; size < whole.size() - 6; ++size)
      CHECK(orientationOf(test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size))) == 1);
    for (std::size_t at = 0; at < whole.size(); ++at) {
      test::Bytes damaged = whole;
      damaged[at] = 0xff;
      const int orientation = orientationOf(damaged);
      CHECK((orientation >= 1 && orientation <= 8));
    }
  }
}
