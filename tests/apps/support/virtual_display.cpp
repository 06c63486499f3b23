// SPDX-License-Identifier: Apache-2.0
#include "virtual_display.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "support/skipped.h"

namespace ibr::test {
namespace {

// Starts a program that is killed with this process. `keep`: a descriptor that stays open in the program, or −1.
pid_t start(std::vector<std::string> words, int keep) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int null = ::open("/dev/null", O_RDWR);
  for (const int fd : {0, 1, 2}) ::dup2(null, fd);
  for (int fd = 3; fd < 64; ++fd)
    if (fd != keep) ::close(fd);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execvp(arguments[0], arguments.data());
  ::_exit(127);
}

std::string outputOf(std::vector<std::string> words);

// Waits for the window manager. GLFW hangs if the manager starts between creating and showing a window.
void waitForManager() {
  for (int tries = 0; tries < 100; ++tries, sleepFor(0.1)) try {
      outputOf({"sh", "-c", "xdotool get_desktop 2>/dev/null"});
      return;
    } catch (const std::runtime_error&) {  // not yet running
    }
}

struct Display {
  pid_t server = -1, manager = -1;
  std::string number;

  Display() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    server = start({"Xvfb", "-displayfd", std::to_string(ends[1]), "-screen", "0", "1280x900x24", "-nolisten", "tcp"},
                   ends[1]);
    ::close(ends[1]);
    char digit = 0;
    while (::read(ends[0], &digit, 1) == 1 && digit != '\n') number += digit;
    ::close(ends[0]);
    if (number.empty()) return;
    ::setenv("DISPLAY", (":" + number).c_str(), 1);
    manager = start({"openbox"}, -1);
    waitForManager();
  }
  ~Display() {
    for (const pid_t child : {manager, server})
      if (child > 0) ::kill(child, SIGTERM), ::waitpid(child, nullptr, 0);
  }
};

std::string outputOf(std::vector<std::string> words) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], 1);
    ::close(ends[0]);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  std::string text;
  std::array<char, 512> buffer;
  for (ssize_t n; (n = ::read(ends[0], buffer.data(), buffer.size())) > 0;) text.append(buffer.data(), std::size_t(n));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error(words[0] + " " + words[1] + " failed");
  return text;
}

std::string visibleWindow() {
  for (int tries = 0; tries < 300; ++tries, sleepFor(0.1)) try {
      const std::string found = outputOf({"xdotool", "search", "--onlyvisible", "--name", "(^| )ibr$"});
      if (!found.empty()) return found.substr(0, found.find('\n'));
    } catch (const std::runtime_error&) {  // no window yet
    }
  throw std::runtime_error("no window appeared");
}

// Activates a window; retries while the window manager is starting.
void activate(const std::string& window) {
  for (int tries = 0;; ++tries, sleepFor(0.1)) try {
      outputOf({"xdotool", "windowactivate", "--sync", window});
      return;
    } catch (const std::runtime_error&) {
      if (tries == 50) throw;
    }
}

}  // namespace

void sleepFor(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

bool displayIsThere() {
  static const bool answer = [] {
    static const Display display;
    for (const char* program : {"xdotool", "openbox"})
      if (std::system(("command -v " + std::string(program) + " >/dev/null").c_str()) != 0) return false;
    return !display.number.empty();
  }();
  if (!answer && std::getenv("IBR_REQUIRE_DEVICE")) FAIL("no display: Xvfb, openbox or xdotool is missing");
  return answer || skipCase("no display");
}

std::string xdotool(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"xdotool"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return outputOf(std::move(words));
}

Hands::Hands(std::function<void(const std::string&)> act)
    : thread_([act = std::move(act)] {
        std::string window;
        try {
          window = visibleWindow();
          activate(window);
          act(window);
        } catch (const std::exception& e) {
          std::fprintf(stderr, "driving the window: %s\n", e.what());
        }
        if (!window.empty()) try {
            activate(window);
            xdotool({"key", "ctrl+q"});
          } catch (const std::exception&) {  // the program has already ended
          }
      }) {}

Hands::~Hands() {
  thread_.join();
}

}  // namespace ibr::test
