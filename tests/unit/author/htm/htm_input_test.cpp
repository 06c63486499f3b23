// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ibr/author/htm.h"
#include "io/image_file.h"
#include "support/contents_below.h"
#include "support/error_of.h"
#include "support/htm_files.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;

namespace ibr {
namespace {

const test::BumpyModel& theBody() {
  static const test::BumpyModel bumpy = [] {
    test::BumpyOptions options;
    options.cameras = 4;
    options.disagreement = 0;
    options.longitudes = 12;
    options.latitudes = 8;
    return test::bumpyModel(options);
  }();
  return bumpy;
}

struct Files {
  test::TemporaryFolder folder;
  HtmBuildOptions options;
  Files() {
    test::writeHtmFiles(theBody(), folder.path());
    options.mesh = folder / "mesh.obj";
    options.model = folder / "sparse";
    options.images = folder / "images";
    options.masks = folder / "masks";
    options.output = folder / "model";
    options.optimise.faces = 0;
    options.optimise.rounds = 1;
    options.optimise.radius = 2;
    options.optimise.laterRadius = 2;
    options.optimise.adjustRounds = 1;
    options.optimise.threads = 1;
  }
  // Checks that reading and building throw an Error with `code` and `what`, and that no output is written.
  void refused(ErrorCode code, const std::string& what) const {
    INFO(what);
    const Error read = test::errorOf([&] { readHtmInput(options); });
    CHECK(read.code() == code);
    CHECK_THAT(read.what(), Catch::Contains(what));
    CHECK(test::errorOf([&] { buildHtm(options); }).code() == code);
    CHECK(!fs::exists(options.output));
  }
};

}  // namespace

TEST_CASE("input is read from files unchanged") {
  Files files;
  auto [mesh, photographs] = readHtmInput(files.options);
  CHECK(mesh == theBody().model.surface.mesh);
  REQUIRE(photographs.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const HtmPhotograph& p = photographs[i];
    const Camera& camera = theBody().model.cameras[i].camera;
    CHECK(p.camera.name == theBody().model.cameras[i].name + ".png");
    CHECK(p.picture.values == theBody().pictures[i].photograph.values);
    CHECK(glm::distance(p.camera.camera.pose.position, camera.pose.position) < 1e-12);
    CHECK(std::abs(glm::dot(p.camera.camera.pose.rotation, camera.pose.rotation)) == Approx(1));
    REQUIRE(p.mask.channels == 1);
    CHECK(p.mask.pixel(80, 60)[0] == 255);
    CHECK(p.mask.pixel(1, 1)[0] == 0);
  }
  files.options.masks.clear();
  CHECK(readHtmInput(files.options).second[0].mask.empty());
  files.options.exclude = {"camera1.png", "camera3.png"};
  const auto fewer = readHtmInput(files.options).second;
  REQUIRE(fewer.size() == 2);
  CHECK(fewer[1].camera.name == "camera2.png");
  files.options.exclude = {"camera1.png", "camera9.png"};
  files.refused(ErrorCode::invalidInput, "camera9.png");
  files.options.exclude = {"camera0.png", "camera1.png", "camera2.png", "camera3.png"};
  files.refused(ErrorCode::invalidInput, "0 images");
}

TEST_CASE("photographs and masks are downsampled together") {
  Files files;
  files.options.maxSize = 80;
  const auto photographs = readHtmInput(files.options).second;
  for (const HtmPhotograph& p : photographs) {
    CHECK(p.picture.width == 80);
    CHECK(p.mask.width == 80);
    CHECK(p.mask.height == 60);
    CHECK(p.camera.camera.intrinsics.width == 80);
    CHECK(p.mask.pixel(40, 30)[0] == 255);
  }
}

TEST_CASE("masks are found by either name, and must have the photograph's size") {
  Files files;
  const fs::path masks = files.folder / "masks";
  fs::rename(masks / "camera0.png", masks / "camera0.png.png");
  CHECK(readHtmInput(files.options).second[0].mask.pixel(80, 60)[0] == 255);
  fs::remove(masks / "camera0.png.png");
  files.refused(ErrorCode::io, "camera0.png");
  for (const auto& [width, height] : {std::pair(80, 60), {120, 160}, {160, 119}, {320, 240}, {1, 1}}) {
    writeImage(masks / "camera0.png", Image8(width, height, 1, 255));
    files.refused(ErrorCode::invalidInput, "camera0.png");
  }
  writeImage(masks / "camera0.png", Image8(160, 120, 3, 255));
  CHECK(readHtmInput(files.options).second[0].mask.pixel(1, 1)[0] == 255);
  std::ofstream(masks / "camera0.png") << "no picture";
  CHECK_THROWS_AS(readHtmInput(files.options), Error);
  CHECK_THROWS_AS(buildHtm(files.options), Error);
  CHECK(!fs::exists(files.options.output));
}

TEST_CASE("missing or damaged input is reported by name, and nothing is written") {
  SECTION("a missing image") {
    Files files;
    fs::remove(files.folder / "images/camera2.png");
    files.refused(ErrorCode::io, "camera2.png");
  }
  SECTION("an image of another aspect ratio") {
    Files files;
    writeImage(files.folder / "images/camera2.png", Image8(100, 120, 3));
    files.refused(ErrorCode::invalidInput, "camera2.png");
  }
  SECTION("a missing, invalid or unsupported mesh") {
    Files files;
    fs::remove(files.folder / "mesh.obj");
    files.refused(ErrorCode::io, "mesh.obj");
    std::ofstream(files.folder / "mesh.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n";
    files.refused(ErrorCode::invalidInput, "mesh.obj");
    files.options.mesh = files.folder / "mesh.txt";
    std::ofstream(files.options.mesh) << "v";
    files.refused(ErrorCode::unsupported, "mesh.txt");
  }
  SECTION("a missing COLMAP model") {
    Files files;
    fs::remove_all(files.folder / "sparse");
    files.refused(ErrorCode::io, "sparse");
  }
  SECTION("more cameras than a model holds") {
    Files files;
    std::vector<HtmCamera> many(65, theBody().model.cameras[0]);
    for (std::size_t i = 0; i < many.size(); ++i) many[i].name = "camera" + std::to_string(i);
    test::writeSparse(files.folder / "sparse", many);
    files.refused(ErrorCode::invalidInput, "65 images");
  }
  SECTION("a mesh that no camera sees") {
    Files files;
    std::ofstream(files.folder / "mesh.obj") << "v 90 0 0\nv 91 0 0\nv 90 1 0\nf 1 2 3\n";
    CHECK(test::errorOf([&] { buildHtm(files.options); }).code() == ErrorCode::invalidInput);
    CHECK(!fs::exists(files.options.output));
  }
  SECTION("invalid options and cancellation") {
    Files files;
    files.options.optimise.rounds = 99;
    CHECK(test::errorOf([&] { buildHtm(files.options); }).code() == ErrorCode::invalidInput);
    files.options.optimise.rounds = 1;
    CHECK(test::errorOf([&] { buildHtm(files.options, [](const Progress&) { return false; }); }).code() ==
          ErrorCode::cancelled);
    CHECK(!fs::exists(files.options.output));
  }
}

TEST_CASE("an invalid output folder is rejected before anything is computed") {
  Files files;
  int steps = 0;
  const auto refusal = [&] {
    return test::errorOf([&] { buildHtm(files.options, [&](const Progress&) { return ++steps > 0; }); });
  };
  SECTION("a file is in the place of the folder") {
    files.options.output = files.folder / "mesh.obj/model";
    CHECK(refusal().code() == ErrorCode::io);
  }
  SECTION("photographs would be overwritten") {
    files.options.output = files.folder.path();
    files.options.maxSize = 80;
    CHECK_THAT(refusal().what(), Catch::Contains("images/camera"));
  }
  SECTION("the mesh or masks would be overwritten") {
    buildHtm(files.options);
    files.options.mesh = files.options.output / "model.gltf";
    CHECK_THAT(refusal().what(), Catch::Contains("model.gltf") && Catch::Contains("overwrite"));
    files.options.mesh = files.folder / "mesh.obj";
    files.options.masks = files.options.output / "visibility";
    CHECK_THAT(refusal().what(), Catch::Contains("camera0.png") && Catch::Contains("overwrite"));
  }
  CHECK(steps == 0);
}

TEST_CASE("a built model can be loaded, and a failed build leaves it unchanged") {
  Files files;
  const HtmResult result = buildHtm(files.options);
  for (const Fault& fault : validateHtmModelFiles(files.options.output)) FAIL_CHECK(fault.field << fault.message);
  const HtmModel model = loadHtmModel(files.options.output);
  CHECK(validate(model).empty());
  CHECK(model.complements == result.model.complements);
  CHECK(model.surface.members == result.model.surface.members);
  CHECK(model.source.has_value());
  REQUIRE(model.cameras.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const HtmCamera& camera = model.cameras[i];
    CHECK(camera.given.has_value());
    CHECK(readImage(files.options.output / camera.imageFile).values == theBody().pictures[i].photograph.values);
    const Image8 seen = readImage(files.options.output / camera.visibilityFile);
    CHECK(seen.width == 160);
    for (std::size_t p = 0; p < result.visibility[i].values.size(); ++p)
      REQUIRE(seen.values[3 * p] == result.visibility[i].values[p]);
  }
  const HtmOptions settings = htmOptionsFromJson(model.settings);
  CHECK(settings.radius == 2);
  CHECK(settings.adjustRounds == 1);
  const auto before = test::contentsBelow(files.options.output);
  fs::remove(files.folder / "masks/camera3.png");
  CHECK_THROWS_AS(buildHtm(files.options), Error);
  CHECK(test::contentsBelow(files.options.output) == before);
  files.options.masks.clear();
  CHECK_THROWS_AS(buildHtm(files.options, [](const Progress& p) { return p.stage != "matching"; }), Error);
  CHECK(test::contentsBelow(files.options.output) == before);
  // An existing model is overwritten.
  buildHtm(files.options);
  CHECK(validateHtmModelFiles(files.options.output).empty());
  // A file is in the place of the output folder.
  std::ofstream(files.folder / "file") << "x";
  files.options.output = files.folder / "file";
  CHECK(test::errorOf([&] { buildHtm(files.options); }).code() == ErrorCode::io);
  CHECK(fs::file_size(files.folder / "file") == 1);
}

TEST_CASE("photographs are never overwritten") {
  Files files;
  files.options.output = files.folder.path();  // images/ would be overwritten by the model's own, smaller images
  files.options.maxSize = 80;
  const auto before = test::contentsBelow(files.folder.path());
  CHECK(test::errorOf([&] { buildHtm(files.options); }).code() == ErrorCode::invalidInput);
  CHECK(test::contentsBelow(files.folder.path()) == before);
}

TEST_CASE("settings round trip through their text, and missing ones have defaults") {
  HtmBuildOptions build;
  HtmOptions& o = build.optimise;
  o = {.faces = 7,
       .inconsistentSize = 1.5,
       .inconsistentDifference = 2.5,
       .inconsistentShare = 0.25,
       .adjustRounds = 3,
       .adjustSmoothness = 4.5,
       .measure = TemplateMeasure::correlation,
       .radius = 5.5,
       .laterRadius = 6.5,
       .minTexture = 7.5,
       .smoothness = 0,
       .outlierPx = 9.5,
       .alpha = 0.125,
       .gamma1 = 11,
       .rounds = 4,
       .meanDifference = 12,
       .faceDifference = 13,
       .selfOccluded = false,
       .minFacePx = 14,
       .maxFaces = 15,
       .reject = false,
       .rejectDifference = 16,
       .rejectCorrelation = -0.5,
       .softPx = 17};
  build.maxSize = 640;
  const std::string text = htmOptionsToJson(build);
  const HtmOptions back = htmOptionsFromJson(text);
  HtmBuildOptions again{.optimise = back};
  again.maxSize = 640;
  CHECK(htmOptionsToJson(again) == text);
  CHECK(back.measure == TemplateMeasure::correlation);
  CHECK((back.faces == 7 && back.rounds == 4 && back.maxFaces == 15 && !back.reject && !back.selfOccluded));
  CHECK((back.softPx == 17 && back.rejectCorrelation == -0.5 && back.smoothness == 0));
  CHECK(htmOptionsFromJson("").rounds == HtmOptions().rounds);
  CHECK(htmOptionsFromJson("{}").rounds == HtmOptions().rounds);
  CHECK(htmOptionsFromJson(R"({"rounds":3,"another":[1]})").rounds == 3);
  CHECK(htmOptionsFromJson(R"({"measure":"sad"})").measure == TemplateMeasure::absoluteDifferences);
  for (const char* wrong : {"[", "[]", "1", R"({"rounds":"3"})", R"({"reject":1})", R"({"radius":true})",
                            R"({"radius":null})", R"({"faces":-1})", R"({"rounds":1.5})", R"({"measure":3})",
                            R"({"measure":"ssd"})", R"({"rounds":1e300})", R"({"faces":1e300})"}) {
    INFO(wrong);
    CHECK(test::errorOf([&] { htmOptionsFromJson(wrong); }).code() == ErrorCode::invalidInput);
  }
}

}  // namespace ibr
