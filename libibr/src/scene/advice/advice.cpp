// SPDX-License-Identifier: Apache-2.0
#include "ibr/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "base/check.h"
#include "base/median.h"
#include "scene/advice/next_views.h"
#include "scene/advice/sharpness_advice.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {
namespace {

constexpr double kWide = 0.75;        // estimated share shown between neighbours below which they are too far apart
constexpr double kDirection = 0.85;   // likewise at a capture site, for a neighbour's viewing direction
constexpr double kGoodShift = 0.2;    // of a step, in distances of the subject: about 0.77 is shown halfway
constexpr double kTwice = 0.05;       // radians between two viewing directions at one site
constexpr double kFewMatched = 0.25;  // share of a photograph that matches others, and …
constexpr double kFewerThan = 0.4;    // … times the median share of its neighbours
constexpr double kResidual = 0.003;   // of the longest side: poses are inaccurate, if …
constexpr double kWorseThan = 2.5;    // … above this many times the median of all cells
constexpr double kStops = 1.0;        // of exposure, from the median of its neighbours
constexpr double kTurnLess = 30;      // degrees from one photograph to the next
constexpr double kMinGain = 0.02;     // of a further photograph, at one viewpoint
const glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);  // weights for linear sRGB
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

int percent(double share) {
  return int(std::lround(100 * share));
}

std::vector<std::vector<std::uint32_t>> cellNeighbours(const Scene& scene) {
  std::vector<std::set<std::uint32_t>> neighbours(scene.nodes.size());
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members)
      for (const std::uint32_t j : cell.members)
        if (i != j) neighbours[i].insert(j);
  std::vector<std::vector<std::uint32_t>> lists;
  for (const auto& set : neighbours) lists.emplace_back(set.begin(), set.end());
  return lists;
}

class Adviser {
 public:
  explicit Adviser(const Scene& scene)
      : scene_(scene),
        depths_(depthGrids(scene)),
        siteGraph_(buildSiteGraph(scene, depths_)),
        walk_(scene, depths_, siteGraph_),
        used_(scene.nodes.size(), false),
        neighbours_(cellNeighbours(scene)) {
    for (const Cell& cell : scene.cells)
      for (const std::uint32_t i : cell.members) used_[i] = true;
  }

  CaptureAdvice run(const AdviceOptions& options) {
    if (tooFew()) return std::move(result_);
    parts();
    links();
    directions();
    twice();
    exposures();
    matches();
    poses();
    row();
    unused();
    if (options.readTextures)
      for (Advice& advice : sharpnessAdvice(scene_, neighbours_)) result_.advice.push_back(std::move(advice));
    result_.coverage = walk_.shown();
    result_.views = nextViews(scene_, siteGraph_, walk_, options.views, kMinGain);
    result_.coverageWithViews = walk_.shown();
    for (const LinkRemedy& remedy : remedies_) agree(remedy);
    sort();
    return std::move(result_);
  }

 private:
  struct LinkRemedy {
    std::size_t advice;  // index in result_, before sorting
    const SiteLink* way;
    std::uint32_t i, j;  // photographs at its ends
    std::size_t more;    // number to take between them
  };

  const std::string& name(std::uint32_t node) const { return scene_.nodes[node].name; }

  void put(AdviceKind kind, Severity severity, std::vector<std::uint32_t> nodes, double figure, std::string sentence,
           std::string remedy) {
    std::ranges::sort(nodes, {}, [&](std::uint32_t i) -> const std::string& { return name(i); });
    result_.advice.push_back({kind, severity, std::move(sentence), std::move(remedy), std::move(nodes), figure});
  }

  // Sorts each kind from the worst: the smallest share, or the most stops or pixels.
  void sort() {
    const auto worst = [](const Advice& a) {
      if (std::isnan(a.value)) return 0.0;
      return a.kind == AdviceKind::exposure || a.kind == AdviceKind::pose ? -std::abs(a.value) : a.value;
    };
    std::ranges::sort(result_.advice, [&](const Advice& a, const Advice& b) {
      if (a.severity != b.severity) return a.severity > b.severity;
      if (a.kind != b.kind) return a.kind < b.kind;
      return worst(a) != worst(b) ? worst(a) < worst(b) : a.problem < b.problem;
    });
  }

  bool tooFew() {
    const std::size_t count = scene_.nodes.size();
    if (count < 2) {
      put(AdviceKind::tooFew, Severity::serious, {}, double(count),
          count == 0 ? "The scene has no photographs." : fmt::format("{} is the only photograph.", name(0)),
          "Take at least three: step sideways by a tenth of the distance to the subject, and photograph it again.");
      unused();
      return true;
    }
    if (siteGraph_.sites.size() == 1) {
      put(AdviceKind::turned, Severity::serious, {}, kNoValue,
          fmt::format("All {} photographs were taken from one position, by turning the camera.", count),
          "No other viewpoint can be shown. Step sideways by a tenth of the distance to near objects, and take the "
          "photographs again from there.");
      unused();
      return true;
    }
    if (!scene_.cells.empty()) return false;
    put(AdviceKind::tooFew, Severity::serious, {}, 0,
        fmt::format("None of the {} photographs could be connected to another.", count),
        "Neighbouring photographs must show the same objects: take more of them, each overlapping the next by two "
        "thirds.");
    unused();
    return true;
  }

  void parts() {
    const std::size_t count = siteGraph_.sites.size();
    std::vector<std::uint32_t> root(count);
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](std::uint32_t i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    for (const Cell& cell : scene_.cells)
      for (const std::uint32_t i : cell.members)
        root[find(siteGraph_.siteOf[i])] = find(siteGraph_.siteOf[cell.members[0]]);
    part_.assign(count, 0);
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;  // used nodes
    for (std::uint32_t p = 0; p < count; ++p) {
      part_[p] = find(p);
      for (const std::uint32_t n : siteGraph_.sites[p].nodes)
        if (used_[n]) members[part_[p]].push_back(n);
    }
    if (members.size() < 2) return;
    std::vector<std::vector<std::uint32_t>> lists;
    for (auto& [key, list] : members) lists.push_back(list);
    std::ranges::sort(lists, [&](const auto& a, const auto& b) {
      return a.size() != b.size() ? a.size() > b.size() : name(a[0]) < name(b[0]);
    });
    for (std::size_t i = 1; i < lists.size(); ++i) {
      const auto [from, to] = nearest(lists[i], lists);
      put(AdviceKind::apart, Severity::serious, lists[i], double(lists[i].size()),
          fmt::format(
              "{} (a group of {} photographs) is not connected to the other photographs; {} is the nearest of them.",
              name(from), lists[i].size(), name(to)),
          fmt::format("Walk from {} to {} and take photographs on the way, each overlapping the next by two thirds.",
                      name(from), name(to)));
    }
  }

  std::pair<std::uint32_t, std::uint32_t> nearest(const std::vector<std::uint32_t>& from,
                                                  const std::vector<std::vector<std::uint32_t>>& lists) const {
    std::pair<std::uint32_t, std::uint32_t> best{from[0], from[0]};
    double least = std::numeric_limits<double>::infinity();
    for (const auto& list : lists) {
      if (&list == &from || list == from) continue;
      for (const std::uint32_t i : from)
        for (const std::uint32_t j : list) {
          const double d = glm::distance(scene_.nodes[i].camera.pose.position, scene_.nodes[j].camera.pose.position);
          if (d < least) least = d, best = {i, j};
        }
    }
    return best;
  }

  // The photographs of two capture sites with the most similar viewing directions.
  std::pair<std::uint32_t, std::uint32_t> mostSimilar(const CaptureSite& a, const CaptureSite& b, double& angle) const {
    std::pair<std::uint32_t, std::uint32_t> best{a.nodes[0], b.nodes[0]};
    double most = -2;
    for (const std::uint32_t i : a.nodes)
      for (const std::uint32_t j : b.nodes) {
        const double cosine = glm::dot(viewAxis(scene_.nodes[i].camera.pose), viewAxis(scene_.nodes[j].camera.pose));
        if (cosine > most + 1e-9) most = cosine, best = {i, j};
      }
    angle = glm::degrees(std::acos(std::clamp(most, -1.0, 1.0)));
    return best;
  }

  bool isUsedSite(std::uint32_t site) const {
    return std::ranges::any_of(siteGraph_.sites[site].nodes, [&](std::uint32_t n) { return used_[n]; });
  }

  void links() {
    for (const SiteLink& way : siteGraph_.links) {
      const CaptureSite &a = siteGraph_.sites[way.a], &b = siteGraph_.sites[way.b];
      if (!isUsedSite(way.a) || !isUsedSite(way.b) || part_[way.a] != part_[way.b]) continue;
      const double shown = walk_.shownFrom(0.5 * (a.position + b.position), {way.a, way.b});
      if (!(shown < kWide)) continue;
      double angle = 0;
      const auto [i, j] = mostSimilar(a, b, angle);
      const double shift = way.length * 0.5 * (depths_[i].middle + depths_[j].middle);
      const auto more = std::size_t(std::clamp(std::ceil(shift / kGoodShift) - 1, 1.0, 20.0));
      const std::string between = fmt::format("{} and {}", name(i), name(j));
      if (!way.joined && angle > kTurnLess)
        put(AdviceKind::hole, Severity::warning, {i, j}, shown,
            fmt::format("{} are neighbours but not connected: their viewing directions differ by {:.0f}°.", between,
                        angle),
            fmt::format("Take more photographs in between, turning by less than {:.0f}° from one to the next.",
                        kTurnLess));
      else
        put(way.joined ? AdviceKind::wide : AdviceKind::hole, Severity::warning, {i, j}, shown,
            way.joined
                ? fmt::format("{} are too far apart for near objects: about {} % of the image can be shown halfway.",
                              between, percent(shown))
                : fmt::format("{} are neighbours but not connected: they are too far apart for near objects.", between),
            more == 1 ? std::string("Take one more photograph halfway between them.")
                      : fmt::format("Take {} more photographs between them, evenly spaced.", more));
      if (way.joined || angle <= kTurnLess) remedies_.push_back({result_.advice.size() - 1, &way, i, j, more});
    }
  }

  // Up to two: the remedy repeats the chosen next-best views, since the estimate may prefer thirds of the way.
  void agree(const LinkRemedy& remedy) {
    const glm::dvec3 from = siteGraph_.sites[remedy.way->a].position,
                     along = siteGraph_.sites[remedy.way->b].position - from;
    std::set<int> sixths;  // of the way
    for (const NextView& view : result_.views) {
      const glm::dvec3 to = view.camera.pose.position - from;
      const double t = glm::dot(to, along) / glm::dot(along, along);
      if (t > 0.1 && t < 0.9 && glm::distance(to, t * along) < 1e-6 * remedy.way->length)
        sixths.insert(int(std::lround(6 * t)));
    }
    if (sixths.empty() || remedy.more > 2) return;
    std::string& text = result_.advice[remedy.advice].remedy;
    if (sixths.size() > 1)
      text = sixths == std::set{2, 4}
                 ? "Take two more photographs between them, a third of the way from either."
                 : fmt::format("Take {} more photographs between them, evenly spaced.", sixths.size());
    else if (*sixths.begin() == 3)
      text = "Take one more photograph halfway between them.";
    else
      text = fmt::format("Take one more photograph between them, a third of the way from {}.",
                         name(*sixths.begin() < 3 ? remedy.i : remedy.j));
  }

  // At each capture site: viewing directions of neighbours that the site lacks.
  void directions() {
    for (std::size_t s = 0; s < walk_.viewpointCount(); ++s) {
      const auto here = walk_.viewpoint(s).site;
      if (!here || !isUsedSite(*here)) continue;
      const auto worst = walk_.worstShown(s);
      if (!worst || !(worst->shown < kDirection)) continue;
      const CaptureSite& at = siteGraph_.sites[*here];
      const auto looksSo = [&](std::uint32_t site) {
        return std::ranges::any_of(siteGraph_.sites[site].nodes, [&](std::uint32_t n) {
          return glm::dot(viewAxis(scene_.nodes[n].camera.pose), viewAxis(scene_.nodes[worst->node].camera.pose)) >
                 std::cos(glm::radians(kTurnLess));
        });
      };
      if (looksSo(*here) || std::ranges::count_if(at.beside, looksSo) < 2) continue;
      put(AdviceKind::direction, Severity::warning, {at.nodes[0], worst->node}, worst->shown,
          fmt::format("No photograph at the position of {} has the viewing direction of its neighbour {}.",
                      name(at.nodes[0]), name(worst->node)),
          "Return to this position and take one more photograph in that direction.");
    }
  }

  void twice() {
    for (const CaptureSite& site : siteGraph_.sites)
      for (std::size_t b = 1; b < site.nodes.size(); ++b)
        for (std::size_t a = 0; a < b; ++a) {
          const std::uint32_t i = site.nodes[a], j = site.nodes[b];
          const Camera &first = scene_.nodes[i].camera, &second = scene_.nodes[j].camera;
          const double same = std::abs(glm::dot(first.pose.rotation, second.pose.rotation));
          if (2 * std::acos(std::min(1.0, same)) > kTwice) continue;
          put(AdviceKind::twice, Severity::hint, {i, j}, kNoValue,
              fmt::format("{} repeats {}: both have the same position and viewing direction.", name(j), name(i)),
              "One of them is enough; a photograph from one step aside would add more.");
          break;
        }
  }

  // Judges the gains that make photographs alike: stored data, not displayed colours.
  void exposures() {
    const auto stops = [&](std::uint32_t n) { return -std::log2(glm::dot(scene_.nodes[n].gain, kLuminance)); };
    for (std::uint32_t n = 0; n < scene_.nodes.size(); ++n) {
      if (neighbours_[n].empty()) continue;
      std::vector<double> theirs;
      for (const std::uint32_t m : neighbours_[n]) theirs.push_back(stops(m));
      const double jump = stops(n) - median(std::move(theirs));
      if (!(std::abs(jump) > kStops)) continue;
      put(AdviceKind::exposure, Severity::warning, {n}, jump,
          fmt::format("{} is {:.1f} stops {} than its neighbours, for example {}.", name(n), std::abs(jump),
                      jump > 0 ? "brighter" : "darker",
                      name(*std::ranges::min_element(neighbours_[n], {}, [&](std::uint32_t m) { return name(m); }))),
          "Lock the exposure before the first photograph, or set it manually.");
    }
  }

  void matches() {
    for (std::uint32_t n = 0; n < scene_.nodes.size(); ++n) {
      if (neighbours_[n].empty()) continue;
      std::vector<double> theirs;
      for (const std::uint32_t m : neighbours_[n]) theirs.push_back(depths_[m].agreedShare());
      const double own = depths_[n].agreedShare();
      if (!(own < kFewMatched) || !(own < kFewerThan * median(theirs))) continue;
      put(AdviceKind::unmatched, Severity::warning, {n}, own,
          fmt::format("Only {} % of {} matches its neighbours.", percent(own), name(n)),
          "Is the photograph blurred, or are most objects in it moving, shiny, textureless or hidden from its "
          "neighbours? Take it again, nearer to them.");
    }
  }

  double residual(const Cell& cell) const {
    double longest = 1;
    for (const std::uint32_t i : cell.members) {
      const Intrinsics& k = scene_.nodes[i].camera.intrinsics;
      longest = std::max(longest, double(std::max(k.width, k.height)));
    }
    return cell.quality.residualPx / longest;
  }

  void poses() {
    std::vector<double> all;
    std::vector<std::vector<double>> ofNode(scene_.nodes.size());
    for (const Cell& cell : scene_.cells)
      if (const double r = residual(cell); std::isfinite(r)) {
        all.push_back(r);
        for (const std::uint32_t i : cell.members) ofNode[i].push_back(r);
      }
    const double typical = median(all);
    const auto px = [&](double share, const Intrinsics& k) { return share * std::max(k.width, k.height); };
    if (typical > kResidual) {
      put(AdviceKind::pose, Severity::serious, {}, typical,
          fmt::format("The camera poses are inaccurate: matches are off by {:.1f} % of the longer image side.",
                      100 * typical),
          "Estimate the poses again from sharper photographs that overlap more, with one lens and without zooming.");
      return;
    }
    for (std::uint32_t n = 0; n < scene_.nodes.size(); ++n) {
      if (ofNode[n].empty()) continue;
      const double least = *std::ranges::min_element(ofNode[n]);
      if (!(least > kResidual) || !(least > kWorseThan * typical)) continue;
      put(AdviceKind::pose, Severity::warning, {n}, least,
          fmt::format("The pose of {} is inaccurate: its matches are off by {:.1f} px.", name(n),
                      px(least, scene_.nodes[n].camera.intrinsics)),
          "Exclude the photograph (--exclude), or take it again with more overlap.");
    }
  }

  void row() {
    if (!siteGraph_.row || siteGraph_.sites.size() < 3) return;
    put(AdviceKind::row, Severity::hint, {}, kNoValue,
        "The photographs form one row: the viewpoint can move along the row, but not away from it, up or down.",
        "Take a second row beside or above the first, at the spacing of the photographs in the first.");
  }

  void unused() {
    for (const UnusedPhotograph& photo : scene_.unusedPhotographs) {
      std::vector<std::uint32_t> nodes;
      for (std::uint32_t n = 0; n < scene_.nodes.size(); ++n)
        if (scene_.nodes[n].name == photo.name) nodes.push_back(n);
      // Reasons of unreadable files include the remedy.
      const bool hasRemedy = nodes.empty() && photo.reason != kNotRegistered;
      put(AdviceKind::unused, Severity::warning, std::move(nodes), kNoValue,
          fmt::format("{} is not used: {}.", photo.name, photo.reason),
          hasRemedy ? "" : "Take it again nearer to the others, overlapping its neighbours by two thirds.");
    }
  }

  const Scene& scene_;
  const std::vector<DepthGrid> depths_;
  const SiteGraph siteGraph_;
  WalkEstimate walk_;
  std::vector<bool> used_;
  const std::vector<std::vector<std::uint32_t>> neighbours_;  // nodes that share a cell with each node
  std::vector<std::uint32_t> part_;                           // of each capture site
  std::vector<LinkRemedy> remedies_;
  CaptureAdvice result_;
};

}  // namespace

const char* adviceKindName(AdviceKind kind) noexcept {
  constexpr const char* kNames[] = {"tooFew",  "turned",    "apart", "hole",   "wide",  "direction", "exposure",
                                    "blurred", "unmatched", "pose",  "unused", "twice", "row"};
  return kNames[std::size_t(kind)];
}

const char* severityName(Severity severity) noexcept {
  constexpr const char* kNames[] = {"hint", "warning", "serious"};
  return kNames[std::size_t(severity)];
}

CaptureAdvice adviseCapture(const Scene& scene, const AdviceOptions& options) {
  const std::vector<Fault> faults = validate(scene, 1);
  if (!faults.empty())
    fail(ErrorCode::invalidInput, "{}: {} {}", scene.folder.string(), faults[0].field, faults[0].message);
  return Adviser(scene).run(options);
}

}  // namespace ibr
