// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "base/file.h"
#include "ibr/error.h"
#include "io/exr.h"
#include "support/temporary_folder.h"

using namespace ibr;
using Catch::Contains;

namespace {

ImageF ramp(int width, int height, float step) {
  ImageF image(width, height, 1);
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = step * float(i);
  return image;
}

}  // namespace

TEST_CASE("float channels read back bit for bit, in the order of their names") {
  test::TemporaryFolder folder;
  std::vector<ExrChannel> channels{
      {"Z", ramp(37, 21, 0.1f)}, {"R", ramp(37, 21, -3.7e-5f)}, {"confidence.spread", ramp(37, 21, 1e30f)}};
  channels[0].values.pixel(3, 4)[0] = std::numeric_limits<float>::infinity();
  channels[0].values.pixel(4, 4)[0] = std::numeric_limits<float>::denorm_min();
  writeExr(folder / "a.exr", channels);
  const std::vector<ExrChannel> read = readExr(folder / "a.exr");
  REQUIRE(read.size() == 3);
  CHECK(read[0].name == "R");
  CHECK(read[1].name == "Z");
  CHECK(read[2].name == "confidence.spread");
  CHECK(read[1].values == channels[0].values);
  CHECK(read[0].values == channels[1].values);
  CHECK(read[2].values == channels[2].values);
  writeExr(folder / "b.exr", channels);
  CHECK(readFile(folder / "a.exr") == readFile(folder / "b.exr"));
}

TEST_CASE("the error for a damaged OpenEXR file names the file") {
  test::TemporaryFolder folder;
  writeExr(folder / "whole.exr", std::vector<ExrChannel>{{"Z", ramp(64, 64, 0.3f)}});
  const std::vector<std::byte> whole = readFile(folder / "whole.exr");
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 40) {
    writeFile(folder / "cut.exr", std::span(whole).first(length));
    CHECK_THROWS_WITH(readExr(folder / "cut.exr"), Contains("cut.exr"));
  }
  CHECK_THROWS_AS(readExr(folder / "none.exr"), Error);
  writeFile(folder / "text.exr", "not a picture at all");
  CHECK_THROWS_WITH(readExr(folder / "text.exr"), Contains("text.exr"));
  CHECK_THROWS_AS(writeExr(folder / "no/such/folder.exr", std::vector<ExrChannel>{{"Z", ramp(2, 2, 1)}}), Error);
}
