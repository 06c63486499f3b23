// SPDX-License-Identifier: Apache-2.0
// Folders with one trouble each, as a user asks about them.
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "../unit/io/unusual_files.h"
#include "base/file.h"
#include "io/image_file.h"
#include "run_program.h"
#include "support/temporary_folder.h"
#include "tiny_scene.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::runProgram;

namespace {

struct Diagnosis {
  int code;
  std::string text;  // of the findings
  std::set<std::string> subjects;
  std::string err;
};

Diagnosis doctor(const std::vector<std::string>& arguments, const test::RunOptions& options = {}) {
  std::vector<std::string> words{"doctor"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--json", "-"});
  const auto outcome = runProgram(words, options);
  Diagnosis diagnosis{outcome.code, {}, {}, outcome.err};
  if (outcome.out.empty()) return diagnosis;
  const auto json = nlohmann::json::parse(outcome.out);
  for (const auto& finding : json.at("findings")) {
    diagnosis.subjects.insert(finding.at("subject").get<std::string>());
    diagnosis.text += finding.at("sentence").get<std::string>() + ' ' + finding.at("remedy").get<std::string>() + '\n';
  }
  return diagnosis;
}

using Subjects = std::set<std::string>;

void writeBytes(const fs::path& file, const test::Bytes& bytes) {
  writeFile(file, std::as_bytes(std::span(bytes)));
}

}  // namespace

TEST_CASE("doctor finds nothing amiss with a good folder, and each trouble of a bad one by itself") {
  test::TemporaryFolder folder;
  const fs::path photographs = folder / "row";
  fs::create_directories(photographs);
  test::makeRow(photographs);
  const auto examine = [&] { return doctor({photographs}); };

  SECTION("none") {
    const Diagnosis good = examine();
    INFO(good.text);
    CHECK(good.code == 0);
    CHECK(good.subjects.empty());
    CHECK_THAT(runProgram({"doctor", photographs}).out,
               Contains("5 photographs, most of 192×144 px") && Contains("poses: ") && Contains("nothing is amiss"));
  }
  SECTION("a file that breaks off") {
    const auto whole = readFile(photographs / "row2.png");
    writeFile(photographs / "row2.png", std::span(whole).first(whole.size() / 2));
    const Diagnosis broken = examine();
    CHECK(broken.code == 3);
    CHECK(broken.subjects == Subjects{"file"});
    CHECK_THAT(broken.text, Contains("row2.png cannot be read"));
  }
  SECTION("a format that is not read, raw files and a video") {
    writeFile(photographs / "IMG_1.HEIC", std::string_view("\0\0\0\x18"
                                                           "ftypheic\0\0\0\0mif1heic",
                                                           24));
    writeFile(photographs / "_DSC1.NEF", std::string_view("II*\0", 4));
    writeFile(photographs / "walk.mp4", std::string_view("video"));
    const Diagnosis foreign = examine();
    CHECK(foreign.code == 0);
    CHECK(foreign.subjects == Subjects{"format"});
    CHECK_THAT(foreign.text, Contains("IMG_1.HEIC is not read (HEIC") && Contains("_DSC1.NEF is not read (raw)") &&
                                 Contains("ffmpeg"));
  }
  SECTION("one that was made small, without a pose") {
    writeImage(photographs / "small.png", test::noisyPicture(64, 48, 3));
    const Diagnosis small = examine();
    CHECK(small.code == 0);
    CHECK(small.subjects == Subjects{"poses", "size"});
    CHECK_THAT(small.text, Contains("small.png: 64×48 px, much less than the others") &&
                               Contains("1 of 6 photographs have no pose: small.png"));
  }
  SECTION("a copy") {
    fs::remove_all(photographs / "sparse");
    fs::copy(photographs / "row3.png", photographs / "row3 (1).png");
    const Diagnosis copy = examine();
    CHECK(copy.subjects == Subjects{"repeated"});
    CHECK_THAT(copy.text, Contains("is a copy of"));
  }
  SECTION("a blurred one") {
    std::uint32_t state = 1;  // of the grain that sharp photographs have
    for (int n = 0; n < 5; ++n) {
      const fs::path file = photographs / ("row" + std::to_string(n) + ".png");
      Image8 grained = readImage(file);
      for (std::uint8_t& v : grained.values) {
        state = state * 1664525u + 1013904223u;
        v = std::uint8_t(std::clamp(int(v) + int(state >> 27) - 16, 0, 255));
      }
      writeImage(file, grained);
    }
    CHECK(examine().subjects.empty());
    const Image8 sharp = readImage(photographs / "row2.png");
    Image8 soft = sharp;
    for (int y = 0; y < sharp.height; ++y)
      for (int x = 0; x < sharp.width; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          int sum = 0, count = 0;
          for (int j = std::max(0, y - 4); j <= std::min(sharp.height - 1, y + 4); ++j)
            for (int i = std::max(0, x - 4); i <= std::min(sharp.width - 1, x + 4); ++i, ++count)
              sum += sharp.pixel(i, j)[c];
          soft.pixel(x, y)[c] = std::uint8_t(sum / count);
        }
    writeImage(photographs / "row2.png", soft);
    const Diagnosis blurred = examine();
    CHECK(blurred.subjects == Subjects{"blur"});
    CHECK_THAT(blurred.text, Contains("row2.png is blurred"));
  }
  SECTION("a model that is no model") {
    writeFile(photographs / "sparse/images.txt", std::string_view("1 2 three\n"));
    const Diagnosis spoilt = examine();
    CHECK(spoilt.code == 3);
    CHECK(spoilt.subjects == Subjects{"poses"});
    CHECK_THAT(spoilt.text, Contains("images.txt"));
  }
}

TEST_CASE("doctor reads what the camera wrote down: exposure and zoom") {
  test::TemporaryFolder folder;
  const auto shoot = [&](const std::string& name, std::uint32_t perSecond, std::uint32_t millimetres) {
    const auto jpeg = test::makeJpeg(test::noisyPicture(160, 120, 3), test::JpegKind::baseline);
    using E = test::ExifEntry;
    const auto block = test::exifBlock(
        {E{0x10f, 2, {}, "Maker"}, E{0x110, 2, {}, "Camera"}},
        {E{0x829a, 5, {1, perSecond}}, E{0x829d, 5, {8, 1}}, E{0x8827, 3, {100}}, E{0x920a, 5, {millimetres, 1}}},
        true);
    writeBytes(folder / name, test::withExifBlock(jpeg, block));
  };
  for (int i = 0; i < 5; ++i) shoot("p" + std::to_string(i) + ".jpg", 100, 24);
  shoot("p5.jpg", 500, 24);
  shoot("p6.jpg", 100, 50);
  const Diagnosis diagnosis = doctor({folder.path()});
  INFO(diagnosis.text);
  CHECK(diagnosis.code == 0);
  CHECK(diagnosis.subjects == Subjects{"exposure", "repeated", "zoom"});
  CHECK_THAT(diagnosis.text, Contains("was exposed 2.3 stops more than p5.jpg") &&
                                 Contains("p6.jpg: zoomed, at 50 mm and not 24 mm as the others"));
}

TEST_CASE("doctor and a scene") {
  CHECK(doctor({test::tinyScene()}).code == 0);
  test::TemporaryFolder folder;
  fs::copy(test::tinyScene(), folder / "scene", fs::copy_options::recursive);
  const std::string gltf = readTextFile(folder / "scene/scene.gltf");
  fs::remove(*fs::directory_iterator(folder / "scene/cells"));
  const Diagnosis spoilt = doctor({folder / "scene"});
  CHECK(spoilt.code == 3);
  CHECK(spoilt.subjects == Subjects{"fault"});
}

TEST_CASE("doctor takes anything, and says what it is not") {
  test::TemporaryFolder folder;
  CHECK(doctor({folder / "nowhere"}).code == 2);
  const Diagnosis empty = doctor({folder.path()});
  CHECK(empty.code == 3);
  CHECK(empty.subjects == Subjects{"count"});
  writeImage(folder / "a.png", test::noisyPicture(32, 32, 3));
  CHECK(doctor({folder / "a.png"}).code == 5);
  CHECK_THAT(doctor({folder.path()}).text, Contains("There is one photograph"));

  fs::create_directories(folder / "folder.jpg");
  fs::create_symlink(folder / "gone", folder / "link.jpg");
  REQUIRE(::mkfifo((folder / "pipe.png").c_str(), 0600) == 0);
  writeFile(folder / "empty.jpg", std::string_view());
  writeFile(folder / "words.tif", std::string_view("no picture"));
  writeImage(folder / "new\nline \xff.png", test::noisyPicture(1, 1, 3));
  const Image8 grey(64, 64, 3);
  writeImage(folder / "b.png", grey);
  writeImage(folder / "c.png", grey);
  const Diagnosis odd = doctor({folder.path()});
  INFO(odd.text);
  CHECK(odd.code == 3);
  CHECK_THAT(odd.text,
             Contains("empty.jpg cannot be read") && Contains("words.tif") && Contains("c.png is a copy of b.png"));
}

TEST_CASE("doctor of a machine says what is missing there") {
  test::TemporaryFolder folder;
  const std::string path = "PATH=" + folder.path().string(), home = "HOME=" + folder.path().string();
  const test::RunOptions bare{
      .environment = {path, home, "XR_RUNTIME_JSON=", "XDG_CONFIG_HOME=", "DISPLAY=", "WAYLAND_DISPLAY="}};
  const Diagnosis machine = doctor({}, bare);
  INFO(machine.text << machine.err);
  for (const char* subject : {"colmap", "ffmpeg", "display"}) CHECK(machine.subjects.contains(subject));
  if (test::deviceIsThere()) CHECK(machine.code == 0);

  writeFile(folder / "runtime.json", std::string_view(R"({"runtime":{"library_path":"./libgone.so"}})"));
  const Diagnosis gone = doctor({}, {.environment = {"XR_RUNTIME_JSON=" + (folder / "runtime.json").string()}});
  CHECK_THAT(gone.text, Contains("runtime.json names is not there"));
  writeFile(folder / "runtime.json", std::string_view("{"));
  const Diagnosis unread = doctor({}, {.environment = {"XR_RUNTIME_JSON=" + (folder / "runtime.json").string()}});
  CHECK_THAT(unread.text, Contains("does not name an OpenXR runtime"));

  const Diagnosis without =
      doctor({}, {.environment = {"VK_ICD_FILENAMES=/nowhere.json", "VK_DRIVER_FILES=/nowhere.json"}});
  CHECK(without.code == 5);
  CHECK(without.subjects.contains("device"));

  // A program that tells an old version, and one that never ends its sentence.
  writeFile(folder / "colmap", std::string_view("#!/bin/sh\necho 'COLMAP 3.6 -- Structure-from-Motion'\n"));
  fs::permissions(folder / "colmap", fs::perms::owner_all);
  CHECK_THAT(doctor({}, bare).text, Contains("COLMAP 3.6 is too old"));
}
