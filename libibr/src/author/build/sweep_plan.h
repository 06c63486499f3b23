// SPDX-License-Identifier: Apache-2.0
// Sources and range of depths of each view's sweep, from the tracks. Reads no photographs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "author/build/build_input.h"
#include "author/depth/depth_views.h"
#include "author/depth/photograph_sweep.h"

namespace ibr {

/// Size at which a view's depth is matched: half of that of matchedCamera, at most backdropSize.
glm::ivec2 sweptSize(const Intrinsics& stored);

struct ViewSweep {
  std::vector<std::uint32_t> sources;  // other views
  SweepRange range;
};

/// Sweep of each view; nullopt if the view sees no tracks, or no other view overlaps.
using ViewSweeps = std::function<std::optional<ViewSweep>(std::size_t view)>;

/// Immutable, hence thread-safe.
class SweepPlan {
 public:
  explicit SweepPlan(const BuildInput& input);

  const std::vector<DepthView>& views() const { return views_; }
  /// As ViewSweeps.
  std::optional<ViewSweep> sweep(std::size_t view) const;
  /// Number of levels of the view's sweep; 0 without one.
  int levels(std::size_t view) const;

 private:
  // Inverse depths of the tracks that a view sees, along its axis.
  std::vector<double> tracksSeenBy(std::size_t view) const;

  PosedModel model_;  // the input's model; photographs without tracks get assumed ones
  std::vector<std::vector<std::uint32_t>> tracksOf_;
  std::vector<DepthView> views_;
  bool fromInfinity_ = false;  // all sweeps start at infinity (mostReachInfinity)
};

}  // namespace ibr
