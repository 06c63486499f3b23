// SPDX-License-Identifier: Apache-2.0
// A folder of photographs becomes a scene beside the viewer, by the program `ibr` in a process of its own: so the
// viewer needs nothing that only building does, and lives on whatever becomes of it.
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ibr::app {

/// Whether a folder holds photographs, in it or below.
bool holdsPhotographs(const std::filesystem::path& folder) noexcept;

/// `ibr` beside this program's folder, as it is built, or else on PATH.
std::filesystem::path builderProgram();

class BuildJob {
 public:
  /// Begins `ibr build PHOTOGRAPHS -o SCENE`, with the poses that the folder holds (sparse/, sparse/0/ or
  /// transforms.json), else those that COLMAP estimates; SCENE is PHOTOGRAPHS with "-scene" behind its name, and a
  /// build that was stopped there goes on. Where the program cannot be started it has failed.
  explicit BuildJob(const std::filesystem::path& photographs);
  BuildJob(const BuildJob&) = delete;
  BuildJob& operator=(const BuildJob&) = delete;
  ~BuildJob();  // cancels and waits

  const std::filesystem::path& photographs() const noexcept { return photographs_; }
  const std::filesystem::path& scene() const noexcept { return scene_; }

  enum class State { running, done, cancelled, failed };
  State state() const;
  std::string progress() const;                  // the last line that it said
  void cancel() noexcept { cancelled_ = true; }  // whole files stay: the same folder goes on there

 private:
  void run(const std::vector<std::string>& words);

  std::filesystem::path photographs_, scene_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;  // of what follows
  State state_ = State::running;
  std::string progress_;
  std::thread thread_;  // last: it uses all of this
};

}  // namespace ibr::app
