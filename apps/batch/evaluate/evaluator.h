// SPDX-License-Identifier: Apache-2.0
// Compares views of a scene with the truth, and, if requested, with simpler methods for the same photographs.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batch/evaluate/scores.h"
#include "ibr/author/baselines.h"
#include "ibr/author/reference.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/context.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {

struct EvaluationOptions {
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  bool seams = false, fitGain = false;
  std::vector<std::string> baselines;  // names of kBaselines
  bool guessed = false;                // also measures Scores::guessed
  std::filesystem::path truthDepth;    // folder of exact depth (truthDepth in truth.h); empty: none
  double depthUnit = 0.01;             // world units for a step of the depth images
  double depthBaseline = 0.3;          // DepthTolerance::baseline, world units
  std::filesystem::path pictures;      // folder for prediction, truth and difference side by side; empty: none
};

/// Names in JSON, also of the folders of their images; and titles.
inline constexpr std::array kBaselines{std::pair{"nearest", "nearest photograph"},
                                       std::pair{"lumigraph", "unstructured lumigraph"},
                                       std::pair{"crossFade", "cross-fade of one cell"},
                                       std::pair{"paper", "the paper's morph and order"},
                                       std::pair{"paperOrder", "our morph in the paper's order"},
                                       std::pair{"gathered", "reference implementation of the gather"}};

/// Result of a view.
struct ViewOutcome {
  std::string name;
  Scores scores;
  std::vector<std::pair<std::string, Scores>> baselines = {};  // by name
  std::string failure = {};                                    // reason why there are no scores; empty: success
};
nlohmann::ordered_json outcomeJson(const ViewOutcome& outcome);

/// Reads outcomeJson's output. Throws nlohmann::json::exception for other input.
ViewOutcome outcomeOf(const nlohmann::ordered_json& json);

class Evaluator {
 public:
  /// `views`: all views that will be evaluated. The scene must outlive this object. Throws Error.
  Evaluator(const Scene& scene, const std::vector<View>& views, const EvaluationOptions& options,
            const Context& context);

  /// Renders, scores and writes images; pixels with 0 in `used` (one channel, or empty) do not count. Throws Error.
  ViewOutcome evaluate(const View& view, const Image8& truth, const Image8& used = {});

  std::string deviceName() const { return renderer_.deviceName(); }

 private:
  SceneRenderer::Picture render(const Camera& view, const RenderSettings& settings);
  SceneRenderer::Picture baseline(const std::string& name, const Camera& view);
  // Depth of a view along its axis, world units, 0 for the sky; empty if unknown.
  ImageF truthOf(const View& view) const;
  void measureDepth(const View& view, const ImageF& inverseDepth, const ImageF& truth, Scores& scores) const;
  Scores gathered(const View& view, const Image8& truth, const Image8& used);
  void measureAlignment(const Camera& view, Scores& scores) const;
  void write(const std::filesystem::path& folder, const View& view, const Image8& picture, const Image8& truth) const;

  const Scene& scene_;
  SceneBounds bounds_;
  EvaluationOptions options_;
  SceneRenderer renderer_;
  std::optional<Baselines> baselines_;
  std::optional<ReferenceRenderer> reference_;
  bool first_ = true;
};

/// Returns the files for a view's images. Throws Error{invalidInput} for a name that leads out of the folder.
std::vector<std::filesystem::path> evaluationFiles(const EvaluationOptions& options, const std::string& viewName);

/// Prints tables of the views with means, and of the baselines; writes the JSON report, with `more` added.
void reportOutcomes(const std::vector<ViewOutcome>& outcomes, const EvaluationOptions& options,
                    nlohmann::ordered_json more, const Context& context);

}  // namespace ibr::app
