// SPDX-License-Identifier: Apache-2.0
// Images of named float channels: OpenEXR scan line files, 32 bits per channel, lossless (ZIP). Throws Error (io,
// invalidInput) with the file's name.
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

/// Channels of one size; at least one. Writes to a file beside the final name, then renames.
void writeExr(const std::filesystem::path& path, std::span<const ExrChannel> channels);

/// Channels in the order of their names. Other channel types are converted to float.
std::vector<ExrChannel> readExr(const std::filesystem::path& path);

}  // namespace ibr
