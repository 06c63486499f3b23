// SPDX-License-Identifier: Apache-2.0
#include "batch/build/refinement_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

double medianOf(const std::vector<PoseRefinement::PoseChange>& moved, double PoseRefinement::PoseChange::*value) {
  std::vector<double> values;
  for (const auto& photograph : moved) values.push_back(photograph.*value);
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Json errorsJson(const PoseRefinement::Errors& errors) {
  return {{"medianPx", errors.medianPx}, {"p90Px", errors.p90Px}};
}

}  // namespace

std::string text(const PoseRefinement& r) {
  if (r.steps.empty()) return "poses are unchanged: the poses are exact, or no photographs share a point\n";
  std::string said;
  for (const auto& step : r.steps)
    said += fmt::format("{}{} {}", said.empty() ? "" : ", ", step.description, step.accepted ? "accepted" : "rejected");
  if (r.poseChanges.empty())
    return fmt::format(
        "poses are unchanged: a fit to half of the points does not improve the other half ({} points of cells, {} of "
        "the model; reprojection error, median and 90th percentile: {:.3f} and {:.3f} px)\n",
        r.cellTracks, r.modelTracks, r.initialErrors.medianPx, r.initialErrors.p90Px);
  const auto furthest = std::ranges::max_element(r.poseChanges, {}, &PoseRefinement::PoseChange::rotationPx);
  return fmt::format(
      "poses of {} photographs are refined with {} points of cells and {} of the model ({}):\n"
      "  reprojection error, median and 90th percentile: {:.3f} and {:.3f} px before, {:.3f} and {:.3f} px after\n"
      "  rotated by {:.2f} px (median; most: {} by {:.2f} px), moved by {:.4g} (median); focal lengths × {:.5f}\n",
      r.poseChanges.size(), r.cellTracks, r.modelTracks, said, r.initialErrors.medianPx, r.initialErrors.p90Px,
      r.finalErrors.medianPx, r.finalErrors.p90Px, medianOf(r.poseChanges, &PoseRefinement::PoseChange::rotationPx),
      furthest->photograph, furthest->rotationPx, medianOf(r.poseChanges, &PoseRefinement::PoseChange::shift),
      medianOf(r.poseChanges, &PoseRefinement::PoseChange::focalFactor));
}

Json json(const PoseRefinement& r) {
  Json report{{"tracksOfCells", r.cellTracks},         {"tracksOfModel", r.modelTracks},
              {"posesKept", r.poseChanges.empty()},    {"steps", Json::array()},
              {"before", errorsJson(r.initialErrors)}, {"after", errorsJson(r.finalErrors)},
              {"photographs", Json::array()}};
  for (const auto& [description, cells, model, accepted] : r.steps)
    report["steps"].push_back(
        {{"description", description}, {"cellsGainSigmas", cells}, {"modelGainSigmas", model}, {"accepted", accepted}});
  for (const auto& [photograph, rotationPx, shift, focalFactor] : r.poseChanges)
    report["photographs"].push_back(
        {{"photograph", photograph}, {"rotationPx", rotationPx}, {"shift", shift}, {"focalFactor", focalFactor}});
  return report;
}

}  // namespace ibr::app
