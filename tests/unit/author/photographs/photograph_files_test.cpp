// SPDX-License-Identifier: Apache-2.0
// Photograph folders: all orientations, sizes unlike the model's, and unreadable files.
#include <catch2/catch.hpp>
#include <fstream>
#include <glm/vec2.hpp>

#include "author/build/build_input.h"
#include "author/photographs/photographs.h"
#include "base/file.h"
#include "ibr/author/build.h"
#include "ibr/author/photographs.h"
#include "io/image_file.h"
#include "support/court_photographs.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"
#include "support/turned_photograph.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::storedAs, test::writeTurned;

namespace {

void writeText(const fs::path& file, std::string_view text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

double meanDifference(const Image8& a, const Image8& b) {
  REQUIRE((a.width == b.width && a.height == b.height));
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) sum += std::abs(int(a.values[i]) - int(b.values[i]));
  return sum / double(a.values.size());
}

Image8 ramp(int width, int height) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      picture.pixel(x, y)[0] = std::uint8_t(240 * x / width);
      picture.pixel(x, y)[1] = std::uint8_t(240 * y / height);
      picture.pixel(x, y)[2] = 60;
    }
  return picture;
}

PosedImage posed(const std::string& name, int width, int height) {
  return {name, {pinholeFromFov(width, height, 1), {}}};
}

}  // namespace

TEST_CASE("a picture is read as stored, with three channels") {
  const test::TemporaryFolder folder;
  const Image8 stored = storedAs(6, ramp(48, 32));
  writeTurned(folder / "a.jpg", stored, 6);
  const Image8 picture = readPicture(folder / "a.jpg");
  CHECK(picture.width == stored.width);
  CHECK(picture.channels == 3);
  CHECK(meanDifference(picture, stored) < 4);
  CHECK(test::errorOf([&] { readPicture(folder / "missing.jpg"); }).code() == ErrorCode::io);
}

TEST_CASE("each EXIF orientation fits a model of upright images and a model of stored images") {
  const test::TemporaryFolder folder;
  for (const glm::ivec2 size : {glm::ivec2(48, 32), {32, 48}, {40, 40}})
    for (int orientation = 1; orientation <= 8; ++orientation) {
      const Image8 upright = ramp(size.x, size.y), stored = storedAs(orientation, upright);
      writeTurned(folder / "a.jpg", stored, orientation);
      INFO(size.x << "x" << size.y << ", orientation " << orientation);
      const PosedImage modelOfUpright = posed("a.jpg", size.x, size.y);
      const PosedImage modelOfStored = posed("a.jpg", stored.width, stored.height);
      const auto load = [&](const PosedImage& image, Orientation how) {
        return loadPhotograph(findPhotograph(folder / "", image, 0, how));
      };
      CHECK(meanDifference(load(modelOfUpright, Orientation::exif), upright) < 2);
      CHECK(meanDifference(load(modelOfStored, Orientation::stored), stored) < 2);
      const bool turnDetectable = orientation >= 5 && size.x != size.y;  // width and height reveal a quarter turn
      CHECK(meanDifference(load(modelOfUpright, Orientation::automatic), turnDetectable ? upright : stored) < 2);
      CHECK(meanDifference(load(modelOfStored, Orientation::automatic), stored) < 2);
      CHECK(findPhotograph(folder / "", modelOfStored, 0).orientationAmbiguous == (orientation > 1 && !turnDetectable));
      if (turnDetectable) {
        CHECK_THROWS_AS(findPhotograph(folder / "", modelOfUpright, 0, Orientation::stored), Error);
        CHECK_THROWS_AS(findPhotograph(folder / "", modelOfStored, 0, Orientation::exif), Error);
      }
    }
}

TEST_CASE("photographs that fit in both orientations are turned like the others of their set") {
  const test::TemporaryFolder folder;
  for (const bool withTurned : {false, true}) {
    fs::remove_all(folder / "photos");
    const Image8 upright = ramp(48, 32);
    PosedModel model;
    const auto add = [&](const std::string& name, int orientation, int width, int height) {
      writeTurned(folder / "photos" / name, storedAs(orientation, upright), orientation);
      model.images.push_back(posed(name, width, height));
    };
    add("half.jpg", 3, 48, 32);
    add("plain.jpg", 1, 48, 32);
    if (withTurned) add("quarter.jpg", 6, 48, 32);
    writeColmapModel(model, folder / "model");
    BuildOptions options;
    options.photographs = folder / "photos";
    options.model = folder / "model";
    options.output = folder / "scene";
    std::string logged;
    const LogCallback log = [&](LogLevel level, std::string_view text) {
      if (level == LogLevel::warning) logged += text;
    };
    const BuildInput input = readInput(options, log);
    CHECK(input.photographs[0].applyOrientation == withTurned);
    CHECK(!input.photographs[1].applyOrientation);
    CHECK(meanDifference(loadPhotograph(input.photographs[0]), withTurned ? upright : storedAs(3, upright)) < 2);
    CHECK_THAT(logged, Contains("half.jpg") && !Contains("plain.jpg") &&
                           Contains(withTurned ? "--orientation stored" : "--orientation exif"));
    options.orientation = withTurned ? Orientation::stored : Orientation::exif;
    logged.clear();
    if (withTurned) continue;  // as stored, quarter.jpg has another shape than its camera
    CHECK(readInput(options, log).photographs[0].applyOrientation);
    CHECK(logged.empty());
  }
}

TEST_CASE("a folder's photographs are separated from previews, hidden files and unreadable files") {
  const test::TemporaryFolder folder;
  const Image8 small(2, 2, 3, 9);
  for (const char* name : {"a.jpg", "b.png"}) writeImage(folder / name, small);
  fs::create_directories(folder / "sub/@eaDir/IMG.jpg");
  fs::copy_file(folder / "a.jpg", folder / "C.JPG");
  fs::copy_file(folder / "a.jpg", folder / "sub/d.jpeg");
  fs::copy_file(folder / "a.jpg", folder / "._a.jpg");
  fs::copy_file(folder / "a.jpg", folder / "sub/@eaDir/IMG.jpg/SYNOPHOTO_THUMB.jpg");
  fs::create_directories(folder / ".thumbnails");
  fs::copy_file(folder / "a.jpg", folder / ".thumbnails/a.jpg");
  fs::copy_file(folder / "a.jpg", folder / "caf\xe9.jpg");  // Latin-1
  writeText(folder / "notes.txt", "hello");
  writeText(folder / "empty.jpg", "");
  writeText(folder / "text.jpg", "hello");
  using namespace std::string_literals;
  const std::string heic = "\0\0\0\x18"s + "ftypheic" + "\0\0\0\0"s;
  writeText(folder / "phone.jpg", heic);  // under a JPEG name
  writeText(folder / "x1.HEIC", heic);
  writeText(folder / "a.heic", heic);         // beside a.jpg
  writeText(folder / "a.CR2", "II*\0raw"s);   // beside a.jpg
  writeText(folder / "x1.dng", "II*\0raw"s);  // beside x1.HEIC
  writeText(folder / "raw.NEF", "MM\0*raw"s);
  writeText(folder / "web.webp", "RIFF\x10\0\0\0WEBPVP8 "s);
  for (const char* name : {"1.gif", "2.gif", "3.gif", "4.GIF"}) writeText(folder / name, "GIF89a");
  writeText(folder / "x1.MOV", "live");  // a telephone's video beside a photograph
  writeText(folder / "walk.mp4", "video");
  const PhotographFolder found = scanPhotographFolder(folder / "");
  CHECK((found.pictures == std::vector<std::string>{"C.JPG", "a.jpg", "b.png", "caf\xe9.jpg", "phone.jpg", "raw.NEF",
                                                    "sub/d.jpeg", "web.webp", "x1.HEIC"}));
  std::vector<std::string> names;
  for (const auto& unreadable : found.unreadable) names.push_back(unreadable.name);
  CHECK((names == std::vector<std::string>{"1.gif", "2.gif", "3.gif", "4.GIF", "empty.jpg", "text.jpg"}));
  CHECK(found.videos == std::vector<std::string>{"walk.mp4"});
  CHECK((found.doubles == 3 && found.others == 2));
  const std::string text = unreadableText(found.unreadable);
  CHECK_THAT(text, Contains("1.gif, 2.gif, 3.gif") && Contains("1 more") && Contains(": GIF") && !Contains("4.GIF") &&
                       Contains("empty.jpg: ") && Contains("text.jpg: ") && !Contains("\n"));
  CHECK(unreadableText({}).empty());
  CHECK_THAT(countText(found), Contains("9 photographs") && Contains("3 files beside") && Contains("6 unreadable") &&
                                   Contains("1 video") && Contains("2 other files") && !Contains("\n"));
  CHECK(countText({}) == "0 photographs");
}

namespace {

// Four photographs of a court's wall: 96 × 72 px, 160 × 120 px, upright ones, and one that is twice as wide as its
// camera in the model.
test::CourtPhotographs mixedSet() {
  Court court = makeCourt(36, 96, 72, 1);
  court.cameras.resize(4);
  court.cameras[1].intrinsics = pinholeFromFov(160, 120, 0.9);
  court.cameras[2].intrinsics = pinholeFromFov(72, 96, 1.1);
  return test::CourtPhotographs(court, 3);
}

}  // namespace

TEST_CASE("links to photographs and folders are followed, and each file is found once") {
  const test::TemporaryFolder folder, elsewhere;
  const Image8 small(2, 2, 3, 9);
  fs::create_directories(folder / "p/sub");
  fs::create_directories(elsewhere / "trip/day");
  writeImage(folder / "p/a.jpg", small);
  for (const char* name : {"trip/b.jpg", "trip/day/c.jpg", "d.jpg"}) writeImage(elsewhere / name, small);
  fs::create_symlink(elsewhere / "d.jpg", folder / "p/d.jpg");
  fs::create_symlink(folder / "p/a.jpg", folder / "p/again.jpg");
  fs::create_symlink(folder / "nothing.jpg", folder / "p/broken.jpg");
  fs::create_directory_symlink(elsewhere / "trip", folder / "p/trip");
  fs::create_directory_symlink(elsewhere / "trip", folder / "p/trip2");
  fs::create_directory_symlink(folder / "p", folder / "p/loop");
  fs::create_directory_symlink(folder / "", folder / "p/sub/above");
  fs::create_directory_symlink(folder / "p", folder / "linked");
  for (const char* root : {"p", "linked"}) {
    INFO(root);
    const PhotographFolder found = scanPhotographFolder(folder / root);
    const std::string trip = fs::exists(folder / root / found.pictures.back())
                                 ? found.pictures.back().substr(0, found.pictures.back().find('/'))
                                 : "";
    CHECK((trip == "trip" || trip == "trip2"));
    CHECK((found.pictures == std::vector<std::string>{"a.jpg", "d.jpg", trip + "/b.jpg", trip + "/day/c.jpg"}));
    CHECK((found.doubles == 1 && found.others == 1));
    for (const std::string& name : found.pictures) CHECK(readPicture(folder / root / name) == small);
  }
}

TEST_CASE("a build follows links to photographs, and its scene needs none of them") {
  const test::CourtPhotographs set = mixedSet();
  const test::TemporaryFolder linked;
  fs::create_directories(linked / "photographs");
  for (int i = 0; i < 4; ++i) {
    const std::string name = fmt::format("photo0{}.jpg", i);
    fs::create_symlink(set.options.photographs / name, linked / "photographs" / name);
  }
  BuildOptions options = set.options;
  options.photographs = linked / "photographs";
  options.output = linked / "scene";
  options.backdrops = false;
  CHECK(!build(options).cells.empty());
  for (const auto& entry : fs::recursive_directory_iterator(linked / "scene")) CHECK(!entry.is_symlink());
  // A model whose names are those of a linked folder.
  fs::create_directory_symlink(set.options.photographs, linked / "sub");
  const PosedImage image = posed("sub/photo00.jpg", 96, 72);
  CHECK(findPhotograph(linked / "", image, 0).source == linked / "sub/photo00.jpg");
  for (const char* outside : {"../photo00.jpg", "sub/../../x.jpg", "/etc/hosts"}) {
    const Error error = test::errorOf([&] { findPhotograph(linked / "", posed(outside, 96, 72), 0); });
    CHECK_THAT(error.what(), Contains("leads outside"));
  }
}

TEST_CASE("photographs of several cameras and shapes share a cell") {
  const test::CourtPhotographs set = mixedSet();
  BuildOptions options = set.options;
  const BuildReport report = build(options);
  CHECK(report.unusedPhotographs.empty());
  REQUIRE(!report.cells.empty());
  bool mixed = false;
  for (const auto& cell : report.cells) {
    CHECK(cell.quality.ecc > 0.8);
    CHECK(cell.quality.coverage > 0.2);
    mixed = mixed || std::ranges::count(cell.members, "photo02.jpg") > 0;
  }
  CHECK(mixed);
  const Scene scene = loadScene(options.output);
  CHECK(scene.nodes[2].camera.intrinsics.height == 96);
  CHECK(scene.nodes[3].camera.intrinsics.width == 192);
}

TEST_CASE("all unreadable photographs are reported at once with a remedy") {
  const test::CourtPhotographs set = mixedSet();
  for (const char* name : {"photo01.jpg", "photo02.jpg"}) {
    const fs::path file = set.options.photographs / name;
    fs::resize_file(file, fs::file_size(file) / 2);
  }
  const Error error = test::errorOf([&] { build(set.options); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains("2 photographs") && Contains("photo01.jpg") && Contains("photo02.jpg") &&
                               !Contains("photo00.jpg") && Contains("--exclude"));
  BuildOptions options = set.options;
  options.exclude = {"photo01.jpg", "photo02.jpg"};
  options.backdrops = false;
  CHECK(build(options).cells.size() == 1);
}

TEST_CASE("unsupported files in a folder are reported and listed in the scene") {
  const test::CourtPhotographs set = mixedSet();
  using namespace std::string_literals;
  writeText(set.options.photographs / "x.gif", "GIF89a");
  writeText(set.options.photographs / "photo00.CR2", "II*\0raw"s);
  BuildOptions options = set.options;
  options.backdrops = false;
  std::string logged;
  const BuildReport report = build(options, {}, [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) logged += text;
  });
  CHECK_THAT(logged, Contains("x.gif: GIF") && !Contains("photo00.CR2"));
  REQUIRE(report.unusedPhotographs.size() == 1);
  CHECK(report.unusedPhotographs[0].name == "x.gif");
  CHECK_THAT(report.unusedPhotographs[0].reason, Contains("JPEG"));
}

TEST_CASE("scenes in a folder of photographs are not read as photographs") {
  const test::TemporaryFolder folder;
  const Image8 small(2, 2, 3, 9);
  for (const char* name : {"a.jpg", "made/images/a.jpg", "half/images/a.jpg", "trip/b.jpg"}) {
    fs::create_directories((folder / name).parent_path());
    writeImage(folder / name, small);
  }
  writeText(folder / "made/scene.gltf", "{}");
  fs::create_directories(folder / "half/.build");
  CHECK((scanPhotographFolder(folder / "").pictures == std::vector<std::string>{"a.jpg", "trip/b.jpg"}));
  CHECK((scanPhotographFolder(folder / "made").pictures ==
         std::vector<std::string>{"images/a.jpg"}));  // requested folder
}

TEST_CASE("all missing photographs are reported at once with similar file names") {
  const test::CourtPhotographs set = mixedSet();
  const fs::path photographs = set.options.photographs;
  fs::rename(photographs / "photo01.jpg", photographs / "Photo01.JPG");
  fs::remove(photographs / "photo03.jpg");
  const Error error = test::errorOf([&] { build(set.options); });
  CHECK(error.code() == ErrorCode::io);
  CHECK_THAT(error.what(), Contains("photo01.jpg") && Contains("Photo01.JPG") && Contains("photo03.jpg") &&
                               !Contains("photo00.jpg") && !Contains("photo02.jpg") && Contains("--exclude"));
}

TEST_CASE("stored images have the extension of their format") {
  const test::TemporaryFolder folder;
  const Image8 picture = ramp(48, 32);
  fs::create_directories(folder / "p");
  writeImage(folder / "p/a.png", picture);
  fs::rename(folder / "p/a.png", folder / "p/a.jpg");
  writeImage(folder / "p/b.jpg", picture);
  fs::rename(folder / "p/b.jpg", folder / "p/b.png");
  const Photograph called = findPhotograph(folder / "p", posed("a.jpg", 48, 32), 0);
  CHECK(!called.copied);
  CHECK(called.imageFile == "images/a.jpg.png");
  const Photograph other = findPhotograph(folder / "p", posed("b.png", 48, 32), 0);
  CHECK(!other.copied);
  CHECK(other.imageFile == "images/b.png");
  storePicture(other, folder / "scene");
  CHECK(probeImage(folder / "scene/images/b.png").format == ImageFormat::png);
}
