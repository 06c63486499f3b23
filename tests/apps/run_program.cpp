// SPDX-License-Identifier: Apache-2.0
#include "run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>

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

// True while there may be more.
bool drain(int fd, std::string& into) {
  std::array<char, 4096> buffer;
  const ssize_t n = ::read(fd, buffer.data(), buffer.size());
  if (n > 0) into.append(buffer.data(), std::size_t(n));
  return n > 0 || (n < 0 && errno == EINTR);
}

}  // namespace

Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options) {
  const Pipe out(false), err(options.terminal);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
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

  Outcome outcome;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  bool interrupted = false;
  std::array<pollfd, 2> waiting{pollfd{out.read, POLLIN, 0}, pollfd{err.read, POLLIN, 0}};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    ::poll(waiting.data(), waiting.size(), 1000);
    if (waiting[0].revents && !drain(out.read, outcome.out)) waiting[0].fd = -1;
    if (waiting[1].revents && !drain(err.read, outcome.err)) waiting[1].fd = -1;
    if (options.interruptWhen && !interrupted && options.interruptWhen(outcome.err)) {
      interrupted = true;
      ::kill(child, SIGINT);
    }
    if (std::chrono::steady_clock::now() > deadline) {
      ::kill(child, SIGKILL);
      UNSCOPED_INFO(outcome.err);
      FAIL("the program did not end");
    }
  }
  ::close(out.read);
  ::close(err.read);
  int status = 0;
  ::waitpid(child, &status, 0);
  outcome.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return outcome;
}

bool deviceIsThere() {
  static const bool answer = runProgram({"device"}).code == 0;
  if (!answer && std::getenv("IBR_REQUIRE_DEVICE")) FAIL("no Vulkan device");
  if (!answer) WARN("no Vulkan device: skipped");
  return answer;
}

}  // namespace ibr::test
