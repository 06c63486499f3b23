// SPDX-License-Identifier: Apache-2.0
// Fails the N-th call that creates or writes a file, as on a full disk, N = 0, 1, … until none is left, in all commands
// that write (failing_writes.c). Afterwards the exit code is 2, the message names a file, no temporary file remains,
// existing files are complete, and the same command succeeds.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

namespace {

/// Returns the failed call; empty if no call failed.
std::string failWrite(int n, const fs::path& below, const std::vector<std::string>& command, Outcome& outcome) {
  const TemporaryFolder notes;
  RunOptions options;
  options.environment = {"LD_PRELOAD=" IBR_FAILING_WRITES, fmt::format("IBR_FAIL_WRITE={}", n),
                         "IBR_FAIL_BELOW=" + below.string(), "IBR_FAIL_REPORT=" + (notes / "failure").string(),
                         "XDG_CACHE_HOME=" + (notes / "cache").string()};
  outcome = runProgram(command, options);
  return fs::exists(notes / "failure") ? readTextFile(notes / "failure") : std::string();
}

void expectNoDraft(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    CAPTURE(entry.path().string());
    CHECK(entry.path().extension() != ".tmp");
  }
}

/// `command` writes only below `out`. Every `step`-th write fails, or every write if IBR_EVERY_FAULT is set. A failure
/// may be ignored (`madeGood`) only if the file is a cache.
int walk(const char* name, const fs::path& out, const std::vector<std::string>& command, int step) {
  if (std::getenv("IBR_EVERY_FAULT")) step = 1;
  int failures = 0, madeGood = 0;
  for (int n = 0;; n += step) {
    fs::remove_all(out);
    Outcome outcome;
    const std::string failed = failWrite(n, out, command, outcome);
    INFO(name << ", write " << n << ": " << failed << "\n" << outcome.err);
    if (failed.empty()) {
      CHECK(outcome.code == 0);
      break;
    }
    ++failures;
    if (outcome.code == 0) ++madeGood;
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err, Catch::Contains(out.string()));
    expectNoDraft(out);
    if (failures % 5 == 1) {
      const Outcome again = runProgram(command);
      INFO(again.err);
      CHECK(again.code == 0);
    }
  }
  std::printf("%s: %d writes failed, %d recovered\n", name, failures, madeGood);
  return failures;
}

}  // namespace

TEST_CASE("a failed write of build is reported, leaves no partial file, and the build continues when run again",
          "[P2]") {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  CHECK(walk("build", out, {"build", tinySet().photographs, "-o", out}, 5) >= 4);
}

TEST_CASE("a failed write of optimise is reported and leaves no partial file", "[P2]") {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  CHECK(walk("optimise", out, {"optimise", tinyScene(), "-o", out, "--method", "cpu"}, 7) >= 3);
}

TEST_CASE("a failed write of render or eval is reported and leaves no partial file", "[P2]") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  CHECK(walk("render", out, {"render", tinyScene(), "--path", "auto:2", "--size", "32x24", "-o", out}, 1) >= 6);
  CHECK(walk("eval", out, {"eval", tinyScene(), "--truth", tinySet().truth, "-o", out}, 2) >= 2);
}

TEST_CASE("a failed write of a drawing or a report is reported", "[P2]") {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  CHECK(walk("info", out, {"info", tinyScene(), "--svg", out}, 1) >= 4);
  CHECK(walk("report", out, {"info", tinyScene(), "--json", out}, 1) >= 4);
}
