// SPDX-License-Identifier: Apache-2.0
// What two photographs of a model have in common.
//
// Found through the tracks of the two when it is asked for: all pairs of a large model are never looked at.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "ibr/author.h"

namespace ibr {

struct ViewRelation {
  std::uint32_t shared = 0;    // tracks that both see
  std::uint32_t poorer = 0;    // tracks of the one that sees fewer
  double axisAngle = 0;        // between the viewing directions, radians
  double disparitySpread = 0;  // 90th less 10th percentile of the shared points' disparity, as a share of the width

  /// Of what the poorer one sees, the share that the other sees too; 0 where it sees nothing.
  double covisible() const { return poorer > 0 ? double(shared) / poorer : 0.0; }
};

class ViewRelations {
 public:
  /// Keeps a reference to the model.
  explicit ViewRelations(const PosedModel& model);

  /// Symmetric. Remembers what it found: not to be called from several threads at once.
  const ViewRelation& between(std::uint32_t a, std::uint32_t b) const;

  /// The photographs that share at least `least` tracks with one, with their number, ascending by index.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours(std::uint32_t image, std::uint32_t least) const;

  bool hasTracks() const { return !model_.tracks.empty(); }

 private:
  ViewRelation find(std::uint32_t a, std::uint32_t b) const;

  const PosedModel& model_;
  std::vector<std::vector<std::uint32_t>> tracks_;
  mutable std::unordered_map<std::uint64_t, ViewRelation> known_;
};

/// Between two directions of any length, radians; exact for small and for straight angles.
double angleBetween(glm::dvec3 a, glm::dvec3 b);

}  // namespace ibr
