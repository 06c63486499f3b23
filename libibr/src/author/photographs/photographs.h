// SPDX-License-Identifier: Apache-2.0
// Photographs of a model: finds them, checks them against their cameras, stores them in the scene's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/author/poses.h"
#include "ibr/capture.h"
#include "ibr/error.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

/// A photograph, and how it is stored in the scene.
struct Photograph {
  std::string name;
  std::filesystem::path source;
  bool applyOrientation = false;      // the model's camera is that of the upright image
  bool orientationAmbiguous = false;  // EXIF says that the image is rotated, and the camera fits both ways
  double sourcePixels = 0;
  double sourceBytes = 0;                        // additional memory while it is read
  std::optional<Lens> lens;                      // distortion to remove before storing, if any
  bool copied = false;                           // stored byte by byte
  bool stripped = false;                         // copied without its metadata
  CaptureMetadata capture;                       // from the file's metadata
  Intrinsics whole;                              // undistorted, at the size of the file
  Camera camera;                                 // intrinsics at the stored size
  std::filesystem::path imageFile, textureFile;  // relative to the scene's folder
  std::filesystem::path mask = {};               // given mask of the source; empty: none (author/photographs/masks.h)
  std::filesystem::path storedMask = {};         // once stored: the scene's mask, which includes moving objects
};

inline constexpr int kJpegQuality = 95;  // of re-encoded photographs

/// True for JPEG, by the file name's extension.
bool isJpeg(const std::filesystem::path& path);

/// Finds the file of a model's image and plans its storage: undistorted, scaled to at most `maxSize` px along the
/// longest side (0: unchanged), rotated by `orientation` (automatic: if the shape is unambiguous). Throws Error (io,
/// invalidInput) that names the file if it is missing or unreadable, or its size is neither the camera's nor a uniform
/// scale of it.
Photograph findPhotograph(const std::filesystem::path& folder, const PosedImage& image, int maxSize,
                          Orientation orientation = Orientation::automatic);

/// Throws Error{invalidInput} that names all unreadable photographs and what to do. `faults`: each photograph's error
/// message; "" for readable ones.
void checkReadable(std::vector<std::string> faults);

/// Throws Error{invalidInput} if the folder has too few photographs to estimate poses.
void checkEnoughForPoses(const std::filesystem::path& folder, std::size_t photographs);

/// True if the error concerns the file itself, so that the photograph may be left out.
bool isFileError(const Error& error);

/// Loads the source and returns the image as stored (RGB).
Image8 loadPhotograph(const Photograph& photograph);

/// Maximum memory of loadPhotograph, bytes.
double bytesToLoad(const Photograph& photograph);

/// Approximate memory of storePhotograph, bytes.
double bytesToStore(const Photograph& photograph);

/// Throws Error{invalidInput} if storePicture below `folder` would overwrite the photograph itself.
void checkNotOverwritten(const Photograph& photograph, const std::filesystem::path& folder);

/// Writes the image below `folder`, and returns it. Throws as checkNotOverwritten, and Error{io}.
Image8 storePicture(const Photograph& photograph, const std::filesystem::path& folder);

/// Hashes the source file's bytes, the undistortion and the given mask.
std::uint64_t hashPhotograph(const Photograph& photograph);

/// Writes the image and its texture of this format below `scene`. A mask is written, too, also as the texture's alpha;
/// BC1 has no alpha and becomes BC7. Returns the value of hashPhotograph.
std::uint64_t storePhotograph(Photograph& photograph, const std::filesystem::path& scene, TextureFormat format);

/// Writes `picture`, of the stored size, and its texture below `scene` in place of the stored photograph. The mask is
/// kept. Throws as storePicture.
void replaceStored(Photograph& photograph, const Image8& picture, const std::filesystem::path& scene,
                   TextureFormat format);

/// Masks the pixels that are 0 in `mask`, of the stored size: writes the mask and the texture. Returns the mask's hash.
std::uint64_t storeMask(Photograph& photograph, const Image8& mask, const Image8& picture,
                        const std::filesystem::path& scene, TextureFormat format);

}  // namespace ibr
