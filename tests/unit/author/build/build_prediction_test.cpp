// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_prediction.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <string>
#include <string_view>

#include "author/build/build_cost.h"
#include "ibr/author/build.h"
#include "ibr/author/poses.h"
#include "support/court_photographs.h"
#include "support/error_of.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

BuildWork someWork(std::size_t count) {
  BuildWork work;
  work.photographs = count;
  work.readPixels = work.storedPixels = 1e6 * double(count);
  work.cells.assign(count, {1e6, 100, 3});
  work.backdrops = count;
  work.backdropPixels = work.sweptPixels = 2e5 * double(count);
  return work;
}

double secondsOf(const std::vector<StageCost>& stages, bool processor = false) {
  double sum = 0;
  for (const StageCost& stage : stages) sum += processor ? stage.cpuSeconds : stage.seconds;
  return sum;
}

test::CourtPhotographs court(int count) {
  return test::CourtPhotographs(makeCourt(count, 96, 72, 1));
}

}  // namespace

TEST_CASE("predicted time grows with the work, and shrinks with threads down to the longest job") {
  const StageThreads one, four{4, 4, 4, 4};
  const double once = secondsOf(costOf(someWork(8), one, TextureFormat::rgba8, {}));
  CHECK(secondsOf(costOf(someWork(16), one, TextureFormat::rgba8, {})) == Approx(2 * once));
  CHECK(secondsOf(costOf(someWork(8), four, TextureFormat::rgba8, {})) == Approx(once / 4));
  CHECK(secondsOf(costOf(someWork(1), four, TextureFormat::rgba8, {})) == Approx(once / 8));
  CHECK(secondsOf(costOf(someWork(8), four, TextureFormat::rgba8, {}), true) == Approx(once));
  CHECK(secondsOf(costOf(someWork(8), one, TextureFormat::rgba8, {2, 3})) == Approx(3 * once));
  CHECK(secondsOf(costOf(someWork(8), one, TextureFormat::rgba8, {2, 3}), true) == Approx(2 * once));
  CHECK(secondsOf(costOf(someWork(8), one, TextureFormat::bc7, {})) > once);
  BuildWork deep = someWork(8), full = someWork(8);
  for (CellWork& cell : deep.cells) cell.levels = 200;
  for (CellWork& cell : full.cells) cell.members = 4;
  CHECK(secondsOf(costOf(deep, one, TextureFormat::rgba8, {})) > 1.2 * once);
  CHECK(secondsOf(costOf(full, one, TextureFormat::rgba8, {})) > once);
  CHECK(costOf({}, four, TextureFormat::rgba8, {}).empty());
}

TEST_CASE("pose refinement is predicted on one thread, and not for exact poses") {
  const BuildWork work = someWork(8);
  BuildWork refined = work;
  refined.refinementObservations = 10000;
  const auto timeOf = [](const std::vector<StageCost>& stages, std::string_view name) {
    const auto found = std::ranges::find_if(stages, [&](const auto& s) { return s.stage == name; });
    return found == stages.end() ? 0 : found->seconds;
  };
  CHECK(timeOf(costOf(work, {}, TextureFormat::rgba8, {}), "refining poses") == 0);
  const double once = timeOf(costOf(refined, {}, TextureFormat::rgba8, {}), "refining poses");
  CHECK(once > 0.1);
  CHECK(timeOf(costOf(refined, {4, 4, 4, 4}, TextureFormat::rgba8, {}), "refining poses") == once);
  refined.refinementObservations *= 2;
  CHECK(timeOf(costOf(refined, {}, TextureFormat::rgba8, {}), "refining poses") == Approx(2 * once));

  // Cells are matched once more before.
  refined.sweptCells = refined.cells;
  CHECK(timeOf(costOf(refined, {}, TextureFormat::rgba8, {}), "matching cells") ==
        Approx(2 * timeOf(costOf(work, {}, TextureFormat::rgba8, {}), "matching cells")));

  const test::CourtPhotographs set = court(8);
  const test::TemporaryFolder folder;
  PosedModel bare = readColmapModel(set.options.model);
  REQUIRE(!bare.tracks.empty());
  bare.tracks.clear();
  writeColmapModel(bare, folder / "bare");
  const auto isPredicted = [&](RefinePoses refine, const std::filesystem::path& model) {
    BuildOptions options = set.options;
    options.model = model;
    options.refinePoses = refine;
    options.tracks = TrackSource::automatic;
    bool predicted = true;
    options.onPrediction = [&](const BuildPrediction& p) {
      predicted = std::ranges::any_of(p.stages, [](const auto& stage) { return stage.name == "refining poses"; });
      return false;
    };
    build(options);
    return predicted;
  };
  // The court's points show that its poses are exact. Without points, nothing is known of the poses.
  for (const RefinePoses refine : {RefinePoses::off, RefinePoses::on})
    CHECK_FALSE(isPredicted(refine, set.options.model));
  CHECK_FALSE(isPredicted(RefinePoses::off, folder / "bare"));
  CHECK(isPredicted(RefinePoses::on, folder / "bare"));
}

TEST_CASE("the time of planning depth is predicted by the points of all views, projected into each view") {
  // Of one point, relative to the time of finding a photograph's depth.
  const auto planningPerPoint = [](int count) {
    const test::CourtPhotographs set = court(count);
    double points = 0;
    for (const Track& track : readColmapModel(set.options.model).tracks) points += double(track.observations.size());
    BuildOptions options = set.options;
    double relative = 0;
    options.onPrediction = [&](const BuildPrediction& p) {
      std::map<std::string, double> seconds;
      for (const auto& stage : p.stages) seconds[stage.name] = stage.cpuSeconds;
      relative = seconds["planning depth"] / (points * count) / (seconds["finding depth"] / count);
      return false;
    };
    build(options);
    return relative;
  };
  const double few = planningPerPoint(8);
  CHECK(few > 0);
  CHECK(planningPerPoint(16) == Approx(few));
}

TEST_CASE("comparing exposures is predicted, unless it is disabled") {
  BuildWork work = someWork(8);
  const auto compared = [](const std::vector<StageCost>& stages) {
    return std::ranges::find_if(stages,
                                [](const auto& s) { return std::string_view(s.stage) == "comparing exposures"; });
  };
  const std::vector<StageCost> without = costOf(work, {}, TextureFormat::rgba8, {});
  CHECK(compared(without) == without.end());
  work.exposures = true;
  const std::vector<StageCost> with = costOf(work, {}, TextureFormat::rgba8, {});
  REQUIRE(compared(with) != with.end());
  CHECK(secondsOf(with) == Approx(secondsOf(without) + compared(with)->seconds));
  const std::vector<StageCost> side = costOf(work, {64, 64, 64, 64}, TextureFormat::rgba8, {});
  CHECK(compared(side)->seconds > 0.05 * compared(with)->seconds);  // the solver runs on one thread
  CHECK(compared(side)->seconds < compared(with)->seconds);

  CHECK(bytesToCompareExposures(work) > 0);
  CHECK(bytesToCompareExposures(someWork(8)) == 0);
  const auto bytesOf = [](std::size_t photographs) {
    BuildWork many = someWork(photographs);
    many.exposures = true;
    return bytesToCompareExposures(many);
  };
  CHECK(bytesOf(20) > 1.9 * bytesOf(10));
  CHECK(bytesOf(1000) == Approx(bytesOf(300)).epsilon(0.01));  // fewer points per photograph

  const test::CourtPhotographs set = court(4);
  BuildOptions options = set.options;
  for (const bool match : {true, false}) {
    bool comparisonPredicted = false;
    options.matchExposures = match;
    options.onPrediction = [&](const BuildPrediction& p) {
      comparisonPredicted =
          std::ranges::any_of(p.stages, [](const auto& stage) { return stage.name == "comparing exposures"; });
      return false;
    };
    build(options);
    CHECK(comparisonPredicted == match);
  }
}

TEST_CASE("the prediction is reported before the build begins, and a dry run writes nothing") {
  const test::CourtPhotographs set = court(8);
  BuildOptions options = set.options;
  int predictionCount = 0;
  BuildPrediction prediction;
  options.onPrediction = [&](const BuildPrediction& p) {
    ++predictionCount;
    prediction = p;
    CHECK(!fs::exists(options.output));
    return false;
  };
  CHECK(build(options).cells.empty());
  CHECK(!fs::exists(options.output));
  REQUIRE(predictionCount == 1);
  CHECK(prediction.photographs == 8);
  CHECK(prediction.backdrops == 8);
  CHECK(prediction.posesKnown);
  CHECK(prediction.cellCountKnown);
  CHECK(prediction.megapixels == Approx(8 * 96 * 72 / 1e6));
  CHECK(prediction.seconds > 0);
  double sum = 0;
  for (const auto& stage : prediction.stages) sum += stage.seconds;
  CHECK(sum == Approx(prediction.seconds));

  options.onPrediction = [](const BuildPrediction&) { return true; };
  const BuildReport report = build(options);
  CHECK(report.cells.size() + report.dropped.size() >= prediction.cells);
  CHECK(report.prediction.cells == prediction.cells);
  double bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(options.output))
    if (entry.is_regular_file()) bytes += double(entry.file_size());
  CHECK(bytes < prediction.disk);
  CHECK(bytes > 0.3 * prediction.disk);
  CHECK(report.cpuSeconds > 0);
  CHECK(report.memory > 1e6);
}

TEST_CASE("finding moving objects takes longer with more judging photographs, and is predicted only if it is enabled") {
  BuildWork work = someWork(8);
  const StageThreads one;
  const double without = secondsOf(costOf(work, one, TextureFormat::rgba8, {}));
  work.comparedPixels = 8e6;
  const double alone = secondsOf(costOf(work, one, TextureFormat::rgba8, {}));
  CHECK(alone > without);
  work.comparisonPixels = 24e6;
  const double judged = secondsOf(costOf(work, one, TextureFormat::rgba8, {}));
  CHECK(judged > alone);
  CHECK(secondsOf(costOf(work, {1, 1, 1, 1, 4}, TextureFormat::rgba8, {})) == Approx(without + (judged - without) / 4));

  const test::CourtPhotographs set = court(6);
  BuildOptions options = set.options;
  const auto stages = [&](bool remove) {
    std::vector<std::string> names;
    options.maskMovingObjects = remove;
    options.onPrediction = [&](const BuildPrediction& p) {
      for (const auto& stage : p.stages) names.push_back(stage.name);
      return false;
    };
    build(options);
    return names;
  };
  const std::vector<std::string> kept = stages(false), removed = stages(true);
  CHECK(std::ranges::find(kept, "finding moving objects") == kept.end());
  CHECK(std::ranges::find(removed, "finding moving objects") != removed.end());
}

TEST_CASE("a cell needs more memory for more pixels, levels and members") {
  const CellWork cell{1e6, 100, 2, 2e6, 3e6, 0};
  const double bytes = bytesToMake(cell);
  const auto with = [&](auto change) {
    CellWork other = cell;
    change(other);
    return bytesToMake(other);
  };
  CHECK(bytes > 1e8);
  CHECK(bytes < 3e8);
  CHECK(with([](CellWork& c) { c.pixels *= 2; }) > 1.9 * bytes);
  CHECK(with([](CellWork& c) { c.levels = 250; }) > 1.5 * bytes);
  CHECK(with([](CellWork& c) { c.members = 4; }) > bytes);
  CHECK(with([](CellWork& c) { c.loadingBytes += 1e8; }) == Approx(bytes + 1e8));
  CHECK(with([](CellWork& c) { c.excessPixels = 10e6; }) > bytes + 3e7);
  CHECK(with([](CellWork& c) { c.swept = false; }) > bytes);
}

TEST_CASE("less memory means fewer threads, never more memory") {
  // The job must be much larger than the memory that the test's own objects occupy between two predictions.
  const test::CourtPhotographs set(makeCourt(6, 480, 360, 1));
  BuildOptions options = set.options;
  options.threads = 8;
  const auto predicted = [&](double memory) {
    BuildPrediction prediction;
    options.memory = memory;
    options.onPrediction = [&](const BuildPrediction& p) {
      prediction = p;
      return false;
    };
    build(options);
    return prediction;
  };
  const BuildPrediction much = predicted(64e9), least = predicted(1e6);
  const double between = 0.5 * (least.memory + much.memory);
  const BuildPrediction less = predicted(between);
  CHECK(much.threads > 1);
  CHECK(less.memory <= between);
  CHECK(least.threads == 1);
  CHECK(least.memory > least.memoryLimitBytes);
}

TEST_CASE("without poses, the prediction uses the files alone") {
  const test::CourtPhotographs set = court(5);
  BuildOptions options = set.options;
  options.model.clear();
  options.colmap = "no such program";
  bool predicted = false;
  options.onPrediction = [&](const BuildPrediction& p) {
    predicted = true;
    CHECK(!p.posesKnown);
    CHECK(!p.cellCountKnown);
    CHECK(p.photographs == 5);
    return false;
  };
  build(options);
  CHECK(predicted);
  CHECK(!fs::exists(options.output));
}

TEST_CASE("insufficient disk space and memory are reported before anything is written") {
  BuildPrediction prediction;
  BuildOptions options;
  options.output = "scene";
  prediction.disk = 2e9;
  prediction.diskFreeBytes = 1e9;
  const Error error = test::errorOf([&] { checkDiskSpace(prediction, options, {}); });
  CHECK(error.code() == ErrorCode::io);
  CHECK_THAT(error.what(), Contains("2.0 GB") && Contains("1.0 GB") && Contains("--texture bc7"));
  std::string logged;
  const LogCallback log = [&](LogLevel, std::string_view text) { logged += text; };
  prediction.disk = 1.1e9;
  checkDiskSpace(prediction, options, log);
  CHECK_THAT(logged, Contains("1.1 GB"));
  logged.clear();
  prediction.disk = 0.5e9;
  checkDiskSpace(prediction, options, log);
  CHECK(logged.empty());
  prediction.memory = 3e9;
  prediction.memoryLimitBytes = 2e9;
  checkDiskSpace(prediction, options, log);
  CHECK_THAT(logged, Contains("3.0 GB") && Contains("--memory"));
}
