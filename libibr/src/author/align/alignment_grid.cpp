// SPDX-License-Identifier: Apache-2.0
#include "author/align/alignment_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "author/geometry/mesh_signs.h"

namespace ibr {
namespace {

constexpr double kUnits = kAlignmentUnitsPerPixel;

glm::vec2 pixels(glm::ivec2 at) {
  return glm::vec2(at) / float(kAlignmentUnitsPerPixel);
}

class Grid {
 public:
  Grid(const MorphMesh& mesh, const std::vector<glm::ivec2>& size, const std::vector<std::uint8_t>& fixed)
      : mesh_(mesh),
        size_(size),
        all_(allPositive(size.size())),
        around_(mesh.vertexCount()),
        gridPosition_(mesh.match) {
    fixed_ = fixed;
    fixed_.resize(mesh.vertexCount(), 0);
    out_.alignment.position.resize(size.size());
    for (std::size_t i = 0; i < size.size(); ++i)
      for (std::size_t p = 0; p < mesh.vertexCount(); ++p) put(i, p, nearest(i, p));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const glm::uvec3 corner = mesh.triangles[t];
      triangles_.push_back((meshSigns(mesh.match, corner) & 1u) ? corner : turned(corner));
      judged_.push_back(mesh.tier[t] == kTierConsistent && meshSigns(mesh.match, triangles_[t]) == all_);
      if (judged_[t])
        for (int k = 0; k < 3; ++k) around_[corner[k]].push_back(t);
    }
  }

  AlignmentGrid run() {
    for (std::size_t p = 0; p < mesh_.vertexCount(); ++p)
      if (outside(p)) fixPoint(unsigned(p));
    for (std::size_t t = 0; t < judged_.size(); ++t)
      if (folded(t)) shift(t);
    for (std::size_t t = 0; t < judged_.size(); ++t)
      if (folded(t)) fixPoint(worstCorner(t));
    for (std::size_t t = 0; t < judged_.size(); ++t) {
      (judged_[t] ? out_.alignment.triangles : out_.alignment.unevaluated).push_back(triangles_[t]);
      if (judged_[t]) out_.judged.push_back(t);
    }
    out_.alignment.fixed = std::move(fixed_);
    return std::move(out_);
  }

 private:
  glm::ivec2 nearest(std::size_t i, std::size_t p) const {
    const glm::dvec2 at = glm::clamp(glm::dvec2(mesh_.match[i][p]), glm::dvec2(0.0), glm::dvec2(size_[i]));
    return glm::ivec2(glm::round(at * kUnits));
  }
  void put(std::size_t i, std::size_t p, glm::ivec2 at) {
    auto& list = out_.alignment.position[i];
    if (list.size() <= p) list.resize(mesh_.vertexCount());
    list[p] = at;
    gridPosition_[i][p] = pixels(at);
  }
  bool outside(std::size_t p) const {
    for (std::size_t i = 0; i < size_.size(); ++i) {
      const glm::dvec2 at(mesh_.match[i][p]), size(size_[i]);
      if (!(at.x >= 0 && at.y >= 0 && at.x <= size.x && at.y <= size.y)) return true;
    }
    return false;
  }
  bool folded(std::size_t t) const { return judged_[t] && meshSigns(gridPosition_, triangles_[t]) != all_; }
  std::size_t folds(unsigned p) const {
    return std::size_t(std::ranges::count_if(around_[p], [&](std::size_t t) { return folded(t); }));
  }

  // Searches a grid point nearby, for one corner in one image, that unfolds all triangles around the corner.
  void shift(std::size_t t) {
    for (int k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < size_.size(); ++i)
        if (shift(i, mesh_.triangles[t][k])) return;
  }
  bool shift(std::size_t i, unsigned p) {
    const glm::ivec2 before = out_.alignment.position[i][p], centre = nearest(i, p);
    const glm::dvec2 wanted = glm::dvec2(mesh_.match[i][p]) * kUnits;
    std::vector<glm::ivec2> places;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const glm::ivec2 at = centre + glm::ivec2(x, y);
        if (at == glm::clamp(at, glm::ivec2(0), size_[i] * kAlignmentUnitsPerPixel)) places.push_back(at);
      }
    std::ranges::stable_sort(places, {}, [&](glm::ivec2 at) { return glm::distance(glm::dvec2(at), wanted); });
    for (const glm::ivec2 at : places) {
      put(i, p, at);
      if (folds(p) == 0) return true;
    }
    put(i, p, before);
    return false;
  }

  unsigned worstCorner(std::size_t t) const {
    const glm::uvec3& corner = mesh_.triangles[t];
    unsigned worst = corner.x;
    for (int k = 1; k < 3; ++k)
      if (folds(corner[k]) > folds(worst)) worst = corner[k];
    return worst;
  }
  void fixPoint(unsigned p) {
    fixed_[p] = 1;
    ++out_.fixed;
    for (const std::size_t t : around_[p]) judged_[t] = false;
  }

  const MorphMesh& mesh_;
  const std::vector<glm::ivec2>& size_;
  std::uint32_t all_;
  std::vector<glm::uvec3> triangles_;                 // turned to be positive in the first image
  std::vector<std::vector<std::size_t>> around_;      // judged triangles around each point
  std::vector<std::vector<glm::vec2>> gridPosition_;  // on the grid, px
  std::vector<std::uint8_t> fixed_;
  std::vector<bool> judged_;
  AlignmentGrid out_;
};

}  // namespace

AlignmentGrid toAlignmentGrid(const MorphMesh& mesh, const std::vector<glm::ivec2>& size,
                              const std::vector<std::uint8_t>& fixed) {
  return Grid(mesh, size, fixed).run();
}

std::vector<std::vector<glm::vec2>> movedMatch(const MorphMesh& mesh, const std::vector<std::vector<glm::ivec2>>& from,
                                               const std::vector<std::vector<glm::ivec2>>& to) {
  std::vector<std::vector<glm::vec2>> match = mesh.match;
  for (std::size_t i = 0; i < match.size(); ++i)
    for (std::size_t p = 0; p < match[i].size(); ++p)
      if (to[i][p] != from[i][p]) match[i][p] = pixels(to[i][p]);
  for (std::size_t i = 0; i < match.size(); ++i)
    for (std::size_t p = match[i].size(); p < to[i].size(); ++p) match[i].push_back(pixels(to[i][p]));
  return match;
}

}  // namespace ibr
