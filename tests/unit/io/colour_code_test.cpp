// SPDX-License-Identifier: Apache-2.0
#include "io/colour_code.h"

#include <cmath>

#include "base/srgb.h"
#include "unusual_files.h"

using namespace ibr;

namespace {

// One pixel of values of 0 to 1.
std::array<int, 3> converted(std::array<double, 3> rgb, io::ColourCode code) {
  Image<std::uint16_t> picture(1, 1, 3);
  for (std::size_t c = 0; c < 3; ++c) picture.values[c] = std::uint16_t(std::lround(65535 * rgb[c]));
  const Image8 result = io::toSrgb(picture, code);
  return {result.values[0], result.values[1], result.values[2]};
}

int srgb(double light) {
  return int(std::lround(255 * linearToSrgb(std::min(std::max(light, 0.0), 1.0))));
}

}  // namespace

TEST_CASE("sRGB's code points leave values as they are") {
  CHECK(io::isSrgb({1, 13}));
  CHECK(io::isSrgb({2, 2}));
  CHECK_FALSE(io::isSrgb({12, 13}));
  CHECK_FALSE(io::isSrgb({1, 16}));
  for (int v = 0; v <= 255; ++v)
    for (const int transfer : {1, 13}) CHECK(converted({v / 255.0, 0.5, 0.0}, {1, transfer})[0] == v);
}

TEST_CASE("white of all primaries is white, black is black") {
  for (const int primaries : {1, 5, 6, 7, 9, 12})
    for (const int transfer : {1, 4, 5, 8, 13}) {
      CHECK(converted({1, 1, 1}, {primaries, transfer}) == std::array{255, 255, 255});
      CHECK(converted({0, 0, 0}, {primaries, transfer}) == std::array{0, 0, 0});
    }
}

TEST_CASE("transfer characteristics follow their definitions") {
  CHECK(converted({0.5, 0.5, 0.5}, {1, 8})[0] == srgb(0.5));
  CHECK(converted({0.5, 0.5, 0.5}, {1, 4})[0] == srgb(std::pow(0.5, 2.2)));
  // PQ: 0.5 is 92.246 cd/m² (SMPTE ST 2084), of diffuse white 203.
  CHECK(converted({0.5, 0.5, 0.5}, {1, 16})[0] == srgb(92.246 / 203));
  // HLG: diffuse white is the value 0.75, and 1 the peak (Report ITU-R BT.2408, table 1).
  CHECK(std::abs(converted({0.75, 0.75, 0.75}, {1, 18})[0] - converted({0.58, 0.58, 0.58}, {1, 16})[0]) <= 2);
  CHECK(converted({1, 1, 1}, {1, 18})[0] == 255);
}

TEST_CASE("HDR light rises to white without a step") {
  int before = 0, flat = 0;
  for (int v = 0; v <= 1000; ++v) {
    const int now = converted({v / 1000.0, v / 1000.0, v / 1000.0}, {9, 16})[1];
    CHECK(now >= before);
    CHECK(now - before <= 2);
    before = now;
    flat += now == 255;
  }
  CHECK(flat < 300);  // above 1000 cd/m²
}

TEST_CASE("unknown code points are named") {
  for (const io::ColourCode code : {io::ColourCode{10, 13}, {1, 11}, {1, 300}}) {
    const Error error = test::errorOf([&] { converted({0, 0, 0}, code); });
    CHECK(error.code() == ErrorCode::unsupported);
    CHECK_THAT(error.what(), Catch::Contains(std::to_string(code.primaries == 1 ? code.transfer : code.primaries)));
  }
}
