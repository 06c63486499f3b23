// SPDX-License-Identifier: Apache-2.0
// Reads and writes whole files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ibr {

/// Reads a whole regular file. Throws Error{io} with the path (missing, a directory, a device, unreadable) or
/// Error{invalidInput} if the file is longer than `limit` bytes.
std::vector<std::byte> readFile(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t(4) << 30);
std::string readTextFile(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t(1) << 30);

/// Reads the first `bytes` bytes of a regular file, or all of a shorter file. Throws Error{io}.
std::vector<std::byte> readFileStart(const std::filesystem::path& path, std::size_t bytes);

/// A regular file that is read in parts. Throws Error{io} with the path, also where the file has become shorter.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  std::uint64_t size() const noexcept { return size_; }
  /// Fills `bytes` from the offset on. Precondition: the range lies within size().
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path path_;
  int descriptor_;
  std::uint64_t size_;
};

/// Writes to a file beside `path`, then renames: `path` is never half-written. Throws Error{io} and leaves nothing.
void writeFile(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeFile(const std::filesystem::path& path, std::string_view text);

/// Makes a folder and its missing parents. Throws Error{io} with the path.
void makeFolders(const std::filesystem::path& folder);

/// Checks, before long work, for makeFolders(folder) and writable files in the folder. Throws Error{io} with the
/// nearest existing path that is not a folder or not writable. Makes nothing.
void checkFolderWritable(const std::filesystem::path& folder);

/// Sum of the sizes of all regular files below a folder, links excluded; 0 if the folder cannot be read.
double folderBytes(const std::filesystem::path& folder);

/// Returns folder / relative. Throws Error{invalidInput} if the path itself leads outside (absolute, ".."); links may.
std::filesystem::path pathBelow(const std::filesystem::path& folder, const std::filesystem::path& relative);

/// Returns `relative` below `folder`, both canonical. Throws Error{invalidInput} if the path leads outside (absolute,
/// "..", links). The file need not exist.
std::filesystem::path pathInside(const std::filesystem::path& folder, const std::filesystem::path& relative);

}  // namespace ibr
