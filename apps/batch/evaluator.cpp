// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluator.h"

#include <chrono>
#include <glm/vec3.hpp>
#include <string_view>

#include "batch/colour_scores.h"
#include "batch/poses.h"
#include "io/image_file.h"
#include "render/alignment.h"
#include "shared/pictures.h"
#include "shared/settings.h"
#include "shared/statistics.h"
#include "shared/table.h"

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
  settings.morph = Morph::paper;
  settings.order = DrawOrder::paper;
  settings.lowestTier = kTierAgrees;
  settings.exposure = Exposure::off;
  return settings;
}

RendererOptions rendererOptions(const Scene& scene, const EvaluationOptions& options) {
  RendererOptions prepared = optionsFor(options.settings, {});
  if (options.seams) prepared.buffers = &scene;
  if (options.baselines) prepared.orders = {DrawOrder::ours, DrawOrder::paper};
  return prepared;
}

Scores meanOfBaseline(const std::vector<ViewOutcome>& outcomes, std::size_t which) {
  std::vector<Scores> all;
  for (const ViewOutcome& outcome : outcomes)
    if (which < outcome.baselines.size()) all.push_back(outcome.baselines[which]);
  return meanOf(all);
}

}  // namespace

Json outcomeJson(const ViewOutcome& outcome) {
  Json json{{"name", outcome.name}};
  json.update(scoresJson(outcome.scores));
  if (!outcome.failure.empty()) json["failure"] = outcome.failure;
  for (std::size_t b = 0; b < outcome.baselines.size(); ++b)
    json["baselines"][kBaselines[b].first] = scoresJson(outcome.baselines[b]);
  return json;
}

ViewOutcome outcomeOf(const Json& json) {
  ViewOutcome outcome{json.at("name"), scoresOf(json), {}, json.value("failure", "")};
  if (json.contains("baselines"))
    for (const auto& [name, title] : kBaselines) outcome.baselines.push_back(scoresOf(json["baselines"].at(name)));
  return outcome;
}

Evaluator::Evaluator(const Scene& scene, const std::vector<View>& views, const EvaluationOptions& options,
                     const Context& context)
    : scene_(scene),
      bounds_(sceneBounds(scene)),
      options_(withHoles(options)),
      renderer_(scene, views, options.gpuScene, rendererOptions(scene, options_), context) {
  if (options.baselines) baselines_.emplace(scene, BaselineOptions{.threads = context.options().threads});
}

SceneRenderer::Picture Evaluator::render(const Camera& view, const RenderSettings& settings) {
  PlanState alone;
  return renderer_.render(view, settings, alone);
}

SceneRenderer::Picture Evaluator::baseline(std::size_t which, const Camera& view) {
  const std::string_view name = kBaselines[which].first;
  if (name == "paper") return render(view, paperSettings(options_.settings));
  if (name == "paperOrder") {
    RenderSettings settings = options_.settings;
    settings.order = DrawOrder::paper;
    return render(view, settings);
  }
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, options_.settings});
  baselines_->expose(options_.settings.exposure == Exposure::off ? std::nullopt : std::optional(plan.exposure));
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
  // A driver compiles on first use: the first picture is made twice, and the second is timed.
  if (std::exchange(first_, false)) render(view.camera, options_.settings);
  const SceneRenderer::Picture ours = render(view.camera, options_.settings);
  ViewOutcome outcome{view.name, score(ours.image, truth, options_.fitGain, used), {}, {}};
  outcome.scores.milliseconds = ours.milliseconds;
  if (ours.buffers) {
    const SeamStep seam = seamStep(ours.image, ours.buffers->surface, truth);
    outcome.scores.seam = seam.levels;
    outcome.scores.seamDeltaE = seam.deltaE;
    outcome.scores.deltaE = gainFreeDeltaE(ours.image, truth, coverOf(ours.image));
  }
  if (options_.seams) measureAlignment(view.camera, outcome.scores);
  if (!options_.pictures.empty()) write(options_.pictures, view, ours.image, truth);
  for (std::size_t b = 0; options_.baselines && b < kBaselines.size(); ++b) {
    const SceneRenderer::Picture other = baseline(b, view.camera);
    outcome.baselines.push_back(score(other.image, truth, options_.fitGain, used));
    outcome.baselines.back().milliseconds = other.milliseconds;
    if (!options_.pictures.empty()) write(options_.pictures / kBaselines[b].first, view, other.image, truth);
  }
  return outcome;
}

void Evaluator::measureAlignment(const Camera& view, Scores& scores) const {
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, options_.settings});
  const std::vector<double> drawn = misalignments(scene_, bounds_, plan, 0, true),
                            without = misalignments(scene_, bounds_, plan, 0, false);
  scores.misaligned = quantile(drawn, 0.5);
  scores.misaligned95 = quantile(drawn, 0.95);
  scores.uncorrected = quantile(without, 0.5);
  scores.uncorrected95 = quantile(without, 0.95);
}

std::vector<fs::path> evaluationFiles(const EvaluationOptions& options, const std::string& viewName) {
  std::vector<fs::path> files;
  if (options.pictures.empty()) return files;
  files.push_back(pictureFile(options.pictures, viewName));
  if (options.baselines)
    for (const auto& [name, title] : kBaselines) files.push_back(pictureFile(options.pictures / name, viewName));
  return files;
}

void reportOutcomes(const std::vector<ViewOutcome>& outcomes, const EvaluationOptions& options, Json more,
                    const Context& context) {
  std::vector<Scores> all;
  Table table, failures;
  Json views = Json::array();
  table.row(scoresHeading("view", options.fitGain));
  failures.row({"failed", "why"});
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
    context.print("seams {} levels, ΔE {}; colours ΔE {}; cells {} px apart, the worst 20th {}; not aligned {}, {}\n",
                  numberText(means.seam, 3), numberText(means.seamDeltaE, 3), numberText(means.deltaE, 3),
                  numberText(means.misaligned, 2), numberText(means.misaligned95, 2), numberText(means.uncorrected, 2),
                  numberText(means.uncorrected95, 2));
  if (options.baselines) {
    Table methods;
    methods.row(scoresHeading("mean of", options.fitGain));
    for (std::size_t b = 0; b < kBaselines.size(); ++b) {
      const Scores other = meanOfBaseline(outcomes, b);
      mean["baselines"][kBaselines[b].first] = scoresJson(other);
      methods.row(scoresRow(kBaselines[b].second, other, options.fitGain));
    }
    methods.row(scoresRow("ours", means, options.fitGain));
    context.print("\n{}", methods.text());
  }
  if (all.size() < outcomes.size()) context.print("\n{}", failures.text());
  Json report{{"views", std::move(views)}, {"mean", std::move(mean)}};
  report.update(more);
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace ibr::app
