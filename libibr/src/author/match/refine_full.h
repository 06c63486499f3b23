// SPDX-License-Identifier: Apache-2.0
// Matches of photographs that were matched at a smaller size, made as exact as the photographs themselves: Lucas &
// Kanade (1981) at vertices only, so that memory is what the grey photographs take.
//
//   patch of 11×11 px of the first member's photograph, carried to the others along the surface that the match found
//   member i ≥ 1: a shift that makes its patch most alike the first one's, brought to the same mean and spread; held
//   by the match where texture is weak, and to the epipolar line where the poses are exact
#pragma once

#include <span>

#include "author/match/match.h"

namespace ibr {

/// Moves matched positions of members 1 …; `vertices` stay in px of the views' pictures. `full`: of each view, the
/// whole photograph in grey (1 channel), of the same shape and at least the view's size. What finds nothing better
/// stays.
void refineInFull(std::span<const MatchView> views, std::span<const Image8> full, const DenseMatch& match,
                  MatchedVertices& vertices);

}  // namespace ibr
