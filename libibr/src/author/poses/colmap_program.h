// SPDX-License-Identifier: Apache-2.0
// The program COLMAP, run command by command in a folder that tells which commands were run to their end.
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
  /// `program`: looked for along PATH unless it names a folder. `progress` may be empty; it must outlive the object.
  ColmapProgram(std::string program, std::filesystem::path folder, const ProgressCallback& progress)
      : program_(std::move(program)), folder_(std::move(folder)), progress_(progress) {}

  /// Names of options that are called otherwise from version 4 on. Throws Error{io} where the program cannot be
  /// started.
  struct OptionNames {
    std::string extraction, matching;
  };
  OptionNames optionNames(const char* stage) const;

  /// Of a command that was run to its end. `mark` tells several runs of a command apart.
  std::filesystem::path doneFile(const std::string& mark, const std::string& command) const {
    return folder_ / (mark + command + ".done");
  }

  /// Runs a command unless it has been run to its end before; what it prints goes to MARK COMMAND .log. Tells its
  /// progress, in photographs where it says nothing else. A mapper that finds no model is not done, and no fault.
  /// Throws Error: io where the program is missing or fails, with its last lines; cancelled.
  void run(const std::string& mark, const std::string& command, const char* stage,
           const std::vector<std::string>& arguments, std::size_t photographs) const;

 private:
  bool wanted(const char* stage, std::size_t done, std::size_t total) const;
  ChildResult runLine(const std::vector<std::string>& line, const std::function<void(std::string_view)>& print,
                      const std::function<bool()>& goesOn) const;

  std::string program_;
  std::filesystem::path folder_;
  const ProgressCallback& progress_;
};

}  // namespace ibr
