// SPDX-License-Identifier: Apache-2.0
#include "run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "support/skipped.h"

namespace ibr::test {
namespace {

struct Pipe {
  int read = -1, write = -1;
  explicit Pipe(bool terminal) {
    int ends[2];
    REQUIRE((terminal ? ::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) : ::pipe(ends)) == 0);
    read = ends[0];
    write = ends[1];
    ::fcntl(read, F_SETFD, FD_CLOEXEC);
  }
};

// Returns true while more output may follow.
bool drain(int fd, std::string& into) {
  std::array<char, 4096> buffer;
  const ssize_t n = ::read(fd, buffer.data(), buffer.size());
  if (n > 0) into.append(buffer.data(), std::size_t(n));
  return n > 0 || (n < 0 && errno == EINTR);
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments, const RunOptions& options)
    : deadline_(std::chrono::steady_clock::now() + std::chrono::minutes(2)) {
  const Pipe out(false), err(options.terminal);
  child_ = ::fork();
  REQUIRE(child_ >= 0);
  if (child_ == 0) {
    ::dup2(::open("/dev/null", O_RDONLY), 0);
    ::dup2(options.out.empty() ? out.write : ::open(options.out.c_str(), O_WRONLY), 1);
    ::dup2(err.write, 2);
    for (int fd = 3; fd < 64; ++fd) ::close(fd);
    for (const std::string& variable : options.environment) ::putenv(const_cast<char*>(variable.c_str()));
    std::vector<char*> words{const_cast<char*>("ibr")};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    ::execv(options.program.empty() ? IBR_PROGRAM : options.program.c_str(), words.data());
    ::_exit(127);
  }
  ::close(out.write);
  ::close(err.write);
  out_ = out.read;
  err_ = err.read;
}

RunningProgram::~RunningProgram() {
  for (const int fd : {out_, err_})
    if (fd >= 0) ::close(fd);
  if (child_ > 0) ::kill(child_, SIGKILL), ::waitpid(child_, nullptr, 0);
}

bool RunningProgram::read() {
  std::array<pollfd, 2> waiting{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0}};
  ::poll(waiting.data(), waiting.size(), 100);
  for (auto [fd, text, ready] :
       {std::tuple{&out_, &outcome_.out, waiting[0].revents}, std::tuple{&err_, &outcome_.err, waiting[1].revents}})
    if (ready && !drain(*fd, *text)) ::close(std::exchange(*fd, -1));
  checkTime();
  return out_ >= 0 || err_ >= 0;
}

void RunningProgram::checkTime() {
  if (std::chrono::steady_clock::now() < deadline_) return;
  ::kill(child_, SIGKILL);
  UNSCOPED_INFO(outcome_.err);
  FAIL("the program did not end");
}

bool RunningProgram::runsUntil(const std::function<bool()>& come) {
  while (!come())
    if (!read()) return come();
  return true;
}

void RunningProgram::interrupt() {
  ::kill(child_, SIGINT);
}

Outcome RunningProgram::finish() {
  while (read()) continue;
  int status = 0;
  ::waitpid(std::exchange(child_, -1), &status, 0);
  outcome_.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return outcome_;
}

Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options) {
  RunningProgram program(arguments, options);
  if (options.interruptWhen && program.runsUntil([&] { return options.interruptWhen(program.err()); }))
    program.interrupt();
  return program.finish();
}

#ifdef IBR_LAB
Outcome runLab(const std::vector<std::string>& arguments, RunOptions options) {
  options.program = IBR_LAB;
  return runProgram(arguments, options);
}
#endif

bool deviceIsThere() {
  static const bool answer = runProgram({"doctor"}).code != 5;
  if (!answer && std::getenv("IBR_REQUIRE_DEVICE")) FAIL("no Vulkan device");
  return answer || skipCase("no Vulkan device");
}

}  // namespace ibr::test
