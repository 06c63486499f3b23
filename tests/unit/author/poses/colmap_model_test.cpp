// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "base/file.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

const fs::path kData = IBR_TEST_DATA;

// The text model of tests/unit/author/data, which tests then damage.
struct TextModel {
  std::string cameras = readTextFile(kData / "tiny/cameras.txt");
  std::string images = readTextFile(kData / "tiny/images.txt");
  std::string points = readTextFile(kData / "tiny/points3D.txt");

  static void replace(std::string& text, const std::string& what, const std::string& with) {
    REQUIRE(text.find(what) != text.npos);
    text.replace(text.find(what), what.size(), with);
  }
  PosedModel read(const LogCallback& log = {}, Border border = Border::crop) const {
    test::TemporaryFolder folder;
    writeFile(folder / "cameras.txt", cameras);
    writeFile(folder / "images.txt", images);
    writeFile(folder / "points3D.txt", points);
    return readColmapModel(folder.path(), log, border);
  }
};

void checkSame(const PosedModel& a, const PosedModel& b) {
  REQUIRE(a.images.size() == b.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) {
    CHECK(a.images[i].name == b.images[i].name);
    CHECK(a.images[i].camera.intrinsics == b.images[i].camera.intrinsics);
    CHECK(glm::distance(a.images[i].camera.pose.position, b.images[i].camera.pose.position) < 1e-12);
    CHECK(a.images[i].camera.pose.rotation == b.images[i].camera.pose.rotation);
  }
  REQUIRE(a.tracks.size() == b.tracks.size());
  for (std::size_t t = 0; t < a.tracks.size(); ++t) {
    CHECK(a.tracks[t].position == b.tracks[t].position);
    REQUIRE(a.tracks[t].observations.size() == b.tracks[t].observations.size());
    for (std::size_t o = 0; o < a.tracks[t].observations.size(); ++o) {
      CHECK(a.tracks[t].observations[o].image == b.tracks[t].observations[o].image);
      CHECK(a.tracks[t].observations[o].pixel == b.tracks[t].observations[o].pixel);
    }
  }
}

}  // namespace

TEST_CASE("a COLMAP text model is converted to libibr's axes and sorted by name") {
  const PosedModel model = readColmapModel(kData / "tiny");
  REQUIRE(model.images.size() == 3);
  CHECK(model.images[0].name == "b.jpg");
  CHECK(model.images[1].name == "c.jpg");
  CHECK(model.images[2].name == "left/a.jpg");
  CHECK(model.images[0].camera.intrinsics == Intrinsics{CameraModel::pinhole, 640, 480, 500.5, 501.25, 320.5, 240.25});
  CHECK(model.images[2].camera.intrinsics == Intrinsics{CameraModel::pinhole, 480, 640, 450, 450, 240, 320});
  // World to camera: a quarter turn about y, t = (-5, 0, 1). R = [0 0 1; 0 1 0; -1 0 0], c = -Rᵀt = (1, 0, 5).
  CHECK(glm::distance(model.images[2].camera.pose.position, glm::dvec3(1, 0, 5)) < 1e-12);
  CHECK(glm::distance(viewAxis(model.images[2].camera.pose), glm::dvec3(-1, 0, 0)) < 1e-12);
  CHECK(glm::distance(viewAxis(model.images[0].camera.pose), glm::dvec3(0, 0, 1)) < 1e-12);

  REQUIRE(model.tracks.size() == 3);
  CHECK(model.tracks[2].position == glm::dvec3(-1.5, 2.25, 3.125));
  REQUIRE(model.tracks[0].observations.size() == 2);
  // Point 10 projects exactly to both of its observations.
  for (const TrackObservation& seen : model.tracks[0].observations) {
    const Camera& camera = model.images[seen.image].camera;
    const auto pixel = project(camera.intrinsics,
                               glm::inverse(camera.pose.rotation) * (model.tracks[0].position - camera.pose.position));
    REQUIRE(pixel);
    CHECK(glm::distance(*pixel, seen.pixel) < 1e-9);
  }
}

TEST_CASE("a binary COLMAP model equals the same model in text") {
  checkSame(readColmapModel(kData / "tiny_binary"), readColmapModel(kData / "tiny"));
}

TEST_CASE("CRLF line ends, comments, spaces in names and files of newer versions are accepted") {
  TextModel model;
  TextModel::replace(model.images, "b.jpg", "my holiday/b (1).jpg");
  TextModel::replace(model.images, "2 0.707", "# a comment\n\n  2 0.707");
  for (std::string* text : {&model.cameras, &model.images, &model.points})
    for (std::size_t at = 0; (at = text->find('\n', at)) != text->npos; at += 2) text->insert(at, "\r");
  const PosedModel read = model.read();
  REQUIRE(read.images.size() == 3);
  CHECK(read.images[2].name == "my holiday/b (1).jpg");
  CHECK(read.tracks.size() == 3);

  test::TemporaryFolder folder;
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"})
    fs::copy_file(kData / "tiny_binary" / name, folder / name);
  for (const char* name : {"rigs.bin", "frames.bin", "project.ini"}) writeFile(folder / name, "anything");
  std::vector<std::string> messages;
  const LogCallback log = [&](LogLevel, std::string_view text) { messages.emplace_back(text); };
  checkSame(readColmapModel(folder.path(), log), readColmapModel(kData / "tiny"));
  REQUIRE(messages.size() == 2);
  CHECK_THAT(messages[0], Contains("rigs.bin"));
  CHECK_THAT(messages[1], Contains("frames.bin"));
}

TEST_CASE("missing parts of a model are reported once and ignored") {
  std::vector<std::string> messages;
  const LogCallback log = [&](LogLevel, std::string_view text) { messages.emplace_back(text); };
  SECTION("a point") {
    TextModel model;
    TextModel::replace(model.points, "10 0 0 5", "99 0 0 5");
    CHECK(model.read(log).tracks.size() == 2);
    REQUIRE(messages.size() == 1);
    CHECK_THAT(messages[0], Contains("images.txt") && Contains(" 2 "));
  }
  SECTION("all points") {
    test::TemporaryFolder folder;
    writeFile(folder / "cameras.txt", TextModel().cameras);
    writeFile(folder / "images.txt", TextModel().images);
    const PosedModel model = readColmapModel(folder.path(), log);
    CHECK(model.images.size() == 3);
    CHECK(model.tracks.empty());
    REQUIRE_FALSE(messages.empty());
    CHECK_THAT(messages[0], Contains("points3D"));
  }
  SECTION("an image's registration") {
    TextModel model;
    TextModel::replace(model.images, "3 1 c.jpg", "3 4294967295 c.jpg");
    CHECK(model.read(log).images.size() == 2);
    REQUIRE(messages.size() == 1);
    CHECK_THAT(messages[0], Contains("images.txt:8") && Contains("c.jpg"));
  }
  SECTION("the last line of observations") {
    TextModel model;
    TextModel::replace(model.images, "c.jpg\n\n", "c.jpg");
    CHECK(model.read(log).images.size() == 3);
    CHECK(messages.empty());
  }
}

TEST_CASE("distorted cameras become pinholes, and their observations are undistorted") {
  TextModel model;
  TextModel::replace(model.cameras, "7 SIMPLE_PINHOLE 480 640 450 240 320", "7 SIMPLE_RADIAL 480 640 450 240 320 -0.1");
  const PosedModel straight = TextModel().read(), bent = model.read();
  REQUIRE(bent.images.size() == 3);
  const PosedImage& image = bent.images[2];
  REQUIRE(image.lens);
  CHECK(image.lens->model() == LensModel::simpleRadial);
  CHECK_FALSE(bent.images[0].lens);
  CHECK(bent.images[0].camera.intrinsics == straight.images[0].camera.intrinsics);
  CHECK(image.camera.intrinsics == undistorted(*image.lens));
  const PosedModel whole = model.read({}, Border::keep);
  CHECK(whole.images[2].camera.intrinsics == undistorted(*image.lens, Border::keep));
  std::size_t moved = 0;
  for (std::size_t t = 0; t < whole.tracks.size(); ++t)
    for (const TrackObservation& o : whole.tracks[t].observations) {
      const auto same = std::find_if(straight.tracks[t].observations.begin(), straight.tracks[t].observations.end(),
                                     [&](const TrackObservation& other) { return other.image == o.image; });
      REQUIRE(same != straight.tracks[t].observations.end());
      if (o.image != 2) {
        CHECK(o.pixel == same->pixel);
        continue;
      }
      const auto back = image.lens->project(unproject(whole.images[2].camera.intrinsics, o.pixel));
      REQUIRE(back);
      CHECK(glm::distance(*back, same->pixel) < 1e-8);
      ++moved;
    }
  CHECK(moved >= 1);
}

TEST_CASE("a malformed text model is rejected with line and field") {
  struct Spoilt {
    std::string TextModel::*file;
    const char *what, *with;
    std::vector<const char*> tokens;  // of the message
    ErrorCode code = ErrorCode::invalidInput;
  };
  const Spoilt cases[] = {
      {&TextModel::cameras, "7 SIMPLE", "1 SIMPLE", {"cameras.txt:3", "CAMERA_ID 1"}},
      {&TextModel::cameras, "500.5", "-500.5", {"cameras.txt:2", "focal", "-500.5"}},
      {&TextModel::cameras, "500.5", "0", {"cameras.txt:2", "focal", " 0 "}},
      {&TextModel::cameras, "500.5", "nan", {"cameras.txt:2", "PARAMS", "nan"}},
      {&TextModel::cameras, "500.5", "5e999", {"cameras.txt:2", "PARAMS", "5e999"}},
      {&TextModel::cameras, "500.5 ", "", {"cameras.txt:2", "3 PARAMS"}},
      {&TextModel::cameras, "640 480", "640 0", {"cameras.txt:2", "640x0"}},
      {&TextModel::cameras, "640 480", "640 99999", {"cameras.txt:2", "640x99999"}},
      {&TextModel::cameras, "640 480", "640 -1", {"cameras.txt:2", "HEIGHT", "-1"}},
      {&TextModel::cameras, "1 PINHOLE", "1 PINHOLES", {"cameras.txt:2", "MODEL", "PINHOLES"}, ErrorCode::unsupported},
      {&TextModel::cameras, "7 SIMPLE_PINHOLE", "7 SIMPLE_RADIAL", {"cameras.txt:3", "3 PARAMS", "SIMPLE_RADIAL"}},
      {&TextModel::images, "5 1 0 0 0", "2 1 0 0 0", {"images.txt:6", "IMAGE_ID 2"}},
      {&TextModel::images, "5 1 0 0 0", "5 0 0 0 0", {"images.txt:4", "(0, 0, 0, 0)"}},
      {&TextModel::images, "5 1 0 0 0", "5 1 1 0 0", {"images.txt:4", "(1, 1, 0, 0)"}},
      {&TextModel::images, "5 1 0 0 0", "5 inf 0 0 0", {"images.txt:4", "QW", "inf"}},
      {&TextModel::images, "5 1 0 0 0", "x 1 0 0 0", {"images.txt:4", "IMAGE_ID", "\"x\""}},
      {&TextModel::images, "-5 0 1 7", "-5 0 1,5 7", {"images.txt:6", "TZ", "1,5"}},
      {&TextModel::images, "1 b.jpg", "3 b.jpg", {"images.txt:4", "CAMERA_ID 3", "cameras.txt"}},
      {&TextModel::images, " 1 b.jpg", "", {"images.txt:4", "CAMERA_ID"}},
      {&TextModel::images, " b.jpg", "", {"images.txt:4", "NAME"}},
      {&TextModel::images, "b.jpg", "c.jpg", {"images.txt:", "NAME", "c.jpg"}},
      {&TextModel::images, "17.5 33.25 12", "17.5 33.25", {"images.txt:7", "POINT3D_ID"}},
      {&TextModel::images, "33.25 12", "33.25 1.5", {"images.txt:7", "POINT3D_ID", "1.5"}},
      {&TextModel::points, "11 1 0 5", "10 1 0 5", {"points3D.txt:2", "POINT3D_ID 10"}},
      {&TextModel::points, "11 1 0 5", "11 1 nan 5", {"points3D.txt:2", " Y ", "nan"}},
  };
  for (const Spoilt& spoilt : cases) {
    INFO(spoilt.what << " -> " << spoilt.with);
    TextModel model;
    TextModel::replace(model.*spoilt.file, spoilt.what, spoilt.with);
    const Error error = test::errorOf([&] { model.read(); });
    for (const char* token : spoilt.tokens) CHECK_THAT(error.what(), Contains(token));
    CHECK(error.code() == spoilt.code);
  }
  CHECK(test::errorOf([] { readColmapModel("/no/such/model"); }).code() == ErrorCode::io);
}

TEST_CASE("a malformed binary model is rejected with byte and field") {
  auto read = [](const char* file, auto&& spoil) {
    test::TemporaryFolder folder;
    for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
      std::vector<std::byte> bytes = readFile(kData / "tiny_binary" / name);
      if (std::string(name) == file) spoil(bytes);
      writeFile(folder / name, bytes);
    }
    return test::errorOf([&] { readColmapModel(folder.path()); });
  };
  auto put = [](auto value, std::size_t at) {
    return [=](std::vector<std::byte>& bytes) { std::memcpy(bytes.data() + at, &value, sizeof(value)); };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(read("cameras.bin", put(std::int32_t(77), 12)).what(),
             Contains("cameras.bin: byte 8") && Contains("MODEL 77"));
  CHECK_THAT(read("cameras.bin", put(nan, 32)).what(), Contains("cameras.bin: byte 32") && Contains("PARAMS"));
  CHECK_THAT(read("cameras.bin", put(-1.0, 32)).what(), Contains("cameras.bin") && Contains("focal") && Contains("-1"));
  CHECK_THAT(read("cameras.bin", put(~std::uint64_t(0), 0)).what(),
             Contains("cameras.bin: byte 0") && Contains("18446744073709551615"));
  CHECK_THAT(read("images.bin", put(nan, 12)).what(), Contains("images.bin: byte 12") && Contains("QVEC"));
  CHECK_THAT(read("images.bin", put(0.0, 12)).what(), Contains("images.bin: byte 8") && Contains("(0, 0.5, 0.5, 0.5)"));
  CHECK_THAT(read("images.bin", put(std::uint32_t(3), 68)).what(),
             Contains("images.bin: byte") && Contains("CAMERA_ID 3"));
  CHECK_THAT(read("points3D.bin", put(nan, 16)).what(), Contains("points3D.bin: byte 16") && Contains("XYZ"));
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const std::size_t size = readFile(kData / "tiny_binary" / file).size();
    for (std::size_t length = 0; length < size; ++length) {
      const Error error = read(file, [=](std::vector<std::byte>& bytes) { bytes.resize(length); });
      CHECK(error.code() == ErrorCode::invalidInput);
      CHECK_THAT(error.what(), Contains(file));
    }
    const Error longer = read(file, [](auto& bytes) { bytes.push_back({}); });
    CHECK(longer.code() == ErrorCode::invalidInput);
    CHECK_THAT(longer.what(), Contains(file + (": byte " + std::to_string(size))));
  }
}
