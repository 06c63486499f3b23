// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/next_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <queue>

namespace ibr {
namespace {

constexpr double kAlike = 1.05;          // radians; directions closer than this get a candidate in the middle
constexpr double kSameDirection = 0.35;  // radians; two viewing directions within this count as one
constexpr double kSameSite = 0.2;        // of a step; within it a photograph of the same direction adds nothing
constexpr double kTaken = 0.5;           // of the square's shorter side; a site within it is the fourth corner

struct Candidate {
  Camera camera;
  std::vector<std::uint32_t> sites, beside;
  std::string where;
};

// Angle between two orientations, radians, whatever the signs of their quaternions.
double turn(glm::dquat a, glm::dquat b) {
  return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))));
}

class Candidates {
 public:
  Candidates(const Scene& scene, const SiteGraph& sites) : scene_(scene), siteGraph_(sites) {
    for (const SiteLink& link : sites.links) between(link);
    for (std::uint32_t p = 0; p < sites.sites.size(); ++p) {
      turned(p);
      corners(p);
      if (sites.row) aside(p);
    }
    std::ranges::sort(list_, {}, &Candidate::where);
  }
  std::vector<Candidate> take() { return std::move(list_); }

 private:
  const std::string& name(std::uint32_t node) const { return scene_.nodes[node].name; }
  const Pose& pose(std::uint32_t node) const { return scene_.nodes[node].camera.pose; }

  void put(glm::dvec3 position, glm::dquat rotation, std::uint32_t like, std::vector<std::uint32_t> sites,
           std::vector<std::uint32_t> beside, std::string where) {
    const Camera camera{scene_.nodes[like].camera.intrinsics, {position, glm::normalize(rotation)}};
    list_.push_back({camera, std::move(sites), std::move(beside), std::move(where)});
  }

  std::optional<std::uint32_t> alike(std::uint32_t node, const CaptureSite& site) const {
    std::optional<std::uint32_t> best;
    for (const std::uint32_t other : site.nodes)
      if (turn(pose(node).rotation, pose(other).rotation) < kAlike &&
          (!best || turn(pose(node).rotation, pose(other).rotation) < turn(pose(node).rotation, pose(*best).rotation)))
        best = other;
    return best;
  }

  void between(const SiteLink& link) {
    const CaptureSite &a = siteGraph_.sites[link.a], &b = siteGraph_.sites[link.b];
    const auto halfway = [&](std::uint32_t i, std::uint32_t j, double t, glm::dquat rotation, const std::string& look) {
      const std::string first = t > 0.5 ? name(j) : name(i), second = t > 0.5 ? name(i) : name(j);
      put(a.position * (1 - t) + b.position * t, rotation, i, {link.a, link.b}, {i, j},
          t == 0.5 ? fmt::format("halfway between {} and {}, looking as {}", first, second, look)
                   : fmt::format("a third of the way from {} to {}, looking as {}", first, second, look));
    };
    for (const std::uint32_t i : a.nodes)
      for (const double t : {0.5, 1.0 / 3, 2.0 / 3})
        if (const auto j = alike(i, b))
          halfway(i, *j, t, glm::slerp(pose(i).rotation, pose(*j).rotation, t), "they do");
        else
          halfway(i, b.nodes[0], t, pose(i).rotation, name(i) + " does");
    for (const std::uint32_t j : b.nodes)
      if (!alike(j, a)) halfway(a.nodes[0], j, 0.5, pose(j).rotation, name(j) + " does");
  }

  void turned(std::uint32_t p) {
    const CaptureSite& site = siteGraph_.sites[p];
    for (const std::uint32_t q : site.beside)
      for (const std::uint32_t j : siteGraph_.sites[q].nodes)
        put(site.position, pose(j).rotation, j, {p}, {site.nodes[0], j},
            fmt::format("from the position of {}, looking as {} does", name(site.nodes[0]), name(j)));
  }

  void corners(std::uint32_t c) {
    const auto& all = siteGraph_.sites;
    const CaptureSite& at = all[c];
    for (std::size_t i = 0; i < at.beside.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const std::uint32_t a = at.beside[j], b = at.beside[i];
        const glm::dvec3 u = all[a].position - at.position, v = all[b].position - at.position;
        if (std::abs(glm::dot(u, v)) > 0.5 * glm::length(u) * glm::length(v)) continue;
        const glm::dvec3 corner = at.position + u + v;
        const double shorter = std::min(glm::length(u), glm::length(v));
        if (std::ranges::any_of(
                all, [&](const CaptureSite& p) { return glm::distance(p.position, corner) < kTaken * shorter; }))
          continue;
        for (const std::uint32_t n : at.nodes)
          put(corner, pose(n).rotation, n, {a, b, c}, {n, all[a].nodes[0], all[b].nodes[0]},
              fmt::format("at the fourth corner of the square of {}, {} and {}, looking as the first does", name(n),
                          name(all[a].nodes[0]), name(all[b].nodes[0])));
      }
  }

  void aside(std::uint32_t p) {
    const CaptureSite& site = siteGraph_.sites[p];
    bool first = true;
    for (const glm::dvec3& step : rowSideSteps(scene_, siteGraph_, p)) {
      for (const std::uint32_t n : site.nodes)
        put(site.position + step, pose(n).rotation, n, {p}, {n},
            fmt::format("off the row at {}, {}, by the spacing of the row's photographs, looking as {} does", name(n),
                        sideOf(step, n, first), name(n)));
      first = false;
    }
  }

  // Names a side from the photographer's point of view.
  std::string sideOf(glm::dvec3 step, std::uint32_t node, bool first) const {
    const glm::dvec3 own = glm::conjugate(pose(node).rotation) * step;
    if (std::abs(own.x) >= std::max(std::abs(own.y), std::abs(own.z)))
      return own.x > 0 ? "to the right" : "to the left";
    if (std::abs(own.y) >= std::abs(own.z)) return own.y > 0 ? "higher" : "lower";
    return first ? "to one side" : "to the other side";
  }

  const Scene& scene_;
  const SiteGraph& siteGraph_;
  std::vector<Candidate> list_;
};

bool isThere(const Camera& camera, const Camera& candidate, double step) {
  return glm::distance(camera.pose.position, candidate.pose.position) < kSameSite * step &&
         turn(camera.pose.rotation, candidate.pose.rotation) < kSameDirection;
}

}  // namespace

std::vector<NextView> nextViews(const Scene& scene, const SiteGraph& sites, WalkEstimate& walk, std::size_t count,
                                double minGain) {
  if (sites.sites.size() < 2) return {};
  const std::vector<Candidate> candidates = Candidates(scene, sites).take();
  // Gains only fall while photographs are added: the first candidate with a current gain is the best (Minoux 1978).
  struct Promise {
    double gain;
    std::size_t candidate, round;
    bool operator<(const Promise& other) const {
      return gain != other.gain ? gain < other.gain : candidate > other.candidate;
    }
  };
  std::priority_queue<Promise> queue;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    queue.push({walk.gain(candidates[c].camera, candidates[c].sites), c, 0});
  std::vector<NextView> views;
  while (!queue.empty() && views.size() < count) {
    Promise best = queue.top();
    queue.pop();
    if (!(best.gain >= minGain)) break;
    const Candidate& candidate = candidates[best.candidate];
    const auto there = [&](const Camera& camera) { return isThere(camera, candidate.camera, sites.step); };
    if (std::ranges::any_of(scene.nodes, there, &Node::camera) || std::ranges::any_of(views, there, &NextView::camera))
      continue;
    if (best.round < views.size()) {
      queue.push({walk.gain(candidate.camera, candidate.sites), best.candidate, views.size()});
      continue;
    }
    walk.add(candidate.camera, candidate.sites);
    views.push_back({candidate.camera, candidate.beside, best.gain, candidate.where});
  }
  return views;
}

}  // namespace ibr
