// SPDX-License-Identifier: Apache-2.0
// Raw files of cameras, by LibRaw: linear values of 16 bits with the camera's white balance and without automatic
// brightness, so that photographs of different exposure differ by a factor; then sRGB.
#include <libraw/libraw.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "base/check.h"
#include "decode/picture_file.h"
#include "io/colour_code.h"

namespace ibr::app {
namespace {

void checkRaw(int error) {
  const bool unsupported = error == LIBRAW_FILE_UNSUPPORTED || error == LIBRAW_NOT_IMPLEMENTED ||
                           error == LIBRAW_REQUEST_FOR_NONEXISTENT_IMAGE;
  check(error == LIBRAW_SUCCESS, unsupported ? ErrorCode::unsupported : ErrorCode::invalidInput, "LibRaw: {}",
        libraw_strerror(error));
}

double positive(double value) {
  return std::isfinite(value) && value > 0 ? value : 0;
}

std::string textOf(const char* from) {
  std::string text(from);
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

// Bytes that LibRaw asks for behind the end of the file. LibRaw takes them for zeros or noise, without an error.
class RawBytes : public LibRaw_buffer_datastream {
 public:
  explicit RawBytes(std::span<const std::byte> file)
      : LibRaw_buffer_datastream(const_cast<std::byte*>(file.data()), file.size()) {}

  // Decoders read in blocks of 16 KiB, the last of which may be shorter.
  bool lacksData() const { return missing_ > kBlock; }
  // Reading the header may look anywhere.
  void forgetMissing() { missing_ = 0; }

  int read(void* to, size_t size, size_t count) override {
    const INT64 left = this->size() - tell();
    if (INT64(size * count) > left) missing_ += INT64(size * count) - left;
    return LibRaw_buffer_datastream::read(to, size, count);
  }
  int seek(INT64 offset, int whence) override {
    const INT64 start = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? tell() : size();
    if (start + offset > size()) missing_ += start + offset - size();
    return LibRaw_buffer_datastream::seek(offset, whence);
  }
  int get_char() override {
    const int value = LibRaw_buffer_datastream::get_char();
    missing_ += value < 0;
    return value;
  }

 private:
  static constexpr INT64 kBlock = 0x4000;
  INT64 missing_ = 0;
};

class RawFile : public PictureFile {
 public:
  explicit RawFile(std::span<const std::byte> file) : bytes_(file) {
    libraw_output_params_t& p = raw_.imgdata.params;
    p.output_bps = 16;
    p.gamm[0] = p.gamm[1] = 1;  // linear
    p.output_color = 1;         // sRGB primaries
    p.use_camera_wb = 1;
    p.no_auto_bright = 1;
    p.adjust_maximum_thr = 0;  // white is the sensor's, not the picture's
    p.user_flip = 0;           // as stored: info() has the orientation
    raw_.set_dataerror_handler([](void* damaged, const char*, int) { *static_cast<bool*>(damaged) = true; }, &damaged_);
    checkRaw(raw_.open_datastream(&bytes_));
    flip_ = raw_.imgdata.sizes.flip;
    LibRaw sizes;  // after this call, an object cannot decode
    sizes.imgdata.params.user_flip = 0;
    checkRaw(sizes.open_buffer(const_cast<std::byte*>(file.data()), file.size()));
    checkRaw(sizes.adjust_sizes_info_only());
    width_ = sizes.imgdata.sizes.iwidth;
    height_ = sizes.imgdata.sizes.iheight;
  }

  ImageFileInfo info() const override {
    ImageFileInfo info;
    info.width = width_;
    info.height = height_;
    info.channels = 3;
    info.bitsPerChannel = 16;
    switch (flip_) {  // 1 mirrored, 2 upside down, 4 transposed
      case 3:
        info.orientation = 3;
        break;
      case 5:
        info.orientation = 8;
        break;
      case 6:
        info.orientation = 6;
        break;
      default:
        break;
    }
    const libraw_imgother_t& shot = raw_.imgdata.other;
    const libraw_lensinfo_t& lens = raw_.imgdata.lens;
    info.capture = {positive(shot.shutter),
                    positive(shot.aperture),
                    positive(shot.iso_speed),
                    positive(shot.focal_len),
                    positive(lens.FocalLengthIn35mmFormat),
                    textOf(raw_.imgdata.idata.make),
                    textOf(raw_.imgdata.idata.model),
                    textOf(lens.Lens)};
    return info;
  }

  Image8 decode() override {
    bytes_.forgetMissing();
    checkRaw(raw_.unpack());
    damaged_ |= bytes_.lacksData();
    checkRaw(raw_.dcraw_process());
    check(!damaged_, ErrorCode::invalidInput, "the raw file is damaged or incomplete");
    int error = LIBRAW_SUCCESS;
    const std::unique_ptr<libraw_processed_image_t, void (*)(libraw_processed_image_t*)> made(
        raw_.dcraw_make_mem_image(&error), LibRaw::dcraw_clear_mem);
    checkRaw(error);
    const ImageFileInfo size = info();
    const bool fits = made && made->type == LIBRAW_IMAGE_BITMAP && made->bits == 16 &&
                      (made->colors == 3 || made->colors == 1) && made->width == size.width &&
                      made->height == size.height;
    check(fits, ErrorCode::unsupported, "LibRaw: the picture is not RGB of 16 bits and of the announced size");
    Image<std::uint16_t> linear(size.width, size.height, 3);
    const std::size_t pixels = std::size_t(size.width) * std::size_t(size.height);
    const auto value = [&](std::size_t i) {
      std::uint16_t v;
      std::memcpy(&v, made->data + 2 * i, 2);
      return v;
    };
    for (std::size_t i = 0; i < pixels; ++i)
      for (std::size_t c = 0; c < 3; ++c) linear.values[3 * i + c] = value(made->colors == 3 ? 3 * i + c : i);
    constexpr int kLinear = 8;
    return io::toSrgb(linear, {1, kLinear});
  }

 private:
  RawBytes bytes_;  // must outlive raw_
  LibRaw raw_;
  int width_ = 0, height_ = 0, flip_ = 0;
  bool damaged_ = false;
};

}  // namespace

std::unique_ptr<PictureFile> openRaw(std::span<const std::byte> file) {
  return std::make_unique<RawFile>(file);
}

}  // namespace ibr::app
