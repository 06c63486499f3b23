// SPDX-License-Identifier: Apache-2.0
// Fuzz target for metadata of an image: an EXIF block, an ICC profile. Neither makes a photograph unreadable.
#include <lcms2.h>

#include <algorithm>

#include "fuzz_target.h"
#include "ibr/image.h"
#include "io/colour.h"
#include "io/exif.h"

using namespace ibr;
using namespace ibr::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Chosen input = chosen(data, size, 2);
  std::vector<std::byte> bytes(input.bytes.size());
  std::ranges::transform(input.bytes, bytes.begin(), [](char c) { return std::byte(c); });
  if (input.file == 0) {
    const io::Exif exif = io::readExif(bytes);
    demand(exif.orientation >= 1 && exif.orientation <= 8);
    relativeExposure(exif.capture);
    io::resetOrientation(bytes);
    demand(io::readExif(bytes).orientation == 1);
    return 0;
  }
  return answers([&] {
    Image8 picture(2, 2, 3, 90);
    io::toSrgb(picture, bytes);
  });
}

std::vector<std::string> ibr::test::seeds() {
  // An orientation as cameras write it: one entry, little-endian. Also a profile with a camera's gamut.
  std::string exif("\0II*\0\10\0\0\0\1\0\22\1\3\0\1\0\0\0\6\0\0\0\0\0\0\0", 27);
  const cmsCIExyY white{0.3127, 0.3290, 1};
  const cmsCIExyYTRIPLE primaries{{0.68, 0.32, 1}, {0.265, 0.69, 1}, {0.15, 0.06, 1}};
  cmsToneCurve* const curve = cmsBuildGamma(nullptr, 2.2);
  cmsToneCurve* const curves[] = {curve, curve, curve};
  const cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves);
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  std::string icc(size + 1, char(1));
  cmsSaveProfileToMem(profile, icc.data() + 1, &size);
  cmsCloseProfile(profile);
  cmsFreeToneCurve(curve);
  return {exif, icc};
}
