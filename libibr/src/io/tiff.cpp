// SPDX-License-Identifier: Apache-2.0
// TIFF through libtiff's RGBA interface, which handles strips, tiles, palettes, YCbCr and 16 bits. First page only.
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/check.h"
#include "io/codec.h"
#include "io/colour.h"
#include "io/exif.h"

namespace ibr::io {
namespace {

// The file in memory as a stream for libtiff, and the first reported error.
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
// Maps the file in memory. libtiff 4.5 reads tiles in no other way.
int map(thandle_t handle, void** begin, toff_t* length) {
  const Bytes file = static_cast<Stream*>(handle)->file;
  *begin = const_cast<std::byte*>(file.data());  // libtiff does not write to a file opened for reading
  *length = file.size();
  return 1;
}
void unmap(thandle_t, void*, toff_t) {}

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
    // Handlers for this file only: libtiff's default ones are global.
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    check(options, ErrorCode::outOfMemory, "{}: out of memory in libtiff", name);
    TIFFOpenOptionsSetErrorHandlerExtR(options, remember, &stream_);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore, nullptr);
    tiff = TIFFClientOpenExt(name.c_str(), "r", &stream_, take, refuse, seek, close, size, map, unmap, options);
    TIFFOpenOptionsFree(options);
    if (!tiff) throwError(ErrorCode::invalidInput);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { TIFFClose(tiff); }

  [[noreturn]] void throwError(ErrorCode code) const {
    fail(code, "{}: {}", name_, *stream_.text ? stream_.text : "the file is damaged");
  }

  ImageFileInfo info() const {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    const int most = 0x7fffffff;
    const int orientation = field(TIFFTAG_ORIENTATION);
    return {int(std::min(width, std::uint32_t(most))),
            int(std::min(height, std::uint32_t(most))),
            field(TIFFTAG_SAMPLESPERPIXEL),
            field(TIFFTAG_BITSPERSAMPLE),
            orientation >= 1 && orientation <= 8 ? orientation : 1,
            readExif(stream_.file).capture,
            ImageFormat::tiff};
  }

  int field(std::uint32_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff, tag, &value);
    return value;
  }

  Bytes colourProfile() const {
    std::uint32_t count = 0;
    void* data = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &count, &data) != 1) return {};
    return {static_cast<const std::byte*>(data), count};
  }

  TIFF* tiff = nullptr;

 private:
  const std::string& name_;
  Stream stream_;
};

// True for 16-bit grey, of which libtiff's interface keeps the upper 8 bits without rounding; colours are rounded.
bool isGrey16(const Decoder& decoder, const ImageFileInfo& info) {
  const int photometric = decoder.field(TIFFTAG_PHOTOMETRIC);
  return info.channels == 1 && info.bitsPerChannel == 16 && !TIFFIsTiled(decoder.tiff) &&
         (photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE);
}

Image8 readGrey16(const Decoder& decoder, const ImageFileInfo& info) {
  const bool inverted = decoder.field(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_MINISWHITE;
  Image8 image(info.width, info.height, 3);
  std::vector<std::uint16_t> row(std::size_t(TIFFScanlineSize(decoder.tiff)) / 2);
  for (int y = 0; y < info.height; ++y) {
    if (TIFFReadScanline(decoder.tiff, row.data(), std::uint32_t(y), 0) != 1)
      decoder.throwError(ErrorCode::invalidInput);
    for (int x = 0; x < info.width; ++x) {
      const unsigned rounded = (row[std::size_t(x)] * 255u + 32767u) / 65535u;
      std::ranges::fill(image.pixel(x, y), std::uint8_t(inverted ? 255u - rounded : rounded));
    }
  }
  return image;
}

// Reads through libtiff's interface, in the stored orientation.
Image8 readColours(const Decoder& decoder, const ImageFileInfo& info, const std::string& name) {
  TIFFRGBAImage reader;
  char text[1024] = {};
  constexpr int kStopOnError = 1;
  if (!TIFFRGBAImageOK(decoder.tiff, text) || !TIFFRGBAImageBegin(&reader, decoder.tiff, kStopOnError, text))
    fail(ErrorCode::unsupported, "{}: {}; save it as RGB of 8 or 16 bits", name, text);
  reader.req_orientation = reader.orientation;  // as stored
  const auto pixels = std::size_t(info.width) * std::size_t(info.height);
  const auto raster = std::make_unique_for_overwrite<std::uint32_t[]>(pixels);
  const int done = TIFFRGBAImageGet(&reader, raster.get(), std::uint32_t(info.width), std::uint32_t(info.height));
  TIFFRGBAImageEnd(&reader);
  if (!done) decoder.throwError(ErrorCode::invalidInput);

  Image8 image(info.width, info.height, 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t pixel = raster[i];
    // libtiff multiplies colours by alpha; the file's colours are unchanged only for opaque pixels.
    check(TIFFGetA(pixel) == 255, ErrorCode::unsupported, "{}: has transparent pixels; save it without alpha", name);
    image.values[3 * i] = std::uint8_t(TIFFGetR(pixel));
    image.values[3 * i + 1] = std::uint8_t(TIFFGetG(pixel));
    image.values[3 * i + 2] = std::uint8_t(TIFFGetB(pixel));
  }
  return image;
}

// Throws Error{unsupported} for CMYK and for raw files.
void checkKind(const Decoder& decoder, const ImageFileInfo& info, const std::string& name) {
  const int photometric = decoder.field(TIFFTAG_PHOTOMETRIC);
  check(photometric != PHOTOMETRIC_SEPARATED, ErrorCode::unsupported, "{}: {} inks{}", name, info.channels, kCmykHint);
  // Raw files of cameras start with a preview image.
  std::uint32_t subfile = 0;
  TIFFGetField(decoder.tiff, TIFFTAG_SUBFILETYPE, &subfile);
  check(!(subfile & FILETYPE_REDUCEDIMAGE) && photometric != PHOTOMETRIC_CFA, ErrorCode::unsupported,
        "{}: holds a preview image or raw sensor data; develop the raw file to JPEG or 16-bit TIFF", name);
}

}  // namespace

ImageFileInfo probeTiff(Bytes file, const std::string& name) {
  const Decoder decoder(file, name);
  const ImageFileInfo info = decoder.info();
  checkKind(decoder, info, name);
  return info;
}

Image8 readTiff(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info) {
  Decoder decoder(file, name);
  info = decoder.info();
  checkSize(info, limits, name);
  checkKind(decoder, info, name);
  Image8 image = isGrey16(decoder, info) ? readGrey16(decoder, info) : readColours(decoder, info, name);
  if (const auto profile = decoder.colourProfile(); !profile.empty())
    toSrgb(image, profile);
  else if (readExif(file).adobeRgb)
    adobeRgbToSrgb(image);
  return image;
}

}  // namespace ibr::io
