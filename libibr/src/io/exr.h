// SPDX-License-Identifier: Apache-2.0
// Pictures of named float channels: OpenEXR scan line files, 32 bits a channel, lossless (ZIP). Throws Error (io,
// invalidInput) naming the file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr {

struct ExrChannel {
  std::string name;  // "R", "Z", "confidence.spread", …; unique in a file
  ImageF values;     // one channel
};

/// Channels of one size; at least one. The file is written beside its final name and renamed.
void writeExr(const std::filesystem::path& path, std::span<const ExrChannel> channels);

/// In the order of their names. Channels of other types come as floats.
std::vector<ExrChannel> readExr(const std::filesystem::path& path);

}  // namespace ibr
