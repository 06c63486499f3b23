// SPDX-License-Identifier: Apache-2.0
#include "author/graph/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "author/graph/view_groups.h"
#include "base/check.h"

namespace ibr {
namespace {

Views checkedViews(const PosedModel& model, const BuildOptions& options) {
  checkPlanOptions(options);
  return viewsOf(model, options.thetaDegrees);
}

}  // namespace

void checkPlanOptions(const BuildOptions& options) {
  check(options.dimension >= 0 && options.dimension <= 3, ErrorCode::invalidInput, "dimension {} is not 0 to 3",
        options.dimension);
  check(options.thetaDegrees >= 0 && options.thetaDegrees <= 180, ErrorCode::invalidInput,
        "theta {} is not within 0 to 180 degrees", options.thetaDegrees);
}

CellPlanner::CellPlanner(const PosedModel& model, const BuildOptions& options)
    : dimension_(options.dimension == 0 ? 3 : options.dimension),
      views_(checkedViews(model, options)),
      viewOf_(model.images.size()),
      relations_(model),
      judge_(views_, relations_) {
  for (std::uint32_t i = 0; i < views_.size(); ++i) viewOf_[views_[i].image] = i;
}

CellPlan CellPlanner::plan() {
  std::set<Simplex> cells;
  for (const ViewGroup& group : orientationGroups(views_))
    for (const ViewGroup& part : partsOf(views_, group)) {
      GroupSplit split = splitGroup(views_, part, std::size_t(dimension_) + 1);
      const std::vector<Simplex> chosen = chooseCells(views_, judge_, part, std::move(split), refused_);
      cells.insert(chosen.begin(), chosen.end());
    }
  const std::vector<Simplex> wide = wideLines(views_, judge_, relations_, cells);
  cells.insert(wide.begin(), wide.end());
  tried_ = cells;

  CellPlan plan;
  plan.ordered = 2 * views_.siteCentre.size() <= views_.size();
  std::vector<bool> used(views_.size(), false);
  for (const Simplex& cell : cells) {
    plan.cells.push_back(members(cell));
    for (const std::uint32_t i : cell) used[i] = true;
  }
  for (const auto& [simplex, why] : refused_) {
    if (cells.contains(simplex)) continue;
    std::string names;
    for (const std::uint32_t i : simplex) names += (names.empty() ? "" : ", ") + views_[i].name;
    plan.dropped.push_back({names, why});
  }
  for (std::uint32_t i = 0; i < views_.size(); ++i)
    if (!used[i]) plan.unused.push_back({views_[i].name, whyUnused(views_[i].image)});
  return plan;
}

std::vector<CellMembers> CellPlanner::replacementFaces(const std::vector<CellMembers>& failed,
                                                       const std::vector<CellMembers>& made) {
  const std::vector<Simplex> kept = simplices(made);
  std::vector<CellMembers> result;
  std::set<Simplex> candidates;
  for (const Simplex& simplex : simplices(failed))
    if (simplex.size() > 2)
      for (Simplex& face : faces(simplex)) candidates.insert(std::move(face));
  for (const Simplex& face : candidates) {
    const bool part = std::any_of(kept.begin(), kept.end(), [&](const Simplex& cell) {
      return std::includes(cell.begin(), cell.end(), face.begin(), face.end());
    });
    if (part || tried_.contains(face) || judge_.refusal(face) || liesIn(views_, face, kept)) continue;
    tried_.insert(face);
    result.push_back(members(face));
  }
  return result;
}

double CellPlanner::score(const CellMembers& cell) const {
  return judge_.score(simplices({cell})[0]);
}

std::string CellPlanner::whyUnused(std::uint32_t image) const {
  const std::uint32_t i = viewOf_[image];
  const View& view = views_[i];
  if (views_.size() == 1) return "it is the only photograph";
  if (relations_.hasTracks() && relations_.neighbours(image, 1).empty())
    return "it shares points with no other photograph";
  double nearest = std::numeric_limits<double>::infinity(), angle = nearest, twinDistance = nearest;
  std::uint32_t twin = i;
  for (std::uint32_t j = 0; j < views_.size(); ++j) {
    if (j == i || !views_.sameKind(i, j)) continue;
    const double distance = glm::distance(view.camera.pose.position, views_[j].camera.pose.position);
    const double its = axisAngle(views_, i, j);
    if (views_[j].site != view.site) {
      nearest = std::min(nearest, distance);
      angle = std::min(angle, its);
    } else if (its <= std::min(view.theta, views_[j].theta) && distance < twinDistance) {
      twinDistance = distance;
      twin = j;
    }
  }
  if (!(nearest < std::numeric_limits<double>::infinity()))
    return "no photograph of the same camera type was taken at another capture site";
  if (angle > view.theta)
    return fmt::format(
        "its viewing direction differs by {:.0f}° or more from photographs at other capture sites; the limit is "
        "{:.0f}°",
        glm::degrees(angle), glm::degrees(view.theta));
  if (twin != i)
    return fmt::format(
        "it is within {:.2g} of {}, which looks in the same direction (the next capture site is {:.2g} away)",
        twinDistance, views_[twin].name, nearest);
  // Among the refused pairs of this photograph, reports the one that shares the most tracks.
  const std::string* reason = nullptr;
  std::uint32_t most = 0;
  for (const auto& [simplex, why] : refused_)
    if (simplex.size() == 2 && (simplex[0] == i || simplex[1] == i))
      if (const std::uint32_t shared = judge_.between(simplex[0], simplex[1]).shared; !reason || shared > most) {
        reason = &why;
        most = shared;
      }
  return reason ? *reason : "it forms no well-shaped cell with its neighbours";
}

std::vector<Simplex> CellPlanner::simplices(const std::vector<CellMembers>& cells) const {
  std::vector<Simplex> result;
  for (const CellMembers& cell : cells) {
    result.emplace_back();
    for (const std::uint32_t image : cell) result.back().push_back(viewOf_[image]);
    std::sort(result.back().begin(), result.back().end());
  }
  return result;
}

CellMembers CellPlanner::members(const Simplex& simplex) const {
  CellMembers members;
  for (const std::uint32_t i : simplex) members.push_back(views_[i].image);
  return members;
}

CellPlan planCells(const PosedModel& model, const BuildOptions& options) {
  return CellPlanner(model, options).plan();
}

}  // namespace ibr
