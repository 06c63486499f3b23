// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_reduce.h"

#include <cmath>
#include <glm/trigonometric.hpp>
#include <queue>
#include <tuple>

#include "author/surface/collapse_mesh.h"
#include "base/check.h"

namespace ibr {
namespace {

struct Candidate {
  double cost;
  std::uint32_t a, b;
  std::uint32_t versionA, versionB;  // of the vertices when the candidate was made; a changed vertex makes it void
  glm::dvec3 to;

  bool operator>(const Candidate& other) const { return std::tie(cost, a, b) > std::tie(other.cost, other.a, other.b); }
};

class Reduction {
 public:
  Reduction(const TriangleMesh& mesh, const HtmReduceOptions& options)
      : options_(options),
        mesh_(mesh),
        quadrics_(mesh.positions.size()),
        versions_(mesh.positions.size(), 0),
        minCosine_(std::cos(glm::radians(options.maxTurnDegrees))),
        firstCount_(mesh.triangles.size()) {
    for (std::uint32_t v = 0; v < quadrics_.size(); ++v) quadrics_[v] = mesh_.planesAt(v);
    for (std::uint32_t f = 0; f < firstCount_; ++f) area_ += mesh_.area(f);
  }

  // Runs rounds until one collapses nothing: a refused collapse may become possible when the faces
  // around have changed.
  void run() {
    for (std::size_t before = collapses + 1; !reached() && before != collapses;) {
      before = collapses;
      for (std::uint32_t v = 0; v < quadrics_.size(); ++v) offer(v, true);
      round();
    }
  }

  bool reached() const {
    const std::size_t count = mesh_.faceCount();
    return (options_.faceCount == 0 || count <= options_.faceCount) && area_ >= options_.meanFaceArea * double(count);
  }
  double meanFaceArea() const { return area_ / double(mesh_.faceCount()); }
  TriangleMesh result() const { return mesh_.compact(); }

  std::size_t collapses = 0;

 private:
  void offer(std::uint32_t vertex, bool onlyToLarger) {
    for (const std::uint32_t other : mesh_.neighbours(vertex))
      if (!onlyToLarger || other > vertex) offerEdge(std::min(vertex, other), std::max(vertex, other));
  }

  void offerEdge(std::uint32_t a, std::uint32_t b) {
    Quadric sum = quadrics_[a];
    sum += quadrics_[b];
    const glm::dvec3 to = mesh_.placement(a, b, sum);
    const double cost = std::max(0.0, sum.at(to));
    if (std::isfinite(cost)) queue_.push({cost, a, b, versions_[a], versions_[b], to});
  }

  void round() {
    for (; !queue_.empty() && !reached(); queue_.pop()) {
      const Candidate c = queue_.top();
      if (c.versionA != versions_[c.a] || c.versionB != versions_[c.b] || !mesh_.keepsTopology(c.a, c.b) ||
          !mesh_.keepsNormals(c.a, c.b, c.to, minCosine_))
        continue;
      area_ -= areaAround(c.a, c.b);
      mesh_.collapse(c.a, c.b, c.to);
      area_ += areaAround(c.a, c.a);
      quadrics_[c.a] += quadrics_[c.b];
      ++versions_[c.a];
      ++versions_[c.b];
      ++collapses;
      offer(c.a, false);
      report();
    }
    queue_ = {};
  }

  double areaAround(std::uint32_t a, std::uint32_t b) const {
    double sum = 0;
    for (const std::uint32_t f : mesh_.facesAt(a)) sum += mesh_.area(f);
    if (a == b) return sum;
    for (const std::uint32_t f : mesh_.facesAt(b)) {
      const glm::uvec3& t = mesh_.mesh().triangles[f];
      if (t.x != a && t.y != a && t.z != a) sum += mesh_.area(f);
    }
    return sum;
  }

  void report() const {
    constexpr std::size_t kEvery = 256;
    if (!options_.progress || collapses % kEvery != 0) return;
    const double byArea = options_.meanFaceArea > 0 ? area_ / options_.meanFaceArea : double(firstCount_);
    const double byCount = options_.faceCount > 0 ? double(options_.faceCount) : double(firstCount_);
    const auto target = std::size_t(std::min({byArea, byCount, double(mesh_.faceCount())}));
    if (!options_.progress({"reducing the mesh", firstCount_ - mesh_.faceCount(), firstCount_ - target}))
      fail(ErrorCode::cancelled, "cancelled while reducing the mesh");
  }

  const HtmReduceOptions& options_;
  CollapseMesh mesh_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> versions_;
  double minCosine_;
  std::size_t firstCount_;
  double area_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

ReducedMesh reduceMesh(const TriangleMesh& mesh, const HtmReduceOptions& options) {
  check(options.meanFaceArea >= 0 && std::isfinite(options.meanFaceArea), ErrorCode::invalidInput,
        "reduceMesh: meanFaceArea is {}, must be finite and 0 or more", options.meanFaceArea);
  check(options.maxTurnDegrees > 0 && options.maxTurnDegrees < 90, ErrorCode::invalidInput,
        "reduceMesh: maxTurnDegrees {} is not between 0 and 90", options.maxTurnDegrees);
  RepairedMesh repaired = repairMesh(mesh);
  check(!repaired.mesh.triangles.empty(), ErrorCode::invalidInput, "reduceMesh: the mesh has no usable face");
  const std::vector<glm::dvec3> positions = repaired.mesh.positions;
  // Centre the mesh: squares of coordinates far from the origin lose digits.
  const glm::dvec3 origin = repaired.mesh.positions[0];
  for (glm::dvec3& p : repaired.mesh.positions) p -= origin;
  Reduction reduction(repaired.mesh, options);
  reduction.run();
  ReducedMesh result{reduction.result(), {}};
  for (glm::dvec3& p : result.mesh.positions) p += origin;
  if (reduction.collapses == 0) result.mesh.positions = positions;  // an unchanged mesh keeps its exact positions
  result.report.repair = repaired.report;
  result.report.facesBefore = repaired.mesh.triangles.size();
  result.report.facesAfter = result.mesh.triangles.size();
  result.report.collapses = reduction.collapses;
  result.report.meanFaceArea = reduction.meanFaceArea();
  result.report.reached = reduction.reached();
  if (options.distanceSamples > 0 && reduction.meanFaceArea() > 0) {
    repaired.mesh.positions = positions;
    result.report.toReduced = surfaceDistance(repaired.mesh, result.mesh, options.distanceSamples);
    result.report.toOriginal = surfaceDistance(result.mesh, repaired.mesh, options.distanceSamples);
  }
  return result;
}

}  // namespace ibr
