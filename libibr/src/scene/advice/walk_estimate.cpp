// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/walk_estimate.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <set>

namespace ibr {
namespace {

constexpr double kAngle = 0.375;        // radians at which the shown share is 1/e: fitted to the coverage of cells
constexpr double kMaxAngle = 0.8;       // radians; nothing counts as shown beyond it
constexpr double kNearer = 1.4;         // ratio of distances; farther points are hidden in a photograph
constexpr double kCorner = 0.5;         // weight of a viewpoint outside the photographed area
constexpr double kAside = 0.1;          // weight of a viewpoint beside a row
constexpr double kSquare = 0.35;        // |cos| below which two links from a site lead to corners of a grid
constexpr double kAhead = 0.5;          // sine of the angle between row and view below which the view is along the row
constexpr int kMaxViewpoints = 4;       // along one link
constexpr double kMinPoints = 20;       // of a photograph, for an estimate of its share
constexpr int kStride = 2;              // of the depth grid's cells, along both sides
constexpr std::size_t kMaxSites = 600;  // with own viewpoints; beyond this number, evenly chosen sites

double angleBetween(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

bool inImage(const Intrinsics& k, const std::optional<glm::dvec2>& pixel) {
  return pixel && pixel->x >= 0 && pixel->y >= 0 && pixel->x <= k.width && pixel->y <= k.height;
}

std::optional<glm::dvec2> seenAt(const Camera& camera, glm::dvec3 direction) {
  return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * direction);
}

}  // namespace

std::vector<glm::dvec3> rowSideSteps(const Scene& scene, const SiteGraph& sites, std::uint32_t site) {
  const CaptureSite& p = sites.sites[site];
  if (p.beside.empty()) return {};
  const glm::dvec3 from = p.beside.size() > 1 ? sites.sites[p.beside[0]].position : p.position;
  const glm::dvec3 along = sites.sites[p.beside.back()].position - from;
  const Camera& camera = scene.nodes[p.nodes[0]].camera;
  const glm::dvec3 axis = viewAxis(camera.pose), up = camera.pose.rotation * glm::dvec3(0, 1, 0);
  const bool ahead = glm::length(glm::cross(along, axis)) < kAhead * glm::length(along);
  const glm::dvec3 aside = glm::cross(along, ahead ? up : axis);
  if (!(glm::length(aside) > 0)) return {};
  const glm::dvec3 step = sites.step * glm::normalize(aside);
  return {step, -step};
}

double shownAt(double angle) {
  return angle < kMaxAngle ? std::exp(-angle / kAngle) : 0.0;
}

WalkEstimate::WalkEstimate(const Scene& scene, const std::vector<DepthGrid>& depths, const SiteGraph& sites)
    : scene_(scene), depths_(depths), siteGraph_(sites), viewpointsOf_(sites.sites.size()) {
  addViewpoints();
  for (std::uint32_t s = 0; s < viewpoints_.size(); ++s)
    for (const std::uint32_t p : viewpoints_[s].viewpoint.sites) viewpointsOf_[p].push_back(s);
}

void WalkEstimate::addViewpoints() {
  const auto& all = siteGraph_.sites;
  const std::size_t stride = 1 + all.size() / kMaxSites;
  const auto put = [&](glm::dvec3 at, std::vector<std::uint32_t> among, double weight) {
    std::ranges::sort(among);
    viewpoints_.push_back(look({at, std::move(among), weight, std::nullopt}));
  };
  for (std::uint32_t p = 0; p < all.size(); p += std::uint32_t(stride)) {
    std::vector<std::uint32_t> among = all[p].beside;
    among.push_back(p);
    put(all[p].position, std::move(among), 1);
    viewpoints_.back().viewpoint.site = p;
  }
  for (std::size_t w = 0; w < siteGraph_.links.size(); w += stride) {
    const SiteLink& link = siteGraph_.links[w];
    const int count = std::clamp(int(std::lround(link.length / siteGraph_.step)), 1, kMaxViewpoints);
    for (int k = 1; k <= count; ++k) {
      const double t = double(k) / (count + 1);
      put(all[link.a].position * (1 - t) + all[link.b].position * t, {link.a, link.b}, 1);
    }
  }
  std::set<std::vector<std::uint32_t>> seen;
  for (const Cell& cell : scene_.cells) {
    std::set<std::uint32_t> among;
    for (const std::uint32_t i : cell.members) among.insert(siteGraph_.siteOf[i]);
    const std::vector<std::uint32_t> list(among.begin(), among.end());
    if (list.size() < 3 || !seen.insert(list).second || seen.size() % stride != 0) continue;
    glm::dvec3 middle(0);
    for (const std::uint32_t p : list) middle += all[p].position / double(list.size());
    put(middle, list, 1);
  }
  // The fourth corner where a site and two of its neighbours form three corners of a square.
  std::vector<glm::dvec3> corners;
  for (std::uint32_t c = 0; c < all.size(); c += std::uint32_t(stride))
    for (std::size_t i = 0; i < all[c].beside.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const std::uint32_t a = all[c].beside[i], b = all[c].beside[j];
        const glm::dvec3 u = all[a].position - all[c].position, v = all[b].position - all[c].position;
        const double shorter = std::min(glm::length(u), glm::length(v));
        if (std::abs(glm::dot(u, v)) > kSquare * glm::length(u) * glm::length(v)) continue;
        const glm::dvec3 corner = all[c].position + u + v;
        const auto taken = [&](glm::dvec3 p) { return glm::distance(p, corner) < 0.5 * shorter; };
        if (std::ranges::any_of(all, [&](const CaptureSite& p) { return taken(p.position); })) continue;
        if (std::ranges::any_of(corners, taken)) continue;
        corners.push_back(corner);
        put(corner, {a, b, c}, kCorner);
      }
  if (!siteGraph_.row) return;
  for (std::uint32_t p = 0; p < all.size(); p += std::uint32_t(stride))
    for (const glm::dvec3& aside : rowSideSteps(scene_, siteGraph_, p)) {
      std::vector<std::uint32_t> among = all[p].beside;
      among.push_back(p);
      put(all[p].position + aside, std::move(among), kAside);
    }
}

bool WalkEstimate::sees(std::uint32_t node, glm::dvec3 target, bool far) const {
  const Camera& camera = scene_.nodes[node].camera;
  const glm::dvec3 ray = far ? target : target - camera.pose.position;
  const auto pixel = seenAt(camera, ray);
  if (!inImage(camera.intrinsics, pixel)) return false;
  const double inverse = depths_[node].at(camera.intrinsics, *pixel);
  if (!(inverse > 0)) return true;
  return !far && glm::length(ray) * inverse < kNearer;
}

// Points that the photographs of the viewpoint's sites show, as seen from the viewpoint.
WalkEstimate::SampledViewpoint WalkEstimate::look(Viewpoint viewpoint) const {
  SampledViewpoint known{std::move(viewpoint), {}};
  const glm::dvec3 at = known.viewpoint.position;
  std::vector<std::uint32_t> nodes;
  for (const std::uint32_t p : known.viewpoint.sites)
    nodes.insert(nodes.end(), siteGraph_.sites[p].nodes.begin(), siteGraph_.sites[p].nodes.end());
  for (const std::uint32_t n : nodes) {
    const Camera& camera = scene_.nodes[n].camera;
    const DepthGrid& depth = depths_[n];
    for (int y = kStride / 2; y < depth.rows; y += kStride)
      for (int x = kStride / 2; x < depth.columns; x += kStride) {
        const glm::dvec2 pixel = depth.pixel(camera.intrinsics, x, y);
        const double inverse = depth.at(camera.intrinsics, pixel);
        if (std::isnan(inverse)) continue;
        const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, pixel);
        const bool far = inverse * glm::distance(camera.pose.position, at) < 1e-6;
        const glm::dvec3 target = camera.pose.position + ray / std::max(inverse, 1e-300);
        Point point{far ? ray : target - at, far, n, 0};
        if (!inImage(camera.intrinsics, seenAt(camera, point.ray))) continue;
        double least = angleAt(point, at, camera);
        if (least >= kMaxAngle) continue;
        for (const std::uint32_t other : nodes) {
          if (other == n) continue;
          const double angle = angleAt(point, at, scene_.nodes[other].camera);
          if (angle < least && sees(other, far ? ray : target, far)) least = angle;
        }
        point.shown = float(shownAt(least));
        known.points.push_back(point);
      }
  }
  return known;
}

double WalkEstimate::angleAt(const Point& point, glm::dvec3 viewpoint, const Camera& camera) const {
  return point.far ? 0.0 : angleBetween(-point.ray, camera.pose.position - viewpoint - point.ray);
}

namespace {

template <class Points>
double meanShown(const Points& points) {
  if (points.empty()) return 1;
  double sum = 0;
  for (const auto& point : points) sum += point.shown;
  return sum / double(points.size());
}

}  // namespace

double WalkEstimate::shown(std::size_t viewpoint) const {
  return meanShown(viewpoints_[viewpoint].points);
}

double WalkEstimate::shown() const {
  double sum = 0, weights = 0;
  for (const SampledViewpoint& known : viewpoints_) {
    sum += known.viewpoint.weight * meanShown(known.points);
    weights += known.viewpoint.weight;
  }
  return weights > 0 ? sum / weights : 1.0;
}

std::optional<WalkEstimate::Worst> WalkEstimate::worstShown(std::size_t viewpoint) const {
  struct Sum {
    double shown = 0, points = 0;
  };
  std::map<std::uint32_t, Sum> sums;
  for (const Point& point : viewpoints_[viewpoint].points) {
    sums[point.node].shown += point.shown;
    sums[point.node].points += 1;
  }
  std::optional<Worst> worst;
  for (const auto& [node, sum] : sums) {
    if (sum.points < kMinPoints) continue;
    const double shown = sum.shown / sum.points;
    if (!worst || shown < worst->shown ||
        (shown == worst->shown && scene_.nodes[node].name < scene_.nodes[worst->node].name))
      worst = Worst{node, shown};
  }
  return worst;
}

double WalkEstimate::shownFrom(glm::dvec3 position, const std::vector<std::uint32_t>& sites) const {
  return meanShown(look({position, sites, 1, std::nullopt}).points);
}

// Calls `visit(viewpoint, point, shown)` for points that the camera shows better than the photographs so far.
template <class Visit>
void WalkEstimate::visitNear(const Camera& camera, const std::vector<std::uint32_t>& sites, const Visit& visit) const {
  std::set<std::uint32_t> near;
  for (const std::uint32_t p : sites) near.insert(viewpointsOf_[p].begin(), viewpointsOf_[p].end());
  for (const std::uint32_t s : near) {
    const SampledViewpoint& known = viewpoints_[s];
    const glm::dvec3 to = camera.pose.position - known.viewpoint.position;
    for (std::uint32_t i = 0; i < known.points.size(); ++i) {
      const Point& point = known.points[i];
      const double angle = angleAt(point, known.viewpoint.position, camera);
      const double shown = shownAt(angle);
      if (shown <= point.shown) continue;
      if (inImage(camera.intrinsics, seenAt(camera, point.far ? point.ray : point.ray - to))) visit(s, i, shown);
    }
  }
}

double WalkEstimate::gain(const Camera& camera, const std::vector<std::uint32_t>& sites) const {
  double sum = 0;
  visitNear(camera, sites, [&](std::uint32_t s, std::uint32_t i, double shown) {
    const SampledViewpoint& known = viewpoints_[s];
    sum += known.viewpoint.weight * (shown - known.points[i].shown) / double(known.points.size());
  });
  return sum;
}

void WalkEstimate::add(const Camera& camera, const std::vector<std::uint32_t>& sites) {
  struct Change {
    std::uint32_t viewpoint, point;
    double shown;
  };
  std::vector<Change> changes;
  visitNear(camera, sites, [&](std::uint32_t s, std::uint32_t i, double shown) { changes.push_back({s, i, shown}); });
  for (const Change& c : changes) viewpoints_[c.viewpoint].points[c.point].shown = float(c.shown);
}

}  // namespace ibr
