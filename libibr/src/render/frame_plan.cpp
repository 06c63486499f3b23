// SPDX-License-Identifier: Apache-2.0
// Which cells are drawn, in which order, with which weights ([T] §2.5.1 "clamping", §2.5.2). Pure.
//
// Departures: the former main cell is favoured a little, so that a camera on the border of two cells does not flicker;
// cells with equal keys are told apart by their members' positions, so that the order of cells in a file means nothing.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <tuple>

#include "base/check.h"
#include "ibr/renderer.h"
#include "render/cell_order.h"

namespace ibr {
namespace {

struct Candidate {
  std::uint32_t cell;
  CellDistance distance;
  double extrapolationKey, rotationKey;
};

void checkView(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "view: only a pinhole can be rendered");
  check(k.width > 0 && k.height > 0, ErrorCode::invalidInput, "view: size {}x{} is empty", k.width, k.height);
  check(k.fx > 0 && k.fy > 0 && std::isfinite(k.fx) && std::isfinite(k.fy), ErrorCode::invalidInput,
        "view: focal lengths {} and {} are not positive", k.fx, k.fy);
  check(std::isfinite(k.cx) && std::isfinite(k.cy), ErrorCode::invalidInput, "view: principal point is not finite");
  const glm::dvec3 p = view.pose.position;
  check(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), ErrorCode::invalidInput,
        "view: position ({}, {}, {}) is not finite", p.x, p.y, p.z);
  const double length = glm::length(view.pose.rotation);
  check(std::abs(length - 1.0) <= 1e-3, ErrorCode::invalidInput, "view: rotation has length {}, not 1", length);
}

// Inward normals of the four side planes of the view's frustum, world axes; all pass through the view's centre.
std::array<glm::dvec3, 4> frustum(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  const double left = -k.cx / k.fx, right = (k.width - k.cx) / k.fx;
  const double bottom = (k.cy - k.height) / k.fy, top = k.cy / k.fy;
  const glm::dmat3 toWorld = glm::mat3_cast(view.pose.rotation);
  return {toWorld * glm::dvec3(1, 0, left), toWorld * glm::dvec3(-1, 0, -right), toWorld * glm::dvec3(0, 1, bottom),
          toWorld * glm::dvec3(0, -1, -top)};
}

// Greatest n·x over a box, n and x in the same axes.
double support(glm::dvec3 n, glm::vec3 low, glm::vec3 high) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += std::max(n[a] * low[a], n[a] * high[a]);
  return sum;
}

// False only if every vertex lies outside of one plane: n·D = Σ λ_i n·q_i + ρ n·t, each term bounded by itself.
bool mayBeVisible(const Scene& scene, const Cell& cell, const CellBounds& bounds,
                  const std::array<glm::dvec3, 4>& planes, const Weights& weights, Morph morph, glm::dvec3 eye) {
  const bool ours = morph == Morph::ours;
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < cell.members.size(); ++i)
    shift += weights[i] * (scene.nodes[cell.members[i]].camera.pose.position - eye);
  for (const glm::dvec3& plane : planes) {
    double most = ours ? std::max(0.0, bounds.largestInverseDistance * glm::dot(plane, shift)) : 0.0;
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const CellBounds::Member& box = bounds.members[i];
      const glm::dvec3 n = weights[i] * (glm::conjugate(scene.nodes[cell.members[i]].camera.pose.rotation) * plane);
      most += ours ? support(n, box.low, box.high) : support(n, box.unitLow, box.unitHigh);
    }
    if (most < 0.0) return false;
  }
  return true;
}

// Positions of a cell's members, sorted: what tells two cells apart wherever they stand in the file.
std::vector<std::array<double, 7>> identity(const Scene& scene, const Cell& cell) {
  std::vector<std::array<double, 7>> poses;
  for (std::uint32_t member : cell.members) {
    const Pose& pose = scene.nodes[member].camera.pose;
    poses.push_back({pose.position.x, pose.position.y, pose.position.z, pose.rotation.w, pose.rotation.x,
                     pose.rotation.y, pose.rotation.z});
  }
  std::sort(poses.begin(), poses.end());
  return poses;
}

}  // namespace

FramePlan planFrame(const Scene& scene, std::span<const CellBounds> bounds, const FrameInput& input,
                    const PlanState& state) {
  checkView(input.view);
  const RenderSettings& settings = input.settings;
  FramePlan plan;
  plan.view = input.view;
  plan.view.pose.rotation = glm::normalize(plan.view.pose.rotation);
  plan.settings = settings;

  const std::array<glm::dvec3, 4> planes = frustum(plan.view);
  std::vector<Candidate> candidates;
  for (std::uint32_t c = 0; c < scene.cells.size(); ++c) {
    const Cell& cell = scene.cells[c];
    Candidate candidate{c, cellDistance(scene, cell, bounds[c].size, plan.view.pose), 0, 0};
    const CellDistance& distance = candidate.distance;
    if (distance.extrapolation > settings.extrapolationLimit * bounds[c].size) {
      ++plan.culledByDistance;
      continue;
    }
    const Weights& position = settings.morph == Morph::ours ? distance.weights.clamped : distance.weights.free;
    if (!mayBeVisible(scene, cell, bounds[c], planes, position, settings.morph, plan.view.pose.position)) {
      ++plan.culledByFrustum;
      continue;
    }
    constexpr double kKeepDistance = 0.02;  // of the cell's size
    constexpr double kKeepAngle = 0.02;     // radians, about a degree
    const bool keep = std::int64_t(c) == state.mainCell;
    candidate.extrapolationKey =
        keep ? std::max(0.0, distance.extrapolation - kKeepDistance * bounds[c].size) : distance.extrapolation;
    candidate.rotationKey = distance.rotation - (keep ? kKeepAngle : 0.0);
    candidates.push_back(candidate);
  }

  const auto better = [&](const Candidate& a, const Candidate& b) {
    if (a.extrapolationKey != b.extrapolationKey) return a.extrapolationKey < b.extrapolationKey;
    if (a.rotationKey != b.rotationKey) return a.rotationKey < b.rotationKey;
    return identity(scene, scene.cells[a.cell]) < identity(scene, scene.cells[b.cell]);
  };
  const std::size_t kept = std::min<std::size_t>({candidates.size(), settings.maxCells, kLargestCellCount});
  std::partial_sort(candidates.begin(), candidates.begin() + std::ptrdiff_t(kept), candidates.end(), better);
  plan.culledByCount = std::uint32_t(candidates.size() - kept);

  for (std::uint32_t rank = 0; rank < kept; ++rank) {
    const Candidate& candidate = candidates[rank];
    PlannedCell& planned = plan.cells.emplace_back();
    planned.cell = candidate.cell;
    planned.rank = rank;
    planned.extrapolationDistance = candidate.distance.extrapolation;
    planned.rotationalDistance = candidate.distance.rotation;
    planned.position =
        settings.morph == Morph::ours ? candidate.distance.weights.clamped : candidate.distance.weights.free;
    planned.blend = smoothstep(candidate.distance.weights.clamped);
    planned.best = std::uint32_t(std::max_element(planned.blend.begin(), planned.blend.end()) - planned.blend.begin());
  }
  if (!plan.cells.empty()) {
    plan.next.mainCell = plan.cells[0].cell;
    // Nothing nearer than this keeps its true depth (it is drawn all the same); scale-free, since COLMAP worlds are.
    plan.nearDistance = 0.05 * bounds[plan.cells[0].cell].size;
  }
  return plan;
}

}  // namespace ibr
