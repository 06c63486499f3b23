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
#include <map>
#include <memory_resource>
#include <optional>
#include <span>
#include <utility>

#include "base/check.h"
#include "base/prefetch.h"
#include "ibr/frame_plan.h"
#include "render/photographs/photograph_choice.h"
#include "render/plan/anchors.h"
#include "render/plan/cell_alignment.h"
#include "render/plan/cell_choice.h"
#include "render/plan/cell_distance.h"
#include "render/plan/colour_plan.h"
#include "render/plan/culling.h"
#include "render/plan/exposure_plan.h"
#include "render/plan/frame_arena.h"
#include "render/plan/frame_input.h"
#include "render/plan/occlusion.h"
#include "render/plan/scene_index.h"
#include "render/plan/transition.h"

namespace ibr {
namespace {

// Cells of the hybrid; the gather shows the rest better: 12 cells lose .2 to .7 dB (libibr/docs/tradeoff.md).
constexpr std::uint32_t kHybridCells = 2;

// Pose midway between two views: the mean position and the rotation half-way.
Pose middleOf(const std::vector<Camera>& views) {
  const Pose &first = views.front().pose, &last = views.back().pose;
  if (views.size() == 1) return first;
  return {0.5 * (first.position + last.position), glm::slerp(first.rotation, last.rotation, 0.5)};
}

// Empties a plan, but keeps its vectors' memory.
void restart(FramePlan& plan) {
  FramePlan fresh;
  const auto keep = [](auto& from, auto& to) {
    from.clear();
    to = std::move(from);
  };
  keep(plan.views, fresh.views);
  keep(plan.settings.mutedCells, fresh.settings.mutedCells);
  keep(plan.settings.soloCells, fresh.settings.soloCells);
  keep(plan.cells, fresh.cells);
  keep(plan.fadingOut, fresh.fadingOut);
  keep(plan.photographs, fresh.photographs);
  keep(plan.previous, fresh.previous);
  keep(plan.next.cells, fresh.next.cells);
  keep(plan.next.hiddenCells, fresh.next.hiddenCells);
  keep(plan.next.previous, fresh.next.previous);
  keep(plan.next.colourSlots, fresh.next.colourSlots);
  plan = std::move(fresh);
}

// A sorted list of cells of the settings.
class CellSet {
 public:
  CellSet(const std::vector<std::uint32_t>& cells, std::pmr::memory_resource* memory)
      : cells_(cells.begin(), cells.end(), memory) {
    std::ranges::sort(cells_);
  }
  bool empty() const { return cells_.empty(); }
  bool contains(std::uint32_t cell) const { return std::ranges::binary_search(cells_, cell); }

 private:
  std::pmr::vector<std::uint32_t> cells_;
};

// State of planning one frame, for the steps in run(). `plan` is empty; the input is checked.
class Planner {
 public:
  Planner(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state,
          std::pmr::memory_resource* memory, FramePlan& plan)
      : scene_(scene),
        bounds_(bounds),
        settings_(input.settings),
        state_(state),
        memory_(memory),
        muted_(input.settings.mutedCells, memory),
        solo_(input.settings.soloCells, memory),
        plan_(plan) {
    plan_.views = input.views;
    for (Camera& view : plan_.views) {
      view.pose.rotation = glm::normalize(view.pose.rotation);
      frusta_.push_back({frustum(view), view.pose.position});
    }
    plan_.settings = settings_;
    if (settings_.maxTier >= kTierFilled && bounds_.index->masked) plan_.settings.maxTier = kTierCompleted;
    middle_ = middleOf(plan_.views);
    dt_ = input.dtSeconds > 0 ? std::min(input.dtSeconds, 0.1) : 0.0;  // NaN: 0
    seconds_ = state.secondsSinceSwitch + dt_;
  }

  void run() {
    crossFading_ = !state_.previous.empty() && seconds_ < settings_.switchSeconds;
    choosePhotographs();
    chooseCells();
    align();
    takeCells();
    fadeCells();
    // The paper's methods draw all cells and count their colours, so no cell is marked as hidden.
    if (settings_.order == DrawOrder::ours && settings_.colourMapping <= ColourMapping::ours)
      markHidden(scene_, bounds_, plan_, memory_);
    crossFadeSwitch();
    if (plan_.settings.composition == Composition::gathered) plan_.previousWeight = 0;
    if (gathers() && plan_.cells.empty()) plan_.nearDistance = 0.05 * plan_.gather.spacing;
    plan_.exposure = plannedExposure(scene_, dt_, state_, plan_);
    planColours(dt_, state_, plan_, memory_);
  }

 private:
  // `margin`: radians by which a correction may still move the cell.
  bool visible(const PlannedCell& planned, double margin = 0) const {
    for (std::size_t v = 0; v < plan_.views.size(); ++v)
      if (mayBeVisible(posesOf(planned.cell), bounds_.cells[planned.cell], frusta_[v].planes,
                       {planned.view[v].position, settings_.morph, frusta_[v].eye, planned.correction}, margin))
        return true;
    return false;
  }
  const CellPoses& posesOf(std::uint32_t cell) const { return bounds_.index->cells.poses[cell]; }
  bool aligned() const { return settings_.alignCells && settings_.morph == Morph::ours; }

  // Returns a cell with its weights for every view; the draw order has no influence.
  PlannedCell planned(std::uint32_t index, const CellDistance& fromMiddle) const {
    const CellPoses& cell = posesOf(index);
    PlannedCell planned;
    planned.cell = index;
    planned.extrapolationDistance = fromMiddle.extrapolation;
    planned.rotationalDistance = fromMiddle.rotation;
    const double limit = settings_.extrapolationLimit * bounds_.cells[index].size;
    const double fade = settings_.fadeShare * limit;
    if (fade > 0 && std::isfinite(fade))
      planned.opacity = std::clamp((limit - fromMiddle.extrapolation) / fade, 0.0, 1.0);
    for (std::size_t v = 0; v < plan_.views.size(); ++v) {
      const Barycentric weights = plan_.views.size() == 1 ? fromMiddle.weights : cellWeights(cell, frusta_[v].eye);
      planned.view[v].position = settings_.morph == Morph::ours ? weights.clamped : weights.free;
      planned.view[v].blend = smoothstep(weights.clamped);
    }
    planned.photographDistance = photographDistance(cell, smoothstep(fromMiddle.weights.clamped));
    return planned;
  }

  double photographDistance(const CellPoses& cell, const Weights& blend) const {
    double squared = 0;
    for (std::size_t i = 0; i < cell.count; ++i) {
      const double distance = glm::distance(cell.pose[i].position, middle_.position);
      squared += blend[i] * distance * distance;
    }
    return std::sqrt(squared);
  }

  CellDistance distanceOf(std::uint32_t cell) const {
    return cellDistance(posesOf(cell), bounds_.cells[cell].size, middle_);
  }

  // Cells that may be in view, ascending; counts the others.
  std::pmr::vector<std::uint32_t> cellsNearby() {
    std::pmr::vector<std::uint32_t> cells(memory_);
    const CellQuery query{middle_, settings_.extrapolationLimit, settings_.morph == Morph::ours && !aligned(), frusta_};
    const CulledCells culled = findCells(bounds_.cells, bounds_.index->cells, query, cells);
    plan_.culledByDistance += culled.byDistance;
    plan_.culledByFrustum += culled.byFrustum;
    return cells;
  }

  void findCandidates() {
    const std::pmr::vector<std::uint32_t> nearby = cellsNearby();
    candidates_.reserve(nearby.size());
    planned_.reserve(nearby.size());
    clamped_.reserve(nearby.size());
    const auto ahead = [&](std::size_t i) {  // cells are far apart in memory
      if (i >= nearby.size()) return;
      prefetch(posesOf(nearby[i]));
      prefetch(bounds_.cells[nearby[i]]);
    };
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < kAhead; ++i) ahead(i);
    for (std::size_t i = 0; i < nearby.size(); ++i) {
      ahead(i + kAhead);
      const std::uint32_t c = nearby[i];
      const double size = bounds_.cells[c].size;
      const CellDistance distance = distanceOf(c);
      if (distance.extrapolation > settings_.extrapolationLimit * size) {
        ++plan_.culledByDistance;
        continue;
      }
      const PlannedCell cell = planned(c, distance);
      const bool inView = visible(cell);
      const auto moved = [&] { return aligned() && !bounds_.anchors->of(scene_)[c].empty(); };
      if (!inView && !(moved() && visible(cell, kMaxCorrectionRadians))) {
        ++plan_.culledByFrustum;
        continue;
      }
      if (muted_.contains(c) || !(solo_.empty() || solo_.contains(c))) {
        ++plan_.culledByMuting;
        plan_.next.hiddenCells.push_back(c);  // fades in when it is unmuted
        continue;
      }
      candidates_.push_back({c, distance.extrapolation, distance.rotation, size, !inView,
                             crossFading_ && std::int64_t(c) == state_.mainCell, kNotShown,
                             0.5 * (distance.extrapolation + cell.photographDistance), planned_.size()});
      planned_.push_back(cell);
      clamped_.push_back(distance.weights.clamped);
    }
    std::int64_t rank = 0;
    for (const DrawOrderEntry& shown : state_.cells) {
      if (shown.fadingOut) continue;
      const auto found = std::ranges::lower_bound(candidates_, shown.cell, {}, &CellCandidate::cell);
      if (found != candidates_.end() && found->cell == shown.cell && found->rank == kNotShown) found->rank = rank;
      ++rank;
    }
  }

  // Sets the cells of the plan, best first. Corrections may still move some of them out of view.
  void chooseCells() {
    findCandidates();
    std::pmr::vector<CellCandidate> ordered(candidates_, memory_);
    const std::size_t drawn = ibr::chooseCells(bounds_, plan_.views, ordered, cellLimit(), gathers(), memory_);
    for (const CellCandidate& left : std::span(ordered).subspan(drawn)) {
      ++(left.nearlyInView ? plan_.culledByFrustum : plan_.culledByCount);
      if (!left.nearlyInView) plan_.next.hiddenCells.push_back(left.cell);
    }
    std::ranges::sort(plan_.next.hiddenCells);
    for (const CellCandidate& candidate : std::span(ordered).first(drawn))
      plan_.cells.push_back(planned_[candidate.index]);
  }

  // Keeps the cells that are in view with their corrections.
  void takeCells() {
    if (aligned())
      plan_.culledByFrustum +=
          std::uint32_t(std::erase_if(plan_.cells, [&](const PlannedCell& cell) { return !visible(cell); }));
    if (plan_.cells.empty()) return;
    plan_.next.mainCell = plan_.cells[0].cell;
    // Nearer surfaces are drawn at this depth. Relative to the cell's size, since the scale of the world is arbitrary.
    plan_.nearDistance = 0.05 * bounds_.cells[plan_.cells[0].cell].size;
  }

  bool switched() const { return state_.mainCell >= 0 && plan_.next.mainCell != state_.mainCell; }

  // Plans a cell of a previous draw order with this frame's weights; nullptr: not in view. The cell is planned once a
  // frame, and stays where it is until the frame is planned.
  const PlannedCell* plannedAgain(std::uint32_t cell) {
    const auto [found, isNew] = again_.try_emplace(cell);
    if (isNew && cell < scene_.cells.size()) {  // else the state is of another scene
      const CellCandidate* candidate = candidateOf(cell);
      PlannedCell again = candidate ? planned_[candidate->index] : planned(cell, distanceOf(cell));
      const auto correction = corrections_.find(cell);
      if (correction != corrections_.end()) again.correction = correction->second;
      const bool known = candidate && again.correction == Correction{};
      if (known ? !candidate->nearlyInView : visible(again)) found->second = again;
    }
    return found->second ? &*found->second : nullptr;
  }

  const CellCandidate* candidateOf(std::uint32_t cell) const {
    const auto found = std::ranges::lower_bound(candidates_, cell, {}, &CellCandidate::cell);
    return found != candidates_.end() && found->cell == cell ? &*found : nullptr;
  }

  // Share of a fade that passes in this frame. The paper's colour sequence cannot draw a cell twice, so it cuts.
  double fadeStep() const {
    const bool sequence =
        settings_.colourMapping == ColourMapping::paper || settings_.colourMapping == ColourMapping::paperRedraw;
    return switched() || sequence || !(settings_.switchSeconds > 0) ? 1.0 : dt_ / settings_.switchSeconds;
  }

  // Changes behind the main cell fade. A switch of the main cell cross-fades whole orders, which covers other changes.
  void fadeCells() {
    std::pmr::vector<std::uint32_t> order(memory_), stillVisible(memory_);
    for (const PlannedCell& cell : plan_.cells) order.push_back(cell.cell);
    const double step = fadeStep();
    for (const DrawOrderEntry& shown : state_.cells)
      if (step < 1 && std::ranges::find(order, shown.cell) == order.end() && plannedAgain(shown.cell))
        stillVisible.push_back(shown.cell);
    std::ranges::sort(stillVisible);
    advanceFades(state_.cells, {order, state_.hiddenCells, stillVisible, gathers()}, step, memory_, plan_.next.cells);
    std::uint32_t rank = 0;  // of the next cell of the plan
    for (const DrawOrderEntry& shown : plan_.next.cells) {
      if (!shown.fadingOut) {
        plan_.cells[rank++].opacity *= shown.opacity;
      } else if (const PlannedCell* again = plannedAgain(shown.cell)) {
        plan_.fadingOut.push_back({*again, rank});
        plan_.fadingOut.back().planned.opacity *= shown.opacity;
      }
    }
  }

  // Aligns all cells that this frame may draw in one solve, from the midpoint of the views.
  void align() {
    if (!aligned()) return;
    std::pmr::vector<std::uint32_t> toMove(memory_);
    for (const PlannedCell& cell : plan_.cells) toMove.push_back(cell.cell);
    for (const std::vector<DrawOrderEntry>* shown : {&state_.cells, &state_.previous})
      for (const DrawOrderEntry& cell : *shown)
        if (cell.cell < scene_.cells.size() && std::ranges::find(toMove, cell.cell) == toMove.end())
          toMove.push_back(cell.cell);
    const SceneBounds::Anchors::OfCells& anchors = bounds_.anchors->of(scene_);
    std::pmr::vector<CellToAlign> wanted(memory_);
    for (const std::uint32_t c : toMove) wanted.push_back(toAlign(c, anchors[c]));
    const std::pmr::vector<Correction> found = alignCells(scene_, wanted, middle_.position, memory_);
    for (std::size_t i = 0; i < toMove.size(); ++i) corrections_[toMove[i]] = found[i];
    for (PlannedCell& cell : plan_.cells) cell.correction = corrections_[cell.cell];
  }

  CellToAlign toAlign(std::uint32_t index, std::span<const CellBounds::Anchor> anchors) const {
    const Cell& cell = scene_.cells[index];
    if (const CellCandidate* known = candidateOf(index))
      return {&cell, anchors, clamped_[known->index], known->distance};
    const CellDistance from = distanceOf(index);
    const double photographs = photographDistance(posesOf(index), smoothstep(from.weights.clamped));
    return {&cell, anchors, from.weights.clamped, 0.5 * (from.extrapolation + photographs)};
  }

  // A scene that cannot be gathered from is drawn by its cells. Solo cells and Overlay::overlap show cells alone.
  void choosePhotographs() {
    if (!gathers()) return;
    if (settings_.overlay != Overlay::overlap && settings_.soloCells.empty())
      ibr::choosePhotographs(scene_, bounds_.index->photographs, bounds_.gather, plan_.views, middle_,
                             settings_.gatherCandidates, memory_, plan_.photographs);
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
      if (const PlannedCell* again = plannedAgain(shown.cell)) {
        plan_.previous.push_back(*again);
        plan_.previous.back().opacity *= shown.opacity;
      }
    const double share = next.secondsSinceSwitch / settings_.switchSeconds;
    plan_.previousWeight = 1.0 - share * share * (3.0 - 2.0 * share);
  }

  const Scene& scene_;
  const SceneBounds& bounds_;
  const RenderSettings& settings_;
  const PlanState& state_;
  std::pmr::memory_resource* memory_;
  CellSet muted_, solo_;
  FramePlan& plan_;
  std::pmr::vector<CellQuery::View> frusta_{memory_};                        // by view
  std::pmr::vector<CellCandidate> candidates_{memory_};                      // by cell, ascending
  std::pmr::vector<PlannedCell> planned_{memory_};                           // of the candidates
  std::pmr::vector<Weights> clamped_{memory_};                               // of the candidates, for the middle
  std::pmr::map<std::uint32_t, Correction> corrections_{memory_};            // by cell
  std::pmr::map<std::uint32_t, std::optional<PlannedCell>> again_{memory_};  // by cell; nullopt: not in view
  Pose middle_;
  double dt_ = 0;       // seconds since the previous frame
  double seconds_ = 0;  // since the last switch, at this frame
  bool crossFading_ = false;
};

// Working memory of a thread.
struct Workspace {
  FrameArena arena;
  PlanState previous;  // a state that the plan would overwrite
};

}  // namespace

void planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state,
               FramePlan& plan) {
  check(bounds.index && bounds.cells.size() == scene.cells.size(), ErrorCode::invalidInput,
        "bounds: not those that sceneBounds made for this scene");
  checkInput(input);
  thread_local Workspace workspace;
  workspace.arena.restart();
  const bool isSame = &state == &plan.next;
  if (isSame) workspace.previous = state;
  restart(plan);
  Planner(scene, bounds, input, isSame ? workspace.previous : state, &workspace.arena, plan).run();
}

FramePlan planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state) {
  FramePlan plan;
  planFrame(scene, bounds, input, state, plan);
  return plan;
}

}  // namespace ibr
