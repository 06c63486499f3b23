// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/leave_one_out.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "batch/files/file_hash.h"
#include "batch/files/poses.h"
#include "ibr/author/build.h"
#include "ibr/author/poses.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Counts {
  std::size_t matched = 0, shared = 0;  // cells
  std::size_t refined = 0;              // views whose other poses were refined
};

std::vector<std::size_t> chosenViews(const PosedPhotographs& photographs, const LeaveOneOutOptions& options) {
  const std::vector<PosedImage>& images = photographs.images();
  std::vector<std::size_t> chosen;
  for (const std::string& name : options.views)
    check(std::ranges::find(images, name, &PosedImage::name) != images.end(), ErrorCode::invalidInput,
          "{}: has no photograph {} with a pose (--views)", options.photographs, name);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const bool wanted = options.views.empty() ? i % std::size_t(options.every) == 0
                                              : std::ranges::find(options.views, images[i].name) != options.views.end();
    if (!wanted) continue;
    check(images[i].camera.intrinsics.model == CameraModel::pinhole, ErrorCode::unsupported,
          "{}: a panorama cannot be left out, because views are rendered as pinhole images; compare with pinhole "
          "photographs by `ibr eval SCENE --truth`",
          images[i].name);
    chosen.push_back(i);
  }
  return chosen;
}

// Key of all inputs of the scores except the view: program, files, options.
std::uint64_t keyOf(const LeaveOneOutOptions& options, const BuildOptions& build, const PosedPhotographs& photographs,
                    const Context& context) {
  Hash hash;
  addProgram(hash);
  for (const PosedImage& image : photographs.images()) addFile(hash, fs::path(options.photographs) / image.name);
  if (!build.model.empty()) addFolder(hash, build.model);
  if (!build.masks.empty()) addFolder(hash, build.masks);
  for (const std::string& word : options.words) {
    std::error_code ignored;
    hash.add(word);
    if (fs::is_regular_file(word, ignored)) addFile(hash, word);  // folders hold results, or are hashed above
  }
  hash.add(context.options().seed);
  hash.add(context.options().device);
  return hash.value();
}

class LeaveOneOut {
 public:
  LeaveOneOut(const BuildOptions& build, bool resect, const EvaluationOptions& evaluation, std::uint64_t key,
              fs::path work, const Context& context)
      : build_(build),
        given_(readPoses(build, {})),
        resect_(resect),
        evaluation_(evaluation),
        key_(key),
        work_(std::move(work)),
        context_(context) {
    build_.output = work_ / ".scene-without-one";
    build_.cacheFolder = work_ / "cells";
  }

  ViewOutcome evaluate(const View& view, const Image8& truth, const Image8& used, ProgressLine& progress,
                       Progress place) {
    if (auto kept = fetch(view.name)) return *kept;
    ViewOutcome outcome;
    try {
      outcome = rebuiltWithout(view, truth, used, progress, place);
    } catch (const Error& e) {
      // Errors that this photograph alone can cause; all others end the command.
      if (e.code() != ErrorCode::invalidInput && e.code() != ErrorCode::unsupported) throw;
      outcome.name = view.name;
      outcome.failure = e.what();
    }
    fs::create_directories(file(view.name).parent_path());
    Json json = outcomeJson(outcome);
    json["device"] = device_;
    json["posesRefined"] = refined_;
    counts_.refined += refined_;
    writeFile(file(view.name), jsonLine(json));
    return outcome;
  }

  const Counts& counts() const { return counts_; }
  const std::string& device() const { return device_; }

 private:
  fs::path file(const std::string& view) const {
    Hash hash;
    hash.add(key_);
    hash.add(view);
    return work_ / "views" / fmt::format("{:016x}.json", hash.value());
  }

  // Returns the cached result; nullopt if there is none, or if its images were deleted.
  std::optional<ViewOutcome> fetch(const std::string& view) {
    if (!fs::exists(file(view))) return std::nullopt;
    try {
      const Json json = jsonOrDiscarded(readTextFile(file(view)));
      ViewOutcome outcome = outcomeOf(json);
      const auto pictures = evaluationFiles(evaluation_, view);
      if (outcome.failure.empty() && !std::ranges::all_of(pictures, [](const fs::path& f) { return fs::exists(f); }))
        return std::nullopt;
      if (const std::string device = json.at("device"); !device.empty()) device_ = device;
      counts_.refined += json.at("posesRefined").get<bool>();
      return outcome;
    } catch (const Json::exception&) {
      return std::nullopt;  // damaged file: computed again
    }
  }

  ViewOutcome rebuiltWithout(const View& view, const Image8& truth, const Image8& used, ProgressLine& progress,
                             Progress place) {
    BuildOptions build = build_;
    build.exclude.push_back(view.name);
    fs::remove_all(build.output);
    const BuildReport report = ibr::build(build, [&](const Progress&) { return progress.show(place); });
    refined_ = !report.refinement.poseChanges.empty();
    if (refined_) build.model = build.output / ".refined";
    for (const auto& cell : report.cells) ++(cell.cached ? counts_.shared : counts_.matched);
    const Scene scene = loadScene(build.output);
    check(!scene.cells.empty(), ErrorCode::invalidInput, "no cells are left without this photograph");
    const View among = refined_ || resect_ ? resectedView(view, build) : view;
    Evaluator evaluator(scene, {among}, evaluation_, context_);
    device_ = evaluator.deviceName();
    return evaluator.evaluate(among, truth, used);
  }

  // The view with its pose estimated among the build's poses; unchanged if too few points are shared.
  View resectedView(const View& view, const BuildOptions& build) const {
    const auto camera = resected(given_, view.name, readPoses(build, {}));
    if (!camera) return view;
    const Intrinsics& k = view.camera.intrinsics;
    return {view.name, {resized(camera->intrinsics, k.width, k.height), camera->pose}};
  }

  BuildOptions build_;
  const PosedModel given_;
  const bool resect_;
  bool refined_ = false;  // for the current view
  const EvaluationOptions& evaluation_;
  std::uint64_t key_;
  fs::path work_;
  const Context& context_;
  Counts counts_;
  std::string device_;
};

}  // namespace

ExitCode leaveOneOut(const LeaveOneOutOptions& options, const BuildChoices& choices,
                     const EvaluationOptions& evaluation, const Context& context) {
  BuildOptions build = buildOptionsOf(choices, options.photographs, context);
  check(!build.model.empty(), ErrorCode::invalidInput,
        "{}: --leave-one-out needs poses of all photographs; give them with --model", options.photographs);
  const fs::path anywhere = fs::temp_directory_path() / "ibr-leave-one-out";  // placeholder: the key is not known yet
  build.output = options.work.empty() ? anywhere : fs::path(options.work);
  const std::uint64_t key = keyOf(options, build, PosedPhotographs(build, context.log()), context);
  // Named by the key, so that the same command finds the folder again.
  const fs::path work = options.work.empty() ? fs::temp_directory_path() / fmt::format("ibr-leave-one-out-{:016x}", key)
                                             : fs::path(options.work);
  build.output = work;
  const PosedPhotographs photographs(build, context.log());
  const std::vector<std::size_t> chosen = chosenViews(photographs, options);
  std::vector<View> views;
  for (const std::size_t i : chosen) views.push_back({photographs.images()[i].name, photographs.images()[i].camera});
  if (!evaluation.pictures.empty()) {
    checkNamesDiffer(views);
    for (const View& view : views) evaluationFiles(evaluation, view.name);
  }
  context.logMessage(LogLevel::info, "leaving out {} of {} photographs, one at a time; builds are cached in {}{}",
                     views.size(), photographs.images().size(), work.string(),
                     options.work.empty() ? " until the end of the run" : "");

  context.logMessage(LogLevel::info, "settings: {}", presetText(evaluation.settings));
  LeaveOneOut run(build, options.resect, evaluation, key, work, context);
  std::vector<ViewOutcome> outcomes;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Progress place{"leaving out", i, views.size()};
      check(progress.show(place), ErrorCode::cancelled, "stopped");
      outcomes.push_back(
          run.evaluate(views[i], photographs.photograph(chosen[i]), photographs.mask(chosen[i]), progress, place));
      if (const auto& failure = outcomes.back().failure; !failure.empty())
        context.logMessage(LogLevel::warning, "{}: {}", views[i].name, failure);
    }
    progress.show({"leaving out", views.size(), views.size()});
  }
  Json about{{"device", run.device()},
             {"settings", settingsJson(evaluation.settings, evaluation.gpuScene)},
             {"photographs", options.photographs},
             {"model", build.model.string()},
             {"cellsMatched", run.counts().matched},
             {"cellsShared", run.counts().shared},
             {"posesRefined", run.counts().refined}};
  reportOutcomes(outcomes, evaluation, std::move(about), context);
  context.print("{} cells were matched, {} were reused from another view's build\n", run.counts().matched,
                run.counts().shared);
  if (build.refinePoses == RefinePoses::on || run.counts().refined > 0)
    context.print("poses were refined for {} of {} views, and are unchanged for the others\n", run.counts().refined,
                  views.size());
  fs::remove_all(work / ".scene-without-one");
  if (options.work.empty()) fs::remove_all(work);
  check(std::ranges::any_of(outcomes, [](const ViewOutcome& o) { return o.failure.empty(); }), ErrorCode::invalidInput,
        "{}: no view could be evaluated: {}", options.photographs, outcomes.empty() ? "" : outcomes[0].failure);
  return kExitOk;
}

}  // namespace ibr::app
