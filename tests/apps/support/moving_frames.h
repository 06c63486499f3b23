// SPDX-License-Identifier: Apache-2.0
// A small moving figure as 3D video, for tests of the program `ibr`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ibr::test {

/// Output of `ibr-lab synth moving`: three frames of 96 × 96 px, made once.
const std::filesystem::path& movingFrames();

/// Command line of `ibr htm sequence` with few faces and a JSON report.
std::vector<std::string> sequenceCommand(const std::filesystem::path& frames, const std::filesystem::path& output,
                                         const std::vector<std::string>& options = {});

}  // namespace ibr::test
