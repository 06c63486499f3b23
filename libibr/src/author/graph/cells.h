// SPDX-License-Identifier: Apache-2.0
// Which photographs make a morphing cell ([T] §2.4.1: nodes of similar rotation that span a simplex).
//
//   1. spots: photographs from one place (capture_sites.h), and whether those stand on a grid (lattice.h)
//   2. groups of similar rotation, one photograph a spot (view_groups.h)
//   3. the simplices of a group (split_group.h)
//   4. which of them become cells, and lines between those that are left apart (choose_cells.h)
//   5. once cells are matched: for those that failed, their faces stand in, then edges
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "author/graph/choose_cells.h"
#include "author/graph/graph_views.h"
#include "author/graph/view_relations.h"
#include "ibr/author.h"

namespace ibr {

/// Indices into PosedModel::images, by name.
using CellMembers = std::vector<std::uint32_t>;

struct CellPlan {
  std::vector<CellMembers> cells;
  std::vector<BuildReport::Dropped> dropped;  // simplices that were refused
  std::vector<UnusedPhotograph> unused;       // photographs that are in no cell
  bool ordered = false;                       // several photographs were taken from each spot ([T] §2.4.2)
};

/// Throws Error{invalidInput} for a `dimension` or `thetaDegrees` that cannot be.
void checkPlanOptions(const BuildOptions& options);

class CellPlanner {
 public:
  /// Uses `dimension` and `thetaDegrees` of the options. The model outlives the object. Throws as checkPlanOptions.
  CellPlanner(const PosedModel& model, const BuildOptions& options);

  /// Does not depend on the order of images or tracks, nor on where the world lies, how it is turned, and its scale.
  CellPlan plan();

  /// Faces of cells that failed, which are no part of those that were made, nor lie in one, and did not fail earlier.
  std::vector<CellMembers> standIns(const std::vector<CellMembers>& failed, const std::vector<CellMembers>& made);

  /// choose_cells.h
  double score(const CellMembers& members) const;

  /// Why no cell was planned for a photograph, for people.
  std::string whyUnused(std::uint32_t image) const;

 private:
  std::vector<Simplex> simplices(const std::vector<CellMembers>& cells) const;
  CellMembers members(const Simplex& simplex) const;

  int dimension_;
  Views views_;
  std::vector<std::uint32_t> viewOf_;  // of each image
  ViewRelations relations_;
  CellJudge judge_;
  std::map<Simplex, std::string> refused_;
  std::set<Simplex> tried_;
};

/// A planner's plan.
CellPlan planCells(const PosedModel& model, const BuildOptions& options);

}  // namespace ibr
