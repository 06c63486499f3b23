// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/evaluator.h"

#include <algorithm>
#include <chrono>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/check.h"
#include "batch/evaluate/colour_scores.h"
#include "batch/evaluate/depth_scores.h"
#include "batch/files/poses.h"
#include "batch/files/truth.h"
#include "ibr/view_scores.h"
#include "io/image_file.h"
#include "shared/cli/settings.h"
#include "shared/draw/image_operations.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDifferenceGain = 4;

EvaluationOptions withHoles(EvaluationOptions options) {
  options.settings.alpha = AlphaContent::tier;
  options.settings.background = glm::vec3(0.0f);
  return options;
}

RenderSettings paperSettings(RenderSettings settings) {
  settings.composition = Composition::cells;
  settings.morph = Morph::paper;
  settings.order = DrawOrder::paper;
  settings.maxTier = kTierConsistent;
  settings.exposure = Exposure::off;
  return settings;
}

RendererOptions rendererOptions(const Scene& scene, const EvaluationOptions& options) {
  RendererOptions prepared = optionsFor(options.settings, {});
  if (options.seams || options.guessed || !options.truthDepth.empty()) prepared.bufferScene = &scene;
  if (!options.baselines.empty()) {
    prepared.orders = {DrawOrder::ours, DrawOrder::paper};
    prepared.compositions = {options.settings.composition, Composition::cells};
  }
  return prepared;
}

// True for baselines that display photographs directly (ibr/author/baselines.h).
bool needsBaselines(const EvaluationOptions& options) {
  return std::ranges::any_of(options.baselines, [](const std::string& name) {
    return name == "nearest" || name == "lumigraph" || name == "crossFade";
  });
}

std::string_view titleOf(const std::string& baseline) {
  return std::ranges::find(kBaselines, baseline, [](const auto& named) { return std::string_view(named.first); })
      ->second;
}

Scores meanOfBaseline(const std::vector<ViewOutcome>& outcomes, const std::string& name) {
  std::vector<Scores> all;
  for (const ViewOutcome& outcome : outcomes)
    for (const auto& [baseline, scores] : outcome.baselines)
      if (baseline == name) all.push_back(scores);
  return meanOf(all);
}

}  // namespace

Json outcomeJson(const ViewOutcome& outcome) {
  Json json{{"name", outcome.name}};
  json.update(scoresJson(outcome.scores));
  if (!outcome.failure.empty()) json["failure"] = outcome.failure;
  for (const auto& [name, scores] : outcome.baselines) json["baselines"][name] = scoresJson(scores);
  return json;
}

ViewOutcome outcomeOf(const Json& json) {
  ViewOutcome outcome{json.at("name"), scoresOf(json), {}, json.value("failure", "")};
  if (json.contains("baselines"))
    for (const auto& [name, scores] : json["baselines"].items()) outcome.baselines.emplace_back(name, scoresOf(scores));
  return outcome;
}

Evaluator::Evaluator(const Scene& scene, const std::vector<View>& views, const EvaluationOptions& options,
                     const Context& context)
    : scene_(scene),
      bounds_(sceneBounds(scene)),
      options_(withHoles(options)),
      renderer_(scene, views, options.gpuScene, rendererOptions(scene, options_), context) {
  if (needsBaselines(options)) baselines_.emplace(scene, BaselineOptions{.threads = context.options().threads});
  if (std::ranges::find(options.baselines, "gathered") == options.baselines.end()) return;
  check(isGatherable(scene), ErrorCode::invalidInput,
        "{}: has no depth of the photographs, which the baseline gathered needs; build the scene again",
        scene.folder.string());
  reference_.emplace(scene, context.options().threads);
}

SceneRenderer::Picture Evaluator::render(const Camera& view, const RenderSettings& settings) {
  PlanState alone;
  return renderer_.render(view, settings, alone);
}

SceneRenderer::Picture Evaluator::baseline(const std::string& name, const Camera& view) {
  if (name == "paper") return render(view, paperSettings(options_.settings));
  if (name == "paperOrder") {
    RenderSettings settings = options_.settings;
    settings.composition = Composition::cells;
    settings.order = DrawOrder::paper;
    return render(view, settings);
  }
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, options_.settings});
  baselines_->setExposure(options_.settings.exposure == Exposure::off ? std::nullopt : std::optional(plan.exposure));
  const auto begin = std::chrono::steady_clock::now();
  SceneRenderer::Picture picture;
  if (name == "nearest") {
    picture.image = baselines_->nearest(view);
  } else if (name == "lumigraph") {
    picture.image = baselines_->lumigraph(view);
  } else {
    if (plan.cells.empty()) {
      picture.image = Image8(view.intrinsics.width, view.intrinsics.height, 4, 0);
    } else {
      const Cell& cell = scene_.cells[plan.cells[0].cell];
      picture.image =
          baselines_->crossFade(view, cell, std::span(plan.cells[0].view[0].blend).first(cell.members.size()));
    }
  }
  picture.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return picture;
}

void Evaluator::write(const fs::path& folder, const View& view, const Image8& picture, const Image8& truth) const {
  const fs::path file = pictureFile(folder, view.name);
  fs::create_directories(file.parent_path());
  const Image8 shown = rgb(picture);
  writeImage(file, sideBySide({shown, truth, absoluteDifference(shown, truth, kDifferenceGain)}));
}

ViewOutcome Evaluator::evaluate(const View& view, const Image8& truth, const Image8& used) {
  // Drivers compile on first use, so the first image is rendered twice and the second one is timed.
  if (std::exchange(first_, false)) render(view.camera, options_.settings);
  const SceneRenderer::Picture ours = render(view.camera, options_.settings);
  ViewOutcome outcome{view.name, score(ours.image, truth, options_.fitGain, used), {}, {}};
  outcome.scores.milliseconds = ours.milliseconds;
  if (ours.buffers) {
    const SeamStep seam = seamStep(ours.image, ours.buffers->surface, truth);
    outcome.scores.seam = seam.levels;
    outcome.scores.seamDeltaE = seam.deltaE;
    outcome.scores.deltaE = gainFreeDeltaE(ours.image, truth, coverOf(ours.image));
    outcome.scores.guessed = guessedShare(*ours.buffers);
    const ImageF depth = truthOf(view);
    measureDepth(view, drawnInverseDepth(*ours.buffers), depth, outcome.scores);
    if (!depth.values.empty()) {
      const DeviationScores deviations = deviationScores(*ours.buffers, depth);
      outcome.scores.withinDeviation = deviations.one;
      outcome.scores.withinTwoDeviations = deviations.two;
    }
  }
  if (options_.seams) measureAlignment(view.camera, outcome.scores);
  if (!options_.pictures.empty()) write(options_.pictures, view, ours.image, truth);
  for (const std::string& name : options_.baselines) {
    if (name == "gathered") {
      outcome.baselines.emplace_back(name, gathered(view, truth, used));
      continue;
    }
    const SceneRenderer::Picture other = baseline(name, view.camera);
    outcome.baselines.emplace_back(name, score(other.image, truth, options_.fitGain, used));
    outcome.baselines.back().second.milliseconds = other.milliseconds;
    if (!options_.pictures.empty()) write(options_.pictures / name, view, other.image, truth);
  }
  return outcome;
}

Scores Evaluator::gathered(const View& view, const Image8& truth, const Image8& used) {
  const auto begin = std::chrono::steady_clock::now();
  const ReferenceView composed = reference_->compose(view.camera, options_.settings.exposure);
  Scores scores = score(composed.picture, truth, options_.fitGain, used);
  scores.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  scores.guessed = 1 - scores.coverageTier0;
  ImageF drawn = composed.inverseDepth;
  for (std::size_t p = 0; p < drawn.values.size(); ++p)
    if (composed.picture.values[4 * p + 3] == 0) drawn.values[p] = -1;
  measureDepth(view, drawn, truthOf(view), scores);
  if (!options_.pictures.empty()) write(options_.pictures / "gathered", view, composed.picture, truth);
  return scores;
}

ImageF Evaluator::truthOf(const View& view) const {
  if (options_.truthDepth.empty()) return {};
  ImageF truth = truthDepth(options_.truthDepth, view.name, options_.depthUnit);
  const Intrinsics& k = view.camera.intrinsics;
  check(truth.width == k.width && truth.height == k.height, ErrorCode::invalidInput,
        "{}: the depth image has {}×{} px, but the view has {}×{}",
        pictureFile(options_.truthDepth, view.name).string(), truth.width, truth.height, k.width, k.height);
  return truth;
}

void Evaluator::measureDepth(const View& view, const ImageF& inverseDepth, const ImageF& truth, Scores& scores) const {
  if (truth.values.empty()) return;
  const DepthScores depth = depthScores(inverseDepth, truth, {view.camera.intrinsics.fx, options_.depthBaseline});
  scores.rightDepth = depth.right;
  scores.tooFar = depth.tooFar;
  scores.tooNear = depth.tooNear;
}

void Evaluator::measureAlignment(const Camera& view, Scores& scores) const {
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, options_.settings});
  const std::vector<double> drawn = misalignmentsPx(scene_, bounds_, plan, 0, true),
                            without = misalignmentsPx(scene_, bounds_, plan, 0, false);
  scores.misaligned = quantile(drawn, 0.5);
  scores.misaligned95 = quantile(drawn, 0.95);
  scores.uncorrected = quantile(without, 0.5);
  scores.uncorrected95 = quantile(without, 0.95);
}

std::vector<fs::path> evaluationFiles(const EvaluationOptions& options, const std::string& viewName) {
  std::vector<fs::path> files;
  if (options.pictures.empty()) return files;
  files.push_back(pictureFile(options.pictures, viewName));
  for (const std::string& name : options.baselines) files.push_back(pictureFile(options.pictures / name, viewName));
  return files;
}

void reportOutcomes(const std::vector<ViewOutcome>& outcomes, const EvaluationOptions& options, Json more,
                    const Context& context) {
  std::vector<Scores> all;
  Table table, failures;
  Json views = Json::array();
  table.row(scoresHeading("view", options.fitGain));
  failures.row({"failed view", "reason"});
  for (const ViewOutcome& outcome : outcomes) {
    views.push_back(outcomeJson(outcome));
    if (!outcome.failure.empty()) {
      failures.row({outcome.name, outcome.failure});
      continue;
    }
    all.push_back(outcome.scores);
    table.row(scoresRow(outcome.name, outcome.scores, options.fitGain));
  }
  const Scores means = meanOf(all);
  Json mean = scoresJson(means);
  table.row(scoresRow("mean", means, options.fitGain));
  context.print("{}", table.text());
  if (options.seams)
    context.print(
        "seams {} levels, ΔE {}; colours ΔE {}; misalignment of cells {} px (median), {} px (95 %); unaligned {} px, "
        "{} px\n",
        numberText(means.seam, 3), numberText(means.seamDeltaE, 3), numberText(means.deltaE, 3),
        numberText(means.misaligned, 2), numberText(means.misaligned95, 2), numberText(means.uncorrected, 2),
        numberText(means.uncorrected95, 2));
  if (!options.truthDepth.empty())
    context.print("depth right {}, too far {}, too near {} (shares without sky; tolerance 1 px at a baseline of {})\n",
                  numberText(means.rightDepth, 3), numberText(means.tooFar, 3), numberText(means.tooNear, 3),
                  options.depthBaseline);
  if (!options.baselines.empty()) {
    Table methods;
    methods.row(scoresHeading("mean by method", options.fitGain));
    for (const std::string& name : options.baselines) {
      const Scores other = meanOfBaseline(outcomes, name);
      mean["baselines"][name] = scoresJson(other);
      methods.row(scoresRow(std::string(titleOf(name)), other, options.fitGain));
    }
    methods.row(scoresRow("ours", means, options.fitGain));
    context.print("\n{}", methods.text());
  }
  if (all.size() < outcomes.size()) context.print("\n{}", failures.text());
  Json report{{"views", std::move(views)}, {"mean", std::move(mean)}};
  report.update(more);
  context.report(report);
}

}  // namespace ibr::app
