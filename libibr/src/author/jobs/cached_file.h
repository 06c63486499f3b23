// SPDX-License-Identifier: Apache-2.0
// Cached files of a build, for resuming it and for later ones, named by a hash of all that they depend on. Several
// processes may store and fetch the same file at the same time. Only for machines of one byte order: numbers are stored
// in native layout, with a hash of them at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace ibr {

/// Path of a cache file. `kind`: its extension.
std::filesystem::path cacheFile(const std::filesystem::path& folder, std::uint64_t key, const char* kind);

/// Writes a cached file. Throws Error{io}.
void storeCached(const std::filesystem::path& file, std::vector<std::byte> bytes);

/// Returns the stored bytes, and marks the file as used; nullopt if the file is missing or damaged. Throws Error{io} if
/// the file cannot be read.
std::optional<std::vector<std::byte>> fetchCached(const std::filesystem::path& file);

/// Removes the cached files of a folder, then the folder if it is empty. Files that cannot be removed are skipped.
void removeCached(const std::filesystem::path& folder);

/// As removeCached, for files that were neither stored nor fetched since `time`.
void removeCachedBefore(const std::filesystem::path& folder, std::filesystem::file_time_type time);

}  // namespace ibr
