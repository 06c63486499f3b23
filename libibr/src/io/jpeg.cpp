// SPDX-License-Identifier: Apache-2.0
// JPEG through libjpeg-turbo.
//
// libjpeg reports errors by a call that must not return. Here the call ends in longjmp, so functions handed to
// `guarded` must not contain objects with destructors.
#include <cstdio>  // jpeglib.h needs it
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "io/codec.h"
#include "io/colour.h"
#include "io/exif.h"

namespace ibr::io {
namespace {

constexpr int kMaxScans = 100;  // a progressive file has about ten; each costs a pass over the whole image

struct Errors : jpeg_error_mgr {
  std::jmp_buf jump;
  ErrorCode code = ErrorCode::invalidInput;
  char text[JMSG_LENGTH_MAX] = {};
};

[[noreturn]] void leave(j_common_ptr state) {
  auto& errors = static_cast<Errors&>(*state->err);
  errors.format_message(state, errors.text);
  switch (errors.msg_code) {
    case JERR_ARITH_NOTIMPL:
    case JERR_BAD_PRECISION:
    case JERR_CONVERSION_NOTIMPL:
    case JERR_NOT_COMPILED:
    case JERR_SOF_UNSUPPORTED:
      errors.code = ErrorCode::unsupported;
      break;
    case JERR_OUT_OF_MEMORY:
      errors.code = ErrorCode::outOfMemory;
      break;
    default:
      break;
  }
  std::longjmp(errors.jump, 1);
}

// A warning means that libjpeg continues with a guess. A guess about pixels is an error here; other warnings (stray
// bytes between segments, odd Adobe markers) come from working cameras.
void onMessage(j_common_ptr state, int level) {
  if (level >= 0) return;
  switch (state->err->msg_code) {
    case JWRN_JPEG_EOF:
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_ARITH_BAD_CODE:
    case JWRN_MUST_RESYNC:
    case JWRN_BOGUS_PROGRESSION:
      leave(state);
    default:
      break;
  }
}

void countScans(j_common_ptr state) {
  if (reinterpret_cast<j_decompress_ptr>(state)->input_scan_number <= kMaxScans) return;
  auto& errors = static_cast<Errors&>(*state->err);
  constexpr char kText[] = "has too many progressive scans";
  std::memcpy(errors.text, kText, sizeof kText);
  std::longjmp(errors.jump, 1);
}

template <class State>
class Codec {
 public:
  explicit Codec(const std::string& name) : name_(name) {
    state.err = jpeg_std_error(&errors_);
    errors_.error_exit = leave;
    errors_.emit_message = onMessage;
  }
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;
  ~Codec() { jpeg_destroy(reinterpret_cast<j_common_ptr>(&state)); }

  template <class F>
  void guarded(F&& f) {
    if (setjmp(errors_.jump)) fail(errors_.code, "{}: {}", name_, errors_.text);
    f();
  }

  State state{};

 private:
  const std::string& name_;
  Errors errors_{};
};

constexpr char kExif[6] = {'E', 'x', 'i', 'f', 0, 0};

class Decoder : public Codec<jpeg_decompress_struct> {
 public:
  Decoder(Bytes file, const std::string& name) : Codec(name) {
    guarded([&] {
      jpeg_create_decompress(&state);
      jpeg_mem_src(&state, reinterpret_cast<const unsigned char*>(file.data()), file.size());
      jpeg_save_markers(&state, JPEG_APP0 + 1, 0xffff);
      jpeg_save_markers(&state, JPEG_APP0 + 2, 0xffff);
      jpeg_read_header(&state, TRUE);
    });
    progress_.progress_monitor = countScans;
    state.progress = &progress_;
  }

  ImageFileInfo info() const {
    const Exif exif = this->exif();
    return {int(state.image_width), int(state.image_height), state.num_components,
            state.data_precision,   exif.orientation,        exif.capture,
            ImageFormat::jpeg};
  }

  /// Call before the pixels are decoded, which frees the markers.
  std::vector<std::byte> colourProfile() {
    JOCTET* data = nullptr;
    unsigned int size = 0;
    guarded([&] { jpeg_read_icc_profile(&state, &data, &size); });
    if (!data) return {};
    const auto bytes = std::as_bytes(std::span(data, size));
    std::vector<std::byte> profile(bytes.begin(), bytes.end());
    std::free(data);
    return profile;
  }

  /// EXIF segment with its name before the TIFF header; empty if there is none.
  Bytes exifSegment() const {
    for (auto marker = state.marker_list; marker; marker = marker->next)
      if (marker->data_length > sizeof kExif && std::memcmp(marker->data, kExif, sizeof kExif) == 0)
        return std::as_bytes(std::span(marker->data, marker->data_length));
    return {};
  }

  Exif exif() const {
    const Bytes segment = exifSegment();
    return segment.empty() ? Exif{} : readExif(segment.subspan(sizeof kExif));
  }

  /// Throws Error{unsupported} unless the colour space is grey, RGB or YCbCr.
  void checkColours(const std::string& name) const {
    const auto space = state.jpeg_color_space;
    check(space == JCS_GRAYSCALE || space == JCS_RGB || space == JCS_YCbCr, ErrorCode::unsupported,
          "{}: {} colour components that are neither grey nor RGB{}", name, state.num_components,
          space == JCS_CMYK || space == JCS_YCCK ? kCmykHint : "");
  }

 private:
  jpeg_progress_mgr progress_{};
};

}  // namespace

ImageFileInfo probeJpeg(Bytes file, const std::string& name) {
  const Decoder decoder(file, name);
  decoder.checkColours(name);
  return decoder.info();
}

Image8 readJpeg(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info) {
  Decoder decoder(file, name);
  auto& state = decoder.state;
  info = decoder.info();
  checkSize(info, limits, name);
  decoder.checkColours(name);
  // Huffman coding needs at least one bit per block of the first component: a small file cannot hold a large
  // image.
  const auto blocks = std::uint64_t(info.width / 8) * std::uint64_t(info.height / 8);
  check(state.arith_code || blocks / 8 <= file.size(), ErrorCode::invalidInput, "{}: {} bytes cannot hold {}×{} pixels",
        name, file.size(), info.width, info.height);

  const std::vector<std::byte> profile = decoder.colourProfile();
  const bool adobeRgb = decoder.exif().adobeRgb;
  Image8 image(info.width, info.height, 3);
  decoder.guarded([&] {
    state.out_color_space = JCS_RGB;
    jpeg_start_decompress(&state);
    const std::size_t stride = std::size_t(image.width) * 3;
    while (state.output_scanline < state.output_height) {
      JSAMPROW row = image.values.data() + state.output_scanline * stride;
      jpeg_read_scanlines(&state, &row, 1);
    }
    jpeg_finish_decompress(&state);
  });
  if (!profile.empty())
    toSrgb(image, profile);
  else if (adobeRgb)
    adobeRgbToSrgb(image);
  return image;
}

std::vector<std::byte> encodeJpeg(const Image8& image, int quality, const std::string& name) {
  Codec<jpeg_compress_struct> encoder(name);
  auto& state = encoder.state;
  struct Output {
    unsigned char* data = nullptr;
    unsigned long size = 0;
    ~Output() { std::free(data); }
  } output;
  encoder.guarded([&] {
    jpeg_create_compress(&state);
    jpeg_mem_dest(&state, &output.data, &output.size);
    state.image_width = JDIMENSION(image.width);
    state.image_height = JDIMENSION(image.height);
    state.input_components = image.channels;
    state.in_color_space = image.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, quality, TRUE);
    state.optimize_coding = TRUE;
    // No chroma subsampling: these images are measured per channel and sampled as textures.
    state.comp_info[0].h_samp_factor = state.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&state, TRUE);
    const std::size_t stride = std::size_t(image.width) * std::size_t(image.channels);
    while (state.next_scanline < state.image_height) {
      auto row = const_cast<JSAMPROW>(image.values.data() + state.next_scanline * stride);
      jpeg_write_scanlines(&state, &row, 1);
    }
    jpeg_finish_compress(&state);
  });
  const auto bytes = std::as_bytes(std::span(output.data, output.size));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> withExif(std::vector<std::byte> jpeg, std::span<const std::byte> block) {
  const std::size_t length = sizeof(kExif) + block.size() + 2;  // includes its own two bytes
  if (length > 0xffff) return jpeg;
  std::vector<std::byte> segment{std::byte(0xff), std::byte(0xe1), std::byte(length >> 8), std::byte(length & 0xff)};
  for (const auto c : kExif) segment.push_back(std::byte(c));
  segment.insert(segment.end(), block.begin(), block.end());
  resetOrientation(std::span(segment).subspan(segment.size() - block.size()));
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

std::vector<std::byte> exifOf(Bytes jpeg, const std::string& name) {
  const Decoder decoder(jpeg, name);
  const Bytes segment = decoder.exifSegment();
  if (segment.size() < sizeof(kExif)) return {};
  return {segment.begin() + sizeof(kExif), segment.end()};
}

}  // namespace ibr::io
