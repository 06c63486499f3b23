// SPDX-License-Identifier: Apache-2.0
// A thread that compiles shaders when their files change. Independent of devices.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "reload/shader_compile.h"

namespace ibr {

class ShaderWatch {
 public:
  /// Throws Error{io} if `folder` is not a folder or no scratch folder can be made. Starts by compiling all of `files`,
  /// whose paths are relative to `folder`.
  ShaderWatch(const std::filesystem::path& folder, std::string compiler, std::vector<std::string> files);
  ShaderWatch(const ShaderWatch&) = delete;
  ShaderWatch& operator=(const ShaderWatch&) = delete;
  ~ShaderWatch();

  /// Results since the last call, by index of the file: the latest of each, with all results of one change together.
  /// Wakes the thread to check the folder, at most every tenth of a second.
  std::map<std::size_t, CompiledShader> take();

 private:
  using FileTimes = std::map<std::filesystem::path, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  FileTimes folderTimes() const;
  std::vector<std::size_t> outdated(const FileTimes& now) const;
  void compileChanges(const std::stop_token& stop);
  void work(const std::stop_token& stop);

  std::filesystem::path folder_, scratch_;
  std::string compiler_;
  Stopwatch sinceRequest_;

  // Used by the thread only.
  struct Shader {
    std::string file;
    std::vector<std::filesystem::path> dependencies;  // empty: unknown, or compilation failed
  };
  std::vector<Shader> shaders_;
  FileTimes times_;

  std::mutex mutex_;  // protects the members below
  std::condition_variable_any wake_;
  bool requested_ = true;
  std::map<std::size_t, CompiledShader> done_;

  std::jthread thread_;  // last member: joined before the others are destroyed
};

}  // namespace ibr
