// SPDX-License-Identifier: Apache-2.0
#include "reload/shader_compile.h"

#include <cstring>

#include "base/check.h"
#include "base/child_process.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "reload/embedded_shaders.h"

namespace ibr {

std::vector<std::filesystem::path> prerequisites(std::string_view rule) {
  std::vector<std::filesystem::path> files;
  const std::size_t colon = rule.find(": ");
  if (colon == rule.npos) return files;
  std::string name;
  const auto end = [&] {
    if (!name.empty()) files.push_back(std::filesystem::path(name).lexically_normal());
    name.clear();
  };
  for (std::size_t i = colon + 2; i < rule.size(); ++i) {
    const bool escapes = rule[i] == '\\' && i + 1 < rule.size();
    if (escapes && rule[i + 1] == ' ')
      name += rule[++i];
    else if (rule[i] == ' ' || rule[i] == '\n' || (escapes && rule[i + 1] == '\n'))
      end();
    else
      name += rule[i];
  }
  end();
  return files;
}

CompiledShader compileShader(const std::string& compiler, const std::filesystem::path& folder, const std::string& file,
                             const std::filesystem::path& output, const std::function<bool()>& shouldContinue) {
  constexpr double kMaxSeconds = 30;
  constexpr std::uint64_t kMaxFileBytes = 64u << 20;
  const std::string spirv = output.string() + ".spv", rule = output.string() + ".d";
  std::vector<std::string> arguments{compiler};
  for (const std::string_view flag : shaderFlags()) arguments.emplace_back(flag);
  arguments.insert(arguments.end(), {"-I" + folder.string(), "--depfile", rule, "-o", spirv, (folder / file).string()});
  CompiledShader result;
  try {
    std::error_code ignored;
    std::filesystem::remove(spirv, ignored);
    const Stopwatch watch;
    const ChildResult run = runChild(
        arguments, {}, [&](std::string_view line) { result.text.append(line) += '\n'; },
        [&] { return shouldContinue() && watch.seconds() < kMaxSeconds; });
    if (run.status != 0 || run.stopped) {
      if (run.stopped) result.text += fmt::format("{}: stopped after {:.0f} s\n", compiler, watch.seconds());
      if (result.text.empty()) result.text = fmt::format("{}: failed with exit status {}\n", compiler, run.status);
      return result;
    }
    const std::vector<std::byte> bytes = readFile(spirv, kMaxFileBytes);
    check(!bytes.empty() && bytes.size() % sizeof(std::uint32_t) == 0, ErrorCode::io, "{}: {} bytes are not SPIR-V",
          spirv, bytes.size());
    result.dependencies = prerequisites(readTextFile(rule, kMaxFileBytes));
    result.words.resize(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(result.words.data(), bytes.data(), bytes.size());
    result.text.clear();  // only warnings
  } catch (const Error& error) {
    result.text += error.what();
  }
  return result;
}

}  // namespace ibr
