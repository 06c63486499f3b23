// SPDX-License-Identifier: Apache-2.0
// Whole files in and out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ibr {

/// Reads a regular file whole. Throws Error{io} naming it (missing, a directory, a device, unreadable) or
/// Error{invalidInput} where it is longer than `limit` bytes.
std::vector<std::byte> readFile(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t(4) << 30);
std::string readTextFile(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t(1) << 30);

/// The first `bytes` bytes of a regular file, or all of a shorter one. Throws Error{io}.
std::vector<std::byte> readFileStart(const std::filesystem::path& path, std::size_t bytes);

/// Writes beside `path` and renames, so that `path` is never seen half-written. Throws Error{io}; then nothing is left.
void writeFile(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeFile(const std::filesystem::path& path, std::string_view text);

/// Makes a folder and those above it, where they are missing. Throws Error{io} that names it.
void makeFolders(const std::filesystem::path& folder);

/// Whether makeFolders(folder) and files in it may succeed, before long work: throws Error{io} that names the nearest
/// path which is there and no folder, or may not be written. Makes nothing.
void checkFolderWritable(const std::filesystem::path& folder);

/// Of all regular files below a folder, but for links; 0 where it cannot be read.
double bytesBelow(const std::filesystem::path& folder);

/// `relative` below `folder`, both canonical. Throws Error{invalidInput} where it leads outside (absolute, "..",
/// links). The file need not exist.
std::filesystem::path pathInside(const std::filesystem::path& folder, const std::filesystem::path& relative);

}  // namespace ibr
