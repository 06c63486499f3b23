// SPDX-License-Identifier: Apache-2.0
// `ibr view`: replaces this process by the viewer.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include "base/check.h"
#include "batch/command.h"
#include "shared/cli/options.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// Looks beside this program (installed), in the neighbouring folder (build tree), then along PATH.
std::string viewerProgram() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& file : {folder / "ibr-viewer", folder.parent_path() / "viewer/ibr-viewer"})
    if (fs::exists(file, error)) return file;
  return "ibr-viewer";
}

ExitCode view(const std::vector<std::string>& words) {
  std::string program = viewerProgram();
  std::vector<std::string> line{program};
  line.insert(line.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : line) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(program.c_str(), arguments.data());
  fail(ErrorCode::io, "{} cannot be started: {}; the viewer is only built if GLFW and Dear ImGui are installed",
       program, std::strerror(errno));
}

}  // namespace

const Command kViewCommand{.name = "view",
                           .summary = "Opens scenes in the viewer",
                           .examples = "ibr view scene\nibr view scene --preset fast --size 1280x720",
                           .details = "All arguments are passed to ibr-viewer; `ibr-viewer --help` lists its options.",
                           .afterInterrupt = "",
                           .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
                             passArgumentsOn(app);
                             return [&app](const Context&) { return view(remainingArguments(app)); };
                           }};

}  // namespace ibr::app
