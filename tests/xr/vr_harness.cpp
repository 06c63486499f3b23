// SPDX-License-Identifier: Apache-2.0
#include "vr_harness.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "io/image_file.h"
#include "shared/draw/picture_record.h"
#include "support/json.h"

namespace fs = std::filesystem;

namespace ibr::test {

using Catch::Contains;
using nlohmann::json;

namespace {

fs::path logOf(const XrSetup& setup) {
  return setup.folder() / "log";
}

std::vector<std::string> arguments(const XrSetup& setup, std::vector<std::string> more) {
  more.insert(more.begin(), {tinyScene(), "--validation", "--no-mirror", "--json", "-", "--log", logOf(setup)});
  return more;
}

RunOptions options(const XrSetup& setup, const std::vector<std::string>& environment) {
  RunOptions all{.program = IBR_VR, .environment = setup.environment()};
  all.environment.insert(all.environment.end(), environment.begin(), environment.end());
  return all;
}

}  // namespace

RemoteState lookingAhead(glm::dvec3 head) {
  RemoteState state;
  state.head.position = head;
  state.ownEyes = true;
  state.eyes[0] = {{{-0.031, 0.002, 0}, {1, 0, 0, 0}}, {-0.62, 0.5, 0.48, -0.55}};
  state.eyes[1] = {{{0.033, 0, 0.001}, {1, 0, 0, 0}}, {-0.5, 0.6, 0.5, -0.52}};
  state.left.there = state.right.there = false;
  return state;
}

Visitor::Visitor(XrSetup& setup, std::vector<std::string> more, std::vector<std::string> environment)
    : setup_(setup), program_(arguments(setup, std::move(more)), options(setup, environment)) {}

void Visitor::move(const RemoteState& state) {
  const bool moved = setup_.move(program_, state);
  INFO(program_.err());
  REQUIRE(moved);
}

void Visitor::pass(int frames) {
  const bool passed = setup_.pass(program_, frames);
  INFO(program_.err());
  REQUIRE(passed);
}

void Visitor::waitForScene() {
  // The log has a line only for frames of a scene. The scene fades in within a fifth of a second.
  const auto lines = [&] {
    std::ifstream in(logOf(setup_));
    return std::count(std::istreambuf_iterator<char>(in), {}, '\n');
  };
  const bool came = program_.runsUntil([&] { return lines() >= 15; });
  INFO(program_.err());
  REQUIRE(came);
}

json Visitor::leave() {
  program_.interrupt();
  const Outcome outcome = program_.finish();
  INFO(outcome.err);
  CHECK(outcome.code == 130);
  CHECK_THAT(outcome.err, !Contains("Vulkan validation") && !Contains("validation layers"));
  return parseJson(outcome.out);
}

Outcome Visitor::finish() {
  const Outcome outcome = program_.finish();
  UNSCOPED_INFO(outcome.err);
  CHECK_THAT(outcome.err, !Contains("Vulkan validation") && !Contains("validation layers"));
  return outcome;
}

std::vector<json> shownFrames(const XrSetup& setup) {
  std::vector<json> frames = setup.frames();
  std::erase_if(frames, [](const json& frame) { return frame["layers"].empty(); });
  return frames;
}

std::array<fs::path, 2> lastPictures(const fs::path& folder) {
  // Skips the last images, which may be incomplete.
  std::vector<fs::path> rights;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().string().ends_with("_r.png")) rights.push_back(entry.path());
  REQUIRE(rights.size() > 1);
  std::ranges::sort(rights);
  const std::string right = rights[rights.size() - 2].string();
  return {right.substr(0, right.size() - 6) + "_l.png", right};
}

std::array<Camera, 2> viewsIn(const std::array<fs::path, 2>& pictures) {
  return {app::readRecord(pictures[0]).value().camera, app::readRecord(pictures[1]).value().camera};
}

std::array<Image8, 2> drawnAgain(const XrSetup& setup, const fs::path& left, const fs::path& folder,
                                 const std::vector<std::string>& more) {
  const nlohmann::ordered_json settings = app::readRecord(left).value().settings;
  std::vector<std::string> words{"render", tinyScene(), "--poses", left, "--stereo", "-o", folder};
  words.insert(words.end(), more.begin(), more.end());
  for (const auto& [setting, option] : {std::pair{"floor", "--floor"}, {"floorSpacing", "--floor-spacing"}})
    if (settings.at(setting).is_number()) words.insert(words.end(), {option, jsonLine(settings.at(setting))});
  const Outcome outcome = runProgram(words, {.environment = setup.environment()});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  std::string name = left.filename();
  const fs::path drawnLeft = folder / name;
  name[name.rfind('l', name.size() - 5)] = 'r';
  return {readImage(drawnLeft), readImage(folder / name)};
}

}  // namespace ibr::test
