// SPDX-License-Identifier: Apache-2.0
// Plans the morphing cells of a set of photographs ([T] §2.4.1: nodes of similar rotation that span a simplex).
//
//   1. capture sites (capture_sites.h), which may lie on a grid (lattice.h)
//   2. groups of similar rotation, one photograph per site (view_groups.h)
//   3. simplices of each group (split_group.h)
//   4. choice of cells, and lines between photographs that remain apart (choose_cells.h)
//   5. after matching: cells that failed are replaced by their faces, then by edges
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
#include "ibr/author/build.h"

namespace ibr {

/// Indices into PosedModel::images, in the order of the images' names.
using CellMembers = std::vector<std::uint32_t>;

struct CellPlan {
  std::vector<CellMembers> cells;
  std::vector<BuildReport::RejectedCell> dropped;  // simplices that were refused
  std::vector<UnusedPhotograph> unused;            // photographs that are in no cell
  bool ordered = false;  // several photographs were taken from each capture site ([T] §2.4.2)
};

/// Throws Error{invalidInput} for an invalid `dimension` or `thetaDegrees`.
void checkPlanOptions(const BuildOptions& options);

class CellPlanner {
 public:
  /// Uses the options' `dimension` and `thetaDegrees`. The model must outlive the object. Throws as checkPlanOptions.
  CellPlanner(const PosedModel& model, const BuildOptions& options);

  /// The plan does not depend on the order of images or tracks, or on the world's origin, rotation and scale.
  CellPlan plan();

  /// Faces that replace failed cells. Excludes faces of made cells, faces inside one, and faces returned earlier.
  std::vector<CellMembers> replacementFaces(const std::vector<CellMembers>& failed,
                                            const std::vector<CellMembers>& made);

  /// Returns CellJudge::score (choose_cells.h).
  double score(const CellMembers& members) const;

  /// Reason why no cell was planned for a photograph, for people.
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

/// Plans the cells of a model with a temporary CellPlanner.
CellPlan planCells(const PosedModel& model, const BuildOptions& options);

}  // namespace ibr
