// SPDX-License-Identifier: Apache-2.0
#include "base/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "base/check.h"

namespace ibr {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kMaxReads = 32;  // reads of 4096 bytes, twice a pipe's capacity, between shouldContinue calls
constexpr std::size_t kMaxLineBytes = 64 * 1024;  // longer lines are passed on in pieces
constexpr std::size_t kLastBytes = 2000;          // of a failed program's output, for the error

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() { close(); }
  int get() const { return descriptor_; }
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }

 private:
  int descriptor_;
};

std::vector<std::string> environmentWith(const std::vector<std::pair<std::string, std::string>>& more) {
  std::map<std::string, std::string> all;
  for (char** entry = ::environ; *entry; ++entry) {
    const std::string text = *entry;
    const auto equals = text.find('=');
    if (equals != text.npos) all[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const auto& [name, value] : more) all[name] = value;
  std::vector<std::string> list;
  for (const auto& [name, value] : all) list.push_back(name + '=' + value);
  return list;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// A running program, leader of its own process group. The destructor ends the program.
class Child {
 public:
  /// `input` < 0: stdin is empty.
  Child(const std::vector<std::string>& arguments, std::vector<std::string> environment, int input, int output,
        int messages) {
    std::vector<std::string> copy = arguments;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    if (input < 0)
      ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    else
      ::posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    const int error = ::posix_spawnp(&id_, copy[0].c_str(), &actions, &attributes, pointersTo(copy).data(),
                                     pointersTo(environment).data());
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
    if (error != 0) id_ = -1;
    check(error == 0, ErrorCode::io, "{}: cannot be run: {}", arguments[0], std::strerror(error));
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (id_ > 0) end();
  }

  /// Returns true after the program has ended; status() is valid then.
  bool ended() {
    if (id_ <= 0) return true;
    int raw = 0;
    const pid_t got = ::waitpid(id_, &raw, WNOHANG);
    if (got == 0 || (got < 0 && errno == EINTR)) return false;
    id_ = -1;
    constexpr int kUnknown = 127;  // waited for elsewhere, or this process ignores SIGCHLD
    status_ = got < 0 ? kUnknown : WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
    return true;
  }
  void end() {
    const pid_t group = id_;
    ::kill(-group, SIGTERM);
    for (const auto until = Clock::now() + 3s; Clock::now() < until && !ended();) std::this_thread::sleep_for(20ms);
    ::kill(-group, SIGKILL);
    while (!ended()) std::this_thread::sleep_for(5ms);
  }
  int status() const { return status_; }

 private:
  pid_t id_ = -1;
  int status_ = 0;
};

// The two ends of a pipe; reads do not block.
struct Pipe {
  explicit Pipe(const std::string& program) : Pipe(ends(program)) {}
  Descriptor out, in;  // to read, to write

 private:
  struct Ends {
    int at[2];
  };
  explicit Pipe(Ends ends) : out(ends.at[0]), in(ends.at[1]) { ::fcntl(out.get(), F_SETFL, O_NONBLOCK); }
  static Ends ends(const std::string& program) {
    Ends made;
    check(::pipe2(made.at, O_CLOEXEC) == 0, ErrorCode::io, "{}: cannot be run: {}", program, std::strerror(errno));
    return made;
  }
};

// A file in memory with these bytes, at its start.
Descriptor fileOf(std::span<const std::byte> bytes, const std::string& program) {
  Descriptor file(::memfd_create("input", MFD_CLOEXEC));
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    check(written > 0, ErrorCode::io, "{}: cannot be given its input: {}", program, std::strerror(errno));
    bytes = bytes.subspan(std::size_t(written));
  }
  ::lseek(file.get(), 0, SEEK_SET);
  return file;
}

// Reads what a pipe holds, into `buffer`: nullopt if it holds nothing now, an empty span at its end.
std::optional<std::span<const std::byte>> readNow(const Descriptor& pipe, std::span<std::byte> buffer) {
  const ssize_t got = ::read(pipe.get(), buffer.data(), buffer.size());
  if (got < 0) return std::nullopt;
  return buffer.first(std::size_t(got));
}

}  // namespace

ChildResult runChild(const std::vector<std::string>& arguments,
                     const std::vector<std::pair<std::string, std::string>>& environment,
                     const std::function<void(std::string_view)>& line, const std::function<bool()>& shouldContinue) {
  Pipe pipe(arguments[0]);
  Child child(arguments, environmentWith(environment), -1, pipe.in.get(), pipe.in.get());
  pipe.in.close();
  std::string rest;
  bool open = true;
  const auto read = [&] {
    std::byte buffer[4096];
    for (int turn = 0; turn < kMaxReads; ++turn) {
      const auto got = readNow(pipe.out, buffer);
      if (got && got->empty()) open = false;
      if (!got || got->empty()) return;  // no more output at present
      rest.append(reinterpret_cast<const char*>(got->data()), got->size());
      for (std::size_t end; (end = rest.find_first_of("\r\n")) != rest.npos; rest.erase(0, end + 1))
        if (end > 0) line(std::string_view(rest).substr(0, end));
      if (rest.size() >= kMaxLineBytes) line(std::exchange(rest, {}));
    }
  };
  // A grandchild may hold the pipe open for longer: the program's own end counts.
  for (bool ended = false; !ended;) {
    if (!shouldContinue()) {
      child.end();
      return {child.status(), true};
    }
    if (open) {
      pollfd wait{pipe.out.get(), POLLIN, 0};
      ::poll(&wait, 1, 100);
    } else {
      std::this_thread::sleep_for(20ms);
    }
    ended = child.ended();
    if (open) read();
  }
  if (!rest.empty()) line(rest);
  return {child.status(), false};
}

ChildOutput readChild(const std::vector<std::string>& arguments, std::span<const std::byte> input,
                      const std::function<bool(std::span<const std::byte>)>& output,
                      const std::function<bool()>& shouldContinue) {
  constexpr std::size_t kLastWords = 4096, kPiece = std::size_t(1) << 16;
  Pipe pixels(arguments[0]), messages(arguments[0]);
  const Descriptor file = fileOf(input, arguments[0]);
  Child child(arguments, environmentWith({}), file.get(), pixels.in.get(), messages.in.get());
  pixels.in.close();
  messages.in.close();
  ChildOutput result;
  std::vector<std::byte> buffer(kPiece);
  bool open = true;
  // Returns false if the program is to end.
  const auto readAll = [&] {
    while (const auto got = readNow(pixels.out, buffer)) {
      if (got->empty()) {
        open = false;
        break;
      }
      if (!output(*got) || !shouldContinue()) return false;
    }
    for (auto got = readNow(messages.out, buffer); got && !got->empty(); got = readNow(messages.out, buffer)) {
      result.lastWords.append(reinterpret_cast<const char*>(got->data()), got->size());
      if (result.lastWords.size() > kLastWords) result.lastWords.erase(0, result.lastWords.size() - kLastWords);
    }
    return true;
  };
  for (bool ended = false; !ended;) {
    pollfd wait[]{{open ? pixels.out.get() : -1, POLLIN, 0}, {messages.out.get(), POLLIN, 0}};
    if (open)
      ::poll(wait, 2, 100);
    else
      std::this_thread::sleep_for(5ms);
    ended = child.ended();  // before the last read, which then misses nothing
    if (!shouldContinue() || !readAll()) {
      child.end();
      result.stopped = true;
      break;
    }
  }
  result.status = child.status();
  return result;
}

struct ChildWriter::State {
  std::string name;
  Descriptor input, output;
  std::unique_ptr<Child> child;
  std::string last;        // end of the program's output
  bool outputOpen = true;  // the program may close its output and run on

  void readOutput() {
    char buffer[4096];
    while (outputOpen) {
      const ssize_t got = ::read(output.get(), buffer, sizeof(buffer));
      if (got < 0) return;
      outputOpen = got > 0;
      last.append(buffer, std::size_t(got));
      if (last.size() > kLastBytes) last.erase(0, last.size() - kLastBytes);
    }
  }
  // Waits at most 100 ms for output, and for room in the input if `writes`.
  void wait(bool writes) {
    pollfd ends[2]{{writes ? input.get() : -1, POLLOUT, 0}, {outputOpen ? output.get() : -1, POLLIN, 0}};
    ::poll(ends, 2, writes || outputOpen ? 100 : 20);
    readOutput();
  }
  [[noreturn]] void failed() {
    input.close();
    for (const auto until = Clock::now() + 1s; Clock::now() < until && !child->ended();) wait(false);
    if (!child->ended()) child->end();
    readOutput();
    const auto end = last.find_last_not_of("\r\n");
    fail(ErrorCode::io, "{} failed with exit status {}: {}", name, child->status(),
         end == last.npos ? "no message" : last.substr(0, end + 1));
  }
};

ChildWriter::ChildWriter(const std::vector<std::string>& arguments) {
  int inputs[2];
  // A socket, because a write to a pipe without a reader sends SIGPIPE.
  check(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, inputs) == 0, ErrorCode::io, "{}: cannot be run: {}",
        arguments[0], std::strerror(errno));
  Descriptor theirs(inputs[0]), ours(inputs[1]);
  ::fcntl(ours.get(), F_SETFL, O_NONBLOCK);
  Pipe output(arguments[0]);
  auto child = std::make_unique<Child>(arguments, environmentWith({}), theirs.get(), output.in.get(), output.in.get());
  state_.reset(new State{arguments[0], std::move(ours), std::move(output.out), std::move(child), {}, true});
}

ChildWriter::~ChildWriter() = default;

bool ChildWriter::write(std::span<const std::byte> bytes, const std::function<bool()>& shouldContinue) {
  while (!bytes.empty()) {
    if (!shouldContinue()) return false;
    state_->wait(true);
    const ssize_t sent = ::send(state_->input.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) bytes = bytes.subspan(std::size_t(sent));
    if (sent < 0 && errno != EAGAIN && errno != EINTR) state_->failed();
  }
  return true;
}

bool ChildWriter::finish(const std::function<bool()>& shouldContinue) {
  state_->input.close();
  while (!state_->child->ended()) {
    if (!shouldContinue()) return false;
    state_->wait(false);
  }
  if (state_->child->status() != 0) state_->failed();
  return true;
}

}  // namespace ibr
