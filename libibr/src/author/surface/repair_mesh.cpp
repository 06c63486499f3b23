// SPDX-License-Identifier: Apache-2.0
// Repairs a mesh in rounds, until nothing changes:
//   1. drop unusable and duplicate faces
//   2. join faces across edges: by their corners, then borders by position
//   3. orient each connected part
//   4. merge corners that are joined around a vertex into one vertex
//   5. remove faces without area
#include "author/surface/repair_mesh.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "author/geometry/disjoint_sets.h"
#include "author/surface/degenerate_faces.h"
#include "scene/scene_faults.h"

namespace ibr {
namespace {

// Corner k of face f is 3f + k, and so is the half-edge from corner k to the next.
std::uint32_t next(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

constexpr std::uint32_t kNone = ~0u;

class Repair {
 public:
  Repair(TriangleMesh& mesh, RepairReport& report) : mesh_(mesh), report_(report) {}

  void run() {
    for (int round = 0; round < kMaxRounds; ++round) {
      changed_ = false;
      dropUnusable();
      joinEdges();
      orient();
      numberVertices();
      dropSurplus();
      dropUnused();
      if (const DegenerateFaceCounts flat = removeDegenerateFaces(mesh_); flat.removed > 0) {
        report_.degenerateFaces += flat.removed;
        report_.degenerateFacesLeft = flat.left;
        changed_ = true;
      } else {
        report_.degenerateFacesLeft = flat.left;
      }
      if (!changed_) return;
      report_.changed = true;
    }
  }

 private:
  static constexpr int kMaxRounds = 16;

  const glm::dvec3& at(std::uint32_t corner) const { return mesh_.positions[vertex(corner)]; }
  std::uint32_t vertex(std::uint32_t corner) const { return mesh_.triangles[corner / 3][int(corner % 3)]; }
  std::uint32_t cornerCount() const { return std::uint32_t(3 * mesh_.triangles.size()); }

  void keepFaces(const std::vector<char>& keep) {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < keep.size(); ++f)
      if (keep[f]) mesh_.triangles[kept++] = mesh_.triangles[f];
    changed_ = changed_ || kept < mesh_.triangles.size();
    mesh_.triangles.resize(kept);
  }

  void dropUnusable() {
    std::vector<char> keep(mesh_.triangles.size(), 1);
    std::set<std::array<std::uint32_t, 3>> known;
    for (std::size_t f = 0; f < keep.size(); ++f) {
      const glm::uvec3 t = mesh_.triangles[f];
      std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
      std::sort(corners.begin(), corners.end());
      const auto& p = mesh_.positions;
      if (corners[2] >= p.size() || !finite(p[t.x]) || !finite(p[t.y]) || !finite(p[t.z]) || p[t.x] == p[t.y] ||
          p[t.y] == p[t.z] || p[t.z] == p[t.x]) {
        keep[f] = 0;
        ++report_.unusableFaces;
      } else if (!known.insert(corners).second) {
        keep[f] = 0;
        ++report_.duplicateFaces;
      }
    }
    keepFaces(keep);
  }

  // Calls `use` with the half-edges of each edge; `key` identifies an edge by its ends in either order.
  template <class Key, class Use>
  void forEachEdge(const std::vector<std::uint32_t>& halfEdges, const Key& key, const Use& use) {
    std::vector<std::pair<decltype(key(0u)), std::uint32_t>> sorted;
    sorted.reserve(halfEdges.size());
    for (const std::uint32_t h : halfEdges) sorted.emplace_back(key(h), h);
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> group;
    for (std::size_t i = 0; i < sorted.size();) {
      group.clear();
      const std::size_t first = i;
      for (; i < sorted.size() && sorted[i].first == sorted[first].first; ++i) group.push_back(sorted[i].second);
      use(group);
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    across_[a] = b;
    across_[b] = a;
  }

  void joinEdges() {
    across_.assign(cornerCount(), kNone);
    cut_ = 0;
    std::vector<std::uint32_t> all(cornerCount());
    for (std::uint32_t h = 0; h < all.size(); ++h) all[h] = h;
    const auto byVertex = [&](std::uint32_t h) {
      const std::uint32_t a = vertex(h), b = vertex(next(h));
      return std::pair(std::min(a, b), std::max(a, b));
    };
    joinBy(all, byVertex);
    std::vector<std::uint32_t> border;
    for (const std::uint32_t h : all)
      if (across_[h] == kNone) border.push_back(h);
    using CornerPosition = std::array<double, 3>;
    const auto byPlace = [&](std::uint32_t h) {
      const glm::dvec3 a = at(h), b = at(next(h));
      const CornerPosition from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      return std::pair(std::min(from, to), std::max(from, to));
    };
    const std::size_t cutByVertex = cut_;
    joinBy(border, byPlace);
    cut_ = cutByVertex;  // coincident borders may belong to separate surfaces
  }

  // Joins the two half-edges of an edge; of more than two, the pair that the rest of the surface joins.
  template <class Key>
  void joinBy(const std::vector<std::uint32_t>& halfEdges, const Key& key) {
    std::vector<std::vector<std::uint32_t>> crowded;
    forEachEdge(halfEdges, key, [&](const std::vector<std::uint32_t>& group) {
      if (group.size() == 2 && group[0] / 3 != group[1] / 3) {
        join(group[0], group[1]);
      } else if (group.size() > 2) {
        crowded.push_back(group);
      }
    });
    if (crowded.empty()) return;
    DisjointSets parts(mesh_.triangles.size());
    for (std::uint32_t h = 0; h < cornerCount(); ++h)
      if (across_[h] != kNone) parts.unite(h / 3, across_[h] / 3);
    for (const std::vector<std::uint32_t>& group : crowded) {
      std::map<std::uint32_t, std::vector<std::uint32_t>> ofPart;
      for (const std::uint32_t h : group) ofPart[parts.find(h / 3)].push_back(h);
      for (const auto& [part, members] : ofPart)
        if (members.size() == 2) {
          join(members[0], members[1]);
        }
      ++cut_;
    }
  }

  bool agree(std::uint32_t a, std::uint32_t b) const { return at(a) == at(next(b)); }

  void orient() {
    const std::size_t faces = mesh_.triangles.size();
    std::vector<char> seen(faces, 0), turn(faces, 0);
    std::vector<std::uint32_t> part;
    for (std::uint32_t seed = 0; seed < faces; ++seed) {
      if (seen[seed]) continue;
      part.assign(1, seed);
      seen[seed] = 1;
      bool closed = true, mixed = false;
      for (std::size_t i = 0; i < part.size(); ++i)
        for (std::uint32_t h = 3 * part[i]; h < 3 * part[i] + 3; ++h) {
          const std::uint32_t other = across_[h];
          if (other == kNone) {
            closed = false;
            continue;
          }
          const char wanted = turn[part[i]] != char(!agree(h, other));
          if (!seen[other / 3]) {
            seen[other / 3] = 1;
            turn[other / 3] = wanted;
            part.push_back(other / 3);
          } else if (turn[other / 3] != wanted) {
            across_[h] = across_[other] = kNone;  // a one-sided surface
            ++cut_;
            closed = false;
          }
          mixed = mixed || turn[other / 3];
        }
      if (mixed && wrongSide(part, turn, closed))
        for (const std::uint32_t f : part) turn[f] = !turn[f];
    }
    for (std::uint32_t f = 0; f < faces; ++f) {
      if (!turn[f]) continue;
      // The second and third corners are swapped, and with them the outer half-edges.
      std::swap(mesh_.triangles[f].y, mesh_.triangles[f].z);
      std::swap(across_[3 * f], across_[3 * f + 2]);
      for (const std::uint32_t h : {3 * f, 3 * f + 2})
        if (across_[h] != kNone) across_[across_[h]] = h;
      ++report_.flippedFaces;
      changed_ = true;
    }
    report_.cutEdges = std::max(report_.cutEdges, cut_);  // a later round may see the same edges again
  }

  bool wrongSide(const std::vector<std::uint32_t>& part, const std::vector<char>& turn, bool closed) const {
    double volume = 0;
    std::size_t turned = 0;
    const glm::dvec3 origin = at(3 * part[0]);
    for (const std::uint32_t f : part) {
      const double six = glm::dot(at(3 * f) - origin, glm::cross(at(3 * f + 1) - origin, at(3 * f + 2) - origin));
      volume += turn[f] ? -six : six;
      turned += turn[f];
    }
    return closed && volume != 0 ? volume < 0 : 2 * turned > part.size();
  }

  void numberVertices() {
    DisjointSets corners(cornerCount());
    for (std::uint32_t h = 0; h < cornerCount(); ++h)
      if (across_[h] != kNone && h < across_[h]) {
        corners.unite(h, next(across_[h]));
        corners.unite(next(h), across_[h]);
        if (vertex(h) != vertex(next(across_[h])) || vertex(next(h)) != vertex(across_[h])) ++report_.stitchedEdges;
      }
    // A vertex with a single fan keeps its index, so that a mesh without faults is unchanged.
    std::vector<std::uint32_t> owner(mesh_.positions.size(), kNone), name(cornerCount(), kNone);
    for (std::uint32_t c = 0; c < cornerCount(); ++c) {
      const std::uint32_t root = corners.find(c), v = vertex(root);
      if (name[root] == kNone) {
        if (owner[v] == kNone) {
          name[root] = v;
          owner[v] = root;
        } else {
          name[root] = std::uint32_t(mesh_.positions.size());
          mesh_.positions.push_back(glm::dvec3(mesh_.positions[v]));
        }
      }
      name[c] = name[root];
    }
    for (std::uint32_t c = 0; c < cornerCount(); ++c) {
      std::uint32_t& v = mesh_.triangles[c / 3][int(c % 3)];
      changed_ = changed_ || v != name[c];
      v = name[c];
    }
  }

  void dropSurplus() {
    std::set<std::pair<std::uint32_t, std::uint32_t>> used;
    std::vector<char> keep(mesh_.triangles.size(), 1);
    for (std::uint32_t f = 0; f < keep.size(); ++f) {
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
        if (used.contains({vertex(h), vertex(next(h))})) keep[f] = 0;
      if (keep[f])
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) used.insert({vertex(h), vertex(next(h))});
      else
        ++report_.surplusFaces;
    }
    keepFaces(keep);
  }

  void dropUnused() {
    std::vector<std::uint32_t> name(mesh_.positions.size(), kNone);
    for (const glm::uvec3& t : mesh_.triangles)
      for (int k = 0; k < 3; ++k) name[t[k]] = 0;
    std::uint32_t used = 0;
    for (std::size_t v = 0; v < name.size(); ++v)
      if (name[v] != kNone) {
        mesh_.positions[used] = mesh_.positions[v];
        name[v] = used++;
      }
    changed_ = changed_ || used < name.size();
    mesh_.positions.resize(used);
    for (glm::uvec3& t : mesh_.triangles) t = {name[t.x], name[t.y], name[t.z]};
  }

  TriangleMesh& mesh_;
  RepairReport& report_;
  std::vector<std::uint32_t> across_;  // the half-edge on the other side
  std::size_t cut_ = 0;
  bool changed_ = false;
};

}  // namespace

RepairedMesh repairMesh(const TriangleMesh& mesh) {
  RepairedMesh result{mesh, {}};
  result.report.verticesBefore = mesh.positions.size();
  Repair(result.mesh, result.report).run();
  result.report.verticesAfter = result.mesh.positions.size();
  return result;
}

}  // namespace ibr
