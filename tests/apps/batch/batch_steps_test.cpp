// SPDX-License-Identifier: Apache-2.0
// `ibr build --steps` and `--step`.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::runProgram;

namespace {

using Words = std::vector<std::string>;

struct Step {
  std::string name, output;
  Words arguments, inputs;
};

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// A row of five photographs with a step for each two of them.
Words rowArguments(const test::TemporaryFolder& folder, const std::string& scene) {
  return {"build", folder / "row", "-o", folder / scene, "--photographs-per-step", "2"};
}

// Writes three panoramas of a generated room, and panoramas.json, into `folder`.
void writePanoramas(const fs::path& folder) {
  SyntheticOptions options;
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {0.6, 0, 0}, {0.3, 0.05, -0.5}})
    options.cameras.push_back({{CameraModel::equirectangular, 256, 128}, {at, {1, 0, 0, 0}}});
  options.planes = roomPlanes({-2.5, -1.6, -3.5}, {3.6, 1.9, 2.2}, 0.25, 7);
  const SyntheticScene room = makeScene(options);
  std::string entries;
  for (std::size_t i = 0; i < options.cameras.size(); ++i) {
    const glm::dvec3 at = options.cameras[i].pose.position;
    writeImage(folder / fmt::format("{}.png", i), room.photographs[i]);
    entries +=
        fmt::format(R"({}{{"name": "{}.png", "position": [{}, {}, {}], "q_world_to_camera_wxyz": [0, 1, 0, 0]}})",
                    i ? ", " : "", i, at.x, at.y, at.z);
  }
  writeFile(folder / "panoramas.json", R"({"width": 256, "height": 128, "panoramas": [)" + entries + "]}");
}

std::vector<Step> stepsOf(const Words& build) {
  const auto listed = runProgram(joined(build, {"--steps"}));
  INFO(listed.err);
  REQUIRE(listed.code == 0);
  const auto report = test::parseJson(listed.out);
  std::vector<Step> steps;
  std::map<std::string, double> seconds;
  for (const auto& step : report.at("steps")) {
    seconds[step.at("name")] = step.at("seconds");
    CHECK(step.at("seconds") > 0);
    CHECK(step.at("memory") > 1e7);
    steps.push_back({step.at("name"), step.at("output"), step.at("arguments"), step.at("inputs")});
  }
  CHECK(seconds.at("tracks") > seconds.at("model"));  // plans depth
  CHECK(seconds.at("scene") > seconds.at("tracks"));  // plans depth again
  return steps;
}

const Step& named(const std::vector<Step>& steps, const std::string& name) {
  const auto found = std::ranges::find(steps, name, &Step::name);
  REQUIRE(found != steps.end());
  return *found;
}

void run(const Step& step) {
  const auto outcome = runProgram(step.arguments);
  INFO(step.name << ": " << outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(fs::exists(step.output));
}

bool isReady(const Step& step) {
  return std::ranges::all_of(step.inputs, [](const std::string& input) { return fs::exists(input); });
}

std::set<std::string> cachedFiles(const fs::path& output, const std::string& kind) {
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(output.parent_path() / ".build"))
    if (entry.path().extension() == kind) files.insert(entry.path().filename().string());
  return files;
}

// The last step reads depth and cells from the cache.
void runSceneStep(const Step& step) {
  const auto depths = cachedFiles(step.output, ".depth");
  const auto outcome = runProgram(joined(step.arguments, {"--json", "-"}));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(cachedFiles(step.output, ".depth") == depths);
  const auto report = test::parseJson(outcome.out);
  REQUIRE(!report.at("cells").empty());
  for (const auto& cell : report["cells"]) CHECK(cell.at("resumed") == true);
  CHECK(report.at("usage").at("step") == "scene");
  CHECK(report["usage"].at("readBytes") > 1e5);
}

// Runs the steps in a random order in which each follows the steps that it needs.
void runInRandomOrder(std::vector<Step> steps, unsigned seed) {
  std::mt19937 random(seed);
  while (!steps.empty()) {
    std::ranges::shuffle(steps, random);
    const auto next = std::ranges::find_if(steps, isReady);
    REQUIRE(next != steps.end());
    if (next->name == "scene")
      runSceneStep(*next);
    else
      run(*next);
    steps.erase(next);
  }
}

// Files of a scene but its cache.
std::map<std::string, std::string> sceneFiles(const fs::path& scene) {
  auto files = test::contentsBelow(scene);
  std::erase_if(files, [](const auto& file) { return file.first.starts_with(".build/"); });
  CHECK(files.contains("scene.gltf"));
  return files;
}

std::map<std::string, std::string> builtInOneProcess(const test::TemporaryFolder& folder, const Words& options) {
  const auto outcome = runProgram(joined({"build", folder / "row", "-o", folder / "one"}, options));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return sceneFiles(folder / "one");
}

}  // namespace

TEST_CASE("the list of steps has photographs, the model and outputs of earlier steps as inputs") {
  const test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  const std::vector<Step> steps = stepsOf(rowArguments(folder, "scene"));
  CHECK(!fs::exists(folder / "scene/scene.gltf"));
  std::set<std::string> outputs, photographs;
  for (const Step& step : steps) {
    INFO(step.name);
    for (const std::string& input : step.inputs) {
      CHECK((fs::exists(input) || outputs.contains(input)));
      if (input.ends_with(".png")) photographs.insert(input);
    }
    CHECK(outputs.insert(step.output).second);
    CHECK_THAT(step.arguments.back(), Contains(step.name));
  }
  CHECK(photographs.size() == 5);
  CHECK(steps.front().name == "model");
  CHECK(steps.back().name == "scene");
  for (const char* kind : {"photographs", "depth", "cells"})
    CHECK(std::ranges::count_if(steps, [&](const Step& step) { return step.name.starts_with(kind); }) == 3);
}

TEST_CASE("steps in any order of their dependencies give the scene of one process") {
  const test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  Words options;
  SECTION("tracks of the model") {}
  SECTION("panoramas") {
    fs::remove_all(folder / "row");
    fs::create_directories(folder / "row");
    writePanoramas(folder / "row");
    options = {"--panoramas", folder / "row/panoramas.json"};
  }
  SECTION("own tracks") {
    options = {"--tracks", "own", "--depth", "fine"};
  }
  SECTION("masks, which are stored without a photograph's metadata") {
    Image8 mask(192, 144, 1, 255);
    for (int x = 0; x < 60; ++x)
      for (int y = 0; y < 50; ++y) mask.pixel(x, y)[0] = 0;
    fs::create_directories(folder / "masks");
    writeImage(folder / "masks/row1.png", mask);
    options = {"--masks", folder / "masks", "--strip-metadata", "--texture", "bc7"};
  }
  SECTION("lens distortion, which the model's points do not fit exactly") {
    std::string cameras = readTextFile(folder / "row/sparse/cameras.txt");
    for (std::size_t at = 0; (at = cameras.find("PINHOLE", at)) != cameras.npos;) {
      cameras.replace(at, 7, "OPENCV");
      cameras.insert(cameras.find('\n', at), " 0.02 0 0 0");
    }
    writeFile(folder / "row/sparse/cameras.txt", std::string_view(cameras));
  }
  const auto one = builtInOneProcess(folder, options);
  runInRandomOrder(stepsOf(joined(rowArguments(folder, "scene"), options)), unsigned(options.size()));
  CHECK((sceneFiles(folder / "scene") == one));
}

TEST_CASE("a step that is killed and repeated, or run twice at the same time, gives the same scene") {
  const test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  const auto one = builtInOneProcess(folder, {});
  for (const Step& step : stepsOf(rowArguments(folder, "scene"))) {
    if (step.name != "scene") {
      test::RunningProgram killed(step.arguments);
      if (step.name.starts_with("depth"))
        killed.runsUntil([&] { return killed.err().find("finding depth") != std::string::npos; });
    }
    test::RunningProgram first(step.arguments), second(step.arguments);
    for (test::RunningProgram* program : {&first, &second}) {
      const auto outcome = program->finish();
      INFO(step.name << ": " << outcome.err);
      CHECK(outcome.code == 0);
    }
    CHECK(fs::exists(step.output));
  }
  CHECK((sceneFiles(folder / "scene") == one));
}

TEST_CASE("a step repairs damaged results, and reports inputs that do not fit") {
  const test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  const Words build = rowArguments(folder, "scene");
  const std::vector<Step> steps = stepsOf(build);
  const auto refused = [&](const Words& arguments, const std::string& text) {
    const auto outcome = runProgram(arguments);
    CHECK(outcome.code != 0);
    CHECK_THAT(outcome.err, Contains(text));
  };
  refused(named(steps, "tracks").arguments, "run the step model first");
  for (const char* name : {"model", "photographs-0000", "photographs-0001", "photographs-0002", "tracks", "depth-0000"})
    run(named(steps, name));
  refused(named(steps, "confirmed").arguments, "run the step depth-0001 first");
  refused(joined(named(steps, "depth-0001").arguments, {"--seed", "2"}), "was made with other options");
  refused(joined(build, {"--step", "depth-0009"}), "none of them has the number 9");
  refused(joined(build, {"--step", "deep"}), "there is no step");
  refused(joined(build, {"--step", "model", "--draft"}), "draft");
  refused(joined(build, {"--step", "model", "--movers", "remove"}), "moving objects");
  refused(joined(build, {"--steps", "--refine-poses", "on"}), "ibr refine");

  std::string depth;
  for (const auto& entry : fs::directory_iterator(folder / "scene/.build"))
    if (entry.path().extension() == ".depth") depth = entry.path().string();
  const std::string found = readTextFile(depth);
  writeFile(depth, std::string_view(found).substr(0, found.size() / 2));
  run(named(steps, "depth-0000"));
  CHECK(readTextFile(depth) == found);
  writeFile(folder / "row/row4.png", std::string_view(readTextFile(folder / "row/row3.png")));
  refused(named(steps, "depth-0002").arguments, "has changed since");
}
