// SPDX-License-Identifier: Apache-2.0
// Refines matches found at a smaller size to the accuracy of the full-size photographs: Lucas & Kanade (1981), at
// vertices only, so that memory is that of the grey photographs.
//
//   A patch of 11×11 px of the first member's photograph is mapped to the others along the matched surface. In each
//   member i ≥ 1 a shift maximises the similarity to the first patch, after normalising mean and spread. The match is
//   the prior where texture is weak; exact poses also hold the shift near the epipolar line.
#pragma once

#include <span>

#include "author/match/match.h"

namespace ibr {

/// Moves matched positions of members 1 …; `vertices` stay in px of the views' images. `full`: for each view the
/// full-size photograph in grey (1 channel), of the same shape and at least the view's size. Vertices without an
/// improvement are kept.
void refineAtFullSize(std::span<const MatchView> views, std::span<const Image8> full, const DenseMatch& match,
                      MatchedVertices& vertices);

}  // namespace ibr
