// SPDX-License-Identifier: Apache-2.0
#include "author/steps/step_cost.h"

#include <algorithm>
#include <string_view>

#include "author/backdrop/backdrop.h"
#include "author/build/backdrop_maker.h"
#include "author/build/build_prediction.h"
#include "author/build/cell_maker.h"
#include "author/build/depth_matcher.h"
#include "author/depth/depth_sources.h"
#include "author/geometry/posed_model.h"
#include "base/usage.h"

namespace ibr {
namespace {

constexpr double kProgramBytes = 60e6;          // of the program itself
constexpr double kFeaturePositionBytes = 16e4;  // of a photograph's features while tracks are joined
// Processor time that no stage of a build contains, s: of a process, and per observation of the model's file. Both are
// small, and not scaled by the machine's speed.
constexpr double kStartSeconds = 0.03, kReadObservationSeconds = 1.5e-6;

BuildPrediction predictedWithOneThread(const BuildInput& input, BuildOptions options, const CellPlan* plan) {
  options.threads = 1;
  return predictBuild(input, options, plan);
}

}  // namespace

StepCosts::StepCosts(const BuildInput& input, const BuildOptions& options, const CellPlan* plan,
                     const std::vector<ImagePair>& pairs)
    : input_(input),
      options_(options),
      plan_(plan),
      needsFeatures_(input.photographs.size(), false),
      pairs_(pairs.size()),
      modelBytes_(std::max(residentMemory(), kProgramBytes)),
      whole_(predictedWithOneThread(input, options, plan)) {
  for (const Track& track : input.model.tracks) reading_ += kReadObservationSeconds * double(track.observations.size());
  for (const auto& [first, second] : pairs) needsFeatures_[first] = needsFeatures_[second] = true;
  featured_ = std::size_t(std::ranges::count(needsFeatures_, true));
  for (const Photograph& photo : input.photographs) {
    const Intrinsics matched = matchedCamera(photo.camera).intrinsics;
    const double pixels = double(matched.width) * matched.height;
    loading_ = std::max(loading_, bytesToReadViews(photo));
    features_ = std::max(features_, bytesToLoad(photo) + kFeatureBytesPerPixel * std::min(pixels, kFeaturePixels));
    const glm::ivec2 swept = sweptSize(photo.camera.intrinsics), size = backdropSize(photo.camera.intrinsics);
    sweeping_ = std::max(sweeping_, kSweptBytesPerPixel * swept.x * swept.y);
    viewBytes_ = std::max(viewBytes_, kViewBytesPerPixel * (isPanorama(photo) ? 6 : 1) * swept.x * swept.y);
    depthBytes_ += kDepthBytesPerPixel * finePixelFactor(options.depth) * size.x * size.y;
  }
  const CellMaker maker(input, options);
  if (plan)
    for (const CellMembers& members : plan->cells) cellBytes_ = std::max(cellBytes_, bytesToMake(maker.work(members)));
  else
    cellBytes_ = sweeping_;  // of a cell whose members are unknown: as much as a sweep
}

double StepCosts::secondsOf(const char* stage) const {
  for (const BuildPrediction::Stage& s : whole_.stages)
    if (std::string_view(s.name) == stage) return s.cpuSeconds;
  return 0;
}

double StepCosts::shareOf(const Batch& batch) const {
  return double(batch.end - batch.begin) / double(input_.photographs.size());
}

StepCost StepCosts::model() const {
  return {kStartSeconds + reading_, modelBytes_};
}

StepCost StepCosts::photographs(const Batch& batch) const {
  std::size_t count = 0;
  for (std::size_t i = batch.begin; i < batch.end; ++i) count += needsFeatures_[i];
  const double each = featured_ == 0 ? 0 : secondsOf("finding features") / double(featured_);
  return {kStartSeconds + each * double(count), kProgramBytes + (count > 0 ? features_ : loading_)};
}

StepCost StepCosts::matches(std::size_t pairs) const {
  const double share = double(pairs) / double(std::max<std::size_t>(pairs_, 1));
  return {kStartSeconds + share * secondsOf("matching features"), kProgramBytes + kBytesToMatchPair};
}

StepCost StepCosts::tracks() const {
  // The plan that it writes has the observations again.
  return {kStartSeconds + 2 * reading_ + secondsOf("planning depth"),
          2 * modelBytes_ + kFeaturePositionBytes * double(featured_)};
}

StepCost StepCosts::depth(const Batch& batch) const {
  const double views = double(batch.end - batch.begin + kNearSources + kWideSources);
  return {kStartSeconds + shareOf(batch) * (secondsOf("finding depth") + secondsOf("sampling panoramas")),
          kProgramBytes + views * viewBytes_ + std::max(sweeping_, loading_)};
}

StepCost StepCosts::confirmed() const {
  return {kStartSeconds + secondsOf("confirming depth"), kProgramBytes + depthBytes_};
}

StepCost StepCosts::cells(const Batch& batch) const {
  double share = shareOf(batch);
  if (plan_ && !plan_->cells.empty())
    share = double(std::ranges::count_if(
                plan_->cells,
                [&](const CellMembers& members) { return members[0] >= batch.begin && members[0] < batch.end; })) /
            double(plan_->cells.size());
  return {kStartSeconds + share * secondsOf("matching cells"), kProgramBytes + cellBytes_};
}

StepCost StepCosts::scene() const {
  double seconds = kStartSeconds + reading_;
  for (const char* stage :
       {"storing photographs", "planning depth", "confirming depth", "comparing exposures", "completing backdrops"})
    seconds += secondsOf(stage);
  return {seconds, whole_.memory};
}

}  // namespace ibr
