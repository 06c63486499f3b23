// SPDX-License-Identifier: Apache-2.0
#include "unusual_files.h"

#include <cstdio>
// clang-format off
#include <jpeglib.h>
#include <png.h>
#include <tiffio.h>
#include <zlib.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <span>

namespace ibr::test {

Image8 noisyPicture(int width, int height, int channels) {
  std::mt19937 random(7);
  Image8 image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        image.pixel(x, y)[std::size_t(c)] = std::uint8_t((3 * x + 2 * y + 60 * c) % 180 + int(random() % 60));
  return image;
}

Bytes makeJpeg(const Image8& image, JpegKind kind) {
  jpeg_compress_struct state{};
  jpeg_error_mgr errors{};
  state.err = jpeg_std_error(&errors);
  jpeg_create_compress(&state);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&state, &data, &size);
  state.image_width = JDIMENSION(image.width);
  state.image_height = JDIMENSION(image.height);
  state.input_components = image.channels;
  state.in_color_space = image.channels == 4 ? JCS_CMYK : image.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&state);
  if (kind == JpegKind::rgb) jpeg_set_colorspace(&state, JCS_RGB);
  if (kind == JpegKind::ycck) jpeg_set_colorspace(&state, JCS_YCCK);
  state.arith_code = kind == JpegKind::arithmetic;
  jpeg_set_quality(&state, 95, TRUE);
  if (kind == JpegKind::progressive) jpeg_simple_progression(&state);
  std::vector<jpeg_scan_info> scans;
  if (kind == JpegKind::manyScans) {
    scans.push_back({state.num_components, {0, 1, 2}, 0, 0, 0, 0});
    for (int coefficient = 1; coefficient < 64; ++coefficient)
      for (int bit = 3; bit >= 0; --bit)
        scans.push_back({1, {0}, coefficient, coefficient, bit == 3 ? 0 : bit + 1, bit});
    state.scan_info = scans.data();
    state.num_scans = int(scans.size());
  }
  jpeg_start_compress(&state, TRUE);
  const std::size_t stride = std::size_t(image.width) * std::size_t(image.channels);
  while (state.next_scanline < state.image_height) {
    auto row = const_cast<JSAMPROW>(image.values.data() + state.next_scanline * stride);
    jpeg_write_scanlines(&state, &row, 1);
  }
  jpeg_finish_compress(&state);
  Bytes bytes(data, data + size);
  jpeg_destroy_compress(&state);
  std::free(data);
  return bytes;
}

Bytes makePng(int width, int height, int type, int bits, const std::vector<Bytes>& rows, bool interlaced,
              const std::vector<std::uint8_t>& palette) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  Bytes bytes;
  const auto append = [](png_structp p, png_bytep data, std::size_t size) {
    auto& out = *static_cast<Bytes*>(png_get_io_ptr(p));
    out.insert(out.end(), data, data + size);
  };
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), bits, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty())
    png_set_PLTE(png, info, reinterpret_cast<png_const_colorp>(palette.data()), int(palette.size() / 3));
  png_write_info(png, info);
  std::vector<png_bytep> pointers;
  for (const Bytes& row : rows) pointers.push_back(const_cast<png_bytep>(row.data()));
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

void makeTiff(const std::filesystem::path& path, const Image<std::uint16_t>& image, int bits, int photometric,
              bool alpha, int orientation, const TiffLayout& layout) {
  TIFF* tiff = TIFFOpen(path.c_str(), layout.mode);
  REQUIRE(tiff);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, image.channels);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, layout.planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation);
  if (layout.preview) TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE);
  if (!layout.profile.empty())
    TIFFSetField(tiff, TIFFTAG_ICCPROFILE, std::uint32_t(layout.profile.size()), layout.profile.data());
  const std::uint16_t kind = EXTRASAMPLE_UNASSALPHA;
  if (alpha) TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &kind);
  // Appends `channel`, or all for −1, in native byte order; libtiff swaps the bytes if the file has another order.
  const auto put = [&](Bytes& bytes, int x, int y, int channel) {
    for (int c = 0; c < image.channels; ++c) {
      if (channel >= 0 && c != channel) continue;
      const bool inside = x < image.width && y < image.height;
      const std::uint16_t value = inside ? image.pixel(x, y)[std::size_t(c)] : 0;
      const auto two = std::bit_cast<std::array<std::uint8_t, 2>>(value);
      if (bits == 16)
        bytes.insert(bytes.end(), two.begin(), two.end());
      else
        bytes.push_back(std::uint8_t(value));
    }
  };
  const int side = layout.tile;
  if (side > 0) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, side);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, side);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, image.height);
  }
  for (int channel = layout.planar ? 0 : -1; channel < (layout.planar ? image.channels : 0); ++channel) {
    const auto sample = std::uint16_t(std::max(channel, 0));
    for (int y = 0; side == 0 && y < image.height; ++y) {
      Bytes row;
      for (int x = 0; x < image.width; ++x) put(row, x, y, channel);
      REQUIRE(TIFFWriteScanline(tiff, row.data(), std::uint32_t(y), sample) == 1);
    }
    for (int top = 0; side > 0 && top < image.height; top += side)
      for (int left = 0; left < image.width; left += side) {
        Bytes tile;
        for (int y = top; y < top + side; ++y)
          for (int x = left; x < left + side; ++x) put(tile, x, y, channel);
        REQUIRE(TIFFWriteTile(tiff, tile.data(), std::uint32_t(left), std::uint32_t(top), 0, sample) > 0);
      }
  }
  TIFFClose(tiff);
}

Bytes exifBlock(int orientation, bool bigEndian) {
  const std::uint8_t value = std::uint8_t(orientation);
  // An entry precedes the orientation, so that the search must skip an entry.
  if (bigEndian)
    return {'M', 'M', 0, 42, 0,    0, 0, 8, 0, 2, 0x01, 0x0f, 0,     2, 0, 0, 0, 1, 'A',
            0,   0,   0, 1,  0x12, 0, 3, 0, 0, 0, 1,    0,    value, 0, 0, 0, 0, 0, 0};
  return {'I', 'I', 42, 0,    8, 0, 0, 0, 2, 0, 0x0f, 0x01,  2, 0, 1, 0, 0, 0, 'A',
          0,   0,   0,  0x12, 1, 3, 0, 1, 0, 0, 0,    value, 0, 0, 0, 0, 0, 0, 0};
}

Bytes exifBlock(const std::vector<ExifEntry>& first, const std::vector<ExifEntry>& exif, bool bigEndian,
                const std::string& interoperability) {
  Bytes out{std::uint8_t(bigEndian ? 'M' : 'I'), std::uint8_t(bigEndian ? 'M' : 'I')};
  const auto putAt = [&](std::size_t at, std::uint32_t value, std::size_t size) {
    if (out.size() < at + size) out.resize(at + size);
    for (std::size_t i = 0; i < size; ++i)
      out[at + (bigEndian ? size - 1 - i : i)] = std::uint8_t(value >> (8 * i) & 255);
  };
  const auto directory = [&](std::size_t at, std::vector<ExifEntry> entries) {
    putAt(at, std::uint32_t(entries.size()), 2);
    putAt(at + 2 + 12 * entries.size(), 0, 4);  // no further directory
    for (std::size_t e = 0; e < entries.size(); ++e) {
      const ExifEntry& entry = entries[e];
      const std::size_t here = at + 2 + 12 * e, size = entry.type == 2 ? 1 : entry.type == 3 ? 2 : 4;
      std::vector<std::uint32_t> values = entry.values;
      if (entry.type == 2) {
        values.assign(entry.text.begin(), entry.text.end());
        values.push_back(0);
      }
      putAt(here, std::uint32_t(entry.tag), 2);
      putAt(here + 2, std::uint32_t(entry.type), 2);
      putAt(here + 4, std::uint32_t(values.size() / (entry.type == 5 ? 2 : 1)), 4);
      std::size_t data = here + 8;
      if (size * values.size() > 4) {
        data = out.size();
        putAt(here + 8, std::uint32_t(data), 4);
      }
      for (std::size_t v = 0; v < values.size(); ++v) putAt(data + size * v, values[v], size);
    }
  };
  putAt(2, 42, 2);
  putAt(4, 8, 4);
  std::vector<ExifEntry> entries = first;
  entries.push_back({0x8769, 4, {0}});
  directory(8, entries);
  const std::size_t at = out.size();
  putAt(8 + 2 + 12 * first.size() + 8, std::uint32_t(at), 4);
  if (interoperability.empty()) {
    directory(at, exif);
    return out;
  }
  std::vector<ExifEntry> more = exif;
  more.push_back({0xa005, 4, {0}});
  directory(at, more);
  const std::size_t last = out.size();
  putAt(at + 2 + 12 * exif.size() + 8, std::uint32_t(last), 4);
  directory(last, {{1, 2, {}, interoperability}});
  return out;
}

Bytes withExif(const Bytes& jpeg, int orientation) {
  return withExifBlock(jpeg, exifBlock(orientation, orientation % 2 == 0));
}

Bytes withExifBlock(const Bytes& jpeg, const Bytes& block) {
  const std::size_t length = 2 + 6 + block.size();
  Bytes segment{0xff, 0xe1, std::uint8_t(length >> 8), std::uint8_t(length & 255), 'E', 'x', 'i', 'f', 0, 0};
  segment.insert(segment.end(), block.begin(), block.end());
  Bytes out = jpeg;
  out.insert(out.begin() + 2, segment.begin(), segment.end());
  return out;
}

Bytes withJpegProfile(const Bytes& jpeg, const Bytes& profile) {
  Bytes segment{0xff, 0xe2, 0, 0, 'I', 'C', 'C', '_', 'P', 'R', 'O', 'F', 'I', 'L', 'E', 0, 1, 1};
  segment.insert(segment.end(), profile.begin(), profile.end());
  const std::size_t length = segment.size() - 2;
  REQUIRE(length < 65536);
  segment[2] = std::uint8_t(length >> 8);
  segment[3] = std::uint8_t(length & 255);
  Bytes out = jpeg;
  out.insert(out.begin() + 2, segment.begin(), segment.end());
  return out;
}

Bytes withJpegSize(Bytes jpeg, int width, int height) {
  for (std::size_t at = 2; at + 9 < jpeg.size(); at += 2 + std::size_t(jpeg[at + 2] << 8 | jpeg[at + 3]))
    if (jpeg[at + 1] == 0xc0 || jpeg[at + 1] == 0xc2) {
      jpeg[at + 5] = std::uint8_t(height >> 8);
      jpeg[at + 6] = std::uint8_t(height & 255);
      jpeg[at + 7] = std::uint8_t(width >> 8);
      jpeg[at + 8] = std::uint8_t(width & 255);
      return jpeg;
    }
  FAIL("no frame header");
  return {};
}

constexpr std::size_t kHeader = 12, kHeaderSize = 17;  // offset and size of type and data of a PNG's IHDR

void putBig(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = std::uint8_t(value >> (24 - 8 * i) & 255);
}

// Checksum of a chunk's type and data, PNG 1.2 §15.
std::uint32_t chunkCheck(std::span<const std::uint8_t> chunk) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : chunk) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return ~crc;
}

Bytes withPngSize(Bytes png, int width, int height) {
  putBig(png, 16, std::uint32_t(width));
  putBig(png, 20, std::uint32_t(height));
  putBig(png, kHeader + kHeaderSize, chunkCheck(std::span(png).subspan(kHeader, kHeaderSize)));
  return png;
}

namespace {

// Inserts a chunk after the header.
Bytes withPngChunk(const Bytes& png, const char* name, const Bytes& data) {
  Bytes chunk(8);
  putBig(chunk, 0, std::uint32_t(data.size()));
  std::copy_n(name, 4, chunk.begin() + 4);
  chunk.insert(chunk.end(), data.begin(), data.end());
  const std::uint32_t check = chunkCheck(std::span(chunk).subspan(4));
  chunk.resize(chunk.size() + 4);
  putBig(chunk, chunk.size() - 4, check);
  Bytes out = png;
  out.insert(out.begin() + kHeader + kHeaderSize + 4, chunk.begin(), chunk.end());
  return out;
}

}  // namespace

Bytes withPngExif(const Bytes& png, const Bytes& block) {
  return withPngChunk(png, "eXIf", block);
}

Bytes withPngProfile(const Bytes& png, const Bytes& profile) {
  Bytes chunk{'a', 0, 0};  // profile name, terminator, compression method deflate
  uLongf size = compressBound(uLong(profile.size()));
  Bytes packed(size);
  REQUIRE(compress(packed.data(), &size, profile.data(), uLong(profile.size())) == Z_OK);
  chunk.insert(chunk.end(), packed.begin(), packed.begin() + std::ptrdiff_t(size));
  return withPngChunk(png, "iCCP", chunk);
}

void writeBytes(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

Bytes readBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace ibr::test
