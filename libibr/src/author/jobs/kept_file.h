// SPDX-License-Identifier: Apache-2.0
// What a build keeps until it is finished, or for the next one: files named by a hash of all that they depend on.
// Private to builds on one machine: numbers as they lie in memory, and a hash of them at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace ibr {

std::filesystem::path keptFile(const std::filesystem::path& folder, std::uint64_t key, const char* kind);

/// Throws Error{io}.
void storeKept(const std::filesystem::path& file, std::vector<std::byte> bytes);

/// What was stored; nullopt where there is no such file, or a damaged one. It counts as used from now on. Throws
/// Error{io} where it cannot be read.
std::optional<std::vector<std::byte>> fetchKept(const std::filesystem::path& file);

/// Removes the kept files of a folder, then the folder where nothing else is in it. What cannot be removed stays.
void removeKept(const std::filesystem::path& folder);

/// The same of files that were neither stored nor fetched since `time`.
void removeKeptBefore(const std::filesystem::path& folder, std::filesystem::file_time_type time);

}  // namespace ibr
