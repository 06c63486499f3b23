// SPDX-License-Identifier: Apache-2.0
// Plans a frame: cells, their order and their weights ([T] §2.5.1 "clamping", §2.5.2). Pure.
//
// Departures from [T]: a cell overtakes another only by a margin. Cells with equal keys are ordered by their members'
// poses, so that the order of cells in the file does not matter (cell_choice.h). Two views share one order, from the
// pose midway between them ([T] §2.5.4). A switch of the main cell cross-fades two draw orders; other changes fade
// (transition.h). Holes are not filled in a scene with masks, since a mask may have made them.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <map>
#include <optional>

#include "base/check.h"
#include "ibr/frame_plan.h"
#include "render/plan/anchors.h"
#include "render/plan/cell_alignment.h"
#include "render/plan/cell_choice.h"
#include "render/plan/cell_distance.h"
#include "render/plan/colour_plan.h"
#include "render/plan/culling.h"
#include "render/plan/exposure_plan.h"
#include "render/plan/occlusion.h"
#include "render/plan/photograph_choice.h"
#include "render/plan/transition.h"
#include "scene/scene_faults.h"

namespace ibr {
namespace {

// Cells of the hybrid; the gather shows the rest better: 12 cells lose .2 to .7 dB (libibr/docs/tradeoff.md).
constexpr std::uint32_t kHybridCells = 2;

void checkView(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "view: the camera model must be pinhole");
  check(k.width > 0 && k.height > 0, ErrorCode::invalidInput, "view: size {}x{} is empty", k.width, k.height);
  check(k.fx > 0 && k.fy > 0 && std::isfinite(k.fx) && std::isfinite(k.fy), ErrorCode::invalidInput,
        "view: focal lengths {} and {} are not positive", k.fx, k.fy);
  check(std::isfinite(k.cx) && std::isfinite(k.cy), ErrorCode::invalidInput, "view: principal point is not finite");
  const glm::dvec3 p = view.pose.position;
  check(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), ErrorCode::invalidInput,
        "view: position ({}, {}, {}) is not finite", p.x, p.y, p.z);
  check(withinWorld(p), ErrorCode::invalidInput,
        "view: position ({}, {}, {}) is further from the origin than {} world units", p.x, p.y, p.z, kWorldRadius);
  const double length = glm::length(view.pose.rotation);
  check(std::abs(length - 1.0) <= 1e-3, ErrorCode::invalidInput, "view: rotation has length {}, not 1", length);
}

void checkScale(const char* name, double scale) {
  check(scale > 0 && std::isfinite(scale), ErrorCode::invalidInput, "settings: {} {} is not positive", name, scale);
}

void checkGather(const RenderSettings& settings) {
  const auto inRange = [](const char* name, std::uint32_t value, std::uint32_t most) {
    check(value >= 1 && value <= most, ErrorCode::invalidInput, "settings: {} {} is not between 1 and {}", name, value,
          most);
  };
  inRange("gatherCandidates", settings.gatherCandidates, kMaxGatherCandidates);
  inRange("gatherColours", settings.gatherColours, kMaxGatherColours);
  inRange("gatherLayers", settings.gatherLayers, kMaxGatherLayers);
  check(settings.voteScale > 0 && settings.voteScale <= 1, ErrorCode::invalidInput,
        "settings: voteScale {} must be above 0 and at most 1", settings.voteScale);
  check(settings.order == DrawOrder::ours, ErrorCode::invalidInput, "settings: order paper requires composition cells");
  check(settings.colourMapping <= ColourMapping::ours, ErrorCode::invalidInput,
        "settings: the paper's colourMapping requires composition cells");
}

bool hasMask(const Scene& scene) {
  return std::ranges::any_of(scene.nodes, [](const Node& node) { return !node.maskFile.empty(); });
}

// Pose midway between two views: the mean position and the rotation half-way.
Pose middleOf(const std::vector<Camera>& views) {
  const Pose &first = views.front().pose, &last = views.back().pose;
  if (views.size() == 1) return first;
  return {0.5 * (first.position + last.position), glm::slerp(first.rotation, last.rotation, 0.5)};
}

// State of planning one frame, for the steps in run().
class Planner {
 public:
  Planner(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state)
      : scene_(scene), bounds_(bounds), settings_(input.settings), state_(state) {
    check(input.views.size() == 1 || input.views.size() == 2, ErrorCode::invalidInput,
          "views: {} cameras, must be 1 or 2", input.views.size());
    for (const Camera& view : input.views) checkView(view);
    checkScale("textureScale", settings_.textureScale);
    checkScale("renderScale", settings_.renderScale);
    if (settings_.composition != Composition::cells) checkGather(settings_);
    plan_.views = input.views;
    for (Camera& view : plan_.views) {
      view.pose.rotation = glm::normalize(view.pose.rotation);
      planes_.push_back(frustum(view));
    }
    plan_.settings = settings_;
    if (settings_.maxTier >= kTierFilled && hasMask(scene)) plan_.settings.maxTier = kTierCompleted;
    middle_ = middleOf(plan_.views);
    dt_ = input.dtSeconds > 0 ? std::min(input.dtSeconds, 0.1) : 0.0;  // NaN: 0
    seconds_ = state.secondsSinceSwitch + dt_;
  }

  FramePlan run() {
    crossFading_ = !state_.previous.empty() && seconds_ < settings_.switchSeconds;
    choosePhotographs();
    std::vector<PlannedCell> cells = chooseCells();
    align(cells);
    takeCells(std::move(cells));
    fadeCells();
    // The paper's methods draw all cells and count their colours, so no cell is marked as hidden.
    if (settings_.order == DrawOrder::ours && settings_.colourMapping <= ColourMapping::ours)
      markHidden(scene_, bounds_, plan_);
    crossFadeSwitch();
    if (plan_.settings.composition == Composition::gathered) plan_.previousWeight = 0;
    if (gathers() && plan_.cells.empty()) plan_.nearDistance = 0.05 * plan_.gather.spacing;
    plan_.exposure = plannedExposure(scene_, dt_, state_, plan_);
    planColours(dt_, state_, plan_);
    return std::move(plan_);
  }

 private:
  // `margin`: radians by which a correction may still move the cell.
  bool visible(const PlannedCell& planned, double margin = 0) const {
    for (std::size_t v = 0; v < plan_.views.size(); ++v)
      if (mayBeVisible(scene_, scene_.cells[planned.cell], bounds_.cells[planned.cell], planes_[v],
                       {planned.view[v].position, settings_.morph, plan_.views[v].pose.position, planned.correction},
                       margin))
        return true;
    return false;
  }
  bool aligned() const { return settings_.alignCells && settings_.morph == Morph::ours; }

  // Returns a cell with its weights for every view; the draw order has no influence.
  PlannedCell planned(std::uint32_t index, const CellDistance& fromMiddle) const {
    const Cell& cell = scene_.cells[index];
    PlannedCell planned;
    planned.cell = index;
    planned.extrapolationDistance = fromMiddle.extrapolation;
    planned.rotationalDistance = fromMiddle.rotation;
    const double limit = settings_.extrapolationLimit * bounds_.cells[index].size;
    const double fade = settings_.fadeShare * limit;
    if (fade > 0 && std::isfinite(fade))
      planned.opacity = std::clamp((limit - fromMiddle.extrapolation) / fade, 0.0, 1.0);
    for (std::size_t v = 0; v < plan_.views.size(); ++v) {
      const Barycentric weights =
          plan_.views.size() == 1 ? fromMiddle.weights
                                  : cellDistance(scene_, cell, bounds_.cells[index].size, plan_.views[v].pose).weights;
      planned.view[v].position = settings_.morph == Morph::ours ? weights.clamped : weights.free;
      planned.view[v].blend = smoothstep(weights.clamped);
    }
    planned.photographDistance = photographDistance(cell, smoothstep(fromMiddle.weights.clamped));
    return planned;
  }

  double photographDistance(const Cell& cell, const Weights& blend) const {
    double squared = 0;
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const double distance = glm::distance(scene_.nodes[cell.members[i]].camera.pose.position, middle_.position);
      squared += blend[i] * distance * distance;
    }
    return std::sqrt(squared);
  }

  bool isChosen(std::uint32_t cell) const {
    const auto has = [cell](const auto& list) { return std::ranges::find(list, cell) != list.end(); };
    return !has(settings_.mutedCells) && (settings_.soloCells.empty() || has(settings_.soloCells));
  }

  // `cells` receives the planned cells; CellCandidate::index refers to them.
  std::vector<CellCandidate> candidates(std::vector<PlannedCell>& cells) {
    std::map<std::uint32_t, std::int64_t> rank;
    for (const DrawOrderEntry& shown : state_.cells)
      if (!shown.fadingOut) rank.emplace(shown.cell, std::int64_t(rank.size()));
    std::vector<CellCandidate> result;
    for (std::uint32_t c = 0; c < scene_.cells.size(); ++c) {
      const double size = bounds_.cells[c].size;
      const CellDistance distance = cellDistance(scene_, scene_.cells[c], size, middle_);
      if (distance.extrapolation > settings_.extrapolationLimit * size) {
        ++plan_.culledByDistance;
        continue;
      }
      PlannedCell cell = planned(c, distance);
      const bool inView = visible(cell);
      const auto moved = [&] { return aligned() && !bounds_.anchors->of(scene_)[c].empty(); };
      if (!inView && !(moved() && visible(cell, kMaxCorrectionRadians))) {
        ++plan_.culledByFrustum;
        continue;
      }
      if (!isChosen(c)) {
        ++plan_.culledByMuting;
        plan_.next.hiddenCells.push_back(c);  // fades in when it is unmuted
        continue;
      }
      const auto before = rank.find(c);
      result.push_back({c, distance.extrapolation, distance.rotation, size, !inView,
                        crossFading_ && std::int64_t(c) == state_.mainCell,
                        before == rank.end() ? kNotShown : before->second,
                        0.5 * (distance.extrapolation + cell.photographDistance), cells.size()});
      cells.push_back(cell);
    }
    return result;
  }

  // Returns the chosen cells, best first. Corrections may still move some of them out of view.
  std::vector<PlannedCell> chooseCells() {
    std::vector<PlannedCell> cells, ordered;
    const CellChoice choice = ibr::chooseCells(scene_, bounds_, plan_.views, candidates(cells), cellLimit(), gathers());
    for (const CellCandidate& left : choice.left) {
      ++(left.nearlyInView ? plan_.culledByFrustum : plan_.culledByCount);
      if (!left.nearlyInView) plan_.next.hiddenCells.push_back(left.cell);
    }
    std::ranges::sort(plan_.next.hiddenCells);
    for (const CellCandidate& drawn : choice.drawn) ordered.push_back(cells[drawn.index]);
    return ordered;
  }

  // Keeps the cells that are in view with their corrections.
  void takeCells(std::vector<PlannedCell> cells) {
    plan_.culledByFrustum +=
        std::uint32_t(aligned() ? std::erase_if(cells, [&](const PlannedCell& cell) { return !visible(cell); }) : 0);
    plan_.cells = std::move(cells);
    if (!plan_.cells.empty()) plan_.next.mainCell = plan_.cells[0].cell;
    // Nearer surfaces are drawn at this depth. Relative to the cell's size, since the scale of the world is arbitrary.
    if (!plan_.cells.empty()) plan_.nearDistance = 0.05 * bounds_.cells[plan_.cells[0].cell].size;
  }

  bool switched() const { return state_.mainCell >= 0 && plan_.next.mainCell != state_.mainCell; }

  // Plans a cell of a previous draw order with this frame's weights; nullopt: not in view.
  std::optional<PlannedCell> plannedAgain(const DrawOrderEntry& shown) const {
    if (shown.cell >= scene_.cells.size()) return std::nullopt;  // the state is of another scene
    PlannedCell again =
        planned(shown.cell, cellDistance(scene_, scene_.cells[shown.cell], bounds_.cells[shown.cell].size, middle_));
    again.opacity *= shown.opacity;
    again.correction = correctionOf(shown.cell);
    if (!visible(again)) return std::nullopt;
    return again;
  }

  // Share of a fade that passes in this frame. The paper's colour sequence cannot draw a cell twice, so it cuts.
  double fadeStep() const {
    const bool sequence =
        settings_.colourMapping == ColourMapping::paper || settings_.colourMapping == ColourMapping::paperRedraw;
    return sequence || !(settings_.switchSeconds > 0) ? 1.0 : dt_ / settings_.switchSeconds;
  }

  // Changes behind the main cell fade. A switch of the main cell cross-fades whole orders, which covers other changes.
  void fadeCells() {
    std::vector<std::uint32_t> order;
    for (const PlannedCell& cell : plan_.cells) order.push_back(cell.cell);
    const WantedOrder wanted{order,
                             [&](std::uint32_t cell) { return std::ranges::binary_search(state_.hiddenCells, cell); },
                             [&](std::uint32_t cell) {
                               return plannedAgain({cell, 1.0, false}).has_value();
                             },
                             gathers()};
    plan_.next.cells = advanceFades(state_.cells, wanted, switched() ? 1.0 : fadeStep());
    std::uint32_t rank = 0;  // of the next cell of the plan
    for (const DrawOrderEntry& shown : plan_.next.cells) {
      if (!shown.fadingOut)
        plan_.cells[rank++].opacity *= shown.opacity;
      else if (const auto planned = plannedAgain(shown))
        plan_.fadingOut.push_back({*planned, rank});
    }
  }

  Correction correctionOf(std::uint32_t cell) const {
    const auto found = corrections_.find(cell);
    return found == corrections_.end() ? Correction{} : found->second;
  }

  // Aligns all cells that this frame may draw in one solve, from the midpoint of the views.
  void align(std::vector<PlannedCell>& cells) {
    if (!aligned()) return;
    std::vector<std::uint32_t> toMove;
    for (const PlannedCell& cell : cells) toMove.push_back(cell.cell);
    for (const std::vector<DrawOrderEntry>* shown : {&state_.cells, &state_.previous})
      for (const DrawOrderEntry& cell : *shown)
        if (cell.cell < scene_.cells.size() && std::ranges::find(toMove, cell.cell) == toMove.end())
          toMove.push_back(cell.cell);
    const SceneBounds::Anchors::OfCells& anchors = bounds_.anchors->of(scene_);
    std::vector<CellToAlign> wanted;
    for (const std::uint32_t c : toMove) wanted.push_back(toAlign(c, anchors[c]));
    const std::vector<Correction> found = alignCells(scene_, wanted, middle_.position);
    for (std::size_t i = 0; i < toMove.size(); ++i) corrections_[toMove[i]] = found[i];
    for (PlannedCell& cell : cells) cell.correction = corrections_[cell.cell];
  }

  CellToAlign toAlign(std::uint32_t index, std::span<const CellBounds::Anchor> anchors) const {
    const Cell& cell = scene_.cells[index];
    const CellDistance from = cellDistance(scene_, cell, bounds_.cells[index].size, middle_);
    const double photographs = photographDistance(cell, smoothstep(from.weights.clamped));
    return {&cell, anchors, from.weights.clamped, 0.5 * (from.extrapolation + photographs)};
  }

  // A scene that cannot be gathered from is drawn by its cells. Solo cells and Overlay::overlap show cells alone.
  void choosePhotographs() {
    if (!gathers()) return;
    if (settings_.overlay != Overlay::overlap && settings_.soloCells.empty())
      plan_.photographs =
          ibr::choosePhotographs(scene_, bounds_.gather, plan_.views, middle_, settings_.gatherCandidates);
    if (plan_.photographs.empty())
      plan_.settings.composition = Composition::cells;
    else
      plan_.gather = bounds_.gather;
  }
  std::size_t cellLimit() const { return std::min(settings_.maxCells, gathers() ? kHybridCells : kMaxCellCount); }
  bool gathers() const { return plan_.settings.composition != Composition::cells; }

  void crossFadeSwitch() {
    PlanState& next = plan_.next;
    if (switched() && settings_.switchSeconds > 0) {
      next.previous = state_.cells;  // the frame of the switch still shows the previous order
      next.secondsSinceSwitch = 0;
    } else if (crossFading_) {
      next.previous = state_.previous;
      next.secondsSinceSwitch = seconds_;
    }
    if (next.previous.empty()) return;
    for (const DrawOrderEntry& shown : next.previous)
      if (const auto cell = plannedAgain(shown)) plan_.previous.push_back(*cell);
    const double share = next.secondsSinceSwitch / settings_.switchSeconds;
    plan_.previousWeight = 1.0 - share * share * (3.0 - 2.0 * share);
  }

  const Scene& scene_;
  const SceneBounds& bounds_;
  const RenderSettings& settings_;
  const PlanState& state_;
  FramePlan plan_;
  std::vector<std::array<glm::dvec3, 4>> planes_;  // by view
  Pose middle_;
  std::map<std::uint32_t, Correction> corrections_;  // by cell
  double dt_ = 0;                                    // seconds since the previous frame
  double seconds_ = 0;                               // since the last switch, at this frame
  bool crossFading_ = false;
};

}  // namespace

FramePlan planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state) {
  return Planner(scene, bounds, input, state).run();
}

}  // namespace ibr
