// SPDX-License-Identifier: Apache-2.0
// Compiles one GLSL file to SPIR-V with an external compiler.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace ibr {

struct CompiledShader {
  std::vector<std::uint32_t> words;                 // empty: compilation failed
  std::string text;                                 // reason of the failure
  std::vector<std::filesystem::path> dependencies;  // the file and its includes, absolute; empty after a failure
};

/// Compiles `folder`/`file` as the build does, with include path `folder`. `output`: path of scratch files, to which
/// suffixes are added. `shouldContinue`: called as in runChild. Throws nothing but std::bad_alloc: failures are
/// described in the result's text.
CompiledShader compileShader(const std::string& compiler, const std::filesystem::path& folder, const std::string& file,
                             const std::filesystem::path& output, const std::function<bool()>& shouldContinue);

/// Prerequisites of a make rule in the format of glslangValidator --depfile: a backslash escapes spaces in names.
std::vector<std::filesystem::path> prerequisites(std::string_view rule);

}  // namespace ibr
