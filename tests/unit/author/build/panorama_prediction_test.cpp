// SPDX-License-Identifier: Apache-2.0
// Predicted work, time and memory of builds from panoramas. Stages are compared within one prediction, since its times
// scale with the present speed of the machine.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string_view>

#include "author/build/build_prediction.h"
#include "author/build/cell_maker.h"
#include "author/build/sweep_plan.h"
#include "author/panorama/panorama_cell.h"

using namespace ibr;

namespace {

// Photographs on a zigzag, a unit from their neighbours; three in a row make a triangle.
BuildInput photographsOf(Intrinsics intrinsics, int count) {
  BuildInput input;
  for (int i = 0; i < count; ++i) {
    const Camera camera{intrinsics, {{0.5 * i, 0, i % 2 ? 0.87 : 0}, {1, 0, 0, 0}}};
    input.model.images.push_back({fmt::format("{:03}.jpg", i), camera});
    Photograph photo;
    photo.name = input.model.images.back().name;
    photo.source = photo.imageFile = photo.name;
    photo.sourcePixels = double(intrinsics.width) * intrinsics.height;
    photo.whole = intrinsics;
    photo.camera = camera;
    photo.copied = true;
    input.photographs.push_back(photo);
  }
  input.tracksOf.resize(std::size_t(count));
  return input;
}

BuildInput panoramas(int width, int count) {
  return photographsOf({CameraModel::equirectangular, width, width / 2, 0, 0, 0, 0}, count);
}

BuildOptions options() {
  BuildOptions options;
  options.output = "no-such-scene";
  options.threads = 1;
  options.memory = 64e9;
  options.matchExposures = false;
  return options;
}

BuildPrediction predictionOf(const BuildInput& input, const BuildOptions& options = ::options()) {
  CellPlan plan;
  for (std::uint32_t i = 0; i + 2 < input.photographs.size(); ++i) plan.cells.push_back({i, i + 1, i + 2});
  return predictBuild(input, options, &plan);
}

double secondsOf(const BuildPrediction& prediction, std::string_view stage) {
  const auto found = std::ranges::find(prediction.stages, stage, &BuildPrediction::Stage::name);
  return found == prediction.stages.end() ? 0 : found->cpuSeconds;
}

// Time of a stage in units of the time that storing takes, which is proportional to the pixels of all photographs.
double costPerPixel(const BuildPrediction& prediction, std::string_view stage) {
  return secondsOf(prediction, stage) / secondsOf(prediction, "storing photographs");
}

}  // namespace

TEST_CASE("a cell of panoramas is predicted by its six faces, at the size at which they are matched") {
  for (const int width : {1024, 2048, 8192}) {
    const BuildInput input = panoramas(width, 4);
    const BuildOptions built = options();
    const CellMaker maker(input, built);
    const CellWork three = maker.work({0, 1, 2}), four = maker.work({0, 1, 2, 3});
    const double side = matchedFaceSide(width);
    CAPTURE(width, side);
    CHECK(three.faces == 6);
    CHECK(three.pixels == side * side);
    CHECK(three.sampledPixels == 3 * 6 * side * side);
    CHECK(three.mapPixels == 3.0 * std::min(width, 2048) * std::min(width, 2048) / 2);
    CHECK(three.levels == 0);
    CHECK(four.sampledPixels == Approx(three.sampledPixels * 4 / 3));
    // All faces with the matches of all members are held.
    CHECK(bytesToMake(three) > 6 * 3 * 11 * side * side);
    CHECK(bytesToMake(three) < 6 * 3 * 60 * side * side);
    CHECK(bytesToMake(four) > 1.15 * bytesToMake(three));
    CHECK(bytesToMake(four) < 4 / 3.0 * bytesToMake(three));
  }
  // Faces have at most two megapixels.
  CHECK(matchedFaceSide(8192) == matchedFaceSide(4096));
  CHECK(matchedFaceSide(2048) == Approx(2 * matchedFaceSide(1024)).margin(1));
}

TEST_CASE("cells of panoramas whose poses are refined are predicted with a sweep") {
  BuildInput input = panoramas(1024, 3);
  const BuildOptions refined = options();
  input.refinesPoses = true;
  CHECK(CellMaker(input, refined).work({0, 1, 2}).levels == 0);  // the poses are exact
  input.refine = true;
  const CellWork swept = CellMaker(input, refined).work({0, 1, 2});
  CHECK(swept.levels > 0);
  CHECK(swept.mapPixels == 0);
  CHECK(swept.faces == 6);
}

TEST_CASE("the sweeps of panoramas' faces have more levels in larger panoramas, within the limits") {
  const auto meanLevels = [](int width) {
    const SweepPlan plan(panoramas(width, 4));
    REQUIRE(plan.views().size() == 24);
    double sum = 0;
    for (std::size_t v = 0; v < plan.views().size(); ++v) {
      const int levels = plan.levels(v);
      REQUIRE(levels <= 161);
      REQUIRE(levels >= 49);
      sum += levels / 24.0;
    }
    return sum;
  };
  const double small = meanLevels(256), medium = meanLevels(512), large = meanLevels(4096);
  CHECK(small < 80);
  CHECK(medium > small);
  CHECK(large > 1.5 * small);
  // A single panorama has nothing to be swept against.
  CHECK(SweepPlan(panoramas(256, 1)).levels(0) == 0);
}

TEST_CASE("the predicted time of panoramas grows with their number and size") {
  const BuildPrediction six = predictionOf(panoramas(1024, 6)), twelve = predictionOf(panoramas(1024, 12)),
                        large = predictionOf(panoramas(2048, 6));
  CHECK(six.cells == 4);
  CHECK(twelve.cells == 10);
  for (const char* stage : {"sampling panoramas", "finding depth", "confirming depth", "completing backdrops"}) {
    CAPTURE(stage);
    CHECK(costPerPixel(six, stage) > 0);
    CHECK(costPerPixel(twelve, stage) == Approx(costPerPixel(six, stage)).epsilon(0.2));
  }
  // Faces of all directions are sampled, whatever the number of panoramas.
  for (const int count : {2, 3, 5, 11, 17}) {
    CAPTURE(count);
    const double cost = costPerPixel(predictionOf(panoramas(1024, count)), "finding depth");
    CHECK(cost == Approx(costPerPixel(six, "finding depth")).epsilon(0.2));
  }
  CHECK(costPerPixel(twelve, "matching cells") ==
        Approx(costPerPixel(six, "matching cells") * (10 / 12.0) / (4 / 6.0)));
  CHECK(costPerPixel(large, "matching cells") == Approx(costPerPixel(six, "matching cells")).epsilon(0.05));
  CHECK(costPerPixel(large, "finding depth") > 1.1 * costPerPixel(six, "finding depth"));  // more levels
  CHECK(costPerPixel(large, "finding depth") < 2 * costPerPixel(six, "finding depth"));
  // Depth takes most of the time, then the cells.
  CHECK(secondsOf(six, "finding depth") > secondsOf(six, "matching cells"));
  CHECK(secondsOf(six, "matching cells") > secondsOf(six, "completing backdrops"));
  CHECK(secondsOf(six, "completing backdrops") > secondsOf(six, "sampling panoramas"));
}

TEST_CASE("panoramas take longer than as many pixels of pinholes, which are not sampled") {
  const BuildPrediction panoramic = predictionOf(panoramas(1024, 6)),
                        pinhole = predictionOf(photographsOf(pinholeFromFov(1024, 512, 0.8), 6));
  CHECK(panoramic.megapixels == pinhole.megapixels);
  CHECK(secondsOf(pinhole, "sampling panoramas") == 0);
  CHECK(costPerPixel(panoramic, "matching cells") > 1.5 * costPerPixel(pinhole, "matching cells"));
}

TEST_CASE("the predicted memory of panoramas grows with their size, and the limit leads to fewer threads") {
  BuildOptions four = options();
  four.threads = 4;
  const auto of = [&](int width, double memory) {
    four.memory = memory;
    return predictionOf(panoramas(width, 6), four);
  };
  const BuildPrediction small = of(2048, 64e9), large = of(4096, 64e9);
  CHECK(large.memory > 1.5 * small.memory);
  CHECK(large.memory < 4 * small.memory);
  CHECK(small.threads == 4);
  const double jobs = 4;
  const double limit = small.memory * 0.6;
  const BuildPrediction limited = of(2048, limit);
  CHECK(limited.threads < jobs);
  CHECK(limited.memory <= limit);
  CHECK(of(2048, 1e6).threads == 1);
}
