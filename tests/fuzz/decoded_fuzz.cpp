// SPDX-License-Identifier: Apache-2.0
// Fuzz target for what the program ibr-decode writes: its header, and the recognition of the formats it reads.
#include <cstring>

#include "fuzz_target.h"
#include "io/decoded.h"

using namespace ibr;
using namespace ibr::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  io::programFormat(bytes);
  return answers([&] {
    const ImageFileInfo info = io::infoOf(bytes, ImageFormat::raw, "a");
    demand(info.width > 0 && info.width <= 65536 && info.height > 0 && info.height <= 65536);
    demand(info.orientation >= 1 && info.orientation <= 8 && info.channels == 3);
    const CaptureMetadata& c = info.capture;
    for (const double v : {c.exposureTime, c.fNumber, c.iso, c.focalLength, c.focalLength35})
      demand(v >= 0 && v - v == 0);
    for (const std::string* text : {&c.maker, &c.model, &c.lens})
      for (const char character : *text) demand(character >= ' ' && character <= '~');
  });
}

std::vector<std::string> ibr::test::seeds() {
  ImageFileInfo info;
  info.width = 40;
  info.height = 30;
  info.bitsPerChannel = 10;
  info.capture = {0.01, 2.8, 100, 35, 52, "Maker", "Model", "Lens"};
  const io::DecodedHeader header = io::headerOf(info);
  std::string message(sizeof(header), 0);
  std::memcpy(message.data(), &header, sizeof(header));
  // A DNG's and a NEF's first directory.
  const std::string dng("II*\0\x08\0\0\0\x01\0\x12\xc6\x01\0\x04\0\0\0\x01\x04\0\0", 22);
  const std::string nef("MM\0*\0\0\0\x08\0\x01\0\xfe\0\x04\0\0\0\x01\0\0\0\x01", 22);
  return {message, dng, nef};
}
