// SPDX-License-Identifier: Apache-2.0
#include "author/photographs.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "author/hash.h"
#include "base/check.h"
#include "base/file.h"
#include "image/ktx2.h"
#include "image/mips.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr int kJpegQuality = 95;
constexpr double kBytesPerPixel = 14;  // picture (3), mips (4 + 4/3) and the encoded texture (as much), the file

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return extension;
}
bool isJpeg(const fs::path& path) {
  return lowerExtension(path) == ".jpg" || lowerExtension(path) == ".jpeg";
}
bool isPng(const fs::path& path) {
  return lowerExtension(path) == ".png";
}

// Equal proportions, to the rounding of whole pixels.
bool sameShape(int width, int height, const Intrinsics& k) {
  return std::abs(double(width) * k.height - double(height) * k.width) <= double(std::max(k.width, k.height));
}

}  // namespace

Photograph findPhotograph(const fs::path& folder, const PosedImage& image, int maxSize) {
  Photograph photo;
  photo.name = image.name;
  photo.source = pathInside(folder, image.name);
  check(fs::exists(photo.source), ErrorCode::io, "{}: the model's photograph is missing", photo.source.string());
  const ImageFileInfo info = probeImage(photo.source);
  const Intrinsics& k = image.camera.intrinsics;
  int width = info.width, height = info.height;
  photo.sourcePixels = double(width) * height;
  if (!sameShape(width, height, k) && info.orientation >= 5 && sameShape(height, width, k)) {
    photo.applyOrientation = true;
    std::swap(width, height);
  }
  check(sameShape(width, height, k), ErrorCode::invalidInput,
        "{}: {}x{} px, but the model's camera has {}x{}, of other proportions", photo.source.string(), width, height,
        k.width, k.height);
  const int longest = std::max(width, height);
  const bool smaller = maxSize > 0 && longest > maxSize;
  if (smaller) {
    const double scale = double(maxSize) / longest;
    width = std::max(1, int(std::lround(width * scale)));
    height = std::max(1, int(std::lround(height * scale)));
  }
  photo.camera = {resized(k, width, height), image.camera.pose};
  const bool storable = isJpeg(photo.source) || isPng(photo.source);
  photo.copied = storable && !smaller && !photo.applyOrientation;
  photo.imageFile = fs::path("images") / (storable ? image.name : image.name + ".png");
  photo.textureFile = fs::path("textures") / (image.name + ".ktx2");
  return photo;
}

Image8 loadPhotograph(const Photograph& photo) {
  const Image8 picture = readImage(photo.source, photo.applyOrientation);
  const Intrinsics& k = photo.camera.intrinsics;
  if (picture.width == k.width && picture.height == k.height) return picture;
  return shrunk(picture, k.width, k.height);
}

Image8 shrunk(const Image8& picture, int width, int height) {
  Image8 small(width, height, 3);
  const cv::Mat from(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.values.data()));
  cv::Mat to(height, width, CV_8UC3, small.values.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

double bytesToStore(const Photograph& photo) {
  return kBytesPerPixel * photo.sourcePixels;
}

std::uint64_t storePhotograph(const Photograph& photo, const fs::path& scene, TextureFormat format) {
  const std::vector<std::byte> source = readFile(photo.source);
  const fs::path image = scene / photo.imageFile, texture = scene / photo.textureFile;
  fs::create_directories(image.parent_path());
  fs::create_directories(texture.parent_path());
  const Image8 picture = loadPhotograph(photo);
  if (photo.copied)
    writeFile(image, source);
  else
    writeImage(image, picture, kJpegQuality);
  writeKtx2(texture, encodeTexture(buildMips(picture), format));
  Hash hash;
  hash.add(source);
  return hash.value();
}

std::vector<std::string> listPictures(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    const std::string extension = lowerExtension(entry.path());
    if (!entry.is_regular_file() ||
        !(isJpeg(entry.path()) || isPng(entry.path()) || extension == ".tif" || extension == ".tiff"))
      continue;
    names.push_back(entry.path().lexically_relative(folder).generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace ibr
