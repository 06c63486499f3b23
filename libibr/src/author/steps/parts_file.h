// SPDX-License-Identifier: Apache-2.0
// A file of several parts, of which a step reads only those that it needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "author/jobs/cached_values.h"
#include "base/file.h"

namespace ibr {

/// `key`: identifies the options that the parts depend on. Throws Error{io}.
void writeParts(const std::filesystem::path& file, std::uint64_t key, std::span<const std::vector<std::byte>> parts);

class PartsFile {
 public:
  /// `step`: name of the step that writes the file, for messages. Throws Error: io if the file is missing or damaged,
  /// invalidInput if its key is another.
  PartsFile(const std::filesystem::path& file, std::uint64_t key, const char* step);

  std::size_t count() const { return ends_.size(); }
  /// Reads a part. Throws Error{io} if the part is damaged.
  CacheReader part(std::size_t index) const;

 private:
  std::filesystem::path path_;
  const char* step_;
  InputFile file_;
  std::vector<std::uint64_t> ends_;  // of the parts, bytes from the start of the file
};

}  // namespace ibr
