// SPDX-License-Identifier: Apache-2.0
// TIFF through libtiff: its RGBA interface, which knows strips, tiles, palettes, YCbCr and 16 bits. First page only.
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/check.h"
#include "io/codec.h"
#include "io/exif.h"

namespace ibr::io {
namespace {

// The file in memory as libtiff's stream, and the first error it told.
struct Stream {
  Bytes file;
  std::uint64_t at = 0;
  char text[256] = {};
};

tmsize_t take(thandle_t handle, void* out, tmsize_t size) {
  auto& stream = *static_cast<Stream*>(handle);
  if (stream.at > stream.file.size()) return 0;
  const auto n = std::min(std::size_t(size), std::size_t(stream.file.size() - stream.at));
  std::memcpy(out, stream.file.data() + stream.at, n);
  stream.at += n;
  return tmsize_t(n);
}
tmsize_t refuse(thandle_t, void*, tmsize_t) {
  return 0;
}
toff_t seek(thandle_t handle, toff_t offset, int whence) {
  auto& stream = *static_cast<Stream*>(handle);
  const std::uint64_t base = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? stream.at : stream.file.size();
  return stream.at = base + offset;
}
int close(thandle_t) {
  return 0;
}
toff_t size(thandle_t handle) {
  return static_cast<Stream*>(handle)->file.size();
}
int remember(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  auto& stream = *static_cast<Stream*>(user);
  if (!*stream.text) std::vsnprintf(stream.text, sizeof stream.text, format, arguments);
  return 1;  // handled: nothing goes to stderr
}
int ignore(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

class Decoder {
 public:
  Decoder(Bytes file, const std::string& name) : name_(name), stream_{file} {
    // Handlers of this one file: libtiff's usual ones are global.
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    check(options, ErrorCode::outOfMemory, "{}: no memory for libtiff", name);
    TIFFOpenOptionsSetErrorHandlerExtR(options, remember, &stream_);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore, nullptr);
    tiff = TIFFClientOpenExt(name.c_str(), "rm", &stream_, take, refuse, seek, close, size, nullptr, nullptr, options);
    TIFFOpenOptionsFree(options);
    if (!tiff) give(ErrorCode::invalidInput);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { TIFFClose(tiff); }

  [[noreturn]] void give(ErrorCode code) const {
    fail(code, "{}: {}", name_, *stream_.text ? stream_.text : "is damaged");
  }

  ImageFileInfo info() const {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    const int most = 0x7fffffff;
    const int orientation = field(TIFFTAG_ORIENTATION);
    return {int(std::min(width, std::uint32_t(most))), int(std::min(height, std::uint32_t(most))),
            field(TIFFTAG_SAMPLESPERPIXEL), field(TIFFTAG_BITSPERSAMPLE),
            orientation >= 1 && orientation <= 8 ? orientation : 1, readExif(stream_.file).capture};
  }

  int field(std::uint32_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff, tag, &value);
    return value;
  }

  TIFF* tiff = nullptr;

 private:
  const std::string& name_;
  Stream stream_;
};

}  // namespace

ImageFileInfo probeTiff(Bytes file, const std::string& name) {
  return Decoder(file, name).info();
}

Image8 readTiff(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info) {
  Decoder decoder(file, name);
  info = decoder.info();
  checkSize(info, limits, name);
  check(decoder.field(TIFFTAG_PHOTOMETRIC) != PHOTOMETRIC_SEPARATED, ErrorCode::unsupported,
        "{}: CMYK pictures are not read", name);

  TIFFRGBAImage reader;
  char text[1024] = {};
  constexpr int kStopOnError = 1;
  if (!TIFFRGBAImageOK(decoder.tiff, text) || !TIFFRGBAImageBegin(&reader, decoder.tiff, kStopOnError, text))
    fail(ErrorCode::unsupported, "{}: {}", name, text);
  reader.req_orientation = reader.orientation;  // as stored
  const auto pixels = std::size_t(info.width) * std::size_t(info.height);
  const auto raster = std::make_unique_for_overwrite<std::uint32_t[]>(pixels);
  const int done = TIFFRGBAImageGet(&reader, raster.get(), std::uint32_t(info.width), std::uint32_t(info.height));
  TIFFRGBAImageEnd(&reader);
  if (!done) decoder.give(ErrorCode::invalidInput);

  Image8 image(info.width, info.height, 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t pixel = raster[i];
    // libtiff multiplies colours by their alpha; only where that changed nothing are they the file's.
    check(TIFFGetA(pixel) == 255, ErrorCode::unsupported, "{}: has transparent pixels", name);
    image.values[3 * i] = std::uint8_t(TIFFGetR(pixel));
    image.values[3 * i + 1] = std::uint8_t(TIFFGetG(pixel));
    image.values[3 * i + 2] = std::uint8_t(TIFFGetB(pixel));
  }
  return image;
}

}  // namespace ibr::io
