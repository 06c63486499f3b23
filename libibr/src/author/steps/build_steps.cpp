// SPDX-License-Identifier: Apache-2.0
//   model          reads the poses and the photographs' headers
//   photographs-N  hashes, masks and features of some photographs
//   matches-N      matches of pairs that the model has few points of, by their first photograph
//   tracks         own tracks; plan of depth and cells
//   depth-N        depth of some photographs
//   confirmed      depth that other photographs confirm; needs the depth of all
//   cells-N        planned cells, by their first member
//   scene          build(): reads all of that from the cache, replaces failed cells, makes backdrops and exposures
#include "ibr/author/build_steps.h"

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "author/build/build_input.h"
#include "author/build/own_tracks.h"
#include "author/graph/cells.h"
#include "author/steps/step_cost.h"
#include "author/steps/step_files.h"
#include "author/steps/step_runner.h"
#include "base/check.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

// Files that a model is read from. XMP sidecars may lie among photographs, which are inputs of their own.
std::vector<fs::path> modelFiles(const fs::path& model) {
  if (!fs::is_directory(model)) return {model};
  std::set<fs::path> files;
  static const std::set<std::string> kExtensions{".txt", ".bin", ".xmp", ".csv", ".json"};
  for (const auto& entry : fs::directory_iterator(model))
    if (entry.is_regular_file() && kExtensions.contains(entry.path().extension().string())) files.insert(entry.path());
  return {files.begin(), files.end()};
}

class StepList {
 public:
  StepList(const BuildInput& input, const BuildOptions& options, std::vector<Batch> batches,
           const std::vector<ImagePair>& pairs, const StepCosts& costs)
      : input_(input), options_(options), batches_(std::move(batches)), costs_(costs) {
    for (const ImagePair& pair : pairs) pairsOf_[batchOf(pair.first)].push_back(pair);
  }

  std::vector<BuildStep> list() {
    const std::vector<fs::path> poses = modelFiles(options_.model), all = filesOf({0, 0, input_.photographs.size()});
    add("model", joined(poses, all), costs_.model());
    for (const Batch& batch : batches_)
      add(batchStep("photographs", batch.index), joined(outputs("model"), filesOf(batch)), costs_.photographs(batch));
    for (const auto& [batch, pairs] : pairsOf_) {
      std::set<fs::path> inputs{stepFile(options_, "model")};
      for (const auto& [first, second] : pairs)
        for (const std::uint32_t i : {first, second})
          inputs.insert(stepFile(options_, batchStep("photographs", batchOf(i))));
      add(batchStep("matches", batch), {inputs.begin(), inputs.end()}, costs_.matches(pairs.size()));
    }
    add("tracks", joined(poses, joined(outputs("model"), joined(outputs("photographs-"), outputs("matches-")))),
        costs_.tracks());
    for (const Batch& batch : batches_)
      add(batchStep("depth", batch.index), joined(outputs("tracks"), filesOf(batch)), costs_.depth(batch));
    add("confirmed", joined(outputs("tracks"), outputs("depth-")), costs_.confirmed());
    for (const Batch& batch : batches_)
      add(batchStep("cells", batch.index), joined(outputs("tracks"), outputs("confirmed")), costs_.cells(batch));
    add(kSceneStep, joined(poses, joined(outputs("cells-"), all)), costs_.scene());
    steps_.back().output = options_.output / "scene.gltf";
    return std::move(steps_);
  }

 private:
  std::size_t batchOf(std::uint32_t photograph) const { return photograph / (batches_[0].end - batches_[0].begin); }

  std::vector<fs::path> filesOf(const Batch& batch) const {
    std::vector<fs::path> files;
    for (std::size_t i = batch.begin; i < batch.end; ++i) {
      files.push_back(input_.photographs[i].source);
      if (const fs::path& mask = input_.photographs[i].mask; !mask.empty()) files.push_back(mask);
    }
    return files;
  }

  // Outputs of the listed steps whose names begin so.
  std::vector<fs::path> outputs(const std::string& begin) const {
    std::vector<fs::path> files;
    for (const BuildStep& step : steps_)
      if (step.name.starts_with(begin)) files.push_back(step.output);
    return files;
  }

  static std::vector<fs::path> joined(std::vector<fs::path> files, const std::vector<fs::path>& more) {
    files.insert(files.end(), more.begin(), more.end());
    return files;
  }

  void add(const std::string& name, std::vector<fs::path> inputs, StepCost cost) {
    steps_.push_back({name, std::move(inputs), stepFile(options_, name), cost.seconds, cost.memory});
  }

  const BuildInput& input_;
  const BuildOptions& options_;
  const std::vector<Batch> batches_;
  const StepCosts& costs_;
  std::map<std::size_t, std::vector<ImagePair>> pairsOf_;  // by the batch of their first photograph
  std::vector<BuildStep> steps_;
};

// Number at the end of "depth-0003", if the name begins with `kind`.
std::optional<std::size_t> batchIn(const std::string& name, const std::string& kind) {
  if (!name.starts_with(kind + "-")) return std::nullopt;
  std::size_t number = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + kind.size() + 1, end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace

std::vector<BuildStep> buildSteps(const BuildOptions& options, std::size_t photographsPerStep, const LogCallback& log) {
  checkStepOptions(options);
  const BuildInput input = readInput(options, log);
  checkPosesKept(input);
  std::vector<ImagePair> pairs;
  if (options.tracks != TrackSource::model) pairs = pairsForTracks(input.model, options.tracks);
  std::optional<CellPlan> plan;
  if (options.tracks != TrackSource::own && !input.model.tracks.empty()) plan = planCells(input.model, options);
  const StepCosts costs(input, options, plan ? &*plan : nullptr, pairs);
  return StepList(input, options, batchesOf(input.photographs.size(), photographsPerStep), pairs, costs).list();
}

void runBuildStep(const BuildOptions& options, std::size_t photographsPerStep, const std::string& name,
                  const ProgressCallback& progress, const LogCallback& log) {
  checkStepOptions(options);
  const SingleThreadedOpenCv quiet;
  const StepRunner runner(options, photographsPerStep, progress, log);
  if (name == "model") return runner.findModel();
  if (name == "tracks") return runner.planTracks();
  if (name == "confirmed") return runner.confirmDepth();
  using Run = void (StepRunner::*)(std::size_t) const;
  for (const auto& [kind, run] : {std::pair<const char*, Run>{"photographs", &StepRunner::readPhotographs},
                                  {"matches", &StepRunner::matchFeatures},
                                  {"depth", &StepRunner::findDepth},
                                  {"cells", &StepRunner::makeCells}})
    if (const std::optional<std::size_t> batch = batchIn(name, kind)) return (runner.*run)(*batch);
  fail(ErrorCode::invalidInput, "there is no step \"{}\"; --steps lists the steps", name);
}

BuildOptions sceneStepOptions(BuildOptions options) {
  checkStepOptions(options);
  options.cacheFolder = buildCacheFolder(options);
  return options;
}

}  // namespace ibr
