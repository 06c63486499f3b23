// SPDX-License-Identifier: Apache-2.0
// Photographs in formats that libibr does not write, encoded by other programs.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

namespace ibr::test {

/// Runs a program; fails the test with its output if the program fails.
void runEncoder(const std::vector<std::string>& arguments);

/// Smooth colours, which codecs keep: every 8 bits of each channel appear.
Image8 smoothPicture(int width, int height);

/// Flat patches of 16×16 px, one beside the other.
Image8 patches(const std::vector<std::array<int, 3>>& colours);
/// Colour in the middle of a patch.
std::array<int, 3> patch(const Image8& picture, int number);

/// Peak signal-to-noise ratio, dB.
double psnr(const Image8& a, const Image8& b);

/// ICC profile of Display P3.
Bytes displayP3();

/// EXIF block of a camera: maker "Maker", model "M1", 1/250 s, f/2.8, ISO 400, 50 mm (75 mm equivalent).
Bytes cameraExif(int orientation);

/// Encodes a PNG without loss as AVIF with code points of ITU-T H.273.
void encodeAvif(const std::filesystem::path& avif, const std::filesystem::path& png, int primaries, int transfer,
                int bits = 8);

/// The HEIC file with code points in place of its ICC profile, which it must have (heif-enc writes no code points).
Bytes withCodePoints(Bytes heic, int primaries, int transfer);

/// DNG of a camera with a Bayer sensor, black 256 and white 16383, whose colours are those of sRGB times `neutral`.
struct DngOptions {
  std::array<double, 3> neutral{0.5, 1, 0.6};  // sensor values of white
  double exposure = 1;                         // factor of all sensor values
  int orientation = 1;
};
/// `light`: linear sRGB, one row of flat patches 16 px wide and 64 px high.
void writeDng(const std::filesystem::path& file, const std::vector<std::array<double, 3>>& light,
              const DngOptions& options = {});
/// `picture`: sRGB.
void writeDng(const std::filesystem::path& file, const Image8& picture, const DngOptions& options = {});

}  // namespace ibr::test
