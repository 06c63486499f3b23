// SPDX-License-Identifier: Apache-2.0
#include "author/photographs/photographs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "author/photographs/masks.h"
#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "ibr/author/photographs.h"
#include "ibr/texture.h"
#include "io/image_file.h"
#include "io/metadata.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kReadingVersion = 2;  // of the image readers: raise it when their pixels change
constexpr double kBytesPerPixel = 20;         // image (3), mips (4 + 4/3) and the encoded texture (as much)

// Additional memory while a file is read, also of the program ibr-decode.
double rasterBytesPerPixel(ImageFormat format) {
  if (format == ImageFormat::jpeg || format == ImageFormat::png) return 0;
  return format == ImageFormat::tiff ? 4 : 24;
}

// Formats that have lost detail already are stored as JPEG.
bool isLossy(ImageFormat format) {
  return format == ImageFormat::heic || format == ImageFormat::avif || format == ImageFormat::webp;
}

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return extension;
}
bool isPng(const fs::path& path) {
  return lowerExtension(path) == ".png";
}

struct Size {
  int width, height;
};
// Equal proportions, up to rounding to whole pixels.
bool sameShape(int width, int height, Size camera) {
  return std::abs(double(width) * camera.height - double(height) * camera.width) <=
         double(std::max(camera.width, camera.height));
}

// The hash is unchanged without a mask.
std::uint64_t withHashOf(const Image8& mask, std::uint64_t before) {
  if (mask.empty()) return before;
  Hash hash;
  hash.add(before);
  hash.add(std::as_bytes(std::span(mask.values)));
  return hash.value();
}

void storeTexture(const fs::path& file, const Image8& picture, TextureFormat format) {
  makeFolders(file.parent_path());
  writeKtx2(file, encodeTexture(buildMips(picture), format));
}

Intrinsics scaled(const Intrinsics& k, double scale) {
  return resized(k, std::max(1, int(std::lround(k.width * scale))), std::max(1, int(std::lround(k.height * scale))));
}

std::uint64_t hashOf(const Photograph& photo, const std::vector<std::byte>& source, const Image8& picture) {
  Hash hash;
  hash.add(kReadingVersion);
  hash.add(source);
  if (photo.lens) hash.add(std::as_bytes(std::span(picture.values)));  // depends on the lens, too
  return hash.value();
}

}  // namespace

bool isJpeg(const fs::path& path) {
  return lowerExtension(path) == ".jpg" || lowerExtension(path) == ".jpeg";
}

Photograph findPhotograph(const fs::path& folder, const PosedImage& image, int maxSize, Orientation orientation) {
  Photograph photo;
  photo.name = image.name;
  photo.source = pathBelow(folder, image.name);
  check(fs::exists(photo.source), ErrorCode::io, "{}: the model's photograph is missing", photo.source.string());
  const ImageFileInfo info = probeImage(photo.source);
  const Intrinsics& k = image.camera.intrinsics;
  const Size camera = image.lens ? Size{image.lens->width(), image.lens->height()} : Size{k.width, k.height};
  photo.capture = info.capture;
  int width = info.width, height = info.height;
  photo.sourcePixels = double(width) * height;
  std::error_code ignored;
  photo.sourceBytes =
      double(fs::file_size(photo.source, ignored)) + rasterBytesPerPixel(info.format) * photo.sourcePixels;
  const bool swaps = info.orientation >= 5, storedFits = sameShape(width, height, camera);
  const bool turnedFits = swaps ? sameShape(height, width, camera) : storedFits;
  photo.orientationAmbiguous = info.orientation != 1 && storedFits && turnedFits;
  photo.applyOrientation = orientation == Orientation::automatic
                               ? !storedFits && turnedFits
                               : orientation == Orientation::exif && info.orientation != 1;
  if (photo.applyOrientation && swaps) std::swap(width, height);
  check(sameShape(width, height, camera), ErrorCode::invalidInput,
        "{}: {}x{} px, but the model's camera has {}x{} px, another aspect ratio", photo.source.string(), width, height,
        camera.width, camera.height);
  photo.lens = image.lens;
  photo.whole = image.lens ? scaled(k, double(width) / camera.width) : resized(k, width, height);
  const int longest = std::max(photo.whole.width, photo.whole.height);
  const bool smaller = maxSize > 0 && longest > maxSize;
  photo.camera = {smaller ? scaled(photo.whole, double(maxSize) / longest) : photo.whole, image.camera.pose};
  const bool calledPng = isPng(photo.source);
  const bool asCalled =
      info.format == ImageFormat::png ? calledPng : info.format == ImageFormat::jpeg && isJpeg(photo.source);
  photo.copied = asCalled && !smaller && !photo.applyOrientation && !photo.lens;
  photo.imageFile =
      fs::path("images") / (asCalled || calledPng ? image.name : image.name + (isLossy(info.format) ? ".jpg" : ".png"));
  photo.textureFile = fs::path("textures") / (image.name + ".ktx2");
  return photo;
}

void checkReadable(std::vector<std::string> faults) {
  std::erase(faults, "");
  check(faults.size() < 2, ErrorCode::invalidInput, "{} photographs cannot be read (--exclude leaves them out):\n{}",
        faults.size(), fmt::join(faults, "\n"));
  check(faults.empty(), ErrorCode::invalidInput, "{} (--exclude leaves it out)", fmt::join(faults, ""));
}

void checkEnoughForPoses(const fs::path& folder, std::size_t photographs) {
  check(photographs >= 2, ErrorCode::invalidInput, "{}: estimating poses needs at least 2 photographs, found {}",
        folder.string(), photographs);
}

bool isFileError(const Error& error) {
  return error.code() == ErrorCode::invalidInput || error.code() == ErrorCode::unsupported;
}

Image8 loadPhotograph(const Photograph& photo) {
  Image8 picture = readImage(photo.source, photo.applyOrientation);
  if (photo.lens) picture = undistort(picture, *photo.lens, photo.whole);
  const Intrinsics& k = photo.camera.intrinsics;
  if (picture.width == k.width && picture.height == k.height) return picture;
  return downscaled(picture, k.width, k.height);
}

double bytesToLoad(const Photograph& photo) {
  const double whole = photo.lens ? double(photo.whole.width) * photo.whole.height : 0;
  const double stored = double(photo.camera.intrinsics.width) * photo.camera.intrinsics.height;
  return photo.sourceBytes + 3 * (photo.sourcePixels + whole + stored);
}

double bytesToStore(const Photograph& photo) {
  const double whole = double(photo.whole.width) * photo.whole.height;  // undistorted, it may exceed the source
  return 2 * photo.sourceBytes + kBytesPerPixel * std::max(photo.sourcePixels, whole) +
         (photo.lens ? 3 * photo.sourcePixels : 0);
}

void checkNotOverwritten(const Photograph& photo, const fs::path& folder) {
  std::error_code ignored;
  check(photo.copied || !fs::equivalent(photo.source, folder / photo.imageFile, ignored), ErrorCode::invalidInput,
        "{}: the output would overwrite this photograph; choose another output folder", photo.source.string());
}

Image8 storePicture(const Photograph& photo, const fs::path& folder) {
  const fs::path image = folder / photo.imageFile;
  checkNotOverwritten(photo, folder);
  makeFolders(image.parent_path());
  Image8 picture = loadPhotograph(photo);
  if (photo.copied) {
    const std::vector<std::byte> file = readFile(photo.source);
    writeFile(image, photo.stripped ? withoutMetadata(file, photo.source.string()) : file);
  }
  if (!photo.copied) writeImage(image, picture, kJpegQuality);
  return picture;
}

std::uint64_t hashPhotograph(const Photograph& photo) {
  const Image8 mask = photo.mask.empty() ? Image8() : loadMask(photo, photo.mask);
  return withHashOf(mask, hashOf(photo, readFile(photo.source), photo.lens ? loadPhotograph(photo) : Image8()));
}

std::uint64_t storePhotograph(Photograph& photo, const fs::path& scene, TextureFormat format) {
  const std::vector<std::byte> source = readFile(photo.source);
  const Image8 mask = photo.mask.empty() ? Image8() : loadMask(photo, photo.mask);
  const Image8 picture = storePicture(photo, scene);
  if (mask.empty())
    storeTexture(scene / photo.textureFile, picture, format);
  else
    storeMask(photo, mask, picture, scene, format);
  return withHashOf(mask, hashOf(photo, source, picture));
}

void replaceStored(Photograph& photo, const Image8& picture, const fs::path& scene, TextureFormat format) {
  photo.copied = false;
  checkNotOverwritten(photo, scene);
  writeImage(scene / photo.imageFile, picture, kJpegQuality);
  if (const Image8 mask = storedMask(photo); !mask.empty())
    storeMask(photo, mask, picture, scene, format);
  else
    storeTexture(scene / photo.textureFile, picture, format);
}

std::uint64_t storeMask(Photograph& photo, const Image8& mask, const Image8& picture, const fs::path& scene,
                        TextureFormat format) {
  photo.storedMask = scene / storedMaskFile(photo.name);
  makeFolders(photo.storedMask.parent_path());
  writeImage(photo.storedMask, mask);
  storeTexture(scene / photo.textureFile, withMask(picture, mask),
               format == TextureFormat::bc1 ? TextureFormat::bc7 : format);
  return withHashOf(mask, 0);
}

}  // namespace ibr
