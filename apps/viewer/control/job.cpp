// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/job.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <utility>

#include "base/child_process.h"
#include "ibr/error.h"
#include "window/window.h"

namespace fs = std::filesystem;

namespace ibr::app {

Job::Job(JobPlan plan) : plan_(std::move(plan)), thread_([this] { run(); }) {}

Job::~Job() {
  cancel();
  thread_.join();
}

void Job::setProgress(std::string_view line) {
  const std::lock_guard lock(mutex_);
  progress_ = line;
  wakeWindow();
}

void Job::run() {
  State ended = State::done;
  try {
    for (const JobPlan::Step& step : plan_.steps) {
      setProgress(step.what);
      const ChildResult result = runChild(
          step.words, {}, [this](std::string_view line) { setProgress(line); }, [this] { return !cancelled_; });
      if (result.stopped || result.status != 0) {
        ended = result.stopped ? State::cancelled : State::failed;
        break;
      }
    }
  } catch (const std::exception& e) {
    setProgress(e.what());
    ended = State::failed;
  }
  const std::lock_guard lock(mutex_);
  state_ = ended;
  wakeWindow();
}

Job::State Job::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::string Job::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

fs::path ibrProgram() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& beside : {self.parent_path() / "ibr", self.parent_path().parent_path() / "batch/ibr"})
    if (!error && fs::is_regular_file(beside)) return beside;
  return "ibr";
}

bool isOnPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace ibr::app
