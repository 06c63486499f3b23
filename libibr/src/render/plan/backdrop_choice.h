// SPDX-License-Identifier: Apache-2.0
// Which backdrops (tier 2) are drawn. Pure.
//
//   half of them: taken nearest, of those taken in one place what looks most the same way: they look best
//   the other half: whichever shows most of the picture that those before it do not, for as long as one does: what any
//   photograph shows is not left empty because the nearest ones look past it
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

struct BackdropCandidate {
  std::uint32_t backdrop;  // of the scene
  double distance, angle;  // of its photograph from the middle of the views
};

/// At most `most` of the candidates, which are given best first, in that order. What one shows is judged at rays of a
/// grid over each view, at the distances between which most of its mesh lies.
std::vector<std::uint32_t> chooseBackdrops(const Scene& scene, const SceneBounds& bounds, std::span<const Camera> views,
                                           std::span<const BackdropCandidate> candidates, std::size_t most);

}  // namespace ibr
