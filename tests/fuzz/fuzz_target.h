// SPDX-License-Identifier: Apache-2.0
// Interface of a fuzz target: `LLVMFuzzerTestOneInput` reads one input as a file of its format and accepts only
// ibr::Error. `seeds` returns valid files, which the writers create so that the seeds follow the formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "ibr/error.h"
#include "support/temporary_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace ibr::test {

std::vector<std::string> seeds();

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Writes in place: inputs are processed one by one and need no temporary file.
inline void put(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), std::streamsize(bytes.size()));
}

/// Input that represents one file of several: the first byte selects the file, the rest is its content.
struct Chosen {
  std::size_t file;
  std::string_view bytes;
};
inline Chosen chosen(const std::uint8_t* data, std::size_t size, std::size_t files) {
  const std::string_view text = textOf(data, size);
  return text.empty() ? Chosen{0, text} : Chosen{data[0] % files, text.substr(1)};
}
inline std::string seedOf(std::size_t file, const std::filesystem::path& path) {
  return char(file) + readTextFile(path);
}

/// Calls `read`; an Error is a valid outcome.
template <class Read>
int answers(Read read) {
  try {
    read();
  } catch (const Error&) {
  }
  return 0;
}

/// Traps if `right` is false, for faults visible only as a wrong result.
inline void demand(bool right) {
  if (!right) __builtin_trap();
}

}  // namespace ibr::test
