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
  const std::lock_guard lock(mutex_);
  if (sinceRequest_.seconds() > kSeconds) {
    sinceRequest_ = {};
    requested_ = true;
    wake_.notify_one();
  }
  return std::exchange(done_, {});
}

ShaderWatch::FileTimes ShaderWatch::folderTimes() const {
  FileTimes times;
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

std::vector<std::size_t> ShaderWatch::outdated(const FileTimes& now) const {
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

void ShaderWatch::compileChanges(const std::stop_token& stop) {
  using namespace std::chrono_literals;
  FileTimes now = folderTimes();
  while (now != times_ && !stop.stop_requested()) {  // waits until an editor has finished writing
    std::this_thread::sleep_for(30ms);
    FileTimes again = folderTimes();
    if (again == now) break;
    now = std::move(again);
  }
  const std::vector<std::size_t> list = outdated(now);
  times_ = std::move(now);
  if (list.empty()) return;
  std::vector<CompiledShader> compiled(list.size());
  const auto shouldContinue = [&] { return !stop.stop_requested(); };
  const auto compile = [&](std::size_t i) {
    const std::string& file = shaders_[list[i]].file;
    if (shouldContinue())
      compiled[i] = compileShader(compiler_, folder_, file, scratch_ / std::to_string(list[i]), shouldContinue);
  };
  forEachInParallel(list.size(), 0, compile, 1);
  if (!shouldContinue()) return;
  for (std::size_t i = 0; i < list.size(); ++i) shaders_[list[i]].dependencies = compiled[i].dependencies;
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < list.size(); ++i) done_[list[i]] = std::move(compiled[i]);
}

void ShaderWatch::work(const std::stop_token& stop) {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [&] { return requested_; })) return;
      requested_ = false;
    }
    try {
      compileChanges(stop);
    } catch (const std::exception&) {  // no memory or no thread: the file compiles at its next change
    }
  }
}

}  // namespace ibr
