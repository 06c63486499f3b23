// SPDX-License-Identifier: Apache-2.0
// What is made beside the viewer, by programs that run one after the other in processes of their own: so the viewer
// needs nothing that only making does, and lives on whatever becomes of it.
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
    std::string what;                // it does, until it says something itself
    std::vector<std::string> words;  // program and arguments
  };
  std::string name;             // what is being made, for people
  std::vector<Step> steps;      // each begins when the one before has ended well
  std::string done;             // what to say then; empty: nothing
  std::filesystem::path opens;  // place that is opened then; empty: none
};

class Job {
 public:
  /// Begins. Where a program cannot be started it has failed.
  explicit Job(JobPlan plan);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job();  // cancels and waits

  const JobPlan& plan() const noexcept { return plan_; }

  enum class State { running, done, cancelled, failed };
  State state() const;
  std::string progress() const;                  // the last line that a program said
  void cancel() noexcept { cancelled_ = true; }  // files that are whole stay

 private:
  void run();
  void say(std::string_view line);

  const JobPlan plan_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;  // of what follows
  State state_ = State::running;
  std::string progress_;
  std::thread thread_;  // last: it uses all of this
};

/// `ibr` beside this program's folder, as it is built, or else on PATH.
std::filesystem::path ibrProgram();

/// Whether PATH has a program of that name.
bool isOnPath(const std::string& program);

}  // namespace ibr::app
