// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <set>
#include <tuple>

#include "author/surface/collapse_mesh.h"
#include "author/surface/repair_mesh.h"
#include "base/check.h"

namespace ibr {
namespace {

class Collapsing {
 public:
  Collapsing(TriangleMesh mesh, const FaceDifferences& differences, const HtmCollapseOptions& options)
      : differences_(differences),
        options_(options),
        mesh_(std::move(mesh)),
        known_(mesh_.mesh().triangles.size()),
        minCosine_(std::cos(glm::radians(options.maxTurnDegrees))) {
    report_.facesBefore = mesh_.faceCount();
    for (std::uint32_t f = 0; f < known_.size(); ++f) changed_.insert(f);
  }

  CollapsedMesh run() {
    evaluate();
    std::tie(report_.meanBefore, report_.maxBefore) = meanAndMax();
    while (round()) evaluate();
    std::tie(report_.meanAfter, report_.maxAfter) = meanAndMax();
    CollapsedMesh result{mesh_.compact(), {}, {}};
    for (std::uint32_t f = 0; f < known_.size(); ++f)
      if (mesh_.isAlive(f)) {
        result.differences.push_back(known_[f]);
        report_.unknown += !std::isfinite(known_[f]);
        report_.refused += eligible(f);
      }
    report_.facesAfter = mesh_.faceCount();
    result.report = report_;
    return result;
  }

 private:
  // Sorts by largest difference, then by smallest index.
  using Entry = std::pair<double, std::uint32_t>;

  bool eligible(std::uint32_t f) const {
    return std::isfinite(known_[f]) && known_[f] > options_.floor && mesh_.area(f) < options_.faceArea;
  }

  void evaluate() {
    std::vector<std::uint32_t> faces;
    for (const std::uint32_t f : changed_)
      if (mesh_.isAlive(f)) faces.push_back(f);
    changed_.clear();
    if (faces.empty()) return;
    const std::vector<double> values = differences_(mesh_.mesh(), faces);
    check(values.size() == faces.size(), ErrorCode::invalidInput, "collapseDifferences: {} differences for {} faces",
          values.size(), faces.size());
    report_.evaluated += faces.size();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      known_[faces[i]] = values[i];
      enqueue(faces[i]);
    }
    for (const std::uint32_t f : deferred_)
      if (mesh_.isAlive(f)) enqueue(f);
    deferred_.clear();
  }

  // Collapses up to a batch of faces; returns false when there is nothing more to do.
  bool round() {
    std::size_t done = 0;
    while (!queue_.empty() && done < options_.batch) {
      if (report_.collapses >= options_.maxCollapses) {
        report_.end = HtmCollapseEnd::cap;
        return false;
      }
      const std::uint32_t face = queue_.begin()->second;
      queue_.erase(queue_.begin());
      if (!collapse(face)) continue;  // until a face beside this one changes
      ++done;
      ++report_.collapses;
      if (options_.progress && !options_.progress({"collapsing inconsistent faces", report_.collapses, 0}))
        fail(ErrorCode::cancelled, "cancelled while collapsing inconsistent faces");
    }
    return done > 0;
  }

  // Returns the edges of a face, shortest first.
  std::array<std::pair<std::uint32_t, std::uint32_t>, 3> edgesOf(std::uint32_t face) const {
    const glm::uvec3& t = mesh_.mesh().triangles[face];
    std::array<std::pair<std::uint32_t, std::uint32_t>, 3> edges;
    for (int k = 0; k < 3; ++k) edges[std::size_t(k)] = std::minmax(std::uint32_t(t[k]), std::uint32_t(t[(k + 1) % 3]));
    const auto length = [&](const auto& edge) {
      return glm::distance(mesh_.mesh().positions[edge.first], mesh_.mesh().positions[edge.second]);
    };
    std::sort(edges.begin(), edges.end(),
              [&](const auto& a, const auto& b) { return std::pair(length(a), a) < std::pair(length(b), b); });
    return edges;
  }

  bool collapse(std::uint32_t face) {
    for (const auto& [a, b] : edgesOf(face)) {
      if (!mesh_.keepsTopology(a, b)) continue;
      if (touchesChanged(a) || touchesChanged(b)) {
        deferred_.push_back(face);
        return false;
      }
      Quadric planes = mesh_.planesAt(a);
      planes += mesh_.planesAt(b);
      const glm::dvec3 to = mesh_.placement(a, b, planes);
      if (!mesh_.keepsNormals(a, b, to, minCosine_)) continue;
      mesh_.collapse(a, b, to);
      // Faces around the changed ones may be tried again, except those whose difference is not computed yet.
      for (const std::uint32_t f : mesh_.facesAt(a)) changed_.insert(f);
      for (const std::uint32_t other : mesh_.neighbours(a))
        for (const std::uint32_t f : mesh_.facesAt(other)) enqueue(f);
      for (const std::uint32_t f : changed_)
        if (std::isfinite(known_[f])) queue_.erase({-known_[f], f});
      return true;
    }
    return false;
  }

  bool touchesChanged(std::uint32_t vertex) const {
    const auto faces = mesh_.facesAt(vertex);
    return std::any_of(faces.begin(), faces.end(), [&](std::uint32_t f) { return changed_.contains(f); });
  }

  void enqueue(std::uint32_t f) {
    if (eligible(f) && !changed_.contains(f)) queue_.emplace(-known_[f], f);
  }

  std::pair<double, double> meanAndMax() const {
    double sum = 0, largest = 0;
    std::size_t count = 0;
    for (std::uint32_t f = 0; f < known_.size(); ++f)
      if (mesh_.isAlive(f) && std::isfinite(known_[f])) {
        sum += known_[f];
        largest = count++ == 0 ? known_[f] : std::max(largest, known_[f]);
      }
    return {count > 0 ? sum / double(count) : 0.0, largest};
  }

  const FaceDifferences& differences_;
  const HtmCollapseOptions& options_;
  CollapseMesh mesh_;
  std::vector<double> known_;
  std::set<std::uint32_t> changed_;  // faces whose differences must be computed again
  std::set<Entry> queue_;
  std::vector<std::uint32_t> deferred_;  // faces that touch those changed in this batch
  double minCosine_;
  HtmCollapseReport report_;
};

}  // namespace

CollapsedMesh collapseDifferences(const TriangleMesh& mesh, const FaceDifferences& differences,
                                  const HtmCollapseOptions& options) {
  check(options.faceArea >= 0, ErrorCode::invalidInput, "collapseDifferences: faceArea is {}, must be 0 or more",
        options.faceArea);
  check(!std::isnan(options.floor), ErrorCode::invalidInput, "collapseDifferences: floor is not a number");
  check(options.batch >= 1, ErrorCode::invalidInput, "collapseDifferences: batch is 0, must be 1 or more");
  check(options.maxTurnDegrees > 0 && options.maxTurnDegrees < 90, ErrorCode::invalidInput,
        "collapseDifferences: maxTurnDegrees {} is not between 0 and 90", options.maxTurnDegrees);
  RepairedMesh repaired = repairMesh(mesh);
  return Collapsing(std::move(repaired.mesh), differences, options).run();
}

}  // namespace ibr
