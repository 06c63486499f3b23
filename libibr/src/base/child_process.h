// SPDX-License-Identifier: Apache-2.0
// Runs another program to its end and reads its output, line by line or as bytes.

// Runs another program to its end and reads its output line by line, or writes its input.
#pragma once

#include <cstddef>
#include <functional>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ibr {

struct ChildResult {
  int status = 0;        // exit status, or 128 plus the signal that ended the program
  bool stopped = false;  // ended because shouldContinue returned false
};

/// Runs `arguments[0]`, searched along PATH unless the name has a folder. The environment is ours, overridden by
/// `environment` (names and values); stdin is empty. `line` receives the lines of stdout and stderr without line ends;
/// lines over 64 KiB arrive in pieces. `shouldContinue` is called at least ten times a second. When shouldContinue
/// returns false, the program and its children are ended (SIGTERM, after three seconds SIGKILL) and waited for. Throws
/// Error{io} if the program cannot be started.
ChildResult runChild(const std::vector<std::string>& arguments,
                     const std::vector<std::pair<std::string, std::string>>& environment,
                     const std::function<void(std::string_view)>& line, const std::function<bool()>& shouldContinue);

struct ChildOutput {
  int status = 0;         // as ChildResult::status
  bool stopped = false;   // ended because `output` or shouldContinue returned false
  std::string lastWords;  // the end of stderr, at most 4 KiB
};

/// Runs a program whose stdin is a seekable file of the bytes `input`. `output` receives stdout piece by piece, and
/// returns false to end the program. Otherwise as runChild.
ChildOutput readChild(const std::vector<std::string>& arguments, std::span<const std::byte> input,
                      const std::function<bool(std::span<const std::byte>)>& output,
                      const std::function<bool()>& shouldContinue);

/// A running program that reads bytes from stdin, such as raw frames for ffmpeg. Its output is read all the time; only
/// the end is kept, for errors. Used by one thread at a time.
class ChildWriter {
 public:
  /// Starts `arguments[0]` as runChild does, with our environment. Throws Error{io} if the program cannot be started.
  explicit ChildWriter(const std::vector<std::string>& arguments);
  /// Ends the program if it still runs, as runChild does when it is stopped.
  ~ChildWriter();
  ChildWriter(const ChildWriter&) = delete;
  ChildWriter& operator=(const ChildWriter&) = delete;

  /// Writes all bytes to stdin. Returns false as soon as shouldContinue, called at least ten times a second, does.
  /// Throws Error{io} with the last lines of the program's output if the program ends or closes stdin.
  bool write(std::span<const std::byte> bytes, const std::function<bool()>& shouldContinue);
  /// Closes stdin and waits for the program's end. Returns false as soon as shouldContinue does. Throws Error{io} with
  /// the last lines of the program's output if the exit status is not 0.
  bool finish(const std::function<bool()>& shouldContinue);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
