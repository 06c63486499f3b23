// SPDX-License-Identifier: Apache-2.0
#include "optimise/star_mesh.h"

#include <algorithm>
#include <map>

#include "base/check.h"
#include "shared/ecc.h"

namespace ibr {
namespace {

constexpr int kMaxSide = 16384;

glm::ivec2 sumOf(const Positions& at, std::uint32_t point) {
  glm::ivec2 sum(0);
  for (const auto& member : at) sum += member[point];
  return sum;
}

std::int64_t areaIn(const std::vector<glm::ivec2>& at, const glm::uvec3& t) {
  return shader::eccArea(at[t.x], at[t.y], at[t.z]);
}

std::int64_t areaInMean(const Positions& at, std::size_t i, std::size_t k, const glm::uvec3& t) {
  return shader::eccArea(at[i][t.x] + at[k][t.x], at[i][t.y] + at[k][t.y], at[i][t.z] + at[k][t.z]);
}

void checkAlignment(const Alignment& a) {
  const std::size_t d = a.pictures.size();
  check(d >= 2 && d <= 4, ErrorCode::invalidInput, "alignment.pictures: {} pictures, must be 2 to 4", d);
  check(a.position.size() == d, ErrorCode::invalidInput, "alignment.position: {} lists for {} pictures",
        a.position.size(), d);
  const std::size_t n = a.position[0].size();
  check(a.fixed.empty() || a.fixed.size() == n, ErrorCode::invalidInput, "alignment.fixed: {} entries for {} points",
        a.fixed.size(), n);
  for (std::size_t i = 0; i < d; ++i) {
    check(a.pictures[i] && a.pictures[i]->channels == 3 && a.pictures[i]->width > 0 && a.pictures[i]->height > 0,
          ErrorCode::invalidInput, "alignment.pictures[{}]: not an RGB image", i);
    const glm::ivec2 size(a.pictures[i]->width, a.pictures[i]->height);
    check(std::max(size.x, size.y) <= kMaxSide, ErrorCode::invalidInput,
          "alignment.pictures[{}]: {}×{} px, a side must be at most {} px", i, size.x, size.y, kMaxSide);
    check(a.position[i].size() == n, ErrorCode::invalidInput, "alignment.position[{}]: {} points, not {}", i,
          a.position[i].size(), n);
    for (std::size_t p = 0; p < n; ++p) {
      const glm::ivec2 at = a.position[i][p];
      check(at.x >= 0 && at.y >= 0 && at.x <= size.x * kAlignmentUnitsPerPixel &&
                at.y <= size.y * kAlignmentUnitsPerPixel,
            ErrorCode::invalidInput, "alignment.position[{}][{}]: ({}, {})/128 px is outside {}×{} px", i, p, at.x,
            at.y, size.x, size.y);
    }
  }
  const auto checkIndices = [&](const std::vector<glm::uvec3>& triangles, const char* name) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int c = 0; c < 3; ++c)
        check(triangles[t][c] < n, ErrorCode::invalidInput, "alignment.{}[{}]: corner {} is beyond the {} points", name,
              t, triangles[t][c], n);
  };
  checkIndices(a.triangles, "triangles");
  checkIndices(a.unevaluated, "unevaluated");
  for (std::size_t t = 0; t < a.triangles.size(); ++t)
    for (std::size_t i = 0; i < d; ++i)
      check(areaIn(a.position[i], a.triangles[t]) > 0, ErrorCode::invalidInput,
            "alignment.triangles[{}]: folded over in image {}", t, i);
}

struct Lists {
  std::vector<std::vector<glm::uvec2>> star, kept;
  std::vector<std::vector<std::uint32_t>> where;
  std::vector<std::uint8_t> fixed;
};

Lists listsOf(const Alignment& a) {
  const std::size_t n = a.position[0].size();
  Lists lists{std::vector<std::vector<glm::uvec2>>(n), std::vector<std::vector<glm::uvec2>>(n),
              std::vector<std::vector<std::uint32_t>>(n), a.fixed};
  lists.fixed.resize(n, 0);
  for (const glm::uvec3& t : a.triangles) {
    const bool judged = isUnfolded(a.position, t);
    for (int c = 0; c < 3; ++c) {
      if (judged)
        lists.star[t[c]].push_back({t[(c + 1) % 3], t[(c + 2) % 3]});
      else
        lists.fixed[t[c]] = 1;
    }
  }
  for (const glm::uvec3& t : a.unevaluated) {
    std::uint32_t where = 0;
    for (std::size_t i = 0; i < a.position.size(); ++i)
      if (areaIn(a.position[i], t) > 0) where |= 1u << i;
    for (int c = 0; c < 3 && where != 0; ++c) {
      lists.kept[t[c]].push_back({t[(c + 1) % 3], t[(c + 2) % 3]});
      lists.where[t[c]].push_back(where);
    }
  }
  return lists;
}

// A point is inside if its star closes around it, and on a simple border if one edge enters and one leaves.
void findBorder(StarMesh& mesh, std::span<const std::uint8_t> fixed) {
  for (std::uint32_t p = 0; p < fixed.size(); ++p) {
    std::map<std::uint32_t, int> ends;  // +1: begins a triangle's far edge, −1: ends one
    for (const glm::uvec2& edge : mesh.star[p]) ++ends[edge.x], --ends[edge.y];
    std::vector<std::uint32_t> begin, end;
    bool simple = !ends.empty();
    for (const auto& [point, count] : ends) {
      if (count == 1) begin.push_back(point);
      if (count == -1) end.push_back(point);
      simple = simple && count >= -1 && count <= 1;
    }
    simple = simple && ends.size() + begin.size() == mesh.star[p].size() + 2 * begin.size() && begin.size() < 2;
    mesh.chord.push_back(simple && !begin.empty() ? glm::uvec2(begin[0], end[0]) : glm::uvec2(0));
    mesh.border.push_back(!simple || fixed[p] ? BorderKind::fixed
                          : begin.empty()     ? BorderKind::interior
                                              : BorderKind::slides);
  }
}

// Greedy, in the points' order: a point gets the first class that none of its neighbours has.
void colour(StarMesh& mesh) {
  constexpr std::uint32_t kNone = ~0u;
  const std::size_t n = mesh.vertexCount();
  std::vector<std::uint32_t> classOf(n, kNone);
  std::vector<std::vector<std::uint32_t>> classes;
  for (std::uint32_t p = 0; p < n; ++p) {
    if (mesh.border[p] == BorderKind::fixed) continue;
    std::vector<bool> taken(classes.size() + 1, false);
    const auto look = [&](std::uint32_t q) {
      if (classOf[q] != kNone) taken[classOf[q]] = true;
    };
    for (const Rows<glm::uvec2>* rows : {&mesh.star, &mesh.kept})
      for (const glm::uvec2& edge : (*rows)[p]) look(edge.x), look(edge.y);
    classOf[p] = std::uint32_t(std::ranges::find(taken, false) - taken.begin());
    if (classOf[p] == classes.size()) classes.emplace_back();
    classes[classOf[p]].push_back(p);
  }
  for (const auto& points : classes) mesh.colours.add(points);
}

}  // namespace

bool isUnfolded(const Positions& at, const glm::uvec3& t) {
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (areaIn(at[i], t) <= 0) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (areaInMean(at, i, k, t) <= 0) return false;
  }
  return shader::eccArea(sumOf(at, t.x), sumOf(at, t.y), sumOf(at, t.z)) > 0;
}

StarMesh starMeshOf(const Alignment& alignment) {
  checkAlignment(alignment);
  StarMesh mesh;
  for (const Image8* picture : alignment.pictures) mesh.size.push_back({picture->width, picture->height});
  const Lists lists = listsOf(alignment);
  for (std::size_t p = 0; p < lists.fixed.size(); ++p) {
    mesh.star.add(lists.star[p]);
    mesh.kept.add(lists.kept[p]);
    mesh.keptWhere.add(lists.where[p]);
  }
  findBorder(mesh, lists.fixed);
  colour(mesh);
  return mesh;
}

int maxMove(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member, int most) {
  if (mesh.border[point] == BorderKind::fixed) return 0;
  int reach = most;
  for (const glm::uvec2& edge : mesh.star[point]) {
    reach = std::min(reach, shader::eccMaxMove(at[member][point], at[member][edge.x], at[member][edge.y]));
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (k == member) continue;
      const auto mean = [&](std::uint32_t p) { return at[member][p] + at[k][p]; };
      reach = std::min(reach, shader::eccMaxMove(mean(point), mean(edge.x), mean(edge.y)));
    }
    if (at.size() > 2)
      reach = std::min(reach, shader::eccMaxMove(sumOf(at, point), sumOf(at, edge.x), sumOf(at, edge.y)));
  }
  return reach;
}

glm::ivec2 candidateOffset(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member,
                           int radius, std::uint32_t seed, std::uint32_t instance) {
  const std::uint32_t own = shader::eccHash(seed, instance);
  if (mesh.border[point] == BorderKind::interior) return shader::eccOffsetInDisc(own, radius);
  const glm::uvec2 chord = mesh.chord[point];
  return shader::eccOffsetAlong(own, radius, at[member][chord.y] - at[member][chord.x]);
}

bool fits(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member, glm::ivec2 offset) {
  const glm::ivec2 to = at[member][point] + offset, most = mesh.size[member] * kAlignmentUnitsPerPixel;
  if (to.x < 0 || to.y < 0 || to.x > most.x || to.y > most.y) return false;
  for (const glm::uvec2& edge : mesh.star[point]) {
    if (shader::eccArea(to, at[member][edge.x], at[member][edge.y]) <= 0) return false;
    for (std::size_t k = 0; k < at.size(); ++k)
      if (k != member && shader::eccArea(to + at[k][point], at[member][edge.x] + at[k][edge.x],
                                         at[member][edge.y] + at[k][edge.y]) <= 0)
        return false;
    if (at.size() > 2 && shader::eccArea(sumOf(at, point) + offset, sumOf(at, edge.x), sumOf(at, edge.y)) <= 0)
      return false;
  }
  const auto kept = mesh.kept[point];
  for (std::size_t t = 0; t < kept.size(); ++t)
    if ((mesh.keptWhere[point][t] >> member & 1u) &&
        shader::eccArea(to, at[member][kept[t].x], at[member][kept[t].y]) <= 0)
      return false;
  return true;
}

}  // namespace ibr
