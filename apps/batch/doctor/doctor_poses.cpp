// SPDX-License-Identifier: Apache-2.0
// Checks photographs and their poses, before a build.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>

#include "base/median.h"
#include "batch/doctor/findings.h"

namespace ibr::app {
namespace {

constexpr double kError = 0.0015;  // median reprojection error of a photograph's points, share of the longest side
constexpr std::size_t kMinSharedPoints = 30;  // minimum number of points that connect two photographs
constexpr double kMaxStepShare = 0.6;   // distance to the nearest photograph, share of the points' median distance
constexpr std::size_t kFewPoints = 50;  // of a photograph

void names(const PosedModel& model, const std::vector<std::string>& pictures, Findings& findings) {
  std::vector<std::string> posed, unposed, missing;
  for (const PosedImage& image : model.images) posed.push_back(image.name);
  std::ranges::sort(posed);
  std::ranges::set_difference(pictures, posed, std::back_inserter(unposed));
  std::ranges::set_difference(posed, pictures, std::back_inserter(missing));
  if (!missing.empty() && missing.size() == posed.size()) {
    findings.add(
        {"poses", Severity::serious,
         fmt::format("No photograph named in the poses is in this folder; the first missing one is {}.", missing[0]),
         "Give the folder that the names in the poses are relative to."});
    return;
  }
  if (!missing.empty())
    findings.add({"poses", Severity::serious,
                  fmt::format("{} of the photographs with a pose are missing: {}.", missing.size(), someOf(missing)),
                  "Restore the photographs, or exclude them (--exclude)."});
  if (!unposed.empty())
    findings.add(
        {"poses", Severity::warning,
         fmt::format("{} of {} photographs have no pose: {}.", unposed.size(), pictures.size(), someOf(unposed)),
         "Photographs without a pose overlap too little or are blurred: take them again, each overlapping the next by "
         "two thirds."});
}

void errors(const PosedModel& model, Findings& findings) {
  std::vector<std::vector<double>> ofImage(model.images.size());
  for (const Track& track : model.tracks)
    for (const TrackObservation& seen : track.observations) {
      const Camera& camera = model.images[seen.image].camera;
      const glm::dvec3 ray = glm::conjugate(camera.pose.rotation) * (track.position - camera.pose.position);
      const auto pixel = project(camera.intrinsics, ray);
      const Intrinsics& k = camera.intrinsics;
      if (pixel) ofImage[seen.image].push_back(glm::distance(*pixel, seen.pixel) / std::max(k.width, k.height));
    }
  const auto px = [&](double share, std::size_t i) {
    const Intrinsics& k = model.images[i].camera.intrinsics;
    return share * std::max(k.width, k.height);
  };
  std::vector<double> medians, mediansPx;
  for (std::size_t i = 0; i < ofImage.size(); ++i) {
    if (ofImage[i].empty()) continue;
    medians.push_back(median(ofImage[i]));
    mediansPx.push_back(px(medians.back(), i));
  }
  const double typical = median(medians);
  if (typical > kError) {
    findings.add(
        {"poses", Severity::warning,
         fmt::format("The poses are inaccurate: the median reprojection error is {:.1f} px.", median(mediansPx)),
         "Estimate the poses again, from sharp photographs of one lens without zoom."});
    return;
  }
  for (std::size_t i = 0; i < ofImage.size(); ++i) {
    const double own = median(ofImage[i]);
    if (own > kError && own > 3 * typical)
      findings.add({"poses", Severity::warning,
                    fmt::format("The pose of {} is inaccurate: the median reprojection error is {:.1f} px.",
                                model.images[i].name, px(own, i)),
                    "Exclude the photograph (--exclude), or take it again with more overlap."});
    if (ofImage[i].size() < kFewPoints)
      findings.add(
          {"poses", Severity::warning,
           fmt::format("{} shares only {} points with the other photographs.", model.images[i].name, ofImage[i].size()),
           "Take the photograph again nearer to its neighbours, overlapping them by two thirds."});
  }
}

// Groups of photographs connected by at least kMinSharedPoints points, the largest first.
std::vector<std::vector<std::size_t>> partsOf(const PosedModel& model) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> shared;
  for (const Track& track : model.tracks)
    for (std::size_t a = 0; a < track.observations.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        ++shared[std::minmax(track.observations[a].image, track.observations[b].image)];
  std::vector<std::size_t> root(model.images.size());
  std::iota(root.begin(), root.end(), std::size_t(0));
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& [pair, count] : shared)
    if (count >= kMinSharedPoints) root[find(pair.first)] = find(pair.second);
  std::map<std::size_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < root.size(); ++i) groups[find(i)].push_back(i);
  std::vector<std::vector<std::size_t>> parts;
  for (auto& [key, group] : groups) parts.push_back(std::move(group));
  std::ranges::stable_sort(parts, std::greater<>(), &std::vector<std::size_t>::size);
  return parts;
}

void parts(const PosedModel& model, Findings& findings) {
  const auto all = partsOf(model);
  for (std::size_t p = 1; p < all.size(); ++p) {
    std::vector<std::string> members;
    for (const std::size_t i : all[p]) members.push_back(model.images[i].name);
    findings.add({"parts", all[p].size() > 1 ? Severity::serious : Severity::warning,
                  fmt::format("{} {} too few points with the other photographs.", someOf(members),
                              members.size() == 1 ? "shares" : "share"),
                  "Take photographs on the way between the groups, each overlapping the next by two thirds."});
  }
}

// Compares the distance to the nearest photograph at another position with the median distance of the points.
void steps(const PosedModel& model, Findings& findings) {
  std::vector<std::vector<double>> distances(model.images.size());
  for (const Track& track : model.tracks)
    for (const TrackObservation& seen : track.observations)
      distances[seen.image].push_back(glm::distance(track.position, model.images[seen.image].camera.pose.position));
  std::vector<double> shares;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const double away = median(distances[i]);
    double least = std::numeric_limits<double>::infinity();
    for (const PosedImage& other : model.images)
      if (const double d = glm::distance(other.camera.pose.position, model.images[i].camera.pose.position);
          d > 1e-3 * away)
        least = std::min(least, d);
    if (away > 0) shares.push_back(least / away);
  }
  const double typical = median(shares);
  if (std::isinf(typical))
    findings.add(
        {"steps", Severity::serious, "All photographs were taken from one position, with the camera turned.",
         "Views from other positions are impossible. Step aside by a tenth of the distance to near objects, and "
         "take the photographs again."});
  else if (typical > kMaxStepShare)
    findings.add({"steps", Severity::warning,
                  fmt::format("The step from one photograph to the next is {:.0f} % of the distance to the subject.",
                              100 * typical),
                  "Take more photographs: steps of a fifth of the distance give good views in between."});
}

}  // namespace

void examinePoses(const PosedModel& model, const std::vector<std::string>& pictures, Findings& findings) {
  names(model, pictures, findings);
  if (model.tracks.empty() || model.images.size() < 2) return;
  errors(model, findings);
  parts(model, findings);
  steps(model, findings);
}

}  // namespace ibr::app
