// SPDX-License-Identifier: Apache-2.0
// The photographs of a model: found, checked against its cameras, stored in the scene's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/author.h"
#include "ibr/capture.h"
#include "ibr/error.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

/// A photograph and how it enters the scene.
struct Photograph {
  std::string name;
  std::filesystem::path source;
  bool applyOrientation = false;  // the model's camera is that of the picture turned upright
  bool turnUnsure = false;        // EXIF says that it is turned, and the camera fits both ways
  double sourcePixels = 0;
  double sourceBytes = 0;                        // of memory, beside the picture, while it is read
  std::optional<Lens> lens;                      // that took it, where it is undistorted before it is stored
  bool copied = false;                           // stored byte by byte
  CaptureFacts capture;                          // that its file tells
  Intrinsics whole;                              // undistorted, at the size of the file
  Camera camera;                                 // intrinsics at the stored size
  std::filesystem::path imageFile, textureFile;  // relative to the scene's folder
  std::filesystem::path mask = {};        // of its source, as it was given; empty: none (author/photographs/masks.h)
  std::filesystem::path storedMask = {};  // once it is stored: the scene's, which masks what moved as well
};

inline constexpr int kJpegQuality = 95;  // of what is stored anew

/// By the extension of its name.
bool isJpeg(const std::filesystem::path& path);

/// Finds the file of a model's image and plans how it is stored: freed of its lens's distortion, at most `maxSize` px
/// along its longest side (0: as it is), turned as asked, automatically where the shape says so for certain. Throws
/// Error (io, invalidInput) that names the file where it is missing, unreadable, or has neither the camera's size nor a
/// uniform scale of it.
Photograph findPhotograph(const std::filesystem::path& folder, const PosedImage& image, int maxSize,
                          Orientation orientation = Orientation::automatic);

/// Throws Error{invalidInput} that names all photographs that cannot be read, and the way out. `faults`: what each
/// one's error says; "" for those without.
void checkReadable(std::vector<std::string> faults);

/// Throws Error{invalidInput} where there are fewer photographs in the folder than poses can be estimated of.
void checkEnoughForPoses(const std::filesystem::path& folder, std::size_t photographs);

/// Whether that error is of the file itself: of a photograph that can be left out.
bool isOfFile(const Error& error);

/// The picture as it is stored (RGB), from its source.
Image8 loadPhotograph(const Photograph& photograph);

/// The memory that loadPhotograph takes at most, bytes.
double bytesToLoad(const Photograph& photograph);

/// The memory that storePhotograph takes, about.
double bytesToStore(const Photograph& photograph);

/// Throws Error{invalidInput} where storePicture below `folder` would overwrite the photograph itself.
void checkNotOverwritten(const Photograph& photograph, const std::filesystem::path& folder);

/// Writes the picture below `folder`, and gives it back. Throws as checkNotOverwritten does, and Error{io}.
Image8 storePicture(const Photograph& photograph, const std::filesystem::path& folder);

/// Of the source file's bytes, of what is undistorted and of the given mask.
std::uint64_t hashPhotograph(const Photograph& photograph);

/// Writes the picture and its texture, in this format, below `scene`; with a mask, that too, as the texture's alpha as
/// well, which BC1 does not have: it is BC7 then. Returns what hashPhotograph does.
std::uint64_t storePhotograph(Photograph& photograph, const std::filesystem::path& scene, TextureFormat format);

/// Writes `picture`, of the stored size, and its texture below `scene` in the stored photograph's place; what is masked
/// stays so. Throws as storePicture does.
void storeInstead(Photograph& photograph, const Image8& picture, const std::filesystem::path& scene,
                  TextureFormat format);

/// Masks what is 0 in `mask`, of the stored size, in the scene: writes it and the texture. Returns a hash of it.
std::uint64_t storeMask(Photograph& photograph, const Image8& mask, const Image8& picture,
                        const std::filesystem::path& scene, TextureFormat format);

}  // namespace ibr
