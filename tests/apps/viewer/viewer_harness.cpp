// SPDX-License-Identifier: Apache-2.0
#include "viewer_harness.h"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "support/json.h"

namespace fs = std::filesystem;

namespace ibr::test {
namespace {

// A key press and its release take one frame each; then one frame acts on the key and one draws the effect.
constexpr int kFrames = 5;

}  // namespace

using Catch::Contains;
using nlohmann::json;

Outcome view(std::vector<std::string> arguments, std::vector<std::string> environment) {
  for (const char* word : {"--forget", "--validation", "--json", "-"}) arguments.emplace_back(word);
  const auto outcome = runProgram(arguments, {.program = IBR_VIEWER, .environment = std::move(environment)});
  CHECK_THAT(outcome.err, !Contains("Vulkan validation") && !Contains("validation layers"));
  return outcome;
}

bool comes(const std::function<bool()>& what) {
  for (int tries = 0; tries < 600; ++tries, sleepFor(0.1))
    if (what()) return true;
  return false;
}

void waitForPlace(const std::string& window) {
  comes([&] { return xdotool({"getwindowname", window}).find(" - ibr") != std::string::npos; });
}

Image8 settledPixels(const std::string& window) {
  Image8 pixels, before;
  int same = 0;  // times in a row, because a busy machine may take long for a frame
  comes([&] {
    sleepFor(0.4);
    waitForFrames(window, kFrames);
    before = std::exchange(pixels, pixelsOf(window));
    same = pixels.width > 0 && pixels.values == before.values ? same + 1 : 0;
    return same == 2;
  });
  return pixels;
}

json whileViewing(std::vector<std::string> arguments, const std::function<void(const std::string& window)>& act,
                  std::vector<std::string> environment) {
  Outcome outcome;
  {
    const bool opens = fs::exists(fs::path(arguments[0]) / "scene.gltf");
    const Hands hands([&](const std::string& window) {
      if (opens) waitForPlace(window);
      act(window);
    });
    outcome = view(std::move(arguments), std::move(environment));
  }
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return parseJson(outcome.out);
}

bool canView() {
  return deviceIsThere() && displayIsThere();
}

glm::dvec3 positionOf(const json& place) {
  return {place["position"][0], place["position"][1], place["position"][2]};
}

glm::dquat rotationOf(const json& place) {
  const json& q = place["rotation"];
  return {q[3].get<double>(), q[0].get<double>(), q[1].get<double>(), q[2].get<double>()};
}

void act(const std::vector<std::string>& arguments) {
  xdotool(arguments);
  std::string window = xdotool({"getactivewindow"});
  window.erase(window.find_last_not_of('\n') + 1);
  waitForFrames(window, kFrames);
}

void hold(const char* key, double seconds) {
  act({"keydown", key});
  sleepFor(seconds);
  act({"keyup", key});
}

void recordPath() {
  pressAll({"k", "p"});
  hold("w", 0.4);
  pressAll({"k"});
}

void pressAll(const std::vector<std::string>& keys) {
  for (const std::string& key : keys) act({"key", "--delay", "0", key});  // press and release between two frames
}

void makeModel(const TemporaryFolder& folder) {
  BumpyOptions body;
  body.cameras = 4;
  body.longitudes = 12;
  body.latitudes = 8;
  writeHtmFiles(bumpyModel(body), folder / "files");
  REQUIRE(runProgram({"htm", "build", "--mesh", folder / "files/mesh.obj", "--model", folder / "files/sparse",
                      "--images", folder / "files/images", "-o", folder / "model", "--faces", "0", "--rounds", "1",
                      "--adjust", "0", "--radius", "2"})
              .code == 0);
}

bool sameBesidePanel(const Image8& window, const Image8& picture) {
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 240; ++x)
      if (!std::ranges::equal(window.pixel(x, y), picture.pixel(x, y))) return false;
  return true;
}

bool hasFfmpeg() {
  return std::system("command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null") == 0;
}

}  // namespace ibr::test
