// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/photograph_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "base/median.h"
#include "scene/advice/advice_entry.h"

namespace ibr {
namespace {

constexpr double kTwice = 0.05;                       // radians between two viewing directions at one site
constexpr double kFewMatched = 0.25;                  // share of a photograph that matches others, and …
constexpr double kFewerThan = 0.4;                    // … times the median share of its neighbours
constexpr double kResidual = 0.003;                   // residual over the longest side: poses are inaccurate, if …
constexpr double kWorseThan = 2.5;                    // … above this many times the median of all cells
constexpr double kStops = 1.0;                        // difference of exposure from the median of the neighbours, stops
const glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);  // weights for linear sRGB

// Residual of a cell's matches, share of the longest side of its photographs.
double relativeResidual(const Scene& scene, const Cell& cell) {
  double longest = 1;
  for (const std::uint32_t i : cell.members) {
    const Intrinsics& k = scene.nodes[i].camera.intrinsics;
    longest = std::max(longest, double(std::max(k.width, k.height)));
  }
  return cell.quality.residualPx / longest;
}

}  // namespace

std::vector<Advice> twiceAdvice(const CaptureFacts& facts) {
  const Scene& scene = facts.scene;
  std::vector<Advice> advice;
  for (const CaptureSite& site : facts.siteGraph.sites)
    for (std::size_t b = 1; b < site.nodes.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        const std::uint32_t i = site.nodes[a], j = site.nodes[b];
        const Camera &first = scene.nodes[i].camera, &second = scene.nodes[j].camera;
        const double same = std::abs(glm::dot(first.pose.rotation, second.pose.rotation));
        if (2 * std::acos(std::min(1.0, same)) > kTwice) continue;
        advice.push_back(adviceEntry(scene, AdviceKind::twice, Severity::hint, {i, j}, kNoAdviceValue,
                                     fmt::format("{} repeats {}: both have the same position and viewing direction.",
                                                 nodeName(scene, j), nodeName(scene, i)),
                                     "One of them is enough; a photograph from one step aside would add more."));
        break;
      }
  return advice;
}

std::vector<Advice> exposureAdvice(const CaptureFacts& facts) {
  const Scene& scene = facts.scene;
  const auto stops = [&](std::uint32_t n) { return -std::log2(glm::dot(scene.nodes[n].gain, kLuminance)); };
  const auto name = [&](std::uint32_t n) -> const std::string& { return nodeName(scene, n); };
  std::vector<Advice> advice;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    const std::vector<std::uint32_t>& neighbours = facts.neighbours[n];
    if (neighbours.empty()) continue;
    std::vector<double> theirs;
    for (const std::uint32_t m : neighbours) theirs.push_back(stops(m));
    const double jump = stops(n) - median(std::move(theirs));
    if (!(std::abs(jump) > kStops)) continue;
    advice.push_back(adviceEntry(
        scene, AdviceKind::exposure, Severity::warning, {n}, jump,
        fmt::format("{} is {:.1f} stops {} than its neighbours, for example {}.", name(n), std::abs(jump),
                    jump > 0 ? "brighter" : "darker", name(*std::ranges::min_element(neighbours, {}, name))),
        "Lock the exposure before the first photograph, or set it manually."));
  }
  return advice;
}

std::vector<Advice> matchAdvice(const CaptureFacts& facts) {
  const Scene& scene = facts.scene;
  std::vector<Advice> advice;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (facts.neighbours[n].empty()) continue;
    std::vector<double> theirs;
    for (const std::uint32_t m : facts.neighbours[n]) theirs.push_back(facts.depths[m].agreedShare());
    const double own = facts.depths[n].agreedShare();
    if (!(own < kFewMatched) || !(own < kFewerThan * median(theirs))) continue;
    advice.push_back(adviceEntry(
        scene, AdviceKind::unmatched, Severity::warning, {n}, own,
        fmt::format("Only {} % of {} matches its neighbours.", roundedPercent(own), nodeName(scene, n)),
        "Is the photograph blurred, or are most objects in it moving, shiny, textureless or hidden from its "
        "neighbours? Take it again, nearer to them."));
  }
  return advice;
}

std::vector<Advice> poseAdvice(const Scene& scene) {
  std::vector<double> all;
  std::vector<std::vector<double>> ofNode(scene.nodes.size());
  for (const Cell& cell : scene.cells)
    if (const double r = relativeResidual(scene, cell); std::isfinite(r)) {
      all.push_back(r);
      for (const std::uint32_t i : cell.members) ofNode[i].push_back(r);
    }
  const double typical = median(all);
  if (typical > kResidual)
    return {adviceEntry(
        scene, AdviceKind::pose, Severity::serious, {}, typical,
        fmt::format("The camera poses are inaccurate: matches are off by {:.1f} % of the longer image side.",
                    100 * typical),
        "Estimate the poses again from sharper photographs that overlap more, with one lens and without zooming.")};
  const auto px = [&](double share, const Intrinsics& k) { return share * std::max(k.width, k.height); };
  std::vector<Advice> advice;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (ofNode[n].empty()) continue;
    const double least = *std::ranges::min_element(ofNode[n]);
    if (!(least > kResidual) || !(least > kWorseThan * typical)) continue;
    advice.push_back(adviceEntry(scene, AdviceKind::pose, Severity::warning, {n}, least,
                                 fmt::format("The pose of {} is inaccurate: its matches are off by {:.1f} px.",
                                             nodeName(scene, n), px(least, scene.nodes[n].camera.intrinsics)),
                                 "Exclude the photograph (--exclude), or take it again with more overlap."));
  }
  return advice;
}

std::vector<Advice> unusedAdvice(const Scene& scene) {
  std::vector<Advice> advice;
  for (const UnusedPhotograph& photo : scene.unusedPhotographs) {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
      if (scene.nodes[n].name == photo.name) nodes.push_back(n);
    // Reasons of unreadable files include the remedy.
    const bool hasRemedy = nodes.empty() && photo.reason != kNotRegistered;
    advice.push_back(
        adviceEntry(scene, AdviceKind::unused, Severity::warning, std::move(nodes), kNoAdviceValue,
                    fmt::format("{} is not used: {}.", photo.name, photo.reason),
                    hasRemedy ? "" : "Take it again nearer to the others, overlapping its neighbours by two thirds."));
  }
  return advice;
}

}  // namespace ibr
