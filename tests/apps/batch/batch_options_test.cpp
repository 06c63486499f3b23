// SPDX-License-Identifier: Apache-2.0
// Help, wrong command lines, wrong files, full disks: exit codes, and output on stdout or stderr.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

using namespace ibr;
using Catch::Contains;
using test::runProgram;

namespace {
const std::vector<std::string> kCommands{"build", "info", "validate", "render", "eval", "compare", "bench", "doctor"};
}

TEST_CASE("every command has help, with examples first") {
  for (const std::string& command : kCommands)
    for (const char* flag : {"--help", "-h"}) {
      const auto outcome = runProgram({command, flag});
      INFO(command);
      CHECK(outcome.code == 0);
      CHECK(outcome.err.empty());
      CHECK_THAT(outcome.out, Catch::StartsWith("Examples:\n  ibr " + command));
      CHECK(std::ranges::count(outcome.out, '\n') <= 60);
      CHECK_THAT(outcome.out, Contains("--help-all"));
    }
  for (const std::string& command : kCommands) {
    const auto all = runProgram({command, "--help-all"});
    CHECK(all.code == 0);
    for (const char* common : {"--json", "--device", "--seed", "--threads", "--quiet", "--verbose", "--version"})
      CHECK_THAT(all.out, Contains(common));
  }
  const auto outcome = runProgram({"--help"});
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.out, Catch::StartsWith("Examples:"));
  for (const std::string& command : kCommands) CHECK_THAT(outcome.out, Contains("\n  " + command + " "));
}

TEST_CASE("the program and every command print the version") {
  CHECK_THAT(runProgram({"--version"}).out, Catch::StartsWith("ibr 0."));
  for (const std::string& command : kCommands) CHECK_THAT(runProgram({command, "--version"}).out, Contains("ibr 0."));
}

TEST_CASE("a wrong command line gives exit code 1 and a message on stderr") {
  const std::vector<std::vector<std::string>> lines{
      {},
      {"nonsense"},
      {"optimise", "scene"},
      {"build"},
      {"build", "photos"},
      {"build", "photos", "-o"},
      {"build", "photos", "-o", "scene", "--dimension", "4"},
      {"build", "photos", "-o", "scene", "--max-size", "-1"},
      {"build", "photos", "-o", "scene", "--max-size", "12.5"},
      {"build", "photos", "-o", "scene", "--seed", "x"},
      {"build", "photos", "-o", "scene", "--seed", "-1"},
      {"build", "photos", "-o", "scene", "--threads", "1e3"},
      {"info"},
      {"info", "a", "b"},
      {"info", "a", "--nonsense"},
      {"render", "scene", "-o", "out"},
      {"render", "scene", "--poses", "p"},
      {"render", "scene", "--poses", "p", "--path", "auto:3", "-o", "out"},
      {"render", "scene", "--path", "auto", "-o", "out"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--ipd", "0.06"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--stereo", "--ipd", "0"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--fov", "180"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--colour", "paper"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--overlay", "heat"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--mute", "1,"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--solo", "-1"},
      {"render", "scene", "--path", "auto:0", "-o", "out"},
      {"render", "scene", "--path", "auto:4294967297", "-o", "out"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--size", "100"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--size", "0x100"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--size", "100x99999"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--tiers", "4"},
      {"build", "photos", "-o", "scene", "--texture", "bc2"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--vram-budget", "0"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--vram-budget", "M"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--vram-budget", "1.5T"},
      {"eval", "scene", "--truth", "t", "--vram-budget", "-1G"},
      {"bench", "scene", "--vram-budget", "1e30"},
      {"bench", "scene", "--formats", "--walk", "path.json"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--filter", "cubic"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--blocks", "no"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--cells", "0"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--cells", "65"},
      {"eval", "scene", "--truth", "t", "--morph", "theirs"},
      {"eval", "scene", "--truth", "t", "--order", "0"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--blend", "smooth"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--extrapolation", "nan"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--colour", "theirs"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--morph", "paper"},
      {"eval", "scene", "--truth", "t", "--colour-table", "linear"},
      {"eval", "scene", "--truth", "t", "--colour-samples", "1.01"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--extrapolation", "0,5"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--preset", "best"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--render-scale", "0"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--texture-scale", "0"},
      {"eval", "scene", "--truth", "t", "--eye-colours", "both"},
      {"render", "scene", "--path", "auto:3", "-o", "out", "--photographs", "17"},
      {"eval", "scene"},
      {"eval", "--truth", "t"},
      {"eval", "--leave-one-out"},
      {"eval", "--truth", "t", "--leave-one-out", "photographs"},
      {"eval", "scene", "--leave-one-out", "photographs"},
      {"eval", "--leave-one-out", "photographs", "--every", "0"},
      {"eval", "scene", "--truth", "t", "--every", "2"},
      {"eval", "scene", "--truth", "t", "--max-size", "100"},
      {"compare", "a.png"},
      {"compare", "a.png", "b.png", "--tolerance", "1", "2"},
      {"compare", "a.png", "b.png", "--tolerance", "1", "2", "256"},
      {"compare", "a.png", "b.png", "--tolerance", "1", "101", "3"},
      {"doctor", "photographs", "extra"},
  };
  for (const auto& line : lines) {
    std::string text;
    for (const std::string& word : line) text += word + ' ';
    INFO(text);
    const auto outcome = runProgram(line);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Contains("error:") && Contains("--help"));
  }
}

TEST_CASE("a misspelt option or command has the nearest name as suggestion") {
  CHECK_THAT(runProgram({"build", "photographs", "-o", "scene", "--max-szie=5"}).err,
             Contains("--max-szie is not an option; did you mean --max-size?"));
  CHECK_THAT(runProgram({"htm", "biuld"}).err, Contains("'biuld' is not a command; did you mean build?"));
  CHECK_THAT(runProgram({"biuld"}).err, Contains("'biuld' is not a command; did you mean build?"));
  CHECK_THAT(runProgram({"--foo", "htm"}).err, !Contains("'htm'"));
  CHECK_THAT(runProgram({"--foo", "htm", "biuld"}).err, Contains("'biuld' is not a command"));
  CHECK_THAT(runProgram({"htm"}).err, Contains("required"));
  CHECK_THAT(runProgram({"walrus"}).err, Contains("'walrus' is not a command\n"));
}

TEST_CASE("a missing file gives exit code 2 and a message that names the file") {
  test::TemporaryFolder folder;
  const std::string missing = folder / "missing";
  const std::vector<std::vector<std::string>> lines{
      {"build", missing, "-o", folder / "scene"},
      {"build", folder.path(), "-o", folder / "scene", "--model", missing},
      {"build", folder.path(), "-o", folder / "scene", "--model", folder.path(), "--exclude-from", missing},
      {"info", missing},
      {"render", missing, "--path", "auto:3", "-o", folder / "out"},
      {"eval", missing, "--truth", folder.path()},
      {"compare", missing, missing},
  };
  for (const auto& line : lines) {
    INFO(line[0] << ' ' << line[1]);
    const auto outcome = runProgram(line);
    CHECK(outcome.code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Contains("error:") && Contains(missing));
  }
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a folder without photographs and poses gives an error that counts the photographs") {
  test::TemporaryFolder folder;
  const auto outcome = runProgram({"build", folder.path(), "-o", folder / "scene"});
  CHECK(outcome.code == 3);
  CHECK_THAT(outcome.err, Contains(folder.path().string()) && Contains(" 0"));
}

TEST_CASE("a malformed file gives exit code 3 and a message that names the file") {
  test::TemporaryFolder folder;
  const std::string file = folder / "scene.gltf";
  writeFile(file, "{\"asset\":");
  writeFile(folder / "cameras.txt", "1 PINHOLE 10\n");
  writeFile(folder / "images.txt", "");
  writeFile(folder / "points3D.txt", "");
  const std::vector<std::vector<std::string>> lines{
      {"info", folder.path()},
      {"validate", folder.path()},
      {"render", folder.path(), "--path", "auto:3", "-o", folder / "out"},
      {"eval", folder.path(), "--truth", folder.path()},
      {"compare", file, file},
      {"build", folder.path(), "-o", folder / "out", "--model", folder.path()},
  };
  for (const auto& line : lines) {
    INFO(line[0]);
    const auto outcome = runProgram(line);
    CHECK(outcome.code == 3);
    CHECK_THAT(outcome.err + outcome.out, Contains(folder.path().string()));
    CHECK_THAT(outcome.err + outcome.out, Contains("scene.gltf") || Contains("cameras.txt") || Contains("/asset"));
  }
}

TEST_CASE("doctor lists the Vulkan devices") {
  if (!test::deviceIsThere()) return;
  const auto outcome = runProgram({"doctor", "--json", "-"});
  const auto report = test::parseJson(outcome.out);
  REQUIRE(!report.at("devices").empty());
  for (const auto& device : report.at("devices"))
    for (const char* key : {"index", "name", "driver", "type", "apiVersion", "memoryBytes", "features", "missing"})
      CHECK(device.contains(key));
  CHECK_THAT(runProgram({"doctor"}).out, Contains(report["devices"][0]["name"].get<std::string>()));
}

TEST_CASE("doctor reports disabled features, and unknown features are rejected", "[mask]") {
  CHECK_THAT(runProgram({"doctor", "--disable-feature", "bc,multiview"}).out, Contains("bc, multiview"));
  const auto byEnvironment =
      test::parseJson(runProgram({"doctor", "--json", "-"}, {.environment = {"IBR_DISABLE_FEATURES=int64"}}).out);
  CHECK(byEnvironment.at("disabledFeatures") == std::vector<std::string>{"int64"});
  const auto report = test::parseJson(runProgram({"doctor", "--json", "-", "--disable-feature", "bc"}).out);
  CHECK(report.at("disabledFeatures") == std::vector<std::string>{"bc"});
  const auto wrong = runProgram({"doctor", "--disable-feature", "bc,teleport"});
  CHECK(wrong.code == 1);
  CHECK_THAT(wrong.err, Contains("--disable-feature") && Contains("teleport") && Contains("int64-atomics"));
  CHECK(runProgram({"doctor"}, {.environment = {"IBR_DISABLE_FEATURES=teleport"}}).code == 3);
}

TEST_CASE("a report or a result that cannot be written gives exit code 2") {
  CHECK(runProgram({"doctor"}, {.out = "/dev/full"}).code == 2);
  CHECK(runProgram({"--help"}, {.out = "/dev/full"}).code == 2);
  CHECK(runProgram({"doctor", "--json", "/dev/full"}).code == 2);
  CHECK(runProgram({"doctor", "--json", "-"}, {.out = "/dev/full"}).code == 2);
  CHECK(runProgram({"doctor", "--json", "/no/such/folder/a.json"}).code == 2);
}

TEST_CASE("messages have colours only on a terminal and without NO_COLOR") {
  const std::vector<std::string> wrong{"info", "/no/such/scene"};
  CHECK_THAT(runProgram(wrong, {.environment = {"TERM=xterm"}}).err, !Contains("\033"));
  CHECK_THAT(runProgram(wrong, {.environment = {"TERM=xterm", "NO_COLOR="}, .terminal = true}).err,
             Contains("\033[1;31m"));
  CHECK_THAT(runProgram(wrong, {.environment = {"TERM=xterm", "NO_COLOR=1"}, .terminal = true}).err, !Contains("\033"));
  CHECK_THAT(runProgram(wrong, {.environment = {"TERM=dumb"}, .terminal = true}).err, !Contains("\033"));
}

TEST_CASE("view passes its arguments to the viewer in their order and returns the viewer's exit code") {
  const test::TemporaryFolder folder;
  const std::filesystem::path program = folder / "ibr", viewer = folder / "ibr-viewer";
  std::filesystem::copy_file(IBR_PROGRAM, program);
  writeFile(viewer, std::string_view("#!/bin/sh\nprintf '%s ' \"$@\"\nexit 7\n"));
  std::filesystem::permissions(viewer, std::filesystem::perms::owner_all);
  const auto outcome =
      runProgram({"view", "a scene", "--preset", "fast", "-q", "--size", "64x48"}, {.program = program.string()});
  CHECK(outcome.code == 7);
  CHECK(outcome.out == "a scene --preset fast -q --size 64x48 ");
}
