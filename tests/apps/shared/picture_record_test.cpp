// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/picture_record.h"

#include <catch2/catch.hpp>

#include "base/file.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::app;

namespace {

PictureRecord someRecord() {
  PictureRecord record;
  record.camera.intrinsics = {CameraModel::pinhole, 64, 48, 50.1, 50.2, 31.7, 24.3};
  record.camera.pose = {{1e6 + 1.0 / 3, -0.0, 1e-7}, glm::normalize(glm::dquat(0.9, 0.1, -0.3, 0.2))};
  record.settings = {{"cells", 4}, {"blend", "blend"}, {"floor", nullptr}};
  return record;
}

}  // namespace

TEST_CASE("an image's record round trips bit for bit") {
  test::TemporaryFolder folder;
  PictureRecord record = someRecord();
  for (const bool video : {false, true}) {
    if (video) record.time = 1.0 / 7;
    writePicture(folder / "a.png", Image8(64, 48, 3, 7), record);
    const auto again = readRecord(folder / "a.png");
    REQUIRE(again);
    CHECK(again->camera.intrinsics == record.camera.intrinsics);
    CHECK(again->camera.pose.position == record.camera.pose.position);
    CHECK(again->camera.pose.rotation == record.camera.pose.rotation);
    CHECK(again->time == record.time);
    CHECK(again->settings == record.settings);
    writePicture(folder / "b.png", Image8(64, 48, 3, 7), *again);
    CHECK(readFile(folder / "a.png") == readFile(folder / "b.png"));
    CHECK(readImage(folder / "a.png") == Image8(64, 48, 3, 7));
  }
}

TEST_CASE("images without a record are accepted, and errors in a record name the field") {
  test::TemporaryFolder folder;
  const Image8 image(2, 2, 3);
  writeImage(folder / "a.png", image, {{"Title", "something else"}});
  CHECK(!readRecord(folder / "a.png"));
  writeImage(folder / "a.jpg", image);
  CHECK(!readRecord(folder / "a.jpg"));

  const std::string whole =
      R"({"version":1,"view":{"position":[0,0,0],"rotation":[0,0,0,1],"intrinsics":{"model":"pinhole","width":8,)"
      R"("height":8,"fx":9,"fy":9,"cx":4,"cy":4}},"settings":{}})";
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = whole;
    text.replace(text.find(what), what.size(), by);
    return text;
  };
  writeImage(folder / "a.png", image, {{"ibr", whole}});
  REQUIRE(readRecord(folder / "a.png"));
  const std::pair<std::string, std::string> cases[] = {
      {"", "JSON"},
      {"[]", "\"version\""},
      {with(":1,", ":2,"), "/version"},
      {with("[0,0,0]", "[0,0,\"x\"]"), "/view/position/2"},
      {with("[0,0,0,1]", "[0,0,0,2]"), "/view/rotation/3"},
      {with("[0,0,0,1]", "[0,0,0.1,1]"), "/view/rotation"},
      {with("\"pinhole\"", "\"fisheye\""), "/view/intrinsics/model"},
      {with("\"width\":8", "\"width\":0"), "/view/intrinsics/width"},
      {with("\"fx\":9", "\"fx\":-9"), "/view/intrinsics/fx"},
      {with("\"fx\":9", "\"fx\":null"), "/view/intrinsics/fx"},
      {with("{}", "[]"), "/settings"},
      {with("\"position\"", "\"time\":1e300,\"position\""), "/view/time"},
  };
  for (const auto& [text, place] : cases) {
    INFO(text);
    writeImage(folder / "a.png", image, {{"ibr", text}});
    try {
      readRecord(folder / "a.png");
      FAIL_CHECK("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
      CHECK_THAT(e.what(), Catch::Contains("a.png") && Catch::Contains(place));
    }
  }
}
