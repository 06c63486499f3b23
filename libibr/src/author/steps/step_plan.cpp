// SPDX-License-Identifier: Apache-2.0
#include "author/steps/step_plan.h"

#include <algorithm>
#include <utility>

#include "author/build/backdrop_maker.h"
#include "author/steps/input_record.h"

namespace ibr {
namespace {

std::vector<std::size_t> batchOfEach(std::size_t photographs, std::span<const Batch> batches) {
  std::vector<std::size_t> batchOf(photographs);
  for (const Batch& batch : batches)
    for (std::size_t i = batch.begin; i < batch.end; ++i) batchOf[i] = batch.index;
  return batchOf;
}

// Tracks that the members of the cells observe, in the model's order: keys of cells depend on the order.
std::vector<Track> tracksOfCells(const BuildInput& input, const std::vector<CellMembers>& cells) {
  std::vector<std::uint32_t> wanted;
  for (const CellMembers& members : cells)
    for (const std::uint32_t i : members)
      wanted.insert(wanted.end(), input.tracksOf[i].begin(), input.tracksOf[i].end());
  std::ranges::sort(wanted);
  const auto [first, last] = std::ranges::unique(wanted);
  wanted.erase(first, last);
  std::vector<Track> tracks;
  for (const std::uint32_t t : wanted) tracks.push_back(input.model.tracks[t]);
  return tracks;
}

}  // namespace

std::vector<PlannedBatch> planBatches(const BuildInput& input, const BuildOptions& options,
                                      std::span<const Batch> batches, const BuildJobs& jobs) {
  std::vector<PlannedBatch> planned(batches.size());
  const std::vector<std::size_t> batchOf = batchOfEach(input.photographs.size(), batches);
  for (CellMembers& members : planCells(input.model, options).cells)
    planned[batchOf[members[0]]].cells.push_back(std::move(members));
  for (PlannedBatch& batch : planned) batch.tracks = tracksOfCells(input, batch.cells);

  const SweepPlan plan(input);
  const std::vector<DepthView>& views = plan.views();
  std::vector<std::optional<ViewSweep>> sweeps(views.size());
  jobs.runAll("planning depth", views.size(), 1e6, [&](std::size_t v) { sweeps[v] = plan.sweep(v); });
  for (const Batch& batch : batches) planned[batch.index].points.resize(batch.end - batch.begin);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::uint32_t i = views[v].node;
    PlannedBatch& batch = planned[batchOf[i]];
    if (!sweeps[v]) batch.points[i - batches[batchOf[i]].begin] = pointsSeenBy(input, i);
    batch.sweeps.push_back(std::move(sweeps[v]));
  }
  return planned;
}

std::vector<std::optional<ViewSweep>> joinedSweeps(std::span<const PlannedBatch> batches) {
  std::vector<std::optional<ViewSweep>> sweeps;
  for (const PlannedBatch& batch : batches) sweeps.insert(sweeps.end(), batch.sweeps.begin(), batch.sweeps.end());
  return sweeps;
}

std::uint64_t modelHash(const PosedModel& model) {
  CacheWriter out;
  writeTracks(out, model.tracks);
  Hash hash;
  for (const PosedImage& image : model.images) {
    hash.add(std::string_view(image.name));
    const Pose& pose = image.camera.pose;
    const Intrinsics& k = image.camera.intrinsics;
    for (const double v : {double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy, pose.position.x, pose.position.y,
                           pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
      hash.add(v);
  }
  const std::vector<std::byte> tracks = out.take();
  hash.add(std::span(tracks));
  return hash.value();
}

}  // namespace ibr
