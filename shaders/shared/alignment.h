// SPDX-License-Identifier: Apache-2.0
// Data that the optimiser's passes share, for GLSL and C++: one mesh, its images, and the parameters of a step.
#ifndef IBR_SHARED_ALIGNMENT_H
#define IBR_SHARED_ALIGNMENT_H

#include "shared/ecc.h"

IBR_SHARED_BEGIN

IBR_CONSTANT uint kAlignmentGroup = 64u;     // lanes: candidates of a point, or points that are scored in place
IBR_CONSTANT uint kAlignmentMembers = 4u;    // maximum number of images
IBR_CONSTANT uint kAlignmentInstances = 256u;
IBR_CONSTANT uint kAlignmentSurvivors = 8u;       // candidates that pruning keeps, beside the first
IBR_CONSTANT uint kAlignmentPruneRows = 8u;       // pruning scores one of so many rows

IBR_CONSTANT uint kBorderInterior = 0u;
IBR_CONSTANT uint kBorderSlides = 1u;
IBR_CONSTANT uint kBorderFixed = 2u;

// Storage buffers.
IBR_CONSTANT int kBindingAlignment = 0;   // AlignmentMesh
IBR_CONSTANT int kBindingTexels = 1;      // uint, image by image (optimise/texels.h)
IBR_CONSTANT int kBindingPositions = 2;   // ivec2, image by image; moves write it
IBR_CONSTANT int kBindingStarFirst = 3;   // uint, n + 1
IBR_CONSTANT int kBindingStarEdges = 4;   // uvec2
IBR_CONSTANT int kBindingKeptFirst = 5;   // uint, n + 1
IBR_CONSTANT int kBindingKeptEdges = 6;   // uvec3: corners, bit mask of the images in which the edge counts
IBR_CONSTANT int kBindingBorder = 7;      // uvec3 per point: ends of the chord, kind
IBR_CONSTANT int kBindingPoints = 8;      // uint: class by class
IBR_CONSTANT int kBindingOutcomes = 9;    // AlignmentOutcome of each point of a step
IBR_CONSTANT int kBindingJudgements = 10;  // AlignmentJudgement, image by image
IBR_CONSTANT int kBindingStarts = 11;      // ivec2, image by image: positions before the first cycle
IBR_CONSTANT int kAlignmentBindings = 12;

// The paper's method: a second set, for a source and a target image.
IBR_CONSTANT int kBindingSource = 0;    // image, sampled
IBR_CONSTANT int kBindingTarget = 1;
IBR_CONSTANT int kBindingSumsOf = 2;    // int64_t: six sums per slot, x, y, xx, yy, xy, n ([T] §3.5); slots of one
                                        // candidate are consecutive

/// Returns the number of slots per candidate: one in all, or one per target and channel.
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

/// Result of a step for one point.
struct AlignmentOutcome {
  ivec2 offset;       // displacement of the point, 1/128 px
  uint mutations;     // number of scored candidates
  uint unused;
  int64_t pixels;     // number of compared pixels
};

struct AlignmentJudgement {
  EccTarget targets[3];
  int64_t whole;  // 0: the star cannot be scored
};

/// Push constants.
struct AlignmentStep {
  uint member;
  uint first;         // index of the first point in the list; raster: the point
  int radius;         // R, 1/128 px; raster: largest displacement of the point
  uint seed;          // of the cycle
  uint instances;     // M
  uint scaled;        // 1: M′ = M·r²/R²
  uint definition;
  uint prune;
  uint firstOutcome;
  uint target;        // raster: target image of the draw
  int64_t floor;     // variance floor, 2⁻¹⁶ grey²
  int64_t rigidity;  // 2⁻¹⁶ grey² / px²
};

IBR_SHARED_END

#endif
