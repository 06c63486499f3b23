// SPDX-License-Identifier: Apache-2.0
// PNG through libpng. As in jpeg.cpp, errors leave by longjmp: no object with a destructor in `guarded` functions.
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "base/check.h"
#include "io/codec.h"
#include "io/colour.h"
#include "io/exif.h"

namespace ibr::io {
namespace {

constexpr int kCompression = 3;  // 1 to 9; the default 6 takes over three times as long for files 5 % smaller

struct Errors {
  std::jmp_buf jump;
  char text[256] = {};
};

[[noreturn]] void leave(png_structp png, png_const_charp text) {
  auto& errors = *static_cast<Errors*>(png_get_error_ptr(png));
  std::strncpy(errors.text, text, sizeof errors.text - 1);
  std::longjmp(errors.jump, 1);
}

// Warnings concern metadata only; libpng reports damaged pixels as errors.
void ignore(png_structp, png_const_charp) {}

class Codec {
 public:
  enum class Mode { read, write };

  Codec(Mode mode, const std::string& name) : mode_(mode), name_(name) {
    const auto create = mode == Mode::read ? png_create_read_struct : png_create_write_struct;
    png = create(PNG_LIBPNG_VER_STRING, &errors_, leave, ignore);
    if (png) info = png_create_info_struct(png);
    if (info) return;
    destroy();
    fail(ErrorCode::outOfMemory, "{}: out of memory in libpng", name);
  }
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;
  ~Codec() { destroy(); }

  template <class F>
  void guarded(F&& f) {
    if (setjmp(errors_.jump)) fail(ErrorCode::invalidInput, "{}: {}", name_, errors_.text);
    f();
  }

  png_structp png = nullptr;
  png_infop info = nullptr;

 private:
  void destroy() {
    if (mode_ == Mode::read) png_destroy_read_struct(&png, &info, nullptr);
    if (mode_ == Mode::write) png_destroy_write_struct(&png, &info);
  }

  Mode mode_;
  const std::string& name_;
  Errors errors_;
};

class Decoder : public Codec {
 public:
  Decoder(Bytes file, const std::string& name) : Codec(Mode::read, name), rest_(file) {
    guarded([&] {
      png_set_read_fn(png, &rest_, take);
      png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // checkSize enforces the actual limits
      png_set_chunk_malloc_max(png, 8 << 20);
      png_set_chunk_cache_max(png, 128);
      png_read_info(png, info);
    });
  }

  ImageFileInfo probe() {
    const int type = png_get_color_type(png, info);
    const bool palette = type == PNG_COLOR_TYPE_PALETTE;
    const Exif exif = this->exif();
    return {int(png_get_image_width(png, info)),
            int(png_get_image_height(png, info)),
            palette ? 3 : png_get_channels(png, info),
            palette ? 8 : png_get_bit_depth(png, info),
            exif.orientation,
            exif.capture,
            ImageFormat::png};
  }

  Bytes colourProfile() {
    png_charp profileName = nullptr;
    png_bytep data = nullptr;
    png_uint_32 size = 0;
    int method = 0;
    if (png_get_iCCP(png, info, &profileName, &method, &data, &size) == 0) return {};
    return std::as_bytes(std::span(data, size));
  }

 private:
  static void take(png_structp png, png_bytep out, std::size_t size) {
    auto& rest = *static_cast<Bytes*>(png_get_io_ptr(png));
    if (rest.size() < size) png_error(png, "the file is truncated");
    std::memcpy(out, rest.data(), size);
    rest = rest.subspan(size);
  }

  Exif exif() {
    png_uint_32 size = 0;
    png_bytep data = nullptr;
    if (png_get_eXIf_1(png, info, &size, &data) == 0) return {};
    return readExif(std::as_bytes(std::span(data, size)));
  }

  Bytes rest_;
};

std::string utf8FromLatin1(const std::string& text) {
  std::string utf8;
  for (const unsigned char c : text) {
    if (c < 0x80) {
      utf8 += char(c);
    } else {
      utf8 += char(0xc0 | c >> 6);
      utf8 += char(0x80 | (c & 0x3f));
    }
  }
  return utf8;
}

void checkFits(Decoder& decoder, const ImageFileInfo& info, Bytes file, const std::string& name,
               const ReadLimits& limits) {
  checkSize(info, limits, name);
  // Deflate compresses at most 1032 times: a small file cannot hold a large image.
  const auto bits =
      std::uint64_t(info.width) * std::uint64_t(info.height) * png_get_bit_depth(decoder.png, decoder.info);
  check(bits / 8 / 1032 <= file.size(), ErrorCode::invalidInput, "{}: {} bytes cannot hold {}×{} pixels", name,
        file.size(), info.width, info.height);
}

}  // namespace

ImageFileInfo probePng(Bytes file, const std::string& name) {
  return Decoder(file, name).probe();
}

Image8 readPng(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info) {
  Decoder decoder(file, name);
  info = decoder.probe();
  checkFits(decoder, info, file, name, limits);

  Image8 image(info.width, info.height, 3);
  decoder.guarded([&] {
    png_structp png = decoder.png;
    png_set_palette_to_rgb(png);
    png_set_expand_gray_1_2_4_to_8(png);
    png_set_scale_16(png);  // rounds, while png_set_strip_16 truncates
    png_set_strip_alpha(png);
    png_set_gray_to_rgb(png);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, decoder.info);
    const std::size_t stride = std::size_t(image.width) * 3;
    if (png_get_rowbytes(png, decoder.info) != stride) png_error(png, "the pixel format is not supported");
    for (int pass = 0; pass < passes; ++pass)
      for (int y = 0; y < image.height; ++y) png_read_row(png, image.values.data() + std::size_t(y) * stride, nullptr);
    png_read_end(png, decoder.info);
  });
  // Metadata may also follow the pixels.
  const ImageFileInfo whole = decoder.probe();
  info.orientation = whole.orientation;
  info.capture = whole.capture;
  if (const auto profile = decoder.colourProfile(); !profile.empty()) toSrgb(image, profile);
  return image;
}

Image<std::uint16_t> readPngGrey16(Bytes file, const std::string& name, const ReadLimits& limits) {
  Decoder decoder(file, name);
  const ImageFileInfo info = decoder.probe();
  check(info.channels == 1 && info.bitsPerChannel == 16, ErrorCode::invalidInput,
        "{}: has {} channels of {} bits, not 1 channel of 16 bits", name, info.channels, info.bitsPerChannel);
  checkFits(decoder, info, file, name, limits);
  Image<std::uint16_t> image(info.width, info.height, 1);
  decoder.guarded([&] {
    if constexpr (std::endian::native == std::endian::little) png_set_swap(decoder.png);
    const int passes = png_set_interlace_handling(decoder.png);
    png_read_update_info(decoder.png, decoder.info);
    for (int pass = 0; pass < passes; ++pass)
      for (int y = 0; y < image.height; ++y)
        png_read_row(decoder.png,
                     reinterpret_cast<png_bytep>(image.values.data() + std::size_t(y) * std::size_t(image.width)),
                     nullptr);
    png_read_end(decoder.png, decoder.info);
  });
  return image;
}

std::vector<ImageText> pngTexts(Bytes file, const std::string& name) {
  Decoder decoder(file, name);
  png_textp found = nullptr;
  const int count = png_get_text(decoder.png, decoder.info, &found, nullptr);
  std::vector<ImageText> texts;
  for (int i = 0; i < count; ++i) {
    const png_text& text = found[i];
    const bool utf8 = text.compression == PNG_ITXT_COMPRESSION_NONE || text.compression == PNG_ITXT_COMPRESSION_zTXt;
    const std::string stored(text.text ? text.text : "");
    texts.push_back({text.key, utf8 ? stored : utf8FromLatin1(stored)});
  }
  return texts;
}

std::vector<std::byte> encodePng(const Image8& image, const std::vector<ImageText>& texts, const std::string& name) {
  std::vector<png_text> chunks;  // libpng copies them
  for (const auto& [key, text] : texts) {
    png_text& chunk = chunks.emplace_back();
    const bool ascii = std::ranges::all_of(text, [](unsigned char c) { return c < 0x80; });
    chunk.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    chunk.key = const_cast<char*>(key.c_str());
    chunk.text = const_cast<char*>(text.c_str());
    (ascii ? chunk.text_length : chunk.itxt_length) = text.size();
  }
  Codec encoder(Codec::Mode::write, name);
  std::vector<std::byte> file;
  encoder.guarded([&] {
    png_structp png = encoder.png;
    const auto append = [](png_structp p, png_bytep data, std::size_t size) {
      auto& out = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(p));
      out.insert(out.end(), reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + size);
    };
    png_set_write_fn(png, &file, append, nullptr);
    const int type = image.channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : image.channels == 3 ? PNG_COLOR_TYPE_RGB
                                           : PNG_COLOR_TYPE_RGB_ALPHA;
    png_set_compression_level(png, kCompression);
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
    png_set_IHDR(png, encoder.info, png_uint_32(image.width), png_uint_32(image.height), 8, type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!chunks.empty()) png_set_text(png, encoder.info, chunks.data(), int(chunks.size()));
    png_write_info(png, encoder.info);
    const std::size_t stride = std::size_t(image.width) * std::size_t(image.channels);
    for (int y = 0; y < image.height; ++y) png_write_row(png, image.values.data() + std::size_t(y) * stride);
    png_write_end(png, nullptr);
  });
  return file;
}

}  // namespace ibr::io
