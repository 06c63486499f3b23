// SPDX-License-Identifier: Apache-2.0
// What `ibr doctor` finds: sentences, each with its remedy.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/advice.h"
#include "ibr/author.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct BuildChoices;
struct ExaminedPhotograph;

struct Finding {
  std::string subject;  // "device", "memory", "file", "exposure", …: of reports
  Severity severity;
  std::string sentence, remedy;
  ExitCode code = kExitInvalidInput;  // of the program, where it is serious
};

class Findings {
 public:
  void add(Finding finding) { list_.push_back(std::move(finding)); }
  /// What is right, in a few words: printed before the rest.
  void fact(std::string text) { facts_.push_back(std::move(text)); }

  /// The most serious first; at most a few of one subject and severity are printed.
  void print(const Context& context) const;
  /// {"facts": […], "findings": [{"subject", "severity", "sentence", "remedy"}]}
  nlohmann::ordered_json json() const;
  /// kExitOk where nothing is serious, else the code of the first that is.
  ExitCode code() const;

 private:
  std::vector<Finding> sorted() const;

  std::vector<Finding> list_;
  std::vector<std::string> facts_;
};

/// "A", "A and B", "A, B and C", "A, B and 7 more".
std::string someOf(const std::vector<std::string>& names);

/// Devices, drivers, the programs that ibr starts, memory, disk, display, headset.
void examineMachine(Findings& findings, const Context& context);

/// A folder of photographs, and their poses and masks, where they are given or, poses, found in it or beside it. Throws
/// Error{io} where a folder cannot be read, Error{cancelled}.
void examinePhotographs(const std::filesystem::path& folder, const BuildChoices& choices, Findings& findings,
                        const Context& context);

/// Masks that a build could not use, and those of no photograph. Throws Error{io} where there is no such folder.
void examineMasks(const std::filesystem::path& folder, const std::vector<ExaminedPhotograph>& photographs,
                  Findings& findings);

/// Poses: photographs without one, errors of points, parts that share nothing, steps too large for what is near.
/// `pictures`: names of those that there are, sorted.
void examinePoses(const PosedModel& model, const std::vector<std::string>& pictures, Findings& findings);

}  // namespace ibr::app
