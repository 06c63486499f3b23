// SPDX-License-Identifier: Apache-2.0
// Metadata of stored photographs: what they tell of people and places, and files without it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace ibr {

/// Kinds of metadata in a JPEG or PNG file, for people, sorted: "camera", "comment", "editing history (XMP)",
/// "exposure", "location", "maker note", "names", "preview image", "serial number", "time", "other data". Colour
/// profile and orientation are not listed. Empty for other formats and damaged files. Throws Error{io}.
std::vector<std::string> metadataKinds(const std::filesystem::path& file);

/// The JPEG or PNG file without metadata: pixels as coded, colour profile, and orientation. Throws Error{invalidInput}
/// with `name` for a damaged file, Error{unsupported} for other formats.
std::vector<std::byte> withoutMetadata(std::span<const std::byte> file, const std::string& name);

}  // namespace ibr
