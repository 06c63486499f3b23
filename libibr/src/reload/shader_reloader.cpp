// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/check.h"
#include "base/child_process.h"
#include "base/vulkan/shader_replacements.h"
#include "gpu/draw/spirv_interface.h"
#include "ibr/shader_reload.h"
#include "reload/embedded_shaders.h"
#include "reload/shader_watch.h"

namespace ibr {
namespace {

std::vector<std::string> shaderFiles() {
  std::vector<std::string> files;
  for (const EmbeddedShader& shader : embeddedShaders()) files.emplace_back(shader.file);
  return files;
}

// Reason why the words cannot be used; empty if they can.
std::string refusal(std::span<const std::uint32_t> embedded, const CompiledShader& compiled) {
  if (compiled.words.empty()) return compiled.text;
  try {
    const std::string text = interfaceMismatch(spirvInterface(embedded), spirvInterface(compiled.words));
    return text.empty() ? text : "the interface differs from the built-in shader's; rebuild the program:\n" + text;
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

struct ShaderReloader::State {
  State(Device& device, const ShaderReloadOptions& options)
      : replacements(shaderReplacements(device)),
        log(options.log),
        watch(options.folder, options.compiler, shaderFiles()) {}

  void say(LogLevel level, const std::string& message) const {
    if (log) log(level, message);
  }
  /// Returns the replaced words; empty: the embedded words were in use.
  std::vector<std::uint32_t> use(std::span<const std::uint32_t> embedded, std::vector<std::uint32_t> words) {
    std::vector<std::uint32_t>& kept = replacements.words[embedded.data()];
    kept.swap(words);
    if (kept.empty()) replacements.words.erase(embedded.data());
    return words;
  }

  ShaderReplacements& replacements;
  LogCallback log;
  ShaderWatch watch;
  std::map<std::size_t, Failure> failures;                                           // by index of the shader
  std::vector<std::pair<const EmbeddedShader*, std::vector<std::uint32_t>>> before;  // replaced words, for revert()
};

ShaderReloader::ShaderReloader(Device& device, ShaderReloadOptions options) {
  constexpr double kMaxSeconds = 10;
  const Stopwatch watch;
  std::string version;  // the text is not used; a successful run shows that the compiler exists
  const auto keepFirst = [&](std::string_view line) {
    if (version.empty()) version = line;
  };
  runChild({options.compiler, "--version"}, {}, keepFirst, [&] { return watch.seconds() < kMaxSeconds; });
  state_ = std::make_unique<State>(device, options);
  state_->say(LogLevel::info, fmt::format("shaders in {} are compiled on change with {} ({})", options.folder.string(),
                                          options.compiler, version));
}
ShaderReloader::ShaderReloader(ShaderReloader&&) noexcept = default;
ShaderReloader& ShaderReloader::operator=(ShaderReloader&&) noexcept = default;
ShaderReloader::~ShaderReloader() = default;

ShaderReloader::Result ShaderReloader::poll() {
  Result result;
  std::map<std::size_t, CompiledShader> all = state_->watch.take();
  if (all.empty()) return result;
  decltype(state_->before) before;
  for (auto& [i, compiled] : all) {
    const EmbeddedShader& shader = embeddedShaders()[i];
    const std::string file(shader.file);
    if (const std::string text = refusal(*shader.words, compiled); !text.empty()) {
      Failure& known = state_->failures[i];
      if (known.text == text) continue;
      state_->say(LogLevel::warning, fmt::format("{}: {}", file, text));
      result.failed.push_back(known = {file, text});
      continue;
    }
    state_->failures.erase(i);
    if (std::ranges::equal(compiled.words, state_->replacements.currentWords(*shader.words))) continue;
    if (std::ranges::equal(compiled.words, *shader.words)) compiled.words.clear();
    before.emplace_back(&shader, state_->use(*shader.words, std::move(compiled.words)));
    state_->say(LogLevel::info, fmt::format("{}: shader replaced", file));
    result.replaced.push_back(file);
  }
  if (!before.empty()) {
    state_->before = std::move(before);
    ++state_->replacements.generation;
  }
  return result;
}

std::vector<ShaderReloader::Failure> ShaderReloader::failures() const {
  std::vector<Failure> list;
  for (const auto& [i, failure] : state_->failures) list.push_back(failure);
  return list;
}

std::vector<std::string> ShaderReloader::revert() {
  std::vector<std::string> files;
  for (auto& [shader, words] : std::exchange(state_->before, {})) {
    state_->use(*shader->words, std::move(words));
    files.emplace_back(shader->file);
  }
  if (!files.empty()) ++state_->replacements.generation;
  return files;
}

}  // namespace ibr
