// SPDX-License-Identifier: Apache-2.0
#include "moving_frames.h"

#include <catch2/catch.hpp>

#include "run_program.h"
#include "support/temporary_folder.h"

namespace ibr::test {

const std::filesystem::path& movingFrames() {
  static const TemporaryFolder folder;
  static const std::filesystem::path frames = [] {
    REQUIRE(
        runLab({"synth", "moving", "-o", folder / "frames", "--frames", "3", "--views", "1", "--size", "96x96"}).code ==
        0);
    return std::filesystem::path(folder / "frames");
  }();
  return frames;
}

std::vector<std::string> sequenceCommand(const std::filesystem::path& frames, const std::filesystem::path& output,
                                         const std::vector<std::string>& options) {
  std::vector<std::string> command{"htm",      "sequence", frames.string(), "-o", output.string(), "--faces", "60",
                                   "--rounds", "1",        "--adjust",      "0",  "--json",        "-"};
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

}  // namespace ibr::test
