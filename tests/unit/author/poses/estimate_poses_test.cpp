// SPDX-License-Identifier: Apache-2.0
// estimatePoses with a stub for COLMAP (fake_colmap.sh), and running other programs.
#include <signal.h>

#include <catch2/catch.hpp>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "base/child_process.h"
#include "base/file.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "support/error_of.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"
#include "support/turned_photograph.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

// A folder of four photographs. The stub finds one model of three photographs and one of two.
class Place {
 public:
  Place() {
    fs::create_directories(folder / "photos/more");
    for (const char* name : {"a.png", "b.png", "more/c.png", "d.png"})
      writeImage(folder / "photos" / name, Image8(40, 30, 3, 99));
    writeFile(folder / "photos/notes.txt", "no picture");
    writeModel("0", {"b.png", "d.png"});
    writeModel("1", {"a.png", "b.png", "more/c.png"});
    ::setenv("FAKE_COLMAP", folder.path().c_str(), 1);
  }
  void writeModel(const std::string& number, const std::vector<std::string>& names) {
    std::vector<Camera> cameras;
    for (std::size_t i = 0; i < names.size(); ++i)
      cameras.push_back(test::lookingAlong({double(i), 0, 0}, {0, 1, 0}, 40, 30));
    PosedModel model = test::modelOf(cameras, {{0.5, 4, 0}, {0.6, 4, 0}});
    for (std::size_t i = 0; i < names.size(); ++i) model.images[i].name = names[i];
    writeColmapModel(model, folder / "models" / number);
  }
  PoseOptions options() const {
    PoseOptions o;
    o.photographs = folder / "photos";
    o.folder = folder / "poses";
    o.program = IBR_FAKE_COLMAP;
    return o;
  }
  // Returns the commands that were run, in order.
  std::vector<std::string> calls() const {
    std::vector<std::string> commands;
    std::string text = fs::exists(folder / "calls") ? readTextFile(folder / "calls") : "";
    for (std::size_t end; (end = text.find('\n')) != text.npos; text.erase(0, end + 1)) {
      const std::string line = text.substr(0, end);
      CHECK(line.starts_with("offscreen "));
      commands.push_back(line.substr(10, line.find(' ', 10) - 10));
    }
    return commands;
  }
  void touch(const std::string& name) const { writeFile(folder / name, std::string_view("")); }

  test::TemporaryFolder folder;
};

using Calls = std::vector<std::string>;
const Calls kAll{"feature_extractor", "exhaustive_matcher", "mapper"};

}  // namespace

TEST_CASE("a folder with other files is left unchanged, and photographs of an excluded folder are not used") {
  const Place place;
  fs::create_directories(place.options().folder);
  writeFile(place.options().folder / "mine.txt", "kept");
  CHECK(test::errorOf([&] { estimatePoses(place.options()); }).code() == ErrorCode::invalidInput);
  CHECK(readTextFile(place.options().folder / "mine.txt") == "kept");
  PoseOptions options = place.options();
  options.folder = place.folder / "other";
  options.excludedFolder = place.folder / "photos/more";
  CHECK(estimatePoses(options).photographs == 3);
}

TEST_CASE("COLMAP's steps run and report progress, and its largest model is used") {
  const Place place;
  std::map<std::string, std::set<std::size_t>> seen;
  std::vector<std::string> messages;
  const PoseReport report = estimatePoses(
      place.options(),
      [&](const Progress& p) {
        CHECK(p.done <= p.total);
        seen[std::string(p.stage)].insert(p.done);
        return true;
      },
      [&](LogLevel, std::string_view text) { messages.emplace_back(text); });
  CHECK(report.photographs == 4);
  CHECK(report.registered == 3);
  CHECK(report.points == 2);
  CHECK(report.model == place.folder / "poses/sparse/1");
  CHECK(readColmapModel(report.model).images.size() == 3);
  CHECK(place.calls() == kAll);
  REQUIRE(messages.size() == 2);
  CHECK_THAT(messages[0], Contains("3 of 4"));
  CHECK_THAT(messages[1], Contains(" 2 "));
  CHECK(readTextFile(place.folder / "poses/photographs.txt") == "a.png\nb.png\nd.png\nmore/c.png\n");
  const std::string calls = readTextFile(place.folder / "calls");
  CHECK_THAT(calls, Contains("--SiftExtraction.use_gpu 0") && Contains("--SiftMatching.use_gpu 0") &&
                        Contains("--ImageReader.single_camera 1") && Contains("--ExhaustiveMatching.block_size 2"));
  CHECK_THAT(readTextFile(place.folder / "poses/mapper.log"), Contains("Registering image #2"));

  // A second call uses the existing model.
  CHECK(estimatePoses(place.options()).registered == 3);
  CHECK(place.calls() == kAll);
  // A changed photograph restarts the estimate. Its size is different, so it gets its own camera.
  writeImage(place.folder / "photos/d.png", Image8(30, 40, 3));
  place.touch("newer");
  estimatePoses(place.options());
  CHECK(place.calls().size() == 6);
  const std::string later = readTextFile(place.folder / "calls").substr(calls.size());
  CHECK_THAT(later, Contains("--FeatureExtraction.use_gpu 0") && Contains("--FeatureMatching.use_gpu 0") &&
                        Contains("--ImageReader.single_camera 0"));
}

TEST_CASE("added photographs are registered in the existing model") {
  Place place;
  fs::remove_all(place.folder / "models");
  place.writeModel("0", {"a.png", "b.png", "d.png", "more/c.png"});
  const fs::path poses = place.folder / "poses", database = poses / "database.db";
  estimatePoses(place.options());
  writeFile(database, "of four");
  writeImage(place.folder / "photos/e.png", Image8(40, 30, 3, 50));
  writeImage(place.folder / "photos/f.png", Image8(40, 30, 3, 60));
  place.writeModel("../added", {"a.png", "b.png", "d.png", "e.png", "more/c.png"});
  const Calls adding{"feature_extractor", "matches_importer", "image_registrator"};
  Calls expected = kAll;
  const auto then = [&](const Calls& calls) { expected.insert(expected.end(), calls.begin(), calls.end()); };
  then(adding);
  SECTION("a stopped addition resumes") {
    place.touch("FAIL-image_registrator");
    CHECK(test::errorOf([&] { estimatePoses(place.options()); }).code() == ErrorCode::io);
    CHECK(readColmapModel(poses / "sparse/0").images.size() == 4);
    fs::remove(place.folder / "FAIL-image_registrator");
    then({"image_registrator"});
  }
  SECTION("a stopped addition starts again from the previous database if the photographs change") {
    place.touch("FAIL-image_registrator");
    CHECK(test::errorOf([&] { estimatePoses(place.options()); }).code() == ErrorCode::io);
    fs::remove(place.folder / "FAIL-image_registrator");
    writeFile(poses / "added-database.db", "of what is no longer there");
    writeImage(place.folder / "photos/e.png", Image8(40, 30, 3, 51));
    fs::last_write_time(place.folder / "photos/e.png", fs::file_time_type::clock::now() + std::chrono::seconds(9));
    then(adding);
  }
  SECTION("an addition that was stopped before its key was stored resumes") {
    const std::string before = readTextFile(poses / "key");
    estimatePoses(place.options());
    fs::rename(poses / "key", poses / "added-key");
    writeFile(poses / "key", before);
  }
  std::vector<std::string> messages;
  const auto keep = [&](LogLevel, std::string_view text) { messages.emplace_back(text); };
  const PoseReport report = estimatePoses(place.options(), {}, keep);
  CHECK(report.photographs == 6);
  CHECK(report.registered == 5);
  REQUIRE(messages.size() == 2);
  CHECK_THAT(messages[0], Contains("f.png") && Contains("1 of 2"));
  CHECK(place.calls() == expected);
  CHECK(readTextFile(database) == "of four");
  CHECK_FALSE(fs::exists(poses / "added-database.db"));
  CHECK(readTextFile(poses / "added-photographs.txt") == "e.png\nf.png\n");
  CHECK(readTextFile(poses / "added-pairs.txt") ==
        "e.png a.png\ne.png b.png\ne.png d.png\ne.png more/c.png\n"
        "f.png a.png\nf.png b.png\nf.png d.png\nf.png e.png\nf.png more/c.png\n");
  CHECK(readTextFile(poses / "photographs.txt") == "a.png\nb.png\nd.png\nmore/c.png\n");
  const std::string calls = readTextFile(place.folder / "calls");
  CHECK_THAT(calls, Contains("--image_list_path " + (poses / "added-photographs.txt").string()) &&
                        Contains("--ImageReader.existing_camera_id 1") &&
                        Contains("--input_path " + (poses / "sparse/0").string()));
  // A second call runs no command. A further photograph of another size is added to the existing model.
  CHECK(estimatePoses(place.options()).model == report.model);
  CHECK(place.calls() == expected);
  writeImage(place.folder / "photos/g.png", Image8(30, 40, 3, 50));
  place.writeModel("../added", {"a.png", "b.png", "d.png", "e.png", "g.png", "more/c.png"});
  CHECK(estimatePoses(place.options()).registered == 6);
  CHECK(readTextFile(poses / "added-photographs.txt") == "g.png\n");
  const std::string later = readTextFile(place.folder / "calls").substr(calls.size());
  CHECK_THAT(later, Contains("image_registrator") && !Contains("existing_camera_id"));
  // A removed photograph restarts the estimate.
  fs::remove(place.folder / "photos/e.png");
  estimatePoses(place.options());
  CHECK(place.calls().back() == "mapper");
  CHECK_FALSE(fs::exists(poses / "added-photographs.txt"));
}

TEST_CASE("poses are estimated again if photographs cannot be added to the existing model") {
  Place place;
  const auto more = [&](int count, const std::string& suffix) {
    for (int i = 0; i < count; ++i)
      writeImage(place.folder / "photos" / (std::to_string(i) + suffix), Image8(40, 30, 3, 50));
  };
  SECTION("several groups") {
    more(1, ".png");
  }
  SECTION("most photographs are without a pose") {
    fs::remove_all(place.folder / "models/1");
    more(1, ".png");
  }
  SECTION("many photographs are added") {
    fs::remove_all(place.folder / "models/0");
    place.writeModel("1", {"a.png", "b.png", "d.png", "more/c.png"});
    more(3, ".png");
  }
  SECTION("names with spaces") {
    fs::remove_all(place.folder / "models/0");
    place.writeModel("1", {"a.png", "b.png", "d.png", "more/c.png"});
    more(1, " a.png");
  }
  // The first estimate runs without the photographs that each section adds.
  for (const auto& entry : fs::directory_iterator(place.folder / "photos"))
    if (std::isdigit(entry.path().filename().string()[0]))
      fs::rename(entry.path(), place.folder / entry.path().filename());
  estimatePoses(place.options());
  for (const auto& entry : fs::directory_iterator(place.folder.path()))
    if (std::isdigit(entry.path().filename().string()[0]))
      fs::rename(entry.path(), place.folder / "photos" / entry.path().filename());
  estimatePoses(place.options());
  Calls twice = kAll;
  twice.insert(twice.end(), kAll.begin(), kAll.end());
  CHECK(place.calls() == twice);
}

TEST_CASE("many photographs are matched sequentially") {
  const Place place;
  fs::remove(place.folder / "photos/more/c.png");
  for (int i = 0; i < 60; ++i)
    fs::copy_file(place.folder / "photos/a.png", place.folder / "photos" / (std::to_string(i) + ".png"));
  CHECK(estimatePoses(place.options()).photographs == 63);
  CHECK(place.calls() == Calls{"feature_extractor", "sequential_matcher", "mapper"});
}

TEST_CASE("many photographs of several folders are also matched from folder to folder") {
  const Place place;
  for (const char* name : {"a.png", "b.png", "d.png", "more"}) fs::remove_all(place.folder / "photos" / name);
  const auto add = [&](const std::string& name) {
    fs::create_directories((place.folder / "photos" / name).parent_path());
    writeImage(place.folder / "photos" / name, Image8(40, 30, 3, 99));
  };
  for (int i = 0; i < 70; ++i) add("walk/" + std::to_string(100 + i) + ".png");
  for (int i = 0; i < 20; ++i) add("stills/" + std::to_string(i) + ".png");
  estimatePoses(place.options());
  CHECK(place.calls() == Calls{"feature_extractor", "sequential_matcher", "matches_importer", "mapper"});
  std::map<std::string, int> stills, walk;  // number of pairs of each photograph with the other folder
  std::istringstream lines(readTextFile(place.options().folder / "folder-pairs.txt"));
  std::set<std::pair<std::string, std::string>> pairs;
  for (std::string a, b; lines >> a >> b;) {
    CHECK(fs::path(a).parent_path() != fs::path(b).parent_path());
    CHECK(pairs.insert(std::minmax(a, b)).second);
    if (a.starts_with("stills/") && b.starts_with("walk/")) ++stills[a], ++walk[b];
  }
  CHECK(stills.size() == 20);
  CHECK(walk.size() == 70);
  for (const auto& [name, count] : stills) CHECK(count >= 20);
  CHECK(pairs.size() < 90 * 60);

  add("stills/with space.png");  // not in a list of pairs
  std::string warnings;
  estimatePoses(place.options(), {}, [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) warnings += text;
  });
  CHECK_THAT(warnings, Contains("spaces"));
  const Calls calls = place.calls();
  CHECK(Calls(calls.end() - 3, calls.end()) == Calls{"feature_extractor", "sequential_matcher", "mapper"});
}

TEST_CASE("COLMAP gets photographs turned upright by EXIF, unless the stored orientation is requested") {
  const Place place;
  Image8 picture(40, 30, 3, 20);
  for (int x = 0; x < 40; ++x) picture.pixel(x, 0)[0] = 250;
  test::writeTurned(place.folder / "photos/e.jpg", test::storedAs(6, picture), 6);
  Image8 mask(30, 40, 1, 255);
  mask.pixel(0, 34)[0] = 0;  // at the top of the upright picture
  fs::create_directories(place.folder / "masks");
  writeImage(place.folder / "masks/e.jpg.png", mask);
  PoseOptions options = place.options();
  options.masks = place.folder / "masks";
  CHECK(estimatePoses(options).photographs == 5);
  const fs::path pictures = options.folder / "upright";
  const ImageFileInfo info = probeImage(pictures / "e.jpg");
  CHECK(info.width == 40);
  CHECK(info.height == 30);
  CHECK(info.orientation == 1);
  CHECK(info.capture.maker == "Ab");
  CHECK(int(readImage(pictures / "e.jpg").pixel(20, 0)[0]) > 150);
  CHECK(readImage(pictures / "more/c.png").width == 40);
  CHECK(int(readImage(options.folder / "masks/e.jpg.png").pixel(5, 0)[0]) == 0);
  CHECK(int(readImage(options.folder / "masks/e.jpg.png").pixel(0, 5)[0]) == 255);
  const std::string calls = readTextFile(place.folder / "calls");
  CHECK_THAT(calls, Contains("--image_path " + pictures.string()) && Contains("--ImageReader.single_camera 1"));

  options.orientation = Orientation::stored;
  estimatePoses(options);
  CHECK(!fs::exists(pictures));
  const std::string later = readTextFile(place.folder / "calls").substr(calls.size());
  CHECK_THAT(later, Contains("--image_path " + options.photographs.string()) && Contains("single_camera 0"));
}

TEST_CASE("unreadable photographs are reported before COLMAP runs") {
  const Place place;
  const fs::path photographs = place.options().photographs;
  const bool someTurned = GENERATE(false, true);  // turned photographs are copied to a working folder
  if (someTurned) test::writeTurned(photographs / "a-turned.jpg", Image8(30, 40, 3, 20), 6);
  writeImage(photographs / "x.jpg", Image8(400, 300, 3, 9));
  fs::copy_file(photographs / "x.jpg", photographs / "y.jpg");
  fs::resize_file(photographs / "x.jpg", 20);                                        // cut in the header
  fs::resize_file(photographs / "y.jpg", fs::file_size(photographs / "y.jpg") - 9);  // cut at the end
  const auto messageOf = [&](const PoseOptions& options) {
    return std::string(test::errorOf([&] { estimatePoses(options); }).what());
  };
  PoseOptions options = place.options();
  CHECK_THAT(messageOf(options), Contains("x.jpg") && Contains("--exclude"));
  options.exclude = {"x.jpg"};
  CHECK_THAT(messageOf(options), Contains("y.jpg") && Contains("--exclude") && !Contains("x.jpg"));
  CHECK(!fs::exists(place.folder / "calls"));
  options.exclude.push_back("y.jpg");
  CHECK(estimatePoses(options).photographs == (someTurned ? 5 : 4));
}

TEST_CASE("a failed step reports its last lines of output and is repeated first") {
  const Place place;
  place.touch("FAIL-mapper");
  const Error error = test::errorOf([&] { estimatePoses(place.options()); });
  CHECK_THAT(error.what(), Contains("status 3") && Contains("no good initial pair") && Contains("poses/mapper.log"));
  fs::remove(place.folder / "FAIL-mapper");
  CHECK(estimatePoses(place.options()).registered == 3);
  CHECK(place.calls() == Calls{"feature_extractor", "exhaustive_matcher", "mapper", "mapper"});
}

TEST_CASE("cancelling a step ends the program and its child processes") {
  const Place place;
  place.touch("SLEEP-exhaustive_matcher");
  const Error error = test::errorOf(
      [&] { estimatePoses(place.options(), [&](const Progress&) { return !fs::exists(place.folder / "sleeper"); }); });
  CHECK(error.code() == ErrorCode::cancelled);
  const pid_t sleeper = std::stoi(readTextFile(place.folder / "sleeper"));
  bool gone = false;
  for (int i = 0; i < 200 && !gone; ++i) {
    gone = ::kill(sleeper, 0) != 0;
    if (!gone) ::usleep(10000);
  }
  CHECK(gone);
  fs::remove(place.folder / "SLEEP-exhaustive_matcher");
  CHECK(estimatePoses(place.options()).registered == 3);
  CHECK(place.calls() == Calls{"feature_extractor", "exhaustive_matcher", "exhaustive_matcher", "mapper"});
}

TEST_CASE("a missing program, missing photographs and missing poses are reported") {
  Place place;
  PoseOptions options = place.options();
  options.program = "no-such-colmap";
  const Error missing = test::errorOf([&] { estimatePoses(options); });
  CHECK(missing.code() == ErrorCode::io);
  CHECK_THAT(missing.what(), Contains("no-such-colmap") && Contains("--colmap") && Contains("--model"));

  options = place.options();
  options.photographs = place.folder / "nowhere";
  CHECK_THAT(test::errorOf([&] { estimatePoses(options); }).what(), Contains("nowhere"));
  fs::create_directories(place.folder / "empty");
  options.photographs = place.folder / "empty";
  const Error few = test::errorOf([&] { estimatePoses(options); });
  CHECK(few.code() == ErrorCode::invalidInput);
  CHECK_THAT(few.what(), Contains("empty") && Contains(" 2 ") && Contains(" 0"));

  fs::remove_all(place.folder / "models");
  fs::create_directories(place.folder / "models");
  const Error none = test::errorOf([&] { estimatePoses(place.options()); });
  CHECK(none.code() == ErrorCode::invalidInput);
  CHECK_THAT(none.what(), Contains("mapper.log"));
  // COLMAP reports this case as a failure of its own.
  fs::remove_all(place.folder / "poses");
  place.touch("NONE-mapper");
  const Error failed = test::errorOf([&] { estimatePoses(place.options()); });
  CHECK(failed.code() == ErrorCode::invalidInput);
  CHECK_THAT(failed.what(), Contains("mapper.log"));
}

TEST_CASE("photographs of a walk straight ahead are mapped again with forward motion") {
  const Place place;
  place.touch("AHEAD-mapper");
  CHECK(estimatePoses(place.options()).registered == 3);
  CHECK(place.calls() == Calls{"feature_extractor", "exhaustive_matcher", "mapper", "mapper"});
  CHECK(estimatePoses(place.options()).registered == 3);
  CHECK(place.calls().size() == 4);
}

TEST_CASE("the output of a child process is read line by line") {
  std::vector<std::string> lines;
  const auto keep = [&](std::string_view line) { lines.emplace_back(line); };
  const auto on = [] { return true; };
  const ChildResult result =
      runChild({"sh", "-c", "echo one; echo; printf 'two\\rthree' >&2; echo \" $WORD\"; cat; exit 7"},
               {{"WORD", "a b"}}, keep, on);
  CHECK(result.status == 7);
  CHECK_FALSE(result.stopped);
  CHECK(lines == std::vector<std::string>{"one", "two", "three a b"});
  CHECK(runChild({"sh", "-c", "kill -9 $$"}, {}, keep, on).status == 128 + 9);
  // Long output without a final line break.
  std::size_t count = 0, length = 0;
  runChild(
      {"sh", "-c",
       "i=0; while [ $i -lt 3000 ]; do echo 0123456789012345678901234567890123456789; i=$((i+1)); done; "
       "printf end"},
      {},
      [&](std::string_view line) {
        ++count;
        length += line.size();
      },
      on);
  CHECK(count == 3001);
  CHECK(length == 3000 * 40 + 3);
  CHECK(test::errorOf([&] { runChild({"/no/such/program"}, {}, keep, on); }).code() == ErrorCode::io);
}

TEST_CASE("a program with an endless line of output can be stopped, and the line arrives in pieces") {
  std::size_t longest = 0, asked = 0;
  const ChildResult endless = runChild(
      {"sh", "-c", "tr '\\0' x </dev/zero"}, {},
      [&](std::string_view line) { longest = std::max(longest, line.size()); }, [&] { return ++asked < 20; });
  CHECK(endless.stopped);
  CHECK(longest >= 64 * 1024);
  CHECK(longest < 128 * 1024);
}
