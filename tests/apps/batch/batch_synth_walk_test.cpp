// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth walk`. Needs the program ffmpeg; without it only its absence is tested.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "io/image_file.h"
#include "lab/generate/surface_renderer.h"
#include "lab/generate/walk_hall.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::runLab;

namespace {

constexpr int kWidth = 160, kHeight = 90;

test::Outcome run(std::vector<std::string> arguments) {
  return test::runProgram(arguments, {.program = "/usr/bin/env"});
}

bool ffmpegIsThere() {
  static const bool there = run({"ffmpeg", "-version"}).code == 0 && run({"ffprobe", "-version"}).code == 0;
  if (!there) WARN("ffmpeg is not installed");
  return there;
}

std::vector<std::string> walkCommand(const fs::path& folder, const std::vector<std::string>& more) {
  std::vector<std::string> command{"synth", "walk", "-o", folder.string(), "--fps", "15", "--size", "160x90"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

// A walk of four seconds, made once.
const fs::path& walk() {
  static const test::TemporaryFolder folder;
  static const fs::path made = [] {
    const auto outcome = runLab(walkCommand(folder / "walk", {"--seconds", "4", "-q"}));
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return folder / "walk";
  }();
  return made;
}

json jsonOf(const fs::path& file) {
  return test::parseJson(readTextFile(file));
}

std::vector<Image8> decoded(const fs::path& video) {
  const test::TemporaryFolder folder;
  const auto outcome = run({"ffmpeg", "-nostdin", "-v", "error", "-i", video.string(), "-fps_mode", "passthrough", "-f",
                            "rawvideo", "-pix_fmt", "rgb24", folder / "frames"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto bytes = readFile(folder / "frames");
  std::vector<Image8> frames(bytes.size() / (kWidth * kHeight * 3), Image8(kWidth, kHeight, 3));
  REQUIRE(bytes.size() == frames.size() * kWidth * kHeight * 3);
  for (std::size_t i = 0; i < frames.size(); ++i)
    std::memcpy(frames[i].values.data(), bytes.data() + i * frames[i].values.size(), frames[i].values.size());
  return frames;
}

// Mean squared Laplacian of green.
double sharpness(const Image8& image) {
  double sum = 0;
  const auto at = [&](int x, int y) { return int(image.pixel(x, y)[1]); };
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x)
      sum += std::pow(4 * at(x, y) - at(x - 1, y) - at(x + 1, y) - at(x, y - 1) - at(x, y + 1), 2);
  return sum / (image.width * image.height);
}

Camera cameraOf(const json& transforms, std::size_t frame) {
  const json& m = transforms.at("frames").at(frame).at("transform_matrix");
  glm::dmat3 axes;
  glm::dvec3 at;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) axes[column][row] = m.at(row).at(column);
    at[row] = m.at(row).at(3);
  }
  const auto number = [&](const char* key) { return transforms.at(key).get<double>(); };
  return {{CameraModel::pinhole, transforms.at("w"), transforms.at("h"), number("fl_x"), number("fl_y"), number("cx"),
           number("cy")},
          {at, glm::quat_cast(axes)}};
}

// A sharp image of the hall at a pose.
Image8 rendered(const Camera& camera, std::uint64_t seed) {
  static const SurfaceRenderer renderer(makeWalkHall(seed).surfaces, 0.5 * camera.intrinsics.fx, 2);
  constexpr std::size_t kSamples = 32;
  ImageF sum(camera.intrinsics.width, camera.intrinsics.height, 3);
  for (std::size_t i = 0; i < kSamples; ++i) renderer.addSamples(camera, sampleOffset(i), sum);
  return encodedMean(sum, kSamples);
}

// Of luma (BT.709): the video has chroma for every second pixel only.
double psnrOf(const Image8& a, const Image8& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); i += 3) {
    const auto difference = [&](std::size_t c) { return int(a.values[i + c]) - int(b.values[i + c]); };
    sum += std::pow(0.2126 * difference(0) + 0.7152 * difference(1) + 0.0722 * difference(2), 2);
  }
  return 10 * std::log10(255 * 255 * double(a.values.size() / 3) / sum);
}

}  // namespace

TEST_CASE("a walk's video has the frames, times and poses that its files say") {
  if (!ffmpegIsThere()) return;
  const json facts = jsonOf(walk() / "walk.json"), transforms = jsonOf(walk() / "transforms.json");
  const auto frames = decoded(walk() / "walk.mp4");
  REQUIRE(frames.size() == 60);
  CHECK(facts.at("frames") == 60);
  CHECK(facts.at("fps") == 15);
  for (const char* list : {"times", "smears", "speeds", "subFrames"}) CHECK(facts.at(list).size() == 60);
  REQUIRE(transforms.at("frames").size() == 60);
  CHECK(transforms.at("frames").at(7).at("file_path") == "walk_000007.jpg");
  std::size_t compared = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (facts.at("smears").at(i) > 0.7) continue;
    INFO("frame " << i);
    const double here = psnrOf(frames[i], rendered(cameraOf(transforms, i), facts.at("seed")));
    CHECK(here > 36);
    // A pose that is off by a third of a pixel matches worse.
    Camera off = cameraOf(transforms, i);
    off.pose.rotation = off.pose.rotation * glm::angleAxis(0.33 / off.intrinsics.fx, glm::dvec3(0.6, 0.8, 0));
    CHECK(psnrOf(frames[i], rendered(off, facts.at("seed"))) < here - 1);
    ++compared;
  }
  CHECK(compared >= 10);
}

TEST_CASE("every jolted frame of a walk is blurrier than its sharp neighbours") {
  if (!ffmpegIsThere()) return;
  const json facts = jsonOf(walk() / "walk.json");
  const auto frames = decoded(walk() / "walk.mp4");
  const auto blurred = facts.at("blurred").get<std::vector<std::size_t>>();
  CHECK(blurred.size() >= 14);
  CHECK(blurred.size() <= 20);
  std::vector<double> sharp(frames.size(), 0);  // 0: blurred
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (!std::ranges::binary_search(blurred, i)) sharp[i] = sharpness(frames[i]);
  for (const std::size_t i : blurred) {
    std::size_t before = i, after = i;
    while (sharp[before] == 0) --before;
    while (sharp[after] == 0) ++after;
    INFO("frame " << i << ", neighbours " << before << " and " << after);
    CHECK(sharpness(frames[i]) < 0.8 * std::min(sharp[before], sharp[after]));
    const auto smear = [&](std::size_t frame) { return facts.at("smears").at(frame).get<double>(); };
    CHECK(smear(i) > 2 * std::max(smear(before), smear(after)));
  }
}

TEST_CASE("a walk's truth is sharp, and the walk's sharp frames see it") {
  if (!ffmpegIsThere()) return;
  const json facts = jsonOf(walk() / "walk.json"), transforms = jsonOf(walk() / "truth/transforms.json");
  std::vector<double> sharp;
  for (const Image8& frame : decoded(walk() / "walk.mp4")) sharp.push_back(sharpness(frame));
  std::ranges::sort(sharp);
  REQUIRE(transforms.at("frames").size() == 20);
  for (std::size_t i = 0; i < 20; ++i) {
    const json& view = facts.at("truth").at(i);
    const Image8 image = readImage(walk() / "truth/images" / view.at("name").get<std::string>());
    CHECK(transforms.at("frames").at(i).at("file_path") == "images/" + view.at("name").get<std::string>());
    CHECK(sharpness(image) > 0.7 * sharp[sharp.size() / 2]);
    CHECK(psnrOf(image, rendered(cameraOf(transforms, i), facts.at("seed"))) > 45);
    CHECK(view.at("seen") > 0.8);
  }
  CHECK_THAT(readTextFile(walk() / "truth/sparse/images.txt"), Contains("truth07.png"));
}

TEST_CASE("equal seeds give equal walks, on any number of threads; other seeds give others") {
  if (!ffmpegIsThere()) return;
  const test::TemporaryFolder folder;
  const auto made = [&](const std::string& name, const std::vector<std::string>& more) {
    auto command = walkCommand(folder / name, {"--seconds", "2", "--views", "2", "-q"});
    command.insert(command.end(), more.begin(), more.end());
    REQUIRE(runLab(command).code == 0);
    auto files = test::contentsBelow(folder / name);
    CHECK(files.erase("walk.mp4") == 1);  // the encoder's bytes may differ
    return files;
  };
  const auto first = made("a", {"--seed", "5"}), second = made("b", {"--seed", "5", "--threads", "1"}),
             other = made("c", {"--seed", "6"});
  CHECK((first == second));
  CHECK(first.size() == 2 + 2 + 1 + 3);
  CHECK(first.at("transforms.json") != other.at("transforms.json"));
  CHECK(first.at("truth/images/truth01.png") != other.at("truth/images/truth01.png"));
}

TEST_CASE("a walk of variable rate has the times in its file") {
  if (!ffmpegIsThere()) return;
  const test::TemporaryFolder folder;
  REQUIRE(runLab(walkCommand(folder / "walk", {"--seconds", "2", "--views", "0", "--variable-rate", "-q"})).code == 0);
  const auto times = jsonOf(folder / "walk/walk.json").at("times").get<std::vector<double>>();
  const auto probed = run({"ffprobe", "-v", "error", "-select_streams", "v", "-show_entries", "frame=pts_time", "-of",
                           "json", folder / "walk/walk.mp4"});
  const json frames = test::parseJson(probed.out).at("frames");
  REQUIRE(frames.size() == 30);
  double shortest = 1, longest = 0;
  for (std::size_t i = 0; i < 30; ++i) {
    CHECK(std::stod(frames.at(i).at("pts_time").get<std::string>()) == Approx(times[i]).margin(1e-4));
    if (i > 0)
      shortest = std::min(shortest, times[i] - times[i - 1]), longest = std::max(longest, times[i] - times[i - 1]);
  }
  CHECK(shortest < 0.8 / 15);
  CHECK(longest > 1.2 / 15);
}

TEST_CASE("a walk that is interrupted, or that cannot be encoded, leaves no video") {
  const test::TemporaryFolder folder;
  const auto withoutProgram =
      runLab(walkCommand(folder / "a", {"--seconds", "2", "--views", "0"}), {.environment = {"PATH=/nowhere"}});
  CHECK(withoutProgram.code == 2);
  CHECK_THAT(withoutProgram.err, Contains("ffmpeg"));
  CHECK(test::contentsBelow(folder / "a").empty());
  if (!ffmpegIsThere()) return;
  const auto stopped =
      runLab(walkCommand(folder / "b", {"--seconds", "60", "--views", "1"}),
             {.interruptWhen = [&](const std::string& err) { return Contains("rendering the video").match(err); }});
  CHECK(stopped.code == 130);
  const auto files = test::contentsBelow(folder / "b");
  for (const char* name : {"walk.mp4", "walk.mp4.part", "walk.json", "transforms.json"})
    CHECK_FALSE(files.contains(name));
}

TEST_CASE("synth walk refuses sizes, durations and exposures that no walk can have") {
  CHECK(runLab({"synth", "walk", "-o", "x", "--size", "161x90"}).code == 1);
  CHECK(runLab({"synth", "walk", "-o", "x", "--seconds", "0.5"}).code == 1);
  const auto shutter = runLab({"synth", "walk", "-o", "x", "--shutter", "0.02"});
  CHECK(shutter.code == 1);
  CHECK_THAT(shutter.err, Contains("--shutter"));
}
