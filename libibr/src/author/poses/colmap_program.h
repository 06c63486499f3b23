// SPDX-License-Identifier: Apache-2.0
// Runs the program COLMAP, command by command, in a folder that records which commands have finished.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/child_process.h"
#include "ibr/log.h"

namespace ibr {

class ColmapProgram {
 public:
  /// `program`: searched along PATH unless it contains a folder. `progress` may be empty; it must outlive the object.
  ColmapProgram(std::string program, std::filesystem::path folder, const ProgressCallback& progress)
      : program_(std::move(program)), folder_(std::move(folder)), progress_(progress) {}

  /// Prefixes of options that were renamed in COLMAP 4. Throws Error{io} if the program cannot be started.
  struct OptionNames {
    std::string extraction, matching;
  };
  OptionNames optionNames(const char* stage) const;

  /// Marker file of a finished command. `mark` distinguishes several runs of a command.
  std::filesystem::path doneFile(const std::string& mark, const std::string& command) const {
    return folder_ / (mark + command + ".done");
  }

  /// Runs a command unless it has finished before; output is appended to MARK COMMAND .log. Reports progress, in
  /// photographs unless COLMAP reports otherwise. A mapper that finds no model is neither finished nor an error. Throws
  /// Error: io if the program is missing or fails, with its last lines; cancelled.
  void run(const std::string& mark, const std::string& command, const char* stage,
           const std::vector<std::string>& arguments, std::size_t photographs) const;

 private:
  bool reportProgress(const char* stage, std::size_t done, std::size_t total) const;
  ChildResult runLine(const std::vector<std::string>& line, const std::function<void(std::string_view)>& print,
                      const std::function<bool()>& shouldContinue) const;

  std::string program_;
  std::filesystem::path folder_;
  const ProgressCallback& progress_;
};

}  // namespace ibr
