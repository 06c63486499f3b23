// SPDX-License-Identifier: Apache-2.0
// `ibr doctor` on folders with one problem each.
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "unit/io/unusual_files.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::runProgram;

namespace {

struct Diagnosis {
  int code;
  std::string text;  // text of the findings
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
  const auto json = test::parseJson(outcome.out);
  for (const auto& finding : json.at("findings")) {
    diagnosis.subjects.insert(finding.at("subject").get<std::string>());
    diagnosis.text += finding.at("problem").get<std::string>() + ' ' + finding.at("remedy").get<std::string>() + '\n';
  }
  return diagnosis;
}

using Subjects = std::set<std::string>;

void writeBytes(const fs::path& file, const test::Bytes& bytes) {
  writeFile(file, std::as_bytes(std::span(bytes)));
}

}  // namespace

TEST_CASE("doctor finds no problem in a good folder, and only the planted problem in a bad folder") {
  test::TemporaryFolder folder;
  const fs::path photographs = folder / "row";
  fs::create_directories(photographs);
  test::makeRow(photographs);
  const auto examine = [&] { return doctor({photographs}); };

  SECTION("no problem") {
    const Diagnosis good = examine();
    INFO(good.text);
    CHECK(good.code == 0);
    CHECK(good.subjects.empty());
    CHECK_THAT(runProgram({"doctor", photographs}).out,
               Contains("5 photographs") && Contains("192×144") && Contains("sparse"));
  }
  SECTION("a truncated file") {
    const auto whole = readFile(photographs / "row2.png");
    writeFile(photographs / "row2.png", std::span(whole).first(whole.size() / 2));
    const Diagnosis broken = examine();
    CHECK(broken.code == 3);
    CHECK(broken.subjects == Subjects{"file"});
    CHECK_THAT(broken.text, Contains("row2.png"));
  }
  SECTION("unsupported formats and videos") {
    writeFile(photographs / "IMG_1.gif", std::string_view("GIF89a"));
    writeFile(photographs / "walk.mp4", std::string_view("video"));
    const Diagnosis foreign = examine();
    CHECK(foreign.code == 0);
    CHECK(foreign.subjects == Subjects{"file", "format"});
    CHECK_THAT(foreign.text,
               Contains("IMG_1.gif") && Contains("Convert") && Contains("walk.mp4") && Contains("ibr build"));
  }
  SECTION("damaged files of formats that other libraries decode") {
    writeFile(photographs / "IMG_1.HEIC", std::string_view("\0\0\0\x18"
                                                           "ftypheic\0\0\0\0mif1heic",
                                                           24));
    writeFile(photographs / "_DSC1.NEF", std::string_view("II*\0", 4));
    const Diagnosis broken = examine();
    CHECK(broken.code == 3);
    CHECK(broken.subjects.contains("file"));
    CHECK_THAT(broken.text, Contains("IMG_1.HEIC") && Contains("_DSC1.NEF"));
  }
  SECTION("files that a build skips silently") {
    const std::string_view raw("II*\0", 4), webp("RIFF\0\0\0\0WEBP", 12);
    for (const char* name : {"row1.CR2", "row1.mov", "._row1.webp", "._walk.mov"}) writeFile(photographs / name, raw);
    fs::create_directories(photographs / "@eaDir");
    writeFile(photographs / "@eaDir/t.webp", webp);
    writeFile(photographs / "@eaDir/t.mp4", webp);
    const Diagnosis silent = examine();
    INFO(silent.text);
    CHECK(silent.subjects.empty());
  }
  SECTION("files with an unsupported extension, whatever their content") {
    fs::copy(photographs / "row1.png", photographs / "only.jxl");
    fs::copy(photographs / "row1.png", photographs / "solo.bmp");
    const Diagnosis unread = examine();
    CHECK(unread.code == 0);
    CHECK(unread.subjects == Subjects{"file"});
    CHECK_THAT(unread.text, Contains("only.jxl") && Contains("solo.bmp"));
  }
  SECTION("an empty file is reported once, and not as a photograph without a pose") {
    writeFile(photographs / "IMG_10.jpg", std::string_view());
    const Diagnosis empty = examine();
    CHECK(empty.code == 0);
    CHECK(empty.subjects == Subjects{"file"});
    CHECK_THAT(empty.text, Contains("IMG_10.jpg"));
    CHECK(std::ranges::count(empty.text, '\n') == 1);
  }
  SECTION("an empty file with a pose is a serious problem") {
    writeFile(photographs / "row2.png", std::string_view());
    const Diagnosis empty = examine();
    CHECK(empty.code == 3);
    CHECK_THAT(empty.text, Contains("row2.png") && Contains("--exclude"));
    CHECK(empty.text.find("--exclude") == empty.text.rfind("--exclude"));  // not reported as missing, too
  }
  SECTION("valid files of an unsupported kind get no advice to copy them again") {
    writeBytes(photographs / "ink.jpg", test::makeJpeg(test::noisyPicture(64, 48, 4), test::JpegKind::cmyk));
    const Diagnosis inks = examine();
    CHECK(inks.code == 3);
    CHECK(inks.subjects == Subjects{"file"});
    CHECK_THAT(inks.text, Contains("ink.jpg") && Contains("RGB") && !Contains("camera"));
  }
  SECTION("a downscaled photograph without a pose") {
    writeImage(photographs / "small.png", test::noisyPicture(64, 48, 3));
    const Diagnosis small = examine();
    CHECK(small.code == 0);
    CHECK(small.subjects == Subjects{"poses", "size"});
    CHECK_THAT(small.text, Contains("small.png") && Contains("64×48") && Contains("1 of 6"));
  }
  SECTION("a copied photograph") {
    fs::remove_all(photographs / "sparse");
    fs::copy(photographs / "row3.png", photographs / "row3 (1).png");
    const Diagnosis copy = examine();
    CHECK(copy.subjects == Subjects{"repeated"});
    CHECK_THAT(copy.text, Contains("copy") && Contains("row3.png") && Contains("row3 (1).png"));
  }
  SECTION("a photograph above the memory limit is reported from its header") {
    writeBytes(photographs / "vast.png", test::withPngSize(test::readBytes(photographs / "row1.png"), 16000, 16000));
    const auto vast = runProgram({"-c", "ulimit -v 1500000; exec \"$0\" doctor \"$1\"", IBR_PROGRAM, photographs},
                                 {.program = "/bin/sh"});
    CHECK(vast.code == 3);
    CHECK_THAT(vast.out, Contains("vast.png") && Contains("16000×16000") && Contains("1.9 GiB") &&
                             Contains("1.4 GiB") && !Contains("row1"));
  }
  SECTION("a malformed model") {
    writeFile(photographs / "sparse/images.txt", std::string_view("1 2 three\n"));
    const Diagnosis spoilt = examine();
    CHECK(spoilt.code == 3);
    CHECK(spoilt.subjects == Subjects{"poses"});
    CHECK_THAT(spoilt.text, Contains("images.txt"));
  }
}

TEST_CASE("doctor accepts the poses and masks that a build accepts") {
  test::TemporaryFolder folder;
  const fs::path photographs = folder / "in/row", masks = folder / "masks";
  fs::create_directories(photographs);
  test::makeRow(photographs);
  fs::rename(photographs / "sparse", folder / "elsewhere");
  CHECK_THAT(runProgram({"doctor", photographs}).out, Contains("COLMAP"));
  CHECK_THAT(runProgram({"doctor", photographs, "--model", folder / "elsewhere"}).out,
             Contains("elsewhere") && Contains("5 photographs"));
  CHECK(doctor({photographs, "--model", folder / "elsewhere"}).subjects.empty());
  const Diagnosis unread = doctor({photographs, "--transforms", folder / "transforms.json"});
  CHECK(unread.code == 3);
  CHECK_THAT(unread.text, Contains("transforms.json"));

  CHECK(doctor({photographs, "--masks", masks}).code == 2);
  fs::create_directories(masks);
  writeImage(masks / "row1.png", Image8(192, 144, 1));
  const auto good = runProgram({"doctor", photographs, "--masks", masks});
  CHECK_THAT(good.out, Contains("1 of 5"));
  CHECK(doctor({photographs, "--masks", masks}).subjects.empty());
  writeImage(masks / "row2.png.png", Image8(96, 72, 1));
  writeImage(masks / "rwo3.png", Image8(192, 144, 1));
  const Diagnosis wrong = doctor({photographs, "--masks", masks});
  CHECK(wrong.code == 3);
  CHECK(wrong.subjects == Subjects{"masks"});
  CHECK_THAT(wrong.text, Contains("row2.png.png") && Contains("96×72") && Contains("192×144") && Contains("rwo3.png"));
  CHECK(doctor({"--masks", masks}).code == 3);
}

TEST_CASE("info writes all other outputs before next-best views, of which there may be none") {
  test::TemporaryFolder folder;
  const fs::path svg = folder / "graph.svg", json = folder / "info.json";
  const std::vector<std::string> line{"info", test::tinyScene(), "--svg", svg, "--json", json, "--advice-poses"};
  auto words = line;
  words.push_back(folder / "no/such/folder/next.json");
  CHECK(runProgram(words).code == 2);
  CHECK((fs::exists(svg) && fs::exists(json)));

  Scene far = loadScene(test::tinyScene());  // so far away that a person's step shows nothing new
  for (Cell& cell : far.cells) {
    std::ranges::fill(cell.mesh.inverseDistance, 0.0f);
    for (auto& ratio : cell.mesh.ratio) std::ranges::fill(ratio, 1.0f);
  }
  far.backdrops.clear();
  fs::copy(test::tinyScene(), folder / "far", fs::copy_options::recursive);
  saveScene(far, folder / "far");
  const auto none = runProgram({"info", folder / "far", "--advice-poses", folder / "next.json"});
  INFO(none.err);
  CHECK(none.code == 0);
  CHECK_THAT(none.err, Contains("warning:") && Contains("next.json"));
  CHECK_FALSE(fs::exists(folder / "next.json"));
}

TEST_CASE("doctor reads exposure and focal length from EXIF") {
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
  CHECK_THAT(diagnosis.text, Contains("2.3 stops") && Contains("p5.jpg") && Contains("p6.jpg") && Contains("50 mm") &&
                                 Contains("24 mm"));
}

TEST_CASE("doctor reports blur only relative to similar photographs of the same size") {
  test::TemporaryFolder folder;
  // Grain of a given strength over a gradient, from left to right or from top to bottom.
  const auto shoot = [&](const std::string& name, int grain, bool down, int width, std::uint32_t exposure = 0) {
    Image8 picture(width, width * 3 / 4, 3);
    std::uint32_t state = std::uint32_t(std::hash<std::string>()(name));
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        state = state * 1664525u + 1013904223u;
        const int slope = down ? 160 * y / picture.height : 160 * x / picture.width;
        for (std::uint8_t& v : picture.pixel(x, y)) v = std::uint8_t(48 + slope + grain * int(state >> 28) / 16);
      }
    using E = test::ExifEntry;
    const auto block = test::exifBlock({}, {E{0x829a, 5, {exposure, 1}}}, true);
    const auto jpeg = test::makeJpeg(picture, test::JpegKind::baseline);
    writeBytes(folder / name, exposure ? test::withExifBlock(jpeg, block) : jpeg);
  };
  for (int i = 0; i < 6; ++i) shoot("p" + std::to_string(i) + "_a.jpg", 40, false, 240 + 8 * (i % 2));
  for (int i = 0; i < 6; ++i) shoot("p" + std::to_string(i) + "_b.jpg", 40, i == 2, 240 + 8 * (i % 2));
  shoot("p2_b.jpg", 4, true, 240);  // without detail, but no other photograph has the same direction
  CHECK(!doctor({folder.path()}).subjects.contains("blur"));
  shoot("p3_b.jpg", 4, false, 320);  // without detail, but the similar photograph has another size
  for (const char* name : {"q0.jpg", "q1.jpg", "q2.jpg"}) shoot(name, 40, true, 320);
  CHECK(!doctor({folder.path()}).subjects.contains("blur"));
  shoot("p4_b.jpg", 4, false, 240, 4);
  const Diagnosis blurred = doctor({folder.path()});
  CHECK(blurred.subjects.contains("blur"));
  CHECK_THAT(blurred.text, Contains("p4_b.jpg") && Contains("4.0 s"));
}

TEST_CASE("doctor validates a scene") {
  CHECK(doctor({test::tinyScene()}).code == 0);
  test::TemporaryFolder folder;
  fs::copy(test::tinyScene(), folder / "scene", fs::copy_options::recursive);
  const std::string gltf = readTextFile(folder / "scene/scene.gltf");
  fs::remove(*fs::directory_iterator(folder / "scene/cells"));
  const Diagnosis spoilt = doctor({folder / "scene"});
  CHECK(spoilt.code == 3);
  CHECK(spoilt.subjects == Subjects{"fault"});
}

TEST_CASE("doctor accepts any path and reports unusable files") {
  test::TemporaryFolder folder;
  CHECK(doctor({folder / "nowhere"}).code == 2);
  const Diagnosis empty = doctor({folder.path()});
  CHECK(empty.code == 3);
  CHECK(empty.subjects == Subjects{"count"});
  writeImage(folder / "a.png", test::noisyPicture(32, 32, 3));
  CHECK(doctor({folder / "a.png"}).code == 5);
  const Diagnosis one = doctor({folder.path()});
  CHECK(one.subjects == Subjects{"count"});
  CHECK(one.text != empty.text);

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
  CHECK(odd.code == 0);
  CHECK_THAT(odd.text, Contains("empty.jpg") && Contains("words.tif") && Contains("copy") && Contains("c.png") &&
                           Contains("b.png"));
}

TEST_CASE("doctor reports missing programs, runtimes, displays and devices of the machine") {
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
  CHECK_THAT(gone.text, Contains("runtime.json") && Contains("libgone.so"));
  writeFile(folder / "runtime.json", std::string_view("{"));
  const Diagnosis unread = doctor({}, {.environment = {"XR_RUNTIME_JSON=" + (folder / "runtime.json").string()}});
  CHECK(unread.subjects.contains("headset"));
  CHECK_THAT(unread.text, Contains("runtime.json") && !Contains("libgone.so"));

  const Diagnosis without =
      doctor({}, {.environment = {"VK_ICD_FILENAMES=/nowhere.json", "VK_DRIVER_FILES=/nowhere.json"}});
  CHECK(without.code == 5);
  CHECK(without.subjects.contains("device"));

  // Memory limit of this process, which is smaller than the machine's memory.
  const auto limited =
      runProgram({"-c", "ulimit -v 1500000; exec \"$0\" doctor --json -", IBR_PROGRAM}, {.program = "/bin/sh"});
  CHECK_THAT(limited.out, Contains("1.4 GiB"));
}

TEST_CASE("doctor accepts only a version as the answer of an external program") {
  test::TemporaryFolder folder;
  const test::RunOptions bare{.environment = {"PATH=" + folder.path().string() + ":/usr/bin:/bin"}};
  const auto stands = [&](const char* name, const std::string& script) {
    writeFile(folder / name, "#!/bin/sh\n" + script + '\n');
    fs::permissions(folder / name, fs::perms::owner_all);
  };
  stands("ffmpeg", "echo 'ffmpeg version 6.0 Copyright'");
  stands("colmap", "echo a warning; echo 'COLMAP 3.6 -- Structure-from-Motion'");
  Diagnosis machine = doctor({}, bare);
  CHECK_THAT(machine.text, Contains("COLMAP 3.6") && !Contains("ffmpeg"));
  stands("colmap", "echo 'colmap: error while loading shared libraries: libx.so.1' >&2; exit 127");
  machine = doctor({}, bare);
  CHECK(machine.subjects.contains("colmap"));
  CHECK_THAT(machine.text, Contains("COLMAP") && Contains("127") &&
                               Contains("colmap: error while loading shared libraries: libx.so.1"));
  // A program with another answer, and a program whose output never ends.
  stands("colmap", "echo hello");
  stands("ffmpeg", "tr '\\0' f </dev/zero");
  machine = doctor({}, bare);
  CHECK_THAT(machine.text, Contains("COLMAP") && Contains("hello") && Contains("ffmpeg") && Contains("5 seconds"));
}
