// SPDX-License-Identifier: Apache-2.0
// Which simplices of photographs become cells ([T] §2.4.1).
//
//   accepted   axes within θ of each other, no sliver, and each pair shares enough of the points it sees, if there are
//              any; a refused simplex hands on its faces, those their edges
//   pruned     faces of accepted cells; handed-on ones whose middle lies in another cell of the group; handed-on edges
//              that are no relative neighbours
//   wide       where that leaves a photograph alone, at the end of a chain, or without a way to others, though it
//   shares
//              much with them (rings around an object, which turn by more than θ from one photograph to the next):
//              lines between relative neighbours of those that share much
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

/// Says which simplices are good for a cell.
class CellJudge {
 public:
  /// Both outlive the object.
  CellJudge(const Views& views, const ViewRelations& relations) : views_(views), relations_(relations) {}

  /// nullopt: accepted. "": of a shape that needs no words. Else the reason, for people.
  std::optional<std::string> refusal(const Simplex& simplex) const;
  /// Whether two photographs could make a line although their axes lie further apart than θ.
  bool acceptsWide(std::uint32_t a, std::uint32_t b) const;

  const ViewRelation& between(std::uint32_t a, std::uint32_t b) const;
  /// How good a cell is to be expected to be, 0 to 1: its shape × the poorest pair's covisible share × (the widest
  /// pair's disparity spread leaves little to see twice: .15 / spread, at most 1). Without tracks the shape alone.
  double score(const Simplex& simplex) const;

 private:
  std::optional<std::string> sharesTooLittle(std::uint32_t a, std::uint32_t b) const;

  const Views& views_;
  const ViewRelations& relations_;
};

/// Whether the middle of a simplex lies in one of some cells, of which those count that look as it does.
bool liesIn(const Views& views, const Simplex& simplex, std::span<const Simplex> cells);

/// Cells of a group out of its split, sorted by size; what was refused is added to `refused`, with the reason.
std::vector<Simplex> chooseCells(const Views& views, const CellJudge& judge, const ViewGroup& group, GroupSplit split,
                                 std::map<Simplex, std::string>& refused);

/// Lines to add to the cells of all groups.
std::vector<Simplex> wideLines(const Views& views, const CellJudge& judge, const ViewRelations& relations,
                               const std::set<Simplex>& cells);

}  // namespace ibr
