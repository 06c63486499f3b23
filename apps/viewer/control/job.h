// SPDX-License-Identifier: Apache-2.0
// Background job: programs that run one after the other in separate processes. The viewer therefore does not link what
// only building scenes needs, and survives if a program crashes.
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ibr::app {

struct JobPlan {
  struct Step {
    std::string what;                // progress text until the program prints its first line
    std::vector<std::string> words;  // program and arguments
  };
  std::string name;                   // name of the result, for people
  std::vector<Step> steps;            // each begins after the previous one has succeeded
  std::string done;                   // message on success; empty: none
  std::filesystem::path resultScene;  // scene opened on success; empty: none
};

class Job {
 public:
  /// Starts the job. If a program cannot be started, the job's state becomes failed.
  explicit Job(JobPlan plan);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job();  // cancels and waits

  const JobPlan& plan() const noexcept { return plan_; }

  enum class State { running, done, cancelled, failed };
  State state() const;
  std::string progress() const;                  // last line that a program printed
  void cancel() noexcept { cancelled_ = true; }  // complete files are kept

 private:
  void run();
  void setProgress(std::string_view line);

  const JobPlan plan_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;  // guards state_ and progress_
  State state_ = State::running;
  std::string progress_;
  std::thread thread_;  // last: uses all members above
};

/// Path of the `ibr` program: beside this program or in the build tree's batch folder, else "ibr" for a lookup on PATH.
std::filesystem::path ibrProgram();

/// Returns true if a folder on PATH has an executable of this name.
bool isOnPath(const std::string& program);

}  // namespace ibr::app
