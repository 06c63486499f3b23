// SPDX-License-Identifier: Apache-2.0
// Relations of two photographs of a model: shared tracks and disparities.
//
// Computed from the tracks of the two on request: the pairs of a large model are never all evaluated.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "ibr/author/poses.h"

namespace ibr {

struct ViewRelation {
  std::uint32_t shared = 0;       // tracks that both observe
  std::uint32_t fewerTracks = 0;  // tracks of the photograph with fewer
  double axisAngle = 0;           // between the viewing directions, radians
  double disparitySpread = 0;     // 90 % minus 10 % quantile of the shared points' disparity, in image widths

  /// Share of the tracks of the photograph with fewer that the other one observes too; 0 without tracks.
  double covisible() const { return fewerTracks > 0 ? double(shared) / fewerTracks : 0.0; }
};

class ViewRelations {
 public:
  /// Keeps a reference to the model.
  explicit ViewRelations(const PosedModel& model);

  /// Symmetric. Caches results: not thread-safe.
  const ViewRelation& between(std::uint32_t a, std::uint32_t b) const;

  /// Photographs that share at least `least` tracks with `image`, with the number of tracks, ascending by index.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours(std::uint32_t image, std::uint32_t least) const;

  bool hasTracks() const { return !model_.tracks.empty(); }

 private:
  ViewRelation find(std::uint32_t a, std::uint32_t b) const;

  const PosedModel& model_;
  std::vector<std::vector<std::uint32_t>> tracks_;
  mutable std::unordered_map<std::uint64_t, ViewRelation> known_;
};

/// Angle between two directions of any length, radians; accurate for small and for straight angles.
double angleBetween(glm::dvec3 a, glm::dvec3 b);

}  // namespace ibr
