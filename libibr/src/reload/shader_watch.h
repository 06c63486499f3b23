// SPDX-License-Identifier: Apache-2.0
// A thread that compiles shaders when their files change. It knows nothing of devices.
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
  /// Throws Error{io} where `folder` is no folder or there is no place for scratch files. Starts with all of `files`,
  /// which are relative to it.
  ShaderWatch(const std::filesystem::path& folder, std::string compiler, std::vector<std::string> files);
  ShaderWatch(const ShaderWatch&) = delete;
  ShaderWatch& operator=(const ShaderWatch&) = delete;
  ~ShaderWatch();

  /// What was compiled since the last call, by the number of the file: the latest of each, those of one change at
  /// once. Has the thread look at the folder again, unless that was asked for in the last tenth of a second.
  std::map<std::size_t, CompiledShader> take();

 private:
  using Times = std::map<std::filesystem::path, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  Times timesBelow() const;
  std::vector<std::size_t> outdated(const Times& now) const;
  void look(const std::stop_token& stop);
  void work(const std::stop_token& stop);

  std::filesystem::path folder_, scratch_;
  std::string compiler_;
  Stopwatch sinceAsked_;

  // The thread's own.
  struct Shader {
    std::string file;
    std::vector<std::filesystem::path> dependencies;  // empty: not known, or it failed
  };
  std::vector<Shader> shaders_;
  Times times_;

  std::mutex guard_;  // of:
  std::condition_variable_any asked_;
  bool ask_ = true;
  std::map<std::size_t, CompiledShader> done_;

  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace ibr
