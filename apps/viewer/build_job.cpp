// SPDX-License-Identifier: Apache-2.0
#include "viewer/build_job.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/check.h"
#include "viewer/window.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

bool isPhotograph(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  for (const char* known : {".jpg", ".jpeg", ".png", ".tif", ".tiff"})
    if (extension == known) return true;
  return false;
}

// The poses that lie with the photographs, as options.
std::vector<std::string> posesIn(const fs::path& folder) {
  for (const char* model : {"sparse/0", "sparse"})
    for (const char* images : {"images.bin", "images.txt"})
      if (fs::exists(folder / model / images)) return {"--model", (folder / model).string()};
  if (fs::exists(folder / "transforms.json")) return {"--transforms", (folder / "transforms.json").string()};
  return {};
}

}  // namespace

bool holdsPhotographs(const fs::path& folder) noexcept try {
  constexpr int kEnough = 2, kLooks = 10000;
  int found = 0, looks = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    if (++looks > kLooks) return false;
    if (isPhotograph(entry.path()) && ++found == kEnough) return true;
  }
  return false;
} catch (const fs::filesystem_error&) {
  return false;
}

fs::path builderProgram() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& beside : {self.parent_path() / "ibr", self.parent_path().parent_path() / "batch/ibr"})
    if (!error && fs::is_regular_file(beside)) return beside;
  return "ibr";
}

BuildJob::BuildJob(const fs::path& photographs) : photographs_(fs::absolute(photographs).lexically_normal()) {
  if (photographs_.filename().empty()) photographs_ = photographs_.parent_path();
  scene_ = photographs_.string() + "-scene";
  std::vector<std::string> words{builderProgram().string(), "build", photographs_.string(), "-o", scene_.string()};
  for (std::string& word : posesIn(photographs_)) words.push_back(std::move(word));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  int ends[2];
  check(::pipe2(ends, O_CLOEXEC) == 0, ErrorCode::io, "{}: no pipe: {}", words[0], std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  const int error = ::posix_spawnp(&child_, arguments[0], &actions, nullptr, arguments.data(), ::environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    fail(ErrorCode::io, "{}: cannot be started to make a scene: {}", words[0], std::strerror(error));
  }
  thread_ = std::thread([this, output = ends[0]] { follow(output); });
}

BuildJob::~BuildJob() {
  cancel();
  thread_.join();
}

void BuildJob::follow(int output) {
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = ::read(output, buffer.data(), buffer.size())) > 0 || (n < 0 && errno == EINTR);) {
    if (n < 0) continue;
    const std::lock_guard lock(mutex_);
    output_.append(buffer.data(), std::size_t(n));
    wakeWindow();
  }
  ::close(output);
  constexpr int kCancelled = 130;  // exit code of a program that Ctrl-C stopped
  siginfo_t ended;
  while (::waitid(P_PID, id_t(child_), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  const std::lock_guard lock(mutex_);
  int status = 0;
  ::waitpid(child_, &status, 0);  // from here on its number may be another process's: `cancel` sees the state
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  state_ = code == 0 ? State::done : code == kCancelled ? State::cancelled : State::failed;
  wakeWindow();
}

BuildJob::State BuildJob::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::string BuildJob::output() const {
  const std::lock_guard lock(mutex_);
  return output_;
}

std::string BuildJob::progress() const {
  const std::lock_guard lock(mutex_);
  const std::size_t end = output_.find_last_not_of("\r\n");
  if (end == std::string::npos) return {};
  const std::size_t before = output_.find_last_of("\r\n", end);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return output_.substr(begin, end + 1 - begin);
}

void BuildJob::cancel() noexcept {
  const std::lock_guard lock(mutex_);
  if (state_ == State::running) ::kill(child_, SIGINT);
}

}  // namespace ibr::app
