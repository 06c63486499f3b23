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

constexpr double kError = 0.0015;       // median reprojection error of a photograph's points, share of the longest side
constexpr std::size_t kShared = 30;     // minimum number of points that connect two photographs
constexpr double kWideStep = 0.6;       // distance to the nearest photograph, share of the points' median distance
constexpr std::size_t kFewPoints = 50;  // of a photograph

void names(const PosedModel& model, const std::vector<std::string>& pictures, Findings& findings) {
  std::vector<std::string> posed, unposed, missing;
  for (const PosedImage& image : model.images) posed.push_back(image.name);
  std::ranges::sort(posed);
  std::ranges::set_difference(pictures, posed, std::back_inserter(unposed));
  std::ranges::set_difference(posed, pictures, std::back_inserter(missing));
  if (!missing.empty() && missing.size() == posed.size()) {
    findings.add({"poses", Severity::serious,
                  fmt::format("None of the photographs that the poses name is here; the first is {}.", missing[0]),
                  "Name the folder that their names start from."});
    return;
  }
  if (!missing.empty())
    findings.add(
        {"poses", Severity::serious,
         fmt::format("{} of the photographs that have a pose are not here: {}.", missing.size(), someOf(missing)),
         "Bring them back, or build without them (--exclude)."});
  if (!unposed.empty())
    findings.add(
        {"poses", Severity::warning,
         fmt::format("{} of {} photographs have no pose: {}.", unposed.size(), pictures.size(), someOf(unposed)),
         "They share too little with the others, or are blurred: take them again, each with two thirds of its "
         "picture in the next."});
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
  std::vector<double> medians;
  for (const auto& list : ofImage)
    if (!list.empty()) medians.push_back(median(list));
  const double typical = median(medians);
  const auto px = [&](double share, std::size_t i) {
    const Intrinsics& k = model.images[i].camera.intrinsics;
    return share * std::max(k.width, k.height);
  };
  if (typical > kError) {
    findings.add({"poses", Severity::warning,
                  fmt::format("The poses fit the photographs badly: points are off by {:.1f} px.", px(typical, 0)),
                  "Estimate them again; sharp photographs of one lens, without zooming, give better ones."});
    return;
  }
  for (std::size_t i = 0; i < ofImage.size(); ++i) {
    const double own = median(ofImage[i]);
    if (own > kError && own > 3 * typical)
      findings.add({"poses", Severity::warning,
                    fmt::format("The pose of {} is doubtful: its points are off by {:.1f} px.", model.images[i].name,
                                px(own, i)),
                    "Leave it out (--exclude), or take it again with more overlap."});
    if (ofImage[i].size() < kFewPoints)
      findings.add({"poses", Severity::warning,
                    fmt::format("{} shares only {} points with the others.", model.images[i].name, ofImage[i].size()),
                    "Take it again nearer to its neighbours, with two thirds of its picture in the next."});
  }
}

// Groups of photographs connected by at least kShared points, the largest first.
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
    if (count >= kShared) root[find(pair.first)] = find(pair.second);
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
                  fmt::format("{} {} too little with the other photographs.", someOf(members),
                              members.size() == 1 ? "shares" : "share"),
                  "Take photographs on the way between them, each with two thirds of its picture in the next."});
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
    findings.add({"steps", Severity::serious, "All photographs were taken from one place, by turning the camera.",
                  "Nothing can be shown from anywhere else. Step aside by a tenth of the distance to what is near, and "
                  "take them again from there."});
  else if (typical > kWideStep)
    findings.add(
        {"steps", Severity::warning,
         fmt::format("From one photograph to the next it is {:.0f} % as far as to what they show.", 100 * typical),
         "Steps of a fifth give good pictures in between: take more photographs."});
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
