// SPDX-License-Identifier: Apache-2.0
// `ibr build` of photographs as phones and cameras store them: HEIC, AVIF, WebP, raw, with metadata.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "decode/encoded_files.h"
#include "ibr/scene.h"
#include "io/image_file.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "unit/io/unusual_files.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::runProgram;

namespace {

// Writes the photograph of a PNG file without its extension, and returns the new file's extension.
using Encode = std::function<std::string(const fs::path& png, std::size_t number)>;

// Replaces the photographs of the tiny set by encoded ones, also in its model.
void encodePhotographs(const test::TinySet& set, const Encode& encode) {
  std::string images = readTextFile(set.photographs / "sparse/images.txt");
  for (std::size_t i = 0; i < set.cameras.size(); ++i) {
    const std::string name = set.cameras[i].name;
    const std::string extension = encode(set.photographs / name, i);
    fs::remove(set.photographs / name);
    images.replace(images.find(name), name.size(), fs::path(name).replace_extension(extension).string());
  }
  writeFile(set.photographs / "sparse/images.txt", images);
}

std::string encodeHeic(const fs::path& png, std::size_t) {
  test::runEncoder({"heif-enc", "-q", "95", "-o", fs::path(png).replace_extension(".heic").string(), png.string()});
  return ".heic";
}

// One photograph of each format.
std::string encodeMixed(const fs::path& png, std::size_t number) {
  if (number == 0) return encodeHeic(png, number);
  const std::string extension = number == 1 ? ".avif" : ".webp";
  const std::string to = fs::path(png).replace_extension(extension).string();
  if (number == 1)
    test::runEncoder({"avifenc", "-s", "8", "--min", "4", "--max", "8", png.string(), to});
  else
    test::runEncoder({"cwebp", "-quiet", "-q", "98", png.string(), "-o", to});
  return extension;
}

json built(std::vector<std::string> command) {
  command.insert(command.begin(), "build");
  command.insert(command.end(), {"--json", "-"});
  const auto outcome = runProgram(command);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return test::parseJson(outcome.out);
}

double psnrOf(const fs::path& scene, const fs::path& truth) {
  const auto eval = runProgram({"eval", scene, "--truth", truth, "--json", "-"});
  INFO(eval.err);
  REQUIRE(eval.code == 0);
  return test::parseJson(eval.out).at("views").at(0).at("psnr");
}

bool contains(const std::map<std::string, std::string>& files, const std::string& text) {
  return std::ranges::any_of(files, [&](const auto& file) { return file.second.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("photographs in HEIC, AVIF and WebP give the scene of their PNG files") {
  const test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const json plain = built({set.photographs, "-o", folder / "plain"});
  encodePhotographs(set, encodeMixed);
  const json encoded = built({set.photographs, "-o", folder / "scene"});
  REQUIRE(encoded.at("cells").size() == plain.at("cells").size());
  CHECK(encoded["cells"][0]["coverage"] > 0.95 * plain["cells"][0]["coverage"].get<double>());
  CHECK(encoded["cells"][0]["residualPx"] < 0.3);
  CHECK(runProgram({"validate", folder / "scene"}).code == 0);
  for (const char* name : {"a/0.heic", "a/1.avif", "b/2.webp"})
    CHECK(fs::exists(folder / "scene/textures" / (std::string(name) + ".ktx2")));
  // The codecs are lossy.
  if (test::deviceIsThere()) CHECK(psnrOf(folder / "scene", set.truth) > psnrOf(folder / "plain", set.truth) - 3);
}

TEST_CASE("exposures of raw photographs are factors of their linear light") {
  const test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  const std::array<double, 3> exposures{0.4, 0.2, 0.4};
  encodePhotographs(set, [&](const fs::path& png, std::size_t i) {
    test::writeDng(fs::path(png).replace_extension(".dng"), readImage(png), {.exposure = exposures[i]});
    return ".dng";
  });
  const json report = built({set.photographs, "-o", folder / "scene"});
  CHECK(report.at("exposures").at("measured") == 3);
  const Scene scene = loadScene(folder / "scene");
  REQUIRE(scene.nodes.size() == 3);
  for (const Node& node : scene.nodes)
    for (int c = 0; c < 3; ++c) {
      const double expected = node.name.find("a/1") != std::string::npos ? std::cbrt(4.0) : 1 / std::cbrt(2.0);
      INFO(node.name << ", channel " << c);
      CHECK(node.gain[c] == Approx(expected).epsilon(0.01));  // their logs have mean 0
    }
  CHECK(scene.nodes[0].capture.maker == "Maker");
}

TEST_CASE("COLMAP gets copies that it can read of HEIC photographs") {
  const test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  encodePhotographs(set, encodeHeic);
  fs::create_directories(folder / "models");
  fs::rename(set.photographs / "sparse", folder / "models/0");
  const auto outcome = runProgram({"build", set.photographs, "-o", folder / "scene", "--colmap", IBR_FAKE_COLMAP},
                                  {.environment = {"FAKE_COLMAP=" + folder.path().string()}});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const fs::path copies = folder / "scene/.poses/upright";
  CHECK_THAT(readTextFile(folder / "calls"), Contains("--image_path " + copies.string()));
  for (const char* name : {"a/0.heic", "a/1.heic", "b/2.heic"}) {
    CHECK(probeImage(copies / name).format == ImageFormat::jpeg);
    CHECK(test::psnr(readImage(copies / name), readImage(set.photographs / name)) > 35);
  }
}

TEST_CASE("a scene holds the metadata of photographs unless --strip-metadata is given") {
  const test::TemporaryFolder folder;
  const test::TinySet set = test::makeTinySet(folder.path());
  encodePhotographs(set, [](const fs::path& png, std::size_t) {
    test::writeBytes(
        fs::path(png).replace_extension(".jpg"),
        test::withExifBlock(test::makeJpeg(readImage(png), test::JpegKind::baseline), test::cameraExif(1)));
    return ".jpg";
  });
  const auto metadata = [](const fs::path& scene) {
    const auto info = runProgram({"info", scene, "--json", "-"});
    INFO(info.err);
    REQUIRE(info.code == 0);
    return test::parseJson(info.out).at("metadata");
  };
  built({set.photographs, "-o", folder / "kept"});
  CHECK(contains(test::contentsBelow(folder / "kept"), "Maker"));
  CHECK(metadata(folder / "kept").at("captureMetadata") == 3);
  CHECK(metadata(folder / "kept").at("kinds").contains("camera"));

  built({set.photographs, "-o", folder / "stripped", "--strip-metadata"});
  CHECK_FALSE(contains(test::contentsBelow(folder / "stripped"), "Maker"));  // nor in working folders
  CHECK(metadata(folder / "stripped").at("captureMetadata") == 0);
  CHECK(metadata(folder / "stripped").at("kinds").empty());
  CHECK(test::contentsBelow(folder / "stripped/textures") == test::contentsBelow(folder / "kept/textures"));
}
