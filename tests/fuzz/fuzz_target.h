// SPDX-License-Identifier: Apache-2.0
// What a fuzz target has: `LLVMFuzzerTestOneInput`, which reads one input as a file of its format and lets only
// ibr::Error pass, and `seeds`, good files to begin with, made by writers so that they stay true.
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

/// Written in place: that inputs come one by one takes no drafts.
inline void put(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), std::streamsize(bytes.size()));
}

/// Of inputs that stand for one file of several: the first byte chooses it, the rest is what is in it.
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

/// Reads as `read` does; an Error is an answer.
template <class Read>
int answers(Read read) {
  try {
    read();
  } catch (const Error&) {
  }
  return 0;
}

/// Faults that only a wrong result shows.
inline void demand(bool right) {
  if (!right) __builtin_trap();
}

}  // namespace ibr::test
