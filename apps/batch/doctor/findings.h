// SPDX-License-Identifier: Apache-2.0
// Findings of `ibr doctor`: sentences, each with a remedy.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/advice.h"
#include "ibr/author/poses.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct BuildChoices;
struct ExaminedPhotograph;

struct Finding {
  std::string subject;  // "device", "memory", "file", "exposure", …: in reports
  Severity severity;
  std::string sentence, remedy;
  ExitCode code = kExitInvalidInput;  // exit code if the finding is serious
};

class Findings {
 public:
  void add(Finding finding) { list_.push_back(std::move(finding)); }
  /// Adds a short statement without a problem; printed before the findings.
  void fact(std::string text);

  /// Adds a Vulkan device, as Device::list describes it, to the report.
  void device(nlohmann::ordered_json device) { devices_.push_back(std::move(device)); }

  /// Prints the most serious first; at most a few of each subject and severity.
  void print(const Context& context) const;
  /// Returns {"facts": […], "findings": [{"subject", "severity", "problem", "remedy"}]}; "devices" and
  /// "disabledFeatures" too if the machine has Vulkan devices.
  nlohmann::ordered_json json() const;
  /// Returns kExitOk if no finding is serious, else the code of the first serious one.
  ExitCode code() const;

 private:
  std::vector<Finding> sorted() const;

  std::vector<Finding> list_;
  std::vector<std::string> facts_;
  std::vector<nlohmann::ordered_json> devices_;
};

/// Lists names: "A", "A and B", "A, B and C", "A, B and 7 more".
std::string someOf(const std::vector<std::string>& names);

/// Examines devices, drivers, the programs that ibr starts, memory, disk, display and headset.
void examineMachine(Findings& findings, const Context& context);

/// Examines a folder of photographs, given masks, and poses, which may be given or found in or beside the folder.
/// Throws Error{io} if a folder cannot be read, Error{cancelled}.
void examinePhotographs(const std::filesystem::path& folder, const BuildChoices& choices, Findings& findings,
                        const Context& context);

/// Reports masks that a build cannot use, and masks without a photograph. Throws Error{io} if the folder is missing.
void examineMasks(const std::filesystem::path& folder, const std::vector<ExaminedPhotograph>& photographs,
                  Findings& findings);

/// Reports photographs without a pose, large reprojection errors, unconnected groups, and steps too large for the
/// depth. `pictures`: names of the existing photographs, sorted.
void examinePoses(const PosedModel& model, const std::vector<std::string>& pictures, Findings& findings);

}  // namespace ibr::app
