// SPDX-License-Identifier: Apache-2.0
// WebP, by libwebp.
#include <webp/decode.h>
#include <webp/demux.h>

#include <memory>

#include "base/check.h"
#include "decode/picture_file.h"
#include "io/colour.h"
#include "io/exif.h"

namespace ibr::app {
namespace {

struct Free {
  void operator()(WebPDemuxer* demuxer) const { WebPDemuxDelete(demuxer); }
};

class WebpFile : public PictureFile {
 public:
  explicit WebpFile(std::span<const std::byte> file) : file_(file) {
    const WebPData data{bytes(), file_.size()};
    demuxer_.reset(WebPDemux(&data));
    check(demuxer_ != nullptr, ErrorCode::invalidInput, "the WebP file is damaged or incomplete");
    check(!(WebPDemuxGetI(demuxer_.get(), WEBP_FF_FORMAT_FLAGS) & ANIMATION_FLAG), ErrorCode::unsupported,
          "animated WebP files are not supported");
  }

  ImageFileInfo info() const override {
    ImageFileInfo info;
    info.width = int(WebPDemuxGetI(demuxer_.get(), WEBP_FF_CANVAS_WIDTH));
    info.height = int(WebPDemuxGetI(demuxer_.get(), WEBP_FF_CANVAS_HEIGHT));
    info.channels = 3;
    info.bitsPerChannel = 8;
    const io::Exif exif = io::readExif(chunk("EXIF"));
    info.orientation = exif.orientation;
    info.capture = exif.capture;
    return info;
  }

  Image8 decode() override {
    const ImageFileInfo size = info();
    Image8 picture(size.width, size.height, 3);
    check(WebPDecodeRGBInto(bytes(), file_.size(), picture.values.data(), picture.values.size(), size.width * 3),
          ErrorCode::invalidInput, "the WebP file is damaged or incomplete");
    io::toSrgb(picture, chunk("ICCP"));
    return picture;
  }

 private:
  const std::uint8_t* bytes() const { return reinterpret_cast<const std::uint8_t*>(file_.data()); }

  std::span<const std::byte> chunk(const char* name) const {
    WebPChunkIterator found{};
    if (!WebPDemuxGetChunk(demuxer_.get(), name, 1, &found)) return {};
    const std::span payload(reinterpret_cast<const std::byte*>(found.chunk.bytes), found.chunk.size);
    WebPDemuxReleaseChunkIterator(&found);
    // Some programs write EXIF as in JPEG files, with this mark before the TIFF header.
    constexpr std::string_view kMark("Exif\0\0", 6);
    const bool marked = payload.size() >= kMark.size() &&
                        std::string_view(reinterpret_cast<const char*>(payload.data()), kMark.size()) == kMark;
    return marked ? payload.subspan(kMark.size()) : payload;  // part of the file
  }

  std::span<const std::byte> file_;
  std::unique_ptr<WebPDemuxer, Free> demuxer_;
};

}  // namespace

std::unique_ptr<PictureFile> openWebp(std::span<const std::byte> file) {
  return std::make_unique<WebpFile>(file);
}

}  // namespace ibr::app
