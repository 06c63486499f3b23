// SPDX-License-Identifier: Apache-2.0
#include "ibr/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <set>

#include "base/check.h"
#include "base/stop.h"
#include "scene/mesh_buffer.h"
#include "scene/scene_faults.h"
#include "scene/scene_file.h"

namespace ibr {

CellQuality::CellQuality()
    : coverage(std::numeric_limits<double>::quiet_NaN()), ecc(coverage), residualPx(coverage), score(coverage) {}

std::size_t MorphMesh::tier0Count() const {
  return std::size_t(std::count(tier.begin(), tier.end(), std::uint8_t(kTierConsistent)));
}

bool isMasked(const Scene& scene, const Cell& cell) {
  return std::ranges::any_of(cell.members, [&](std::uint32_t member) { return !scene.nodes[member].maskFile.empty(); });
}

std::optional<glm::dvec3> vertexPosition(const Scene& scene, const Cell& cell, std::size_t point) {
  const double inverseDistance = cell.mesh.inverseDistance[point];
  if (!(inverseDistance > 0.0)) return std::nullopt;
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Camera& camera = scene.nodes[cell.members[i]].camera;
    const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][point]);
    sum += camera.pose.position + ray * (cell.mesh.ratio[i][point] / inverseDistance);
  }
  const glm::dvec3 mean = sum / double(cell.members.size());
  return finite(mean) ? std::optional(mean) : std::nullopt;
}

namespace {

void checkMesh(const MorphMesh& mesh, std::size_t members, const std::string& at, Faults& faults) {
  const std::size_t points = mesh.vertexCount(), triangles = mesh.triangles.size();
  auto sized = [&](std::size_t size, std::size_t wanted, const std::string& field) {
    if (size != wanted) faults.add(at + field, "has {} values, not {}", size, wanted);
    return size == wanted;
  };
  if (!sized(mesh.match.size(), members, ".match") || !sized(mesh.ratio.size(), members, ".ratio")) return;
  for (std::size_t i = 0; i < members; ++i) {
    if (sized(mesh.match[i].size(), points, fmt::format(".match[{}]", i)))
      for (std::size_t p = 0; p < points; ++p)
        if (!std::isfinite(mesh.match[i][p].x) || !std::isfinite(mesh.match[i][p].y))
          faults.add(fmt::format("{}.match[{}][{}]", at, i, p), "is not finite");
    if (sized(mesh.ratio[i].size(), points, fmt::format(".ratio[{}]", i)))
      for (std::size_t p = 0; p < points; ++p)
        if (!(mesh.ratio[i][p] > 0.0f) || !std::isfinite(mesh.ratio[i][p]))
          faults.add(fmt::format("{}.ratio[{}][{}]", at, i, p), "{} is not positive", mesh.ratio[i][p]);
  }
  auto nonNegative = [&](const std::vector<float>& values, const std::string& field) {
    if (!sized(values.size(), points, field)) return;
    for (std::size_t p = 0; p < points; ++p)
      if (!(values[p] >= 0.0f) || !std::isfinite(values[p]))
        faults.add(fmt::format("{}{}[{}]", at, field, p), "{} is negative or not finite", values[p]);
  };
  nonNegative(mesh.inverseDistance, ".inverseDistance");
  nonNegative(mesh.uncertainty, ".uncertainty");
  if (!mesh.planes.empty() && sized(mesh.planes.size(), points, ".planes"))
    for (std::size_t p = 0; p < points; ++p)
      if (const glm::u16vec4 set = mesh.planes[p]; !isPlaneSet(set))
        faults.add(fmt::format("{}.planes[{}]", at, p), "({}, {}, {}, {}) is not an ascending list padded with zeros",
                   set.x, set.y, set.z, set.w);
  if (!mesh.confirmations.empty() || !mesh.consensus.empty()) {
    sized(mesh.confirmations.size(), points, ".confirmations");
    if (sized(mesh.consensus.size(), points, ".consensus"))
      for (std::size_t p = 0; p < points; ++p)
        if (!(mesh.consensus[p] >= 0.0f && mesh.consensus[p] <= 1.0f))
          faults.add(fmt::format("{}.consensus[{}]", at, p), "{} is not within 0 to 1", mesh.consensus[p]);
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const glm::uvec3 v = mesh.triangles[t];
    if (v.x >= points || v.y >= points || v.z >= points)
      faults.add(fmt::format("{}.triangles[{}]", at, t), "({}, {}, {}) has an index beyond the {} points", v.x, v.y,
                 v.z, points);
  }
  if (sized(mesh.tier.size(), triangles, ".tier"))
    for (std::size_t t = 0; t < triangles; ++t) {
      if (mesh.tier[t] > kTierRejected)
        faults.add(fmt::format("{}.tier[{}]", at, t), "{} is not 0 or 1", mesh.tier[t]);
      else if (t > 0 && mesh.tier[t] < mesh.tier[t - 1])
        faults.add(fmt::format("{}.tier[{}]", at, t), "tier 0 follows tier 1");
    }
  if (sized(mesh.ecc.size(), triangles, ".ecc"))
    for (std::size_t t = 0; t < triangles; ++t)
      if (!(std::abs(mesh.ecc[t]) <= 1.0f))
        faults.add(fmt::format("{}.ecc[{}]", at, t), "{} is not within -1 to 1", mesh.ecc[t]);
}

void checkQuality(const CellQuality& quality, const std::string& at, Faults& faults) {
  const auto within = [&](double value, double low, double high, const char* field) {
    if (value < low || value > high) faults.add(at + field, "{} is not within {} to {}", value, low, high);
  };
  within(quality.coverage, 0, 1, ".coverage");
  within(quality.ecc, -1, 1, ".ecc");
  within(quality.residualPx, 0, std::numeric_limits<double>::infinity(), ".residualPx");
  within(quality.score, 0, 1, ".score");
}

void checkCell(const Cell& cell, std::size_t nodes, std::size_t least, std::size_t most, const std::string& at,
               Faults& faults) {
  const std::size_t d = cell.members.size();
  if (d < least || d > most) faults.add(at + ".members", "has {} members, not {} to {}", d, least, most);
  for (std::size_t i = 0; i < d; ++i) {
    if (cell.members[i] >= nodes)
      faults.add(fmt::format("{}.members[{}]", at, i), "{} is beyond the {} nodes", cell.members[i], nodes);
    for (std::size_t j = 0; j < i; ++j)
      if (cell.members[i] == cell.members[j])
        faults.add(fmt::format("{}.members[{}]", at, i), "node {} is a member twice", cell.members[i]);
  }
  checkMesh(cell.mesh, d, at + ".mesh", faults);
  checkQuality(cell.quality, at + ".quality", faults);
}

void checkExposure(const Node& node, const std::string& at, Faults& faults) {
  for (int c = 0; c < 3; ++c)
    if (!(node.gain[c] >= 1 / kMaxGain && node.gain[c] <= kMaxGain))
      faults.add(fmt::format("{}.gain[{}]", at, c), "{} is not within 1/{} to {}", node.gain[c], kMaxGain, kMaxGain);
  const CaptureMetadata& capture = node.capture;
  for (const auto& [name, value] : kCaptureNumbers)
    if (!(capture.*value >= 0) || !std::isfinite(capture.*value))
      faults.add(fmt::format("{}.capture.{}", at, name), "{} is negative or not finite", capture.*value);
}

void checkDepth(const Node& node, const std::string& at, Faults& faults) {
  if (node.depthFile.empty() && node.depthScale != 0)
    faults.add(at + ".depthScale", "{} is not 0, but there is no depthFile", node.depthScale);
  if (!node.depthFile.empty() && !(node.depthScale > 0 && std::isfinite(node.depthScale)))
    faults.add(at + ".depthScale", "{} is not positive and finite", node.depthScale);
}

}  // namespace

std::vector<Fault> validate(const Scene& scene, std::size_t limit) {
  return faultsOf(scene, limit, {});
}

std::vector<Fault> faultsOf(const Scene& scene, std::size_t limit, const std::stop_token& stop) {
  constexpr const char* kStage = "checking the scene";
  Faults faults(limit);
  std::set<std::string> names;
  for (std::size_t n = 0; n < scene.nodes.size() && !faults.full(); ++n) {
    checkStop(stop, kStage);
    const std::string at = fmt::format("nodes[{}]", n);
    if (scene.nodes[n].name.empty()) faults.add(at + ".name", "is empty");
    checkCamera(scene.nodes[n].camera, at + ".camera", faults);
    checkExposure(scene.nodes[n], at, faults);
    checkDepth(scene.nodes[n], at, faults);
    if (!names.insert(scene.nodes[n].name).second)
      faults.add(at + ".name", "\"{}\" is not unique", scene.nodes[n].name);
  }
  for (std::size_t c = 0; c < scene.cells.size() && !faults.full(); ++c) {
    checkStop(stop, kStage);
    checkCell(scene.cells[c], scene.nodes.size(), 2, 4, fmt::format("cells[{}]", c), faults);
  }
  std::set<std::uint32_t> covered;
  for (std::size_t b = 0; b < scene.backdrops.size() && !faults.full(); ++b) {
    checkStop(stop, kStage);
    const std::string at = fmt::format("backdrops[{}]", b);
    checkCell(scene.backdrops[b], scene.nodes.size(), 1, 1, at, faults);
    if (scene.backdrops[b].members.size() == 1 && !covered.insert(scene.backdrops[b].members[0]).second)
      faults.add(at + ".members[0]", "node {} has two backdrops", scene.backdrops[b].members[0]);
  }
  return faults.take();
}

}  // namespace ibr
