// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/site_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "scene/advice/advice_entry.h"

namespace ibr {
namespace {

constexpr double kWide = 0.75;       // estimated share shown between neighbours below which they are too far apart
constexpr double kDirection = 0.85;  // likewise at a capture site, for a neighbour's viewing direction
constexpr double kGoodShift = 0.2;   // shift by one step, in distances of the subject: about 0.77 is shown halfway

// The nearest pair of nodes: one of `from`, one of the other lists.
std::pair<std::uint32_t, std::uint32_t> nearestPair(const Scene& scene, const std::vector<std::uint32_t>& from,
                                                    const std::vector<std::vector<std::uint32_t>>& lists) {
  std::pair<std::uint32_t, std::uint32_t> best{from[0], from[0]};
  double least = std::numeric_limits<double>::infinity();
  for (const auto& list : lists) {
    if (&list == &from || list == from) continue;
    for (const std::uint32_t i : from)
      for (const std::uint32_t j : list) {
        const double d = glm::distance(scene.nodes[i].camera.pose.position, scene.nodes[j].camera.pose.position);
        if (d < least) least = d, best = {i, j};
      }
  }
  return best;
}

// Used nodes of each group of sites: the largest group first, then by name.
std::vector<std::vector<std::uint32_t>> usedNodesOfGroups(const CaptureFacts& facts) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t site = 0; site < facts.siteGraph.sites.size(); ++site)
    for (const std::uint32_t n : facts.siteGraph.sites[site].nodes)
      if (facts.used[n]) members[facts.siteGroup[site]].push_back(n);
  std::vector<std::vector<std::uint32_t>> lists;
  for (auto& [key, list] : members) lists.push_back(list);
  std::ranges::sort(lists, [&](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : nodeName(facts.scene, a[0]) < nodeName(facts.scene, b[0]);
  });
  return lists;
}

// The photographs of two capture sites with the most similar viewing directions.
struct SimilarPair {
  std::uint32_t i, j;  // nodes of the first and of the second site
  double angle;        // between the viewing directions, degrees
};
SimilarPair mostSimilar(const Scene& scene, const CaptureSite& a, const CaptureSite& b) {
  std::pair<std::uint32_t, std::uint32_t> best{a.nodes[0], b.nodes[0]};
  double most = -2;
  for (const std::uint32_t i : a.nodes)
    for (const std::uint32_t j : b.nodes) {
      const double cosine = glm::dot(viewAxis(scene.nodes[i].camera.pose), viewAxis(scene.nodes[j].camera.pose));
      if (cosine > most + 1e-9) most = cosine, best = {i, j};
    }
  return {best.first, best.second, glm::degrees(std::acos(std::clamp(most, -1.0, 1.0)))};
}

// True for a scene of `ibr build --draft`, which makes no cells.
bool isDraft(const Scene& scene) {
  const nlohmann::json settings = nlohmann::json::parse(scene.settings, nullptr, false);
  const auto draft = settings.find("draft");
  return draft != settings.end() && *draft == true;
}

// Entry about neighbours that are not connected because their viewing directions differ.
Advice turnedHole(const Scene& scene, const SimilarPair& pair, double shown) {
  return adviceEntry(
      scene, AdviceKind::hole, Severity::warning, {pair.i, pair.j}, shown,
      fmt::format("{} and {} are neighbours but not connected: their viewing directions differ by {:.0f}°.",
                  nodeName(scene, pair.i), nodeName(scene, pair.j), pair.angle),
      fmt::format("Take more photographs in between, turning by less than {:.0f}° from one to the next.",
                  kMaxTurnDegrees));
}

// Entry about neighbours that are too far apart; `count`: number of photographs to take between them.
Advice farApart(const Scene& scene, const SimilarPair& pair, bool joined, double shown, std::size_t count) {
  const std::string between = fmt::format("{} and {}", nodeName(scene, pair.i), nodeName(scene, pair.j));
  return adviceEntry(
      scene, joined ? AdviceKind::wide : AdviceKind::hole, Severity::warning, {pair.i, pair.j}, shown,
      joined ? fmt::format("{} are too far apart for near objects: about {} % of the image can be shown halfway.",
                           between, roundedPercent(shown))
             : fmt::format("{} are neighbours but not connected: they are too far apart for near objects.", between),
      count == 1 ? std::string("Take one more photograph halfway between them.")
                 : fmt::format("Take {} more photographs between them, evenly spaced.", count));
}

}  // namespace

std::vector<Advice> tooFewAdvice(const CaptureFacts& facts) {
  const Scene& scene = facts.scene;
  const std::size_t count = scene.nodes.size();
  if (count < 2)
    return {adviceEntry(
        scene, AdviceKind::tooFew, Severity::serious, {}, double(count),
        count == 0 ? "The scene has no photographs." : fmt::format("{} is the only photograph.", nodeName(scene, 0)),
        "Take at least three: step sideways by a tenth of the distance to the subject, and photograph it again.")};
  if (facts.siteGraph.sites.size() == 1)
    return {adviceEntry(
        scene, AdviceKind::turned, Severity::serious, {}, kNoAdviceValue,
        fmt::format("All {} photographs were taken from one position, by turning the camera.", count),
        "No other viewpoint can be shown. Step sideways by a tenth of the distance to near objects, and take the "
        "photographs again from there.")};
  if (!scene.cells.empty()) return {};
  if (isDraft(scene))
    return {adviceEntry(scene, AdviceKind::tooFew, Severity::hint, {}, 0, "The scene is a draft, which has no cells.",
                        "Build it without --draft for advice on the photographs.")};
  return {adviceEntry(
      scene, AdviceKind::tooFew, Severity::serious, {}, 0,
      fmt::format("None of the {} photographs could be connected to another.", count),
      "Neighbouring photographs must show the same objects: take more of them, each overlapping the next by two "
      "thirds.")};
}

std::vector<Advice> apartAdvice(const CaptureFacts& facts) {
  const std::vector<std::vector<std::uint32_t>> lists = usedNodesOfGroups(facts);
  std::vector<Advice> advice;
  for (std::size_t i = 1; i < lists.size(); ++i) {
    const auto [from, to] = nearestPair(facts.scene, lists[i], lists);
    const std::string &near = nodeName(facts.scene, from), &other = nodeName(facts.scene, to);
    advice.push_back(adviceEntry(
        facts.scene, AdviceKind::apart, Severity::serious, lists[i], double(lists[i].size()),
        fmt::format(
            "{} (a group of {} photographs) is not connected to the other photographs; {} is the nearest of them.",
            near, lists[i].size(), other),
        fmt::format("Walk from {} to {} and take photographs on the way, each overlapping the next by two thirds.",
                    near, other)));
  }
  return advice;
}

LinkAdvice linkAdvice(const CaptureFacts& facts, const WalkEstimate& walk) {
  LinkAdvice result;
  for (const SiteLink& link : facts.siteGraph.links) {
    const CaptureSite &a = facts.siteGraph.sites[link.a], &b = facts.siteGraph.sites[link.b];
    if (!isUsedSite(facts, link.a) || !isUsedSite(facts, link.b) || facts.siteGroup[link.a] != facts.siteGroup[link.b])
      continue;
    const double shown = walk.shownFrom(0.5 * (a.position + b.position), {link.a, link.b});
    if (!(shown < kWide)) continue;
    const SimilarPair pair = mostSimilar(facts.scene, a, b);
    if (!link.joined && pair.angle > kMaxTurnDegrees) {
      result.advice.push_back(turnedHole(facts.scene, pair, shown));
      continue;
    }
    const double shift = link.length * 0.5 * (facts.depths[pair.i].middle + facts.depths[pair.j].middle);
    const auto count = std::size_t(std::clamp(std::ceil(shift / kGoodShift) - 1, 1.0, 20.0));
    result.remedies.push_back({result.advice.size(), link, pair.i, pair.j, count});
    result.advice.push_back(farApart(facts.scene, pair, link.joined, shown, count));
  }
  return result;
}

std::optional<std::string> linkRemedyText(const CaptureFacts& facts, const LinkRemedy& remedy,
                                          std::span<const NextView> views) {
  const glm::dvec3 from = facts.siteGraph.sites[remedy.link.a].position,
                   along = facts.siteGraph.sites[remedy.link.b].position - from;
  std::set<int> sixths;  // positions on the link, sixths of its length
  for (const NextView& view : views) {
    const glm::dvec3 to = view.camera.pose.position - from;
    const double t = glm::dot(to, along) / glm::dot(along, along);
    if (t > 0.1 && t < 0.9 && glm::distance(to, t * along) < 1e-6 * remedy.link.length)
      sixths.insert(int(std::lround(6 * t)));
  }
  if (sixths.empty() || remedy.count > 2) return std::nullopt;
  if (sixths == std::set{2, 4}) return "Take two more photographs between them, a third of the way from either.";
  if (sixths.size() > 1) return fmt::format("Take {} more photographs between them, evenly spaced.", sixths.size());
  if (*sixths.begin() == 3) return "Take one more photograph halfway between them.";
  return fmt::format("Take one more photograph between them, a third of the way from {}.",
                     nodeName(facts.scene, *sixths.begin() < 3 ? remedy.i : remedy.j));
}

std::vector<Advice> directionAdvice(const CaptureFacts& facts, const WalkEstimate& walk) {
  const Scene& scene = facts.scene;
  std::vector<Advice> advice;
  for (std::size_t s = 0; s < walk.viewpointCount(); ++s) {
    const auto here = walk.viewpoint(s).site;
    if (!here || !isUsedSite(facts, *here)) continue;
    const auto worst = walk.worstShown(s);
    if (!worst || !(worst->shown < kDirection)) continue;
    const CaptureSite& at = facts.siteGraph.sites[*here];
    const auto looksSo = [&](std::uint32_t site) {
      return std::ranges::any_of(facts.siteGraph.sites[site].nodes, [&](std::uint32_t n) {
        return glm::dot(viewAxis(scene.nodes[n].camera.pose), viewAxis(scene.nodes[worst->node].camera.pose)) >
               std::cos(glm::radians(kMaxTurnDegrees));
      });
    };
    if (looksSo(*here) || std::ranges::count_if(at.beside, looksSo) < 2) continue;
    advice.push_back(
        adviceEntry(scene, AdviceKind::direction, Severity::warning, {at.nodes[0], worst->node}, worst->shown,
                    fmt::format("No photograph at the position of {} has the viewing direction of its neighbour {}.",
                                nodeName(scene, at.nodes[0]), nodeName(scene, worst->node)),
                    "Return to this position and take one more photograph in that direction."));
  }
  return advice;
}

std::vector<Advice> rowAdvice(const CaptureFacts& facts) {
  if (!facts.siteGraph.row || facts.siteGraph.sites.size() < 3) return {};
  return {adviceEntry(
      facts.scene, AdviceKind::row, Severity::hint, {}, kNoAdviceValue,
      "The photographs form one row: the viewpoint can move along the row, but not away from it, up or down.",
      "Take a second row beside or above the first, at the spacing of the photographs in the first.")};
}

}  // namespace ibr
