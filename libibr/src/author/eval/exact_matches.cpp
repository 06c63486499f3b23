// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <ranges>
#include <utility>

#include "author/eval/exact_surface.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/mesh_signs.h"
#include "author/match/ranges.h"
#include "base/check.h"
#include "ibr/lab/accuracy.h"

namespace ibr {
namespace {

// One point as a mesh stores it.
struct PointMatch {
  std::vector<glm::vec2> at;  // d
  std::vector<float> ratio;   // d
  float inverseDistance = 0;
  float uncertainty = 0;
};

class ExactCell {
 public:
  ExactCell(const MorphMesh& mesh, std::span<const ExactSurface* const> surfaces, const ExactMatchOptions& options,
            std::size_t cell)
      : mesh_(mesh), surfaces_(surfaces), options_(options), around_(mesh.vertexCount()) {
    std::seed_seq seeds{std::uint32_t(options.seed), std::uint32_t(options.seed >> 32), std::uint32_t(cell)};
    random_.seed(seeds);
    for (const ExactSurface* surface : surfaces) cameras_.push_back(surface->camera());
    frame_ = meanFrame(cameras_);
    constexpr double kFar = 1e6;  // standard deviation, relative to the scene's inverse distances
    for (const float rho : mesh.inverseDistance) noPrior_.deviation = std::max(noPrior_.deviation, kFar * double(rho));
    for (const glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) around_[t[k]].push_back(t);
  }

  std::size_t run() {
    std::vector<bool> agrees(mesh_.vertexCount(), false);
    for (std::size_t t = 0, count = mesh_.tier0Count(); t < count; ++t)
      for (int k = 0; k < 3; ++k) agrees[mesh_.triangles[t][k]] = true;
    for (std::size_t p = 0; p < agrees.size(); ++p)
      if (agrees[p]) place(p);
    return moved_;
  }
  MorphMesh& mesh() { return mesh_; }

 private:
  void place(std::size_t p) {
    const auto exact = exactMatch(p);
    if (!exact) return;
    const std::vector<unsigned> before = signsAround(p);
    const PointMatch was = exchange(p, *exact);
    const bool inside = std::ranges::all_of(std::views::iota(std::size_t(0), surfaces_.size()), [&](std::size_t i) {
      const glm::vec2 at = mesh_.match[i][p];
      return at.x >= 0 && at.y >= 0 && at.x <= float(surfaces_[i]->width()) && at.y <= float(surfaces_[i]->height());
    });
    const bool sound = mesh_.inverseDistance[p] >= 0 &&
                       std::ranges::all_of(mesh_.ratio, [&](const auto& ratio) { return ratio[p] > 0; });
    if (inside && sound && signsAround(p) == before)
      ++moved_;
    else
      exchange(p, was);
  }

  std::optional<PointMatch> exactMatch(std::size_t p) {
    const auto point = surfaces_[0]->between(mesh_.match[0][p]);
    if (!point) return std::nullopt;
    PointMatch exact;
    std::vector<double> distance;  // times the point's w; ρ and a_i do not depend on this factor
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      const auto seen = surfaces_[i]->seen(*point);
      if (!seen || glm::distance(*seen, glm::dvec2(mesh_.match[i][p])) > options_.maxErrorPx) return std::nullopt;
      exact.at.push_back(*seen);
      distance.push_back(glm::length(glm::dvec3(*point) - point->w * surfaces_[i]->camera().pose.position));
    }
    const double mean = std::accumulate(distance.begin(), distance.end(), 0.0) / double(distance.size());
    exact.inverseDistance = float(point->w / mean);
    for (const double d : distance) exact.ratio.push_back(float(d / mean));
    exact.uncertainty = mesh_.uncertainty[p];
    if (options_.noisePx > 0) addNoise(exact);
    return exact;
  }

  // Adds noise to the matches, then solves ρ, a_i and uncertainty from the noisy matches alone.
  void addNoise(PointMatch& match) {
    std::vector<glm::dvec2> pixels{match.at[0]};
    for (std::size_t i = 1; i < match.at.size(); ++i) {
      const double x = noise(), y = noise();
      match.at[i] += glm::vec2(x, y);
      pixels.emplace_back(match.at[i]);
    }
    const double deviation = std::max(kNoisePx, options_.noisePx / std::sqrt(3.0));
    const RangeFit range = triangulate(frame_, cameras_, pixels, noPrior_, deviation);
    match.inverseDistance = float(range.inverseDistance);
    match.uncertainty = float(range.uncertainty);
    for (std::size_t i = 0; i < match.ratio.size(); ++i) match.ratio[i] = float(range.ratio[i]);
  }

  double noise() { return options_.noisePx * (double(random_() >> 11) * 0x1p-52 - 1.0); }

  PointMatch exchange(std::size_t p, const PointMatch& now) {
    PointMatch was;
    was.inverseDistance = std::exchange(mesh_.inverseDistance[p], now.inverseDistance);
    was.uncertainty = std::exchange(mesh_.uncertainty[p], now.uncertainty);
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      was.at.push_back(std::exchange(mesh_.match[i][p], now.at[i]));
      was.ratio.push_back(std::exchange(mesh_.ratio[i][p], now.ratio[i]));
    }
    return was;
  }

  // Signs of all triangles around a point, for both orientations: triangles of tier 1 may be folded over.
  std::vector<unsigned> signsAround(std::size_t p) const {
    std::vector<unsigned> signs;
    for (const glm::uvec3& t : around_[p]) {
      signs.push_back(meshSigns(mesh_.match, t));
      signs.push_back(meshSigns(mesh_.match, turned(t)));
    }
    return signs;
  }

  MorphMesh mesh_;
  std::span<const ExactSurface* const> surfaces_;
  const ExactMatchOptions& options_;
  std::vector<Camera> cameras_;
  Camera frame_;
  RangePrior noPrior_{0, 1e-3};
  std::mt19937_64 random_;
  std::vector<std::vector<glm::uvec3>> around_;  // n
  std::size_t moved_ = 0;
};

// Records in the scene's settings that its matches were replaced.
std::string settingsWith(const std::string& settings, const ExactMatchOptions& options) {
  using Json = nlohmann::ordered_json;
  Json json = Json::parse(settings, nullptr, false);
  if (!json.is_object()) json = Json::object();
  json["exactMatches"] = {{"within", options.maxErrorPx}, {"noise", options.noisePx}, {"seed", options.seed}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::size_t setExactMatches(Scene& scene, std::span<const ExactDepthView> truth, const ExactMatchOptions& options,
                            int threads, const ProgressCallback& progress) {
  check(options.maxErrorPx > 0, ErrorCode::invalidInput, "maxErrorPx is {} px, must be above 0", options.maxErrorPx);
  check(options.noisePx >= 0 && options.noisePx <= 64, ErrorCode::invalidInput, "noisePx is {} px, must be 0 to 64",
        options.noisePx);
  const auto surfaces = exactSurfaces(scene, truth, threads, progress);
  std::vector<MorphMesh> meshes(scene.cells.size());
  std::vector<std::size_t> moved(scene.cells.size(), 0);
  forEachCell(scene, "placing exact matches", threads, progress, [&](std::size_t c) {
    const auto members = surfacesOf(scene, scene.cells[c], surfaces);
    if (members.empty()) return;
    ExactCell cell(scene.cells[c].mesh, members, options, c);
    moved[c] = cell.run();
    meshes[c] = std::move(cell.mesh());
  });
  scene.settings = settingsWith(scene.settings, options);
  for (std::size_t c = 0; c < meshes.size(); ++c)
    if (moved[c] > 0) {
      MorphMesh& mesh = scene.cells[c].mesh = std::move(meshes[c]);
      mesh.confirmations.clear();  // lists belong to the old positions
      mesh.consensus.clear();
    }
  return std::accumulate(moved.begin(), moved.end(), std::size_t(0));
}

}  // namespace ibr
