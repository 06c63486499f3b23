// SPDX-License-Identifier: Apache-2.0
// Which cells are drawn, in which order, with which weights ([T] §2.5.1 "clamping", §2.5.2). Pure.
//
// Departures: the former main cell is favoured a little, so that a camera on the border of two cells does not flicker;
// cells with equal keys are told apart by their members' positions, so that the order of cells in a file means nothing;
// for two views one order is made from the pose in their middle ([T] §2.5.4); a switch of the main cell is mixed.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"
#include "ibr/renderer.h"
#include "render/cell_order.h"
#include "render/colour_plan.h"
#include "render/culling.h"

namespace ibr {
namespace {

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

// The pose in the middle: of two views the mean position and the rotation half-way.
Pose middleOf(const std::vector<Camera>& views) {
  const Pose &first = views.front().pose, &last = views.back().pose;
  if (views.size() == 1) return first;
  return {0.5 * (first.position + last.position), glm::slerp(first.rotation, last.rotation, 0.5)};
}

// What planning carries from step to step.
class Planner {
 public:
  Planner(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state)
      : scene_(scene), bounds_(bounds), settings_(input.settings), state_(state) {
    check(input.views.size() == 1 || input.views.size() == 2, ErrorCode::invalidInput, "{} views, not one or two",
          input.views.size());
    for (const Camera& view : input.views) checkView(view);
    plan_.views = input.views;
    for (Camera& view : plan_.views) {
      view.pose.rotation = glm::normalize(view.pose.rotation);
      planes_.push_back(frustum(view));
    }
    plan_.settings = settings_;
    middle_ = middleOf(plan_.views);
    dt_ = input.dtSeconds > 0 ? std::min(input.dtSeconds, 0.1) : 0.0;  // NaN: 0
    seconds_ = state.secondsSinceSwitch + dt_;
  }

  FramePlan run() {
    mixing_ = !state_.former.empty() && seconds_ < settings_.switchSeconds;
    chooseCells();
    chooseBackdrops();
    mixSwitch();
    planColours(scene_, dt_, state_, plan_);
    return std::move(plan_);
  }

 private:
  bool visible(const Cell& cell, const CellBounds& bounds, const PlannedCell& planned) const {
    for (std::size_t v = 0; v < plan_.views.size(); ++v)
      if (mayBeVisible(scene_, cell, bounds, planes_[v], planned.view[v].position, settings_.morph,
                       plan_.views[v].pose.position))
        return true;
    return false;
  }

  // Weights of a cell for every view, wherever it stands in the order.
  PlannedCell planned(std::uint32_t index, const CellDistance& fromMiddle) const {
    const Cell& cell = scene_.cells[index];
    PlannedCell planned;
    planned.cell = index;
    planned.extrapolationDistance = fromMiddle.extrapolation;
    planned.rotationalDistance = fromMiddle.rotation;
    const double limit = settings_.extrapolationLimit * bounds_.cells[index].size;
    const double fade = settings_.fadeShare * limit;
    if (fade > 0) planned.opacity = std::clamp((limit - fromMiddle.extrapolation) / fade, 0.0, 1.0);
    for (std::size_t v = 0; v < plan_.views.size(); ++v) {
      const Barycentric weights =
          plan_.views.size() == 1 ? fromMiddle.weights
                                  : cellDistance(scene_, cell, bounds_.cells[index].size, plan_.views[v].pose).weights;
      planned.view[v].position = settings_.morph == Morph::ours ? weights.clamped : weights.free;
      planned.view[v].blend = smoothstep(weights.clamped);
    }
    const Weights& clamped = fromMiddle.weights.clamped;
    planned.best = std::uint32_t(std::max_element(clamped.begin(), clamped.end()) - clamped.begin());
    return planned;
  }

  void chooseCells() {
    struct Candidate {
      PlannedCell planned;
      bool kept;  // the main cell of the frame before, while its switch is mixed
      double extrapolation, rotation;
    };
    std::vector<Candidate> candidates;
    for (std::uint32_t c = 0; c < scene_.cells.size(); ++c) {
      const double size = bounds_.cells[c].size;
      const CellDistance distance = cellDistance(scene_, scene_.cells[c], size, middle_);
      if (distance.extrapolation > settings_.extrapolationLimit * size) {
        ++plan_.culledByDistance;
        continue;
      }
      PlannedCell cell = planned(c, distance);
      if (!visible(scene_.cells[c], bounds_.cells[c], cell)) {
        ++plan_.culledByFrustum;
        continue;
      }
      constexpr double kKeepDistance = 0.02;  // of the cell's size
      constexpr double kKeepAngle = 0.02;     // radians, about a degree
      const bool main = std::int64_t(c) == state_.mainCell;
      candidates.push_back(
          {cell, main && mixing_,
           main ? std::max(0.0, distance.extrapolation - kKeepDistance * size) : distance.extrapolation,
           distance.rotation - (main ? kKeepAngle : 0.0)});
    }
    const auto better = [&](const Candidate& a, const Candidate& b) {
      if (a.kept != b.kept) return a.kept;
      if (a.extrapolation != b.extrapolation) return a.extrapolation < b.extrapolation;
      if (a.rotation != b.rotation) return a.rotation < b.rotation;
      return identity(scene_, scene_.cells[a.planned.cell]) < identity(scene_, scene_.cells[b.planned.cell]);
    };
    const std::size_t kept = std::min<std::size_t>({candidates.size(), settings_.maxCells, kLargestCellCount});
    std::partial_sort(candidates.begin(), candidates.begin() + std::ptrdiff_t(kept), candidates.end(), better);
    plan_.culledByCount = std::uint32_t(candidates.size() - kept);
    for (std::size_t i = 0; i < kept; ++i) plan_.cells.push_back(candidates[i].planned);
    // Nothing nearer than this keeps its true depth (it is drawn all the same); scale-free, since COLMAP worlds are.
    if (!plan_.cells.empty()) plan_.nearDistance = 0.05 * bounds_.cells[plan_.cells[0].cell].size;
  }

  // Photographs taken nearest come first; of those taken in one place, the one that looks most the same way.
  void chooseBackdrops() {
    if (settings_.lowestTier < kTierBackdrop) return;
    struct Candidate {
      std::uint32_t backdrop;
      double distance, angle;
    };
    std::vector<Candidate> candidates;
    for (std::uint32_t b = 0; b < scene_.backdrops.size(); ++b) {
      const Cell& backdrop = scene_.backdrops[b];
      const Pose& pose = scene_.nodes[backdrop.members[0]].camera.pose;
      PlannedCell single;
      for (PlannedCell::View& view : single.view) view.position = {1, 0, 0, 0};
      if (!visible(backdrop, bounds_.backdrops[b], single)) continue;
      const glm::dvec3 axis = viewAxis(pose), forward = viewAxis(middle_);
      candidates.push_back({b, glm::distance(pose.position, middle_.position),
                            std::atan2(glm::length(glm::cross(axis, forward)), glm::dot(axis, forward))});
    }
    const std::size_t kept = std::min<std::size_t>({candidates.size(), settings_.maxBackdrops, kLargestBackdropCount});
    std::partial_sort(candidates.begin(), candidates.begin() + std::ptrdiff_t(kept), candidates.end(),
                      [&](const Candidate& a, const Candidate& b) {
                        if (a.distance != b.distance) return a.distance < b.distance;
                        if (a.angle != b.angle) return a.angle < b.angle;
                        return identity(scene_, scene_.backdrops[a.backdrop]) <
                               identity(scene_, scene_.backdrops[b.backdrop]);
                      });
    for (std::size_t i = 0; i < kept; ++i) plan_.backdrops.push_back(candidates[i].backdrop);
    if (plan_.cells.empty() && !plan_.backdrops.empty() && candidates[0].distance > 0)
      plan_.nearDistance = 0.05 * candidates[0].distance;
  }

  void mixSwitch() {
    PlanState& next = plan_.next;
    if (!plan_.cells.empty()) next.mainCell = plan_.cells[0].cell;
    for (const PlannedCell& cell : plan_.cells) next.order.push_back(cell.cell);
    if (state_.mainCell >= 0 && next.mainCell != state_.mainCell && settings_.switchSeconds > 0) {
      next.former = state_.order;  // the frame in which the switch happens still shows the former picture
      next.secondsSinceSwitch = 0;
    } else if (mixing_) {
      next.former = state_.former;
      next.secondsSinceSwitch = seconds_;
    }
    if (next.former.empty()) return;
    for (const std::uint32_t c : next.former) {
      if (c >= scene_.cells.size()) continue;  // another scene's state
      PlannedCell cell = planned(c, cellDistance(scene_, scene_.cells[c], bounds_.cells[c].size, middle_));
      if (visible(scene_.cells[c], bounds_.cells[c], cell)) plan_.former.push_back(cell);
    }
    const double share = next.secondsSinceSwitch / settings_.switchSeconds;
    plan_.formerWeight = 1.0 - share * share * (3.0 - 2.0 * share);
  }

  const Scene& scene_;
  const SceneBounds& bounds_;
  const RenderSettings& settings_;
  const PlanState& state_;
  FramePlan plan_;
  std::vector<std::array<glm::dvec3, 4>> planes_;  // by view
  Pose middle_;
  double dt_ = 0;       // seconds since the frame before
  double seconds_ = 0;  // since the last switch, this frame
  bool mixing_ = false;
};

}  // namespace

FramePlan planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state) {
  return Planner(scene, bounds, input, state).run();
}

}  // namespace ibr
