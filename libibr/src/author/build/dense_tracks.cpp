// SPDX-License-Identifier: Apache-2.0
#include "author/build/dense_tracks.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace ibr {
namespace {

// Observations that one cell gives for a seed.
struct Star {
  glm::dvec4 point;  // homogeneous, world
  std::vector<BundleObservation> others;
};

class Seeds {
 public:
  Seeds(const Intrinsics& k, double wanted)
      : step_(std::sqrt(double(k.width) * k.height / wanted)),
        across_(std::max(1, int(k.width / step_))),
        down_(std::max(1, int(k.height / step_))),
        stars_(std::size_t(across_) * std::size_t(down_)) {}

  std::size_t count() const { return stars_.size(); }
  std::vector<Star>& stars(std::size_t seed) { return stars_[seed]; }
  glm::dvec2 pixel(std::size_t seed) const {
    return step_ * (glm::dvec2(double(seed % std::size_t(across_)), double(seed / std::size_t(across_))) + 0.5);
  }
  // Calls `call` with each seed within a box.
  template <class F>
  void within(glm::dvec2 low, glm::dvec2 high, F&& call) const {
    const auto first = [&](double v) { return std::max(0, int(std::ceil(v / step_ - 0.5))); };
    const auto last = [&](double v, int count) { return std::min(count - 1, int(std::floor(v / step_ - 0.5))); };
    for (int y = first(low.y); y <= last(high.y, down_); ++y)
      for (int x = first(low.x); x <= last(high.x, across_); ++x)
        call(std::size_t(y) * std::size_t(across_) + std::size_t(x));
  }

 private:
  double step_;
  int across_, down_;
  std::vector<std::vector<Star>> stars_;
};

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Barycentric coordinates of a pixel; nullopt outside the triangle.
std::optional<glm::dvec3> coordinates(const std::array<glm::dvec2, 3>& corners, glm::dvec2 pixel) {
  const double area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (area == 0) return std::nullopt;
  const glm::dvec3 b(cross(corners[1] - pixel, corners[2] - pixel) / area,
                     cross(corners[2] - pixel, corners[0] - pixel) / area,
                     cross(corners[0] - pixel, corners[1] - pixel) / area);
  if (!(b.x >= 0 && b.y >= 0 && b.z >= 0)) return std::nullopt;
  return b;
}

class StarsOfCell {
 public:
  StarsOfCell(const std::vector<Node>& nodes, const Cell& cell) : cell_(cell) {
    for (const std::uint32_t i : cell.members) cameras_.push_back(nodes[i].camera);
  }

  // Adds the stars of one member's seeds.
  void addTo(Seeds& seeds, std::size_t member) const {
    const MorphMesh& mesh = cell_.mesh;
    std::vector<std::optional<Star>> nearest(seeds.count());
    for (std::size_t t = 0, count = mesh.tier0Count(); t < count; ++t) {
      std::array<glm::dvec2, 3> corners;
      for (int c = 0; c < 3; ++c) corners[std::size_t(c)] = mesh.match[member][mesh.triangles[t][c]];
      const auto [a, b, c] = corners;
      seeds.within(glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), [&](std::size_t seed) {
        const auto found = coordinates(corners, seeds.pixel(seed));
        if (!found) return;
        auto star = starAt(mesh.triangles[t], *found, member);
        if (star && (!nearest[seed] || nearest[seed]->point.w < star->point.w)) nearest[seed] = std::move(star);
      });
    }
    for (std::size_t seed = 0; seed < seeds.count(); ++seed)
      if (nearest[seed]) seeds.stars(seed).push_back(std::move(*nearest[seed]));
  }

 private:
  // Linear interpolation on the triangle is linear in space when vertices lie at their a_i along the member's rays.
  std::optional<Star> starAt(const glm::uvec3& triangle, const glm::dvec3& onPicture, std::size_t member) const {
    const MorphMesh& mesh = cell_.mesh;
    const auto seen = [&](std::size_t i, int corner) {
      const std::uint32_t v = triangle[corner];
      return double(mesh.ratio[i][v]) * unproject(cameras_[i].intrinsics, glm::dvec2(mesh.match[i][v]));
    };
    glm::dvec3 weights;
    double rho = 0, sum = 0;
    for (int c = 0; c < 3; ++c) sum += weights[c] = onPicture[c] / std::max(-seen(member, c).z, 1e-9);
    weights /= sum;
    for (int c = 0; c < 3; ++c) rho += weights[c] * double(mesh.inverseDistance[triangle[c]]);
    Star star{glm::dvec4(0.0), {}};
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      glm::dvec3 q(0.0);
      for (int c = 0; c < 3; ++c) q += weights[c] * seen(i, c);
      const auto pixel = project(cameras_[i].intrinsics, q);
      if (!pixel) return std::nullopt;
      if (i != member) star.others.push_back({cell_.members[i], *pixel});
      const Pose& pose = cameras_[i].pose;
      star.point += glm::dvec4(pose.rotation * q + rho * pose.position, rho) / double(cameras_.size());
    }
    return star;
  }

  const Cell& cell_;
  std::vector<Camera> cameras_;
};

// Mean of the cells' observations for each member; omits a member for which they disagree.
std::vector<BundleObservation> agreed(const std::vector<Star>& stars, double agreePx) {
  std::vector<BundleObservation> all, kept;
  for (const Star& star : stars) all.insert(all.end(), star.others.begin(), star.others.end());
  std::ranges::stable_sort(all, {}, &BundleObservation::camera);
  for (auto first = all.begin(); first != all.end();) {
    const auto last = std::find_if(first, all.end(), [&](const auto& o) { return o.camera != first->camera; });
    glm::dvec2 mean(0.0), low = first->pixel, high = first->pixel;
    for (auto o = first; o != last; ++o) {
      mean += o->pixel / double(last - first);
      low = glm::min(low, o->pixel);
      high = glm::max(high, o->pixel);
    }
    if (glm::distance(low, high) <= agreePx) kept.push_back({first->camera, mean});
    first = last;
  }
  return kept;
}

}  // namespace

std::vector<BundlePoint> denseTracks(const std::vector<Node>& nodes, const std::vector<Cell>& cells,
                                     const DenseTrackOptions& options) {
  std::vector<std::vector<const Cell*>> cellsWith(nodes.size());
  for (const Cell& cell : cells) {
    const bool pinholes = std::ranges::all_of(
        cell.members, [&](std::uint32_t i) { return nodes[i].camera.intrinsics.model == CameraModel::pinhole; });
    for (const std::uint32_t i : cell.members)
      if (pinholes) cellsWith[i].push_back(&cell);
  }
  std::vector<BundlePoint> tracks;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (cellsWith[i].empty()) continue;
    Seeds seeds(nodes[i].camera.intrinsics, options.seeds);
    for (const Cell* cell : cellsWith[i])
      StarsOfCell(nodes, *cell).addTo(seeds, std::size_t(std::ranges::find(cell->members, i) - cell->members.begin()));
    for (std::size_t seed = 0; seed < seeds.count(); ++seed) {
      if (seeds.stars(seed).empty()) continue;
      BundlePoint track{seeds.stars(seed)[0].point, {{i, seeds.pixel(seed)}}};
      const std::vector<BundleObservation> others = agreed(seeds.stars(seed), options.agreePx);
      track.seen.insert(track.seen.end(), others.begin(), others.end());
      if (track.seen.size() >= 2) tracks.push_back(std::move(track));
    }
  }
  return tracks;
}

}  // namespace ibr
