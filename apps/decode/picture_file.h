// SPDX-License-Identifier: Apache-2.0
// The formats that ibr-decode reads. Each reader makes two steps, so that a picture's size is known, and limits are set
// by it, before the picture is decoded.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "ibr/image.h"
#include "io/image_file.h"

namespace ibr::app {

/// A file whose header has been read. It refers to the bytes it was made from.
class PictureFile {
 public:
  PictureFile() = default;
  PictureFile(const PictureFile&) = delete;
  PictureFile& operator=(const PictureFile&) = delete;
  virtual ~PictureFile() = default;

  virtual ImageFileInfo info() const = 0;
  /// RGB, sRGB, of the size in info(). Called once. Throws Error (invalidInput, unsupported).
  virtual Image8 decode() = 0;
};

/// Throw Error (invalidInput, unsupported).
std::unique_ptr<PictureFile> openHeif(std::span<const std::byte> file);  // HEIC and AVIF
std::unique_ptr<PictureFile> openWebp(std::span<const std::byte> file);
std::unique_ptr<PictureFile> openRaw(std::span<const std::byte> file);

}  // namespace ibr::app
