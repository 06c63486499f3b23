// SPDX-License-Identifier: Apache-2.0
#include "reload/shader_watch.h"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "base/check.h"
#include "optimise/workers.h"

namespace ibr {
namespace fs = std::filesystem;

ShaderWatch::ShaderWatch(const fs::path& folder, std::string compiler, std::vector<std::string> files)
    : compiler_(std::move(compiler)) {
  std::error_code error;
  check(fs::is_directory(folder, error), ErrorCode::io, "'{}' is not a folder", folder.string());
  folder_ = fs::canonical(folder, error);
  std::string scratch = (fs::temp_directory_path(error) / "ibr-shaders-XXXXXX").string();
  check(!folder_.empty() && ::mkdtemp(scratch.data()) != nullptr, ErrorCode::io,
        "{}: cannot create the temporary folder", scratch);
  scratch_ = scratch;
  for (std::string& file : files) shaders_.push_back({std::move(file), {}});
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

ShaderWatch::~ShaderWatch() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  std::error_code ignored;
  fs::remove_all(scratch_, ignored);
}

std::map<std::size_t, CompiledShader> ShaderWatch::take() {
  constexpr double kSeconds = 0.1;
  const std::lock_guard lock(guard_);
  if (sinceAsked_.seconds() > kSeconds) {
    sinceAsked_ = {};
    ask_ = true;
    asked_.notify_one();
  }
  return std::exchange(done_, {});
}

ShaderWatch::Times ShaderWatch::timesBelow() const {
  Times times;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    if (!at->is_regular_file(gone)) continue;
    const auto time = at->last_write_time(gone);
    const auto size = at->file_size(gone);
    if (!gone) times[at->path()] = {time, size};
  }
  return times;
}

std::vector<std::size_t> ShaderWatch::outdated(const Times& now) const {
  std::set<fs::path> changed;
  for (const auto& [path, time] : now)
    if (const auto before = times_.find(path); before == times_.end() || before->second != time) changed.insert(path);
  for (const auto& [path, time] : times_)
    if (!now.contains(path)) changed.insert(path);
  std::vector<std::size_t> list;
  if (changed.empty()) return list;
  for (std::size_t i = 0; i < shaders_.size(); ++i) {
    const Shader& shader = shaders_[i];
    const bool touched =
        shader.dependencies.empty() ||
        std::ranges::any_of(shader.dependencies, [&](const fs::path& p) { return changed.contains(p); });
    if (touched && now.contains(folder_ / shader.file)) list.push_back(i);
  }
  return list;
}

void ShaderWatch::look(const std::stop_token& stop) {
  using namespace std::chrono_literals;
  Times now = timesBelow();
  while (now != times_ && !stop.stop_requested()) {  // waits until an editor has finished writing
    std::this_thread::sleep_for(30ms);
    Times again = timesBelow();
    if (again == now) break;
    now = std::move(again);
  }
  const std::vector<std::size_t> list = outdated(now);
  times_ = std::move(now);
  if (list.empty()) return;
  std::vector<CompiledShader> compiled(list.size());
  const auto goesOn = [&] { return !stop.stop_requested(); };
  const auto compile = [&](std::size_t i) {
    const std::string& file = shaders_[list[i]].file;
    if (goesOn()) compiled[i] = compileShader(compiler_, folder_, file, scratch_ / std::to_string(list[i]), goesOn);
  };
  forEachInParallel(list.size(), 0, compile, 1);
  if (!goesOn()) return;
  for (std::size_t i = 0; i < list.size(); ++i) shaders_[list[i]].dependencies = compiled[i].dependencies;
  const std::lock_guard lock(guard_);
  for (std::size_t i = 0; i < list.size(); ++i) done_[list[i]] = std::move(compiled[i]);
}

void ShaderWatch::work(const std::stop_token& stop) {
  while (true) {
    {
      std::unique_lock lock(guard_);
      if (!asked_.wait(lock, stop, [&] { return ask_; })) return;
      ask_ = false;
    }
    try {
      look(stop);
    } catch (const std::exception&) {  // no memory or no thread: the file compiles at its next change
    }
  }
}

}  // namespace ibr
