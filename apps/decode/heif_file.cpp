// SPDX-License-Identifier: Apache-2.0
// HEIC and AVIF, by libheif. It applies the file's rotation, mirroring and cropping, which are not EXIF's.
#include <libheif/heif.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/check.h"
#include "decode/picture_file.h"
#include "io/colour.h"
#include "io/colour_code.h"
#include "io/exif.h"

namespace ibr::app {
namespace {

struct Free {
  void operator()(heif_context* context) const { heif_context_free(context); }
  void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_decoding_options* options) const { heif_decoding_options_free(options); }
  void operator()(heif_color_profile_nclx* profile) const { heif_nclx_color_profile_free(profile); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

void checkHeif(const heif_error& error) {
  const bool unsupported =
      error.code == heif_error_Unsupported_feature || error.code == heif_error_Unsupported_filetype;
  check(error.code == heif_error_Ok, unsupported ? ErrorCode::unsupported : ErrorCode::invalidInput, "libheif: {}",
        error.message);
}

class HeifFile : public PictureFile {
 public:
  explicit HeifFile(std::span<const std::byte> file) : context_(heif_context_alloc()) {
    check(context_ != nullptr, ErrorCode::outOfMemory, "out of memory in libheif");
    heif_context_set_max_decoding_threads(context_.get(), 1);  // photographs are decoded beside each other
    checkHeif(heif_context_read_from_memory_without_copy(context_.get(), file.data(), file.size(), nullptr));
    heif_image_handle* primary = nullptr;
    checkHeif(heif_context_get_primary_image_handle(context_.get(), &primary));
    handle_.reset(primary);
  }

  ImageFileInfo info() const override {
    ImageFileInfo info;
    info.width = heif_image_handle_get_width(handle_.get());
    info.height = heif_image_handle_get_height(handle_.get());
    info.channels = 3;
    info.bitsPerChannel = std::max(8, heif_image_handle_get_luma_bits_per_pixel(handle_.get()));
    info.capture = io::readExif(exif()).capture;
    return info;
  }

  Image8 decode() override {
    const bool wide = info().bitsPerChannel > 8;
    const Owned<heif_decoding_options> options(heif_decoding_options_alloc());
    heif_image* decoded = nullptr;
    checkHeif(heif_decode_image(handle_.get(), &decoded, heif_colorspace_RGB,
                                wide ? heif_chroma_interleaved_RRGGBB_LE : heif_chroma_interleaved_RGB, options.get()));
    const Owned<heif_image> image(decoded);
    return wide ? toSrgb8(rows<std::uint16_t>(*image), *image) : toSrgb8(rows<std::uint8_t>(*image), *image);
  }

 private:
  // The EXIF block, from its TIFF header on; empty if there is none.
  std::vector<std::byte> exif() const {
    heif_item_id id = 0;
    if (heif_image_handle_get_list_of_metadata_block_IDs(handle_.get(), "Exif", &id, 1) < 1) return {};
    std::vector<std::byte> block(heif_image_handle_get_metadata_size(handle_.get(), id));
    if (block.size() < 4 || heif_image_handle_get_metadata(handle_.get(), id, block.data()).code != heif_error_Ok)
      return {};
    std::size_t offset = 0;  // of the TIFF header after these four bytes
    for (int i = 0; i < 4; ++i) offset = offset << 8 | std::to_integer<std::size_t>(block[std::size_t(i)]);
    if (offset > block.size() - 4) return {};
    return {block.begin() + 4 + std::ptrdiff_t(offset), block.end()};
  }

  // Values of the whole range of T.
  template <class T>
  Image<T> rows(const heif_image& image) const {
    int stride = 0;
    const std::uint8_t* const plane = heif_image_get_plane_readonly(&image, heif_channel_interleaved, &stride);
    const int width = heif_image_get_width(&image, heif_channel_interleaved);
    const int height = heif_image_get_height(&image, heif_channel_interleaved);
    check(plane && width == heif_image_handle_get_width(handle_.get()) &&
              height == heif_image_handle_get_height(handle_.get()),
          ErrorCode::invalidInput, "libheif: the picture's size is not as announced");
    Image<T> picture(width, height, 3);
    const int bits = heif_image_get_bits_per_pixel_range(&image, heif_channel_interleaved);
    const std::uint32_t most = (1u << std::clamp(bits, 1, 16)) - 1;
    const std::size_t count = std::size_t(width) * 3;
    for (int y = 0; y < height; ++y) {
      const std::uint8_t* const from = plane + std::ptrdiff_t(y) * stride;
      T* const to = picture.values.data() + std::size_t(y) * count;
      if constexpr (sizeof(T) == 1)
        std::copy_n(from, count, to);
      else
        for (std::size_t i = 0; i < count; ++i)
          to[i] = T(std::min<std::uint32_t>(from[2 * i] | std::uint32_t(from[2 * i + 1]) << 8, most) * 65535 / most);
    }
    return picture;
  }

  std::vector<std::byte> profile() const {
    const heif_color_profile_type type = heif_image_handle_get_color_profile_type(handle_.get());
    if (type != heif_color_profile_type_rICC && type != heif_color_profile_type_prof) return {};
    std::vector<std::byte> bytes(heif_image_handle_get_raw_color_profile_size(handle_.get()));
    checkHeif(heif_image_handle_get_raw_color_profile(handle_.get(), bytes.data()));
    return bytes;
  }

  // Of the file, else of the coded picture in it.
  io::ColourCode code(const heif_image& image) const {
    heif_color_profile_nclx* found = nullptr;
    if (heif_image_handle_get_nclx_color_profile(handle_.get(), &found).code != heif_error_Ok &&
        heif_image_get_nclx_color_profile(&image, &found).code != heif_error_Ok)
      return {};
    const Owned<heif_color_profile_nclx> nclx(found);
    return {int(nclx->color_primaries), int(nclx->transfer_characteristics)};
  }

  Image8 toSrgb8(Image8 picture, const heif_image& image) const {
    if (const std::vector<std::byte> icc = profile(); !icc.empty()) {
      io::toSrgb(picture, icc);
      return picture;
    }
    if (io::isSrgb(code(image))) return picture;
    Image<std::uint16_t> wide(picture.width, picture.height, 3);
    std::ranges::transform(picture.values, wide.values.begin(), [](std::uint8_t v) { return std::uint16_t(v * 257); });
    return io::toSrgb(wide, code(image));
  }
  Image8 toSrgb8(const Image<std::uint16_t>& picture, const heif_image& image) const {
    const std::vector<std::byte> icc = profile();
    if (icc.empty() && !io::isSrgb(code(image))) return io::toSrgb(picture, code(image));
    Image8 narrow(picture.width, picture.height, 3);
    std::ranges::transform(picture.values, narrow.values.begin(),
                           [](std::uint16_t v) { return std::uint8_t((v + 128) / 257); });
    io::toSrgb(narrow, icc);
    return narrow;
  }

  Owned<heif_context> context_;
  Owned<heif_image_handle> handle_;
};

}  // namespace

std::unique_ptr<PictureFile> openHeif(std::span<const std::byte> file) {
  return std::make_unique<HeifFile>(file);
}

}  // namespace ibr::app
