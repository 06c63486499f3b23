// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::contentsBelow;
using test::runLab;
using test::runProgram;

namespace {

std::set<std::string> filesBelow(const fs::path& folder) {
  std::set<std::string> files;
  if (fs::exists(folder))
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), folder).string());
  return files;
}

}  // namespace

TEST_CASE("build finds the COLMAP model, names it and its stages on stderr, and writes a report") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const auto outcome = runProgram({"build", set.photographs, "-o", folder / "scene", "--json", folder / "report.json"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("sparse"));
  CHECK_THAT(outcome.out, Contains((folder / "scene").string()) && Contains("3 photographs"));
  CHECK(fs::exists(folder / "scene/scene.gltf"));
  const auto report = test::parseJson(readTextFile(folder / "report.json"));
  for (const char* key :
       {"scene", "photographs", "model", "cells", "dropped", "unused", "stages", "seconds", "capture"})
    CHECK(report.contains(key));
  REQUIRE(!report.at("cells").empty());
  for (const char* key :
       {"members", "points", "triangles", "tier0", "coverage", "ecc", "residualPx", "score", "seconds", "resumed"})
    CHECK(report["cells"][0].contains(key));
  CHECK(report["cells"][0]["triangles"] > 0);
  CHECK(!report.at("stages").empty());
  for (const auto& stage : report["stages"]) CHECK_THAT(outcome.err, Contains(stage.at("stage").get<std::string>()));

  SECTION("info gives the advice of the build as text, poses and SVG") {
    const auto info = runProgram({"info", folder / "scene", "--advice", "--svg", folder / "graph.svg", "--advice-poses",
                                  folder / "next.json", "--json", folder / "info.json"});
    INFO(info.err);
    REQUIRE(info.code == 0);
    const auto capture = test::parseJson(readTextFile(folder / "info.json")).at("capture");
    CHECK((capture == report.at("capture")));
    for (const auto& one : capture.at("advice"))
      for (const char* key : {"kind", "severity", "problem", "remedy", "photographs", "value"})
        CHECK(one.contains(key));
    REQUIRE(!capture.at("next").empty());
    for (const auto& next : capture["next"]) {
      const std::string where = next.at("description");
      CHECK_THAT(info.out, Contains(where));
      CHECK(next.at("view").at("width") == 192);
      CHECK(next.at("referencePhotographs").size() >= 1);
    }
    CHECK_THAT(readTextFile(folder / "graph.svg"), Contains("<title>1: "));  // first next-best view
    REQUIRE(runProgram({"info", folder / "scene", "--advice-poses", folder / "next"}).code == 0);
    if (test::deviceIsThere()) {
      for (const char* poses : {"next.json", "next"}) {
        const auto render =
            runProgram({"render", folder / "scene", "--poses", folder / poses, "-o", folder / "pictures"});
        INFO(render.err);
        CHECK(render.code == 0);
      }
      CHECK(filesBelow(folder / "pictures").contains("next_01.png"));
    }
  }
  SECTION("info and validate read the scene") {
    const auto info = runProgram({"info", folder / "scene", "--explain", "--svg", folder / "graph.svg", "--json", "-"});
    REQUIRE(info.code == 0);
    CHECK_THAT(readTextFile(folder / "graph.svg"), Contains("<svg") && Contains("a/0.png"));
    const auto json = test::parseJson(info.out);
    CHECK(json.at("photographs") == 3);
    CHECK(json.at("unused").empty());
    CHECK(json.at("cells")[0].at("score") > 0);
    CHECK(json.at("cells").size() == report["cells"].size());
    CHECK(json.at("triangles") > 0);
    CHECK(json.at("memory").at("predicted").at("textures") > 0);
    CHECK(json.at("backdrops").at("count") == 3);
    CHECK(json.at("backdrops").at("triangles") > 100);
    CHECK(json.at("backdrops").at("bytes") > 1000);
    CHECK(json.at("backdrops").at("matchedShare") > 0.3);
    CHECK(json.at("cacheBytes") > 1000);
    if (test::deviceIsThere()) {
      // The prediction excludes alignment padding, so it is a lower bound. It must include every part.
      const auto& memory = json["memory"];
      for (const char* kind : {"positions", "indices", "textures"}) {
        CHECK(memory["measured"][kind] >= memory["predicted"][kind]);
        CHECK(memory["measured"][kind].get<double>() <= 1.5 * memory["predicted"][kind].get<double>() + 65536);
      }
    }
    CHECK(!json.at("stages").empty());
    CHECK_THAT(runProgram({"info", folder / "scene"}).out, Contains("a/0.png"));
    CHECK(runProgram({"validate", folder / "scene"}).code == 0);
  }
  SECTION("the gathered composition reproduces a photograph completely") {
    Scene scene = loadScene(folder / "scene");
    REQUIRE(scene.backdrops.size() == 3);
    CHECK(report.at("backdrops").size() == 3);
    scene.cells.clear();
    saveScene(scene, folder / "scene");
    if (!test::deviceIsThere()) return;
    const auto eval = runProgram(
        {"eval", folder / "scene", "--truth", set.photographs.string(), "--composition", "gathered", "--json", "-"});
    INFO(eval.err);
    REQUIRE(eval.code == 0);
    const auto viewsReport = test::parseJson(eval.out);
    for (const auto& view : viewsReport.at("views")) {
      CHECK(view.at("coverage") == 1.0);
      CHECK(view.at("coverageTier0") > 0.3);
      CHECK(view.at("coverageTier2") > 0);
      CHECK((view.at("psnr").is_null() || view.at("psnr") > 45));  // null: images are equal
    }
  }
  SECTION("a draft renders without cells, and the same command without --draft completes the scene") {
    const fs::path drafted = folder / "drafted";
    const auto draft =
        runProgram({"build", set.photographs, "-o", drafted, "--draft", "--json", folder / "draft.json"});
    INFO(draft.err);
    REQUIRE(draft.code == 0);
    CHECK_THAT(draft.out, Contains("--draft"));
    const auto draftReport = test::parseJson(readTextFile(folder / "draft.json"));
    CHECK(draftReport.at("cells").empty());
    CHECK(draftReport.at("backdrops").size() == 3);
    CHECK_FALSE(draftReport.contains("capture"));
    CHECK(runProgram({"validate", drafted}).code == 0);
    CHECK(runProgram({"build", set.photographs, "-o", folder / "no", "--draft", "--no-backdrops"}).code != 0);
    if (test::deviceIsThere()) {
      const auto eval = runProgram({"eval", drafted, "--truth", set.photographs, "--json", "-"});
      INFO(eval.err);
      REQUIRE(eval.code == 0);
      const auto views = test::parseJson(eval.out).at("views");
      for (const auto& view : views) {
        CHECK(view.at("coverage") == 1.0);
        CHECK((view.at("psnr").is_null() || view.at("psnr") > 45));
      }
    }
    REQUIRE(runProgram({"build", set.photographs, "-o", drafted, "-q"}).code == 0);
    CHECK(contentsBelow(drafted) == contentsBelow(folder / "scene"));
  }
  SECTION("validate lists every fault") {
    fs::remove_all(folder / "scene/textures");
    const auto outcome2 = runProgram({"validate", folder / "scene", "--json", "-"});
    CHECK(outcome2.code == 3);
    const auto faults = test::parseJson(outcome2.out).at("faults");
    CHECK(faults.size() >= 3);
    for (const auto& fault : faults) CHECK((fault.contains("field") && fault.contains("message")));
  }
  SECTION("the same command gives the same bytes, and -q prints nothing") {
    const auto before = contentsBelow(folder / "scene");
    const auto again = runProgram({"build", set.photographs, "-o", folder / "other", "-q"});
    CHECK(again.code == 0);
    CHECK(again.err.empty());
    CHECK(contentsBelow(folder / "other") == before);
  }
}

TEST_CASE("block-compressed textures need less disk space and device memory") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  std::map<std::string, double> predicted;
  std::map<std::string, std::uintmax_t> stored;
  for (const std::string format : {"rgba8", "bc1", "bc7"}) {
    const fs::path scene = folder / format;
    REQUIRE(runProgram({"build", set.photographs, "-o", scene, "--texture", format, "-q"}).code == 0);
    CHECK(runProgram({"validate", scene}).code == 0);
    const auto info = runProgram({"info", scene, "--json", "-"});
    REQUIRE(info.code == 0);
    predicted[format] = test::parseJson(info.out).at("memory").at("predicted").at("textures");
    stored[format] = fs::file_size(scene / "textures/a/0.png.ktx2");
    CHECK_THAT(runProgram({"info", scene}).out, Contains(" " + format));
    CHECK_THAT(readTextFile(scene / "scene.gltf"), Contains(format));
  }
  // Small levels take whole blocks.
  CHECK(predicted["rgba8"] / predicted["bc7"] == Approx(4).epsilon(0.01));
  CHECK(predicted["rgba8"] / predicted["bc1"] == Approx(8).epsilon(0.01));
  CHECK(stored["bc1"] < stored["bc7"]);
  CHECK(stored["bc7"] < stored["rgba8"]);
}

TEST_CASE("backdrops can be omitted or refined") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const auto triangles = [&](const std::string& option, const std::string& value) {
    std::vector<std::string> line{"build", set.photographs, "-o", folder / "scene", "--json", "-", option};
    if (!value.empty()) line.push_back(value);
    const auto outcome = runProgram(line);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    std::size_t sum = 0;
    const auto backdropsReport = test::parseJson(outcome.out);
    for (const auto& backdrop : backdropsReport.at("backdrops")) sum += backdrop.at("triangles").get<std::size_t>();
    return sum;
  };
  CHECK(triangles("--no-backdrops", "") == 0);
  CHECK(triangles("--backdrop-spacing", "4") > triangles("--backdrop-spacing", "16"));
  CHECK(runProgram({"build", set.photographs, "-o", folder / "scene", "--backdrop-spacing", "5"}).code == 1);
}

TEST_CASE("photographs can be excluded by name or by a list") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  writeFile(folder / "list.txt", "a/1.png\r\n\n");
  for (const std::vector<std::string>& choice :
       {std::vector<std::string>{"--exclude", "a/1.png"}, {"--exclude-from", folder / "list.txt"}}) {
    std::vector<std::string> line{"build", set.photographs, "-o", folder / "scene", "--json", "-"};
    line.insert(line.end(), choice.begin(), choice.end());
    fs::remove_all(folder / "scene");
    const auto outcome = runProgram(line);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(test::parseJson(outcome.out).at("cells").size() == 1);
    const auto cellsReport = test::parseJson(outcome.out);
    for (const auto& cell : cellsReport.at("cells"))
      for (const auto& member : cell.at("members")) CHECK(member != "a/1.png");
  }
}

TEST_CASE("build takes poses from transforms.json and points from own features") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const Intrinsics k = set.cameras[0].camera.intrinsics;
  nlohmann::json json{{"fl_x", k.fx}, {"fl_y", k.fy}};  // sizes are those of the image files
  for (const auto& [name, camera] : set.cameras) {
    const glm::dvec3 p = camera.pose.position;  // no camera is rotated
    json["frames"].push_back({{"file_path", "photographs/" + name.substr(0, name.size() - 4)},
                              {"transform_matrix", {{1, 0, 0, p.x}, {0, 1, 0, p.y}, {0, 0, 1, p.z}, {0, 0, 0, 1}}}});
  }
  writeFile(folder / "transforms.json", test::jsonLine(json));
  const std::vector<std::string> line{"build", set.photographs,  "--transforms", folder / "transforms.json",
                                      "-o",    folder / "scene", "--json",       "-"};
  const auto outcome = runProgram(line);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("tracks"));
  const auto report = test::parseJson(outcome.out);
  CHECK(report.at("model") == (folder / "transforms.json").string());
  REQUIRE(report.at("cells").size() == 1);
  CHECK(report.at("cells")[0].at("coverage") > 0.6);
  CHECK(report.at("cells")[0].at("residualPx") < 0.3);
  CHECK(runProgram({"validate", folder / "scene"}).code == 0);

  const auto twice = runProgram({"build", set.photographs, "--transforms", folder / "transforms.json", "--model",
                                 set.photographs / "sparse", "-o", folder / "scene"});
  CHECK(twice.code == 1);
  json["frames"][1]["transform_matrix"][0][0] = 3;
  writeFile(folder / "transforms.json", test::jsonLine(json));
  const auto scaled = runProgram(line);
  CHECK(scaled.code == 3);
  CHECK_THAT(scaled.err, Contains("/frames/1/transform_matrix"));
}

TEST_CASE("--tracks selects points of the model, own features or both") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  std::map<std::string, std::size_t> stages;
  for (const std::string tracks : {"auto", "model", "own"}) {
    const auto outcome =
        runProgram({"build", set.photographs, "-o", folder / tracks, "--tracks", tracks, "--json", "-"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    stages[tracks] = test::parseJson(outcome.out).at("stages").size();
    CHECK(loadScene(folder / tracks).cells.size() == 1);
  }
  CHECK(stages["own"] > stages["model"]);  // own features have stages of their own
  CHECK(runProgram({"build", set.photographs, "-o", folder / "x", "--tracks", "some"}).code == 1);
}

TEST_CASE("without poses, build runs COLMAP and caches its result") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  fs::create_directories(folder / "models");
  fs::rename(set.photographs / "sparse", folder / "models/0");
  const std::vector<std::string> line{"build",    set.photographs, "-o",     folder / "scene",
                                      "--colmap", IBR_FAKE_COLMAP, "--json", "-"};
  const test::RunOptions environment{.environment = {"FAKE_COLMAP=" + folder.path().string()}};
  const auto outcome = runProgram(line, environment);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("COLMAP") && Contains("3 of 3"));
  const auto report = test::parseJson(outcome.out);
  CHECK(report.at("model") == (folder / "scene/.poses/sparse/0").string());
  CHECK(report.at("cells").size() == 1);
  const std::string calls = readTextFile(folder / "calls");
  CHECK(runProgram(line, environment).code == 0);
  CHECK(readTextFile(folder / "calls") == calls);  // the cached result was used

  // Ctrl-C ends the program; the same command resumes the work.
  fs::remove_all(folder / "scene");
  writeFile(folder / "SLEEP-mapper", std::string_view(""));
  const auto stopped =
      runProgram(line, {.environment = environment.environment,
                        .interruptWhen = [&](const std::string&) { return fs::exists(folder / "sleeper"); }});
  CHECK(stopped.code == 130);
  fs::remove(folder / "SLEEP-mapper");
  const std::string before = readTextFile(folder / "calls");
  CHECK(runProgram(line, environment).code == 0);
  CHECK_THAT(readTextFile(folder / "calls").substr(before.size()),
             !Contains("feature_extractor") && Contains("mapper"));

  const auto missing = runProgram({"build", set.photographs, "-o", folder / "other", "--colmap", "no-such-colmap"});
  CHECK(missing.code == 2);
  CHECK_THAT(missing.err, Contains("no-such-colmap") && Contains("--model"));
}

TEST_CASE("a scene is not written into the folder of its photographs, whatever other folders there are") {
  test::TemporaryFolder folder;
  const fs::path photographs = test::makeTinySet(folder.path()).photographs;
  fs::create_directories(folder / "more");
  const auto before = test::contentsBelow(photographs);
  for (const auto& sources : {std::vector{photographs.string()}, {folder / "more", photographs.string()}}) {
    std::vector<std::string> words{"build", "-o", photographs};
    words.insert(words.begin() + 1, sources.begin(), sources.end());
    const auto outcome = runProgram(words);
    CHECK(outcome.code == 3);
    CHECK_THAT(outcome.err, Contains("is the folder of the photographs"));
  }
  CHECK((test::contentsBelow(photographs) == before));
}

TEST_CASE("a dry run predicts time, memory and disk space, and writes nothing") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const auto dry = runProgram({"build", set.photographs, "-o", folder / "scene", "--dry-run"});
  INFO(dry.err);
  REQUIRE(dry.code == 0);
  CHECK_THAT(dry.out, Contains("3 photographs") && Contains("memory") && Contains("disk"));
  CHECK_THAT(dry.out, Catch::Matches("[^]* on (1 thread|([2-9]|[1-9][0-9]+) threads), [^]*"));
  CHECK(!fs::exists(folder / "scene"));
  const auto dryReport =
      test::parseJson(runProgram({"build", set.photographs, "-o", folder / "scene", "--dry-run", "--json", "-"}).out);
  CHECK(dryReport.at("predicted").at("photographs") == 3);
  CHECK(dryReport.at("predicted").at("memory") > 1e6);
  CHECK(!fs::exists(folder / "scene"));
  const auto real = runProgram({"build", set.photographs, "-o", folder / "scene", "--memory", "2G", "--json", "-"});
  REQUIRE(real.code == 0);
  CHECK_THAT(real.err, Contains("3 photographs") && Contains("memory"));
  const auto report = test::parseJson(real.out);
  CHECK(report.at("predicted").at("cells") == dryReport.at("predicted").at("cells"));
  CHECK(report.at("predicted").at("memoryAllowed") == 2147483648.0);
  CHECK(report.at("memory") < report.at("predicted").at("memory"));
  CHECK(report.at("processorSeconds") > 0);
  CHECK(runProgram({"build", set.photographs, "-o", folder / "s", "--memory", "lots"}).code == 1);
  CHECK(runProgram({"build", set.photographs, "-o", folder / "s", "--orientation", "left"}).code == 1);
}

TEST_CASE("a build of many photographs needs no more memory than predicted") {
  test::TemporaryFolder folder;
  REQUIRE(runLab({"synth", "court", "-o", folder / "court", "--photographs", "80", "--size", "96x72"}).code == 0);
  const auto built = runProgram({"build", folder / "court/images", "-o", folder / "scene", "--json", "-"});
  INFO(built.err);
  REQUIRE(built.code == 0);
  const auto report = test::parseJson(built.out);
  CHECK(report.at("predicted").at("photographs") == 80);
  CHECK(report.at("memory") < report.at("predicted").at("memory"));
}

TEST_CASE("Ctrl-C leaves only complete files, and the same command resumes the build") {
  test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const std::vector<std::string> line{"build", set.photographs, "-o", folder / "scene"};
  test::Outcome stopped;
  // On a busy machine the signal may arrive after the end of the program; the test then repeats the attempt.
  for (int attempt = 0; attempt < 10 && stopped.code != 130; ++attempt) {
    fs::remove_all(folder / "scene");
    stopped = runProgram(line, {.interruptWhen = [](const std::string& err) { return Contains("%").match(err); }});
  }
  INFO(stopped.err);
  CHECK(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("warning:") && Contains("again"));
  CHECK(!fs::exists(folder / "scene/scene.gltf"));
  for (const std::string& file : filesBelow(folder / "scene")) {
    INFO(file);
    CHECK(file.find(".tmp") == std::string::npos);
  }
  CHECK(runProgram(line).code == 0);
  CHECK(runProgram({"validate", folder / "scene"}).code == 0);
  // A resumed build has the same result as an uninterrupted build.
  CHECK(runProgram({"build", set.photographs, "-o", folder / "whole"}).code == 0);
  CHECK(contentsBelow(folder / "scene") == contentsBelow(folder / "whole"));
}
