// SPDX-License-Identifier: Apache-2.0
// Chooses the simplices of photographs that become cells ([T] §2.4.1).
//
//   accepted   axes within θ of each other, no sliver, and each pair shares enough of its points, if there are any; a
//              refused simplex is replaced by its faces, a refused face by its edges
//   pruned     faces of accepted cells; replacements whose middle lies in another cell of the group; replacement edges
//              that are not relative neighbours
//   wide       lines between photographs whose axes are more than θ apart, as in rings around an object. Added where a
//              photograph would remain alone, at the end of a chain, or unconnected, although it shares much with
//              others: between relative neighbours among the photographs that share much
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "author/graph/graph_views.h"
#include "author/graph/split_group.h"
#include "author/graph/view_relations.h"

namespace ibr {

/// Decides which simplices are suitable cells.
class CellJudge {
 public:
  /// Both must outlive the object.
  CellJudge(const Views& views, const ViewRelations& relations) : views_(views), relations_(relations) {}

  /// Returns nullopt if accepted; "" if the shape is unsuitable, which needs no report; else the reason, for people.
  std::optional<std::string> refusal(const Simplex& simplex) const;
  /// True if two photographs may form a line although their axes are more than θ apart.
  bool acceptsWide(std::uint32_t a, std::uint32_t b) const;

  const ViewRelation& between(std::uint32_t a, std::uint32_t b) const;
  /// Expected quality of a cell, 0 to 1: its shape × the least covisible share of its pairs × min(1, 0.15 / the largest
  /// disparity spread of its pairs), since a large spread hides much. Without tracks the shape alone.
  double score(const Simplex& simplex) const;

 private:
  std::optional<std::string> sharesTooLittle(std::uint32_t a, std::uint32_t b) const;

  const Views& views_;
  const ViewRelations& relations_;
};

/// True if the middle of a simplex lies in one of the cells; counts only cells of similar viewing direction.
bool liesIn(const Views& views, const Simplex& simplex, std::span<const Simplex> cells);

/// Cells from a group's split, sorted by size; refused simplices are added to `refused`, with the reason.
std::vector<Simplex> chooseCells(const Views& views, const CellJudge& judge, const ViewGroup& group, GroupSplit split,
                                 std::map<Simplex, std::string>& refused);

/// Lines to add to the cells of all groups, between photographs that would remain apart.
std::vector<Simplex> wideLines(const Views& views, const CellJudge& judge, const ViewRelations& relations,
                               const std::set<Simplex>& cells);

}  // namespace ibr
