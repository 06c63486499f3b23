// SPDX-License-Identifier: Apache-2.0
// One GLSL file to SPIR-V, by a compiler that is another program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace ibr {

struct CompiledShader {
  std::vector<std::uint32_t> words;                 // empty: it failed
  std::string text;                                 // why
  std::vector<std::filesystem::path> dependencies;  // the file and all that it includes, absolute; of a success only
};

/// Compiles `folder`/`file` as the build does, with `folder` to include from. `output` is a path for scratch files, to
/// which suffixes are added. `goesOn` as runChild asks it. Throws nothing but std::bad_alloc: what goes wrong is in the
/// text.
CompiledShader compileShader(const std::string& compiler, const std::filesystem::path& folder, const std::string& file,
                             const std::filesystem::path& output, const std::function<bool()>& goesOn);

/// The prerequisites of a rule of make, as glslangValidator --depfile writes it: spaces in names follow a backslash.
std::vector<std::filesystem::path> prerequisites(std::string_view rule);

}  // namespace ibr
