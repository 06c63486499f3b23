// SPDX-License-Identifier: Apache-2.0
#include "author/steps/step_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "author/build/build_cost.h"
#include "author/build/build_depths.h"
#include "author/build/build_input.h"
#include "author/build/cell_cache.h"
#include "author/build/cell_maker.h"
#include "author/build/depth_matcher.h"
#include "author/build/own_tracks.h"
#include "author/build/stored_photographs.h"
#include "author/depth/photograph_depth.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/cached_file.h"
#include "author/steps/input_record.h"
#include "author/steps/step_plan.h"
#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr const char* kConfirmedKind = "confirmed";  // of cache files
constexpr double kBytesToFetch = 1e7;                // memory of reading a depth map from the cache

std::uint64_t hashOfFile(const fs::path& file) {
  const std::vector<std::byte> bytes = readFile(file);
  Hash hash;
  hash.add(std::span(bytes));
  return hash.value();
}

// Marks the output of a step that had nothing to do as newer than its inputs, for programs that compare times.
void touch(const fs::path& file) {
  std::error_code ignored;
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
}

std::string storeConfirmed(const fs::path& folder, const MemberDepth& depth) {
  CacheWriter out;
  writeMemberDepth(out, depth);
  std::vector<std::byte> bytes = out.take();
  Hash hash;
  hash.add(std::span<const std::byte>(bytes));
  const fs::path file = cacheFile(folder, hash.value(), kConfirmedKind);
  if (!fetchCached(file)) storeCached(file, std::move(bytes));
  return file.filename().string();
}

MemberDepth fetchConfirmed(const fs::path& file) {
  auto bytes = fetchCached(file);
  check(bytes.has_value(), ErrorCode::io, "{}: is missing or damaged; run the step confirmed again", file.string());
  CacheReader in(std::move(*bytes));
  return readMemberDepth(in);
}

// Identifies the depth maps that the step "confirmed" compares.
std::string sourceOf(const PlannedBuild& build, const DepthMatcher& matcher) {
  Hash hash;
  hash.add(build.source);
  for (std::size_t v = 0; v < matcher.views().size(); ++v)
    hash.add(std::string_view(matcher.cachedFile(v).filename().string()));
  return fmt::format("{:016x}", hash.value());
}

// Photographs that the sweeps of these views read.
std::vector<std::uint32_t> photographsOf(const DepthMatcher& matcher, const std::vector<std::size_t>& which,
                                         const std::vector<std::optional<ViewSweep>>& sweeps) {
  std::set<std::uint32_t> photographs;
  for (const std::size_t v : which) {
    photographs.insert(matcher.views()[v].node);
    if (sweeps[v])
      for (const std::uint32_t source : sweeps[v]->sources) photographs.insert(matcher.views()[source].node);
  }
  return {photographs.begin(), photographs.end()};
}

}  // namespace

void checkStepOptions(const BuildOptions& options) {
  checkOptions(options);
  checkOutputFolder(options);
  const auto refuse = [](bool unsupported, const char* text) {
    check(!unsupported, ErrorCode::invalidInput, "{}", text);
  };
  refuse(options.model.empty(),
         "steps need poses: name them with --model. A draft of the scene estimates poses in SCENE/.poses");
  refuse(options.draft, "a draft is not built in steps");
  refuse(options.maskMovingObjects, "moving objects are not masked in steps: mask them with --masks");
  refuse(options.refinePoses == RefinePoses::on, "poses are not refined in steps: use ibr refine before");
}

void checkPosesKept(const BuildInput& input) {
  check(!input.refinesPoses, ErrorCode::invalidInput,
        "the poses are a phone's, and are not refined in steps: use ibr refine before, or --refine-poses off");
}

StepRunner::StepRunner(const BuildOptions& options, std::size_t photographsPerStep, const ProgressCallback& progress,
                       const LogCallback& log)
    : options_(options),
      photographsPerStep_(photographsPerStep),
      key_(optionsKey(options, photographsPerStep)),
      jobs_(options.threads, options.memory, progress),
      log_(log) {
  makeFolders(stepFile(options, "model").parent_path());
}

std::vector<Batch> StepRunner::batches(const BuildInput& input) const {
  return batchesOf(input.photographs.size(), photographsPerStep_);
}

Batch StepRunner::batchOf(const BuildInput& input, std::size_t index) const {
  const std::vector<Batch> all = batches(input);
  check(index < all.size(), ErrorCode::invalidInput, "there are {} steps of this kind, none of them has the number {}",
        all.size(), index);
  return all[index];
}

void StepRunner::findModel() const {
  StepModel model{readInput(options_, log_), {}};
  checkPosesKept(model.input);
  model.hash = modelHash(model.input.model);
  if (options_.tracks != TrackSource::model) model.pairs = pairsForTracks(model.input.model, options_.tracks);
  storeModel(options_, key_, model);
}

void StepRunner::readPhotographs(std::size_t index) const {
  StepModel model = fetchModel(options_, key_);
  BuildInput& input = model.input;
  const Batch batch = batchOf(input, index);
  std::vector<bool> needsFeatures(input.photographs.size(), false);
  for (const auto& [first, second] : model.pairs) needsFeatures[first] = needsFeatures[second] = true;
  input.hashes.resize(input.photographs.size());
  PhotographHashes hashes;
  hashes.photographs.resize(batch.end - batch.begin);
  hashes.files.resize(hashes.photographs.size());
  double bytes = 0, pixels = 0;
  for (std::size_t i = batch.begin; i < batch.end; ++i) {
    bytes = std::max(bytes, input.photographs[i].sourcePixels + bytesToLoad(input.photographs[i]));
    const Intrinsics& k = input.photographs[i].camera.intrinsics;
    pixels = std::max(pixels, double(k.width) * k.height);
  }
  jobs_.runAll("reading photographs", hashes.files.size(), bytes, [&](std::size_t n) {
    const std::size_t i = batch.begin + n;
    hashAndCacheMask(input, std::uint32_t(i), options_);
    hashes.photographs[n] = input.hashes[i];
    hashes.files[n] = hashOfFile(input.photographs[i].source);
  });
  const OwnTracksInput own = ownTracksInput(input, options_);
  jobs_.runAll("finding features", hashes.files.size(), bytesToFindFeatures(own, pixels), [&](std::size_t n) {
    if (needsFeatures[batch.begin + n]) findFeatures(own, std::uint32_t(batch.begin + n));
  });
  storeHashes(options_, key_, index, hashes);
}

PhotographHashes StepRunner::allHashes(const BuildInput& input) const {
  PhotographHashes all;
  for (const Batch& batch : batches(input)) {
    const PhotographHashes some = fetchHashes(options_, key_, batch.index);
    all.photographs.insert(all.photographs.end(), some.photographs.begin(), some.photographs.end());
    all.files.insert(all.files.end(), some.files.begin(), some.files.end());
  }
  return all;
}

void StepRunner::matchFeatures(std::size_t index) const {
  StepModel model = fetchModel(options_, key_);
  BuildInput& input = model.input;
  const std::vector<Batch> all = batches(input);
  const Batch batch = batchOf(input, index);
  std::erase_if(model.pairs, [&](const ImagePair& p) { return p.first < batch.begin || p.first >= batch.end; });
  std::set<std::size_t> needed;
  for (const auto& [first, second] : model.pairs)
    for (const std::uint32_t i : {first, second}) needed.insert(i / photographsPerStep_);
  input.hashes.resize(input.photographs.size());
  for (const std::size_t b : needed)
    std::ranges::copy(fetchHashes(options_, key_, b).photographs, input.hashes.begin() + std::ptrdiff_t(all[b].begin));
  const OwnTracksInput own = ownTracksInput(input, options_);
  std::vector<std::string> names;
  jobs_.runAll("matching features", model.pairs.size(), kBytesToMatchPair,
               [&](std::size_t p) { matchesOf(own, model.pairs[p]); });
  for (const ImagePair& pair : model.pairs) names.push_back(matchesFile(own, pair).filename().string());
  storeNames(options_, batchStep("matches", index), names);
}

void StepRunner::planTracks() const {
  StepModel model = fetchModel(options_, key_);
  PhotographHashes hashes = allHashes(model.input);
  Hash source;
  source.add(model.hash);
  for (const std::uint64_t hash : hashes.photographs) source.add(hash);
  if (plannedSource(options_, key_) == source.value()) return touch(stepFile(options_, "tracks"));
  PlannedBuild build{readInput(options_, log_)};
  BuildInput& input = build.input;
  check(modelHash(input.model) == model.hash, ErrorCode::io, "{}: has changed; run the step model again",
        options_.model.string());
  input.hashes = std::move(hashes.photographs);
  for (std::size_t i = 0; i < input.photographs.size(); ++i)
    if (Photograph& photo = input.photographs[i]; !photo.mask.empty())
      photo.storedMask = cachedMask(options_, input.hashes[i]);
  addOwnTracks(input, options_, jobs_, log_);
  applyMasksToTracks(input, log_);
  build.files = std::move(hashes.files);
  build.residualPx = storedResidualPx(input);
  build.source = source.value();
  storePlan(options_, key_, build, planBatches(input, options_, batches(input), jobs_));
}

void StepRunner::checkUnchanged(const PlannedBuild& build, const std::vector<std::uint32_t>& photographs) const {
  jobs_.runAll("reading photographs", photographs.size(), 1e7, [&](std::size_t n) {
    const fs::path& file = build.input.photographs[photographs[n]].source;
    check(hashOfFile(file) == build.files[photographs[n]], ErrorCode::io,
          "{}: has changed since the step that read the photograph; run {} again", file.string(),
          batchStep("photographs", photographs[n] / photographsPerStep_));
  });
}

void StepRunner::findDepth(std::size_t index) const {
  const PlannedBuild build = fetchPlan(options_, key_);
  const Batch batch = batchOf(build.input, index);
  std::vector<std::size_t> views;  // of the batch
  std::vector<std::optional<ViewSweep>> sweeps;
  DepthMatcher matcher(
      build.input, [&](std::size_t view) { return sweeps[view]; }, options_.depth, buildCacheFolder(options_));
  sweeps.resize(matcher.views().size());
  for (std::size_t v = 0; v < sweeps.size(); ++v)
    if (const std::size_t i = matcher.views()[v].node; i >= batch.begin && i < batch.end) views.push_back(v);
  PlannedBatch planned = fetchPlannedBatch(options_, key_, index);
  for (std::size_t k = 0; k < views.size(); ++k) sweeps[views[k]] = std::move(planned.sweeps[k]);
  std::vector<std::string> names;
  std::vector<std::size_t> missing;
  for (const std::size_t v : views) {
    const fs::path file = matcher.cachedFile(v);
    names.push_back(file.filename().string());
    if (!file.empty() && !fetchCached(file)) missing.push_back(v);
  }
  if (!missing.empty()) {
    const std::vector<std::uint32_t> photographs = photographsOf(matcher, missing, sweeps);
    checkUnchanged(build, photographs);
    matcher.read(photographs, jobs_);
    jobs_.runAll("finding depth", missing.size(), matcher.bytesToMatch(),
                 [&](std::size_t k) { matcher.match(missing[k]); });
  }
  storeNames(options_, batchStep("depth", index), names);
}

// The first line of the step's output is sourceOf(); the others are names of cache files.
bool StepRunner::isConfirmed(const std::string& source) const {
  std::error_code ignored;
  if (!fs::is_regular_file(stepFile(options_, "confirmed"), ignored)) return false;
  const std::vector<std::string> names = fetchNames(options_, "confirmed");
  return names[0] == source && std::all_of(names.begin() + 1, names.end(), [&](const std::string& name) {
           return fs::is_regular_file(buildCacheFolder(options_) / name, ignored);
         });
}

void StepRunner::confirmDepth() const {
  const PlannedBuild build = fetchPlan(options_, key_);
  std::vector<PlannedBatch> planned;
  for (const Batch& batch : batches(build.input)) {
    fetchNames(options_, batchStep("depth", batch.index));  // throws if the step has not ended
    planned.push_back(fetchPlannedBatch(options_, key_, batch.index));
  }
  const std::vector<std::optional<ViewSweep>> sweeps = joinedSweeps(planned);
  const fs::path folder = buildCacheFolder(options_);
  const DepthMatcher matcher(
      build.input, [&](std::size_t view) { return sweeps[view]; }, options_.depth, folder);
  std::vector<std::string> names{sourceOf(build, matcher)};
  if (isConfirmed(names[0])) return touch(stepFile(options_, "confirmed"));
  const std::vector<PhotographDepth> depths = confirmDepths(
      build.input, options_.depth,
      {.matches = [&](std::size_t view) { return matcher.fetch(view); },
       .points = [&](std::uint32_t i) { return planned[i / photographsPerStep_].points[i % photographsPerStep_]; },
       .residualPx = build.residualPx,
       .bytesToMatch = kBytesToFetch},
      jobs_);
  const MemberDepths confirmed = memberDepths(depths);
  names.resize(1 + depths.size());
  jobs_.runAll("storing depth", depths.size(), kBytesToFetch,
               [&](std::size_t i) { names[1 + i] = storeConfirmed(folder, confirmed(std::uint32_t(i))); });
  storeNames(options_, "confirmed", names);
}

void StepRunner::makeCells(std::size_t index) const {
  PlannedBuild build = fetchPlan(options_, key_);
  BuildInput& input = build.input;
  batchOf(input, index);
  PlannedBatch planned = fetchPlannedBatch(options_, key_, index);
  input.model.tracks = std::move(planned.tracks);
  input.tracksOf = tracksOfImages(input.model);
  std::set<std::uint32_t> members;
  for (const CellMembers& cell : planned.cells) members.insert(cell.begin(), cell.end());
  checkUnchanged(build, {members.begin(), members.end()});
  const fs::path folder = buildCacheFolder(options_);
  std::vector<std::string> confirmed = fetchNames(options_, "confirmed");
  confirmed.erase(confirmed.begin());
  check(confirmed.size() == input.photographs.size(), ErrorCode::invalidInput,
        "{}: has {} names for {} photographs; run the step confirmed again", stepFile(options_, "confirmed").string(),
        confirmed.size(), input.photographs.size());
  const CellMaker maker(input, options_, [&](std::uint32_t i) { return fetchConfirmed(folder / confirmed[i]); });
  double most = 0;
  for (const CellMembers& cell : planned.cells) most = std::max(most, bytesToMake(maker.work(cell)));
  std::vector<std::string> names(planned.cells.size());
  jobs_.runAll("matching cells", planned.cells.size(), most, [&](std::size_t c) {
    names[c] = cellFile(folder, maker.make(planned.cells[c]).key).filename().string();
  });
  storeNames(options_, batchStep("cells", index), names);
}

}  // namespace ibr
