// SPDX-License-Identifier: Apache-2.0
// What the passes of the optimiser share in memory, for GLSL and C++: one mesh, its pictures, and what a step does.
#ifndef IBR_SHARED_ALIGNMENT_H
#define IBR_SHARED_ALIGNMENT_H

#include "shared/ecc.h"

IBR_SHARED_BEGIN

IBR_CONSTANT uint kAlignmentGroup = 64u;     // lanes: candidates of a point, or points where they stand
IBR_CONSTANT uint kAlignmentMembers = 4u;    // most pictures
IBR_CONSTANT uint kAlignmentInstances = 256u;
IBR_CONSTANT uint kAlignmentLeft = 8u;       // candidates that pruning leaves, beside the first
IBR_CONSTANT uint kAlignmentRows = 8u;       // rows of which one is looked at to prune

IBR_CONSTANT uint kBorderInterior = 0u;
IBR_CONSTANT uint kBorderSlides = 1u;
IBR_CONSTANT uint kBorderFixed = 2u;

// Storage buffers.
IBR_CONSTANT int kBindingAlignment = 0;   // AlignmentMesh
IBR_CONSTANT int kBindingTexels = 1;      // uint, picture after picture (optimise/texels.h)
IBR_CONSTANT int kBindingPositions = 2;   // ivec2, picture after picture: written by moves
IBR_CONSTANT int kBindingStarFirst = 3;   // uint, n + 1
IBR_CONSTANT int kBindingStarEdges = 4;   // uvec2
IBR_CONSTANT int kBindingKeptFirst = 5;   // uint, n + 1
IBR_CONSTANT int kBindingKeptEdges = 6;   // uvec3: corners, and the pictures it counts in, a bit each
IBR_CONSTANT int kBindingBorder = 7;      // uvec3 a point: chord, kind
IBR_CONSTANT int kBindingPoints = 8;      // uint: classes one after another
IBR_CONSTANT int kBindingOutcomes = 9;    // AlignmentOutcome: of a step's points
IBR_CONSTANT int kBindingJudgements = 10;  // AlignmentJudgement, picture after picture
IBR_CONSTANT int kBindingStarts = 11;      // ivec2, picture after picture: positions before the first cycle
IBR_CONSTANT int kAlignmentBindings = 12;

// The paper's way: a second set, of a source and a target.
IBR_CONSTANT int kBindingSource = 0;    // pictures, sampled
IBR_CONSTANT int kBindingTarget = 1;
IBR_CONSTANT int kBindingSumsOf = 2;    // int64_t: six sums a slot, x, y, xx, yy, xy, n ([T] §3.5); slots of a candidate
                                        // one after another

/// Slots of a candidate: one in all, or one a target and channel.
IBR_FUNCTION uint eccSlots(uint definition, uint members) {
  return definition == kEccConcatenated ? 1u : 3u * (members - 1u);
}
IBR_CONSTANT uint kEccSums = 6u;

struct AlignmentPicture {
  ivec2 size;        // px
  uint firstTexel;   // of texel (−1, −1)
  uint stride;
};

struct AlignmentMesh {
  uint members, points;
  AlignmentPicture pictures[4];
};

/// What became of a point in a step.
struct AlignmentOutcome {
  ivec2 offset;       // by which it has been moved
  uint mutations;     // candidates that were judged
  uint unused;
  int64_t pixels;     // that were compared
};

struct AlignmentJudgement {
  EccTarget targets[3];
  int64_t whole;  // 0: cannot be judged
};

/// Push constants.
struct AlignmentStep {
  uint member;
  uint first;         // of the points, in their list; raster: the point
  int radius;         // R, 1/128 px; raster: how far the point may go
  uint seed;          // of the cycle
  uint instances;     // M
  uint scaled;        // 1: M′ = M·r²/R²
  uint definition;
  uint prune;
  uint firstOutcome;
  uint target;        // raster: picture, of the draw
  int64_t floor;     // variance floor, 2⁻¹⁶ grey²
  int64_t rigidity;  // 2⁻¹⁶ grey² / px²
};

IBR_SHARED_END

#endif
