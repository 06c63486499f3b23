// SPDX-License-Identifier: Apache-2.0
// Aligns the photographs inside the triangles of a morphing mesh ([T] chapter 3): points move within each picture until
// the enhanced correlation coefficient (ECC) of the triangles around them rises no more.
//
// A star is a point with its triangles. It is judged at the morph half-way between the picture in which the point moves
// (the source) and each other picture (a target): every pixel centre of the mean of the two meshes is one sample of
// both photographs ([T] §3.6). Everything is counted in whole numbers, so each method gives the same sums on every
// device, bit for bit; `cpu` and `compute` give the same mesh.
//
// What it is worth: views between photographs of a street whose truth is known have 28.35 dB (PSNR, covered) as they
// were matched and 28.35 dB with exact matches: there is nothing to win. With matches off by up to 2 or 4 px they
// have 26.51 and 24.30 dB, optimised 28.24 and 28.00 (`ibr accuracy --exact --noise`, `ibr optimise --rigidity 0`, `ibr
// eval`).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "ibr/device.h"
#include "ibr/ecc.h"
#include "ibr/image.h"
#include "ibr/log.h"

namespace ibr {

/// Positions are whole numbers of 1/128 px, so that the mean of two pictures stands on 1/256 px and no sign of an area
/// is ever rounded.
inline constexpr int kAlignmentUnitsPerPixel = 128;

/// A point that the optimiser added: where it was put, in every picture, is the weighted mean of points before it.
struct InsertedPoint {
  glm::uvec3 parent;
  glm::dvec3 weight;  // sum 1
};

/// One cell as the optimiser sees it: d pictures and a mesh of n points over them; poses are no concern of it.
struct Alignment {
  std::vector<const Image8*> pictures;  // d, 2 to 4; RGB, at most 16384 px wide and high; they outlive the run
  std::vector<std::vector<glm::ivec2>> position;  // d × n, 1/128 px from the picture's top-left corner, inside it
  std::vector<glm::uvec3> triangles;              // that are judged; twice their area is positive in all pictures
  std::vector<glm::uvec3> kept;                   // not judged, but where one is not folded over, it stays so
  std::vector<std::uint8_t> fixed;                // n, or none: points that must not move
  /// d × n, or none: unit direction in which a match may slide, its epipolar line's; (0, 0) = any. Of `gradient`.
  std::vector<std::vector<glm::vec2>> epipolar;
  std::vector<InsertedPoint> inserted;  // the last points, in their order; align() appends to it
};

enum class AlignmentMethod : std::uint8_t {
  raster,    // the paper's: instances drawn by the rasteriser, one point after another
  compute,   // one lane a candidate, points that share no triangle at once, the winner chosen on the device
  cpu,       // the same on the processor
  gradient,  // forward-additive ECC on the displacement after few candidates at random (processor)
};

/// Asked for each point that moved: whether its match in all pictures (`position[i]`, 1/128 px) can stand. What it
/// refuses is taken back. Called from the thread that runs the optimiser. Of points that are inserted, from the number
/// on that there were, it is asked before anything else is known of them, and of some that do not stay.
using AlignmentGuard = std::function<bool(std::uint32_t point, std::span<const glm::ivec2> position)>;

/// Defaults are the paper's ([T] §3.8.1) where it has the setting.
struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::compute;
  EccDefinition definition = EccDefinition::channels;
  int instances = 64;         // M, candidates a point, the first of them where it stands; 2 to 256
  double radiusPx = 5;        // R, largest way of a candidate in the first cycle; (0, 64]
  double decay = 0.5;         // D, of R from cycle to cycle; (0, 1]
  double threshold = 0.005;   // t, relative gain of a cycle below which it was the last; >= 0
  int mostCycles = 50;        // >= 1
  double varianceFloor = 25;  // grey², of the definition `channels`; [0, 1000]
  /// grey²/px², of the definition `channels`; [0, 10000]. A match that stands d px from where it began must explain
  /// rigidity·d² more of the photographs' variance, a sample and channel: where there is no texture it stays. On two
  /// cells of a street whose truth is known (gradient) the share of vertices more than 3 px off is .15 before, .27
  /// after with 0, .16 with 1; mean ECC is .876 before, .922 and .915 after. The paper has no such thing: 0.
  double rigidity = 1;
  bool prune = false;           // compute, cpu: all candidates on every 8th row, the best 8 of them whole
  bool scaledInstances = true;  // M′ = M·r²/R² ([T] §3.7), at least 8
  int levels = 1;               // gradient: of the scale space, one a cycle, the pictures themselves last; 1 to 8
  int escape = 12;              // gradient: candidates at random before a step; 0 to 256
  /// gradient: as rigidity, of the distance off the line along which the match may slide (Alignment::epipolar).
  double epipolarWeight = 0;
  /// After each cycle over the pictures themselves, edges are flipped where the ECC of the two triangles beside them
  /// rises by flipGain, or by more where they have few pixels.
  bool flipEdges = false;
  double flipGain = 0.005;  // [0, 1]
  /// After each cycle over the pictures themselves, points are inserted into triangles whose ECC is below insertBelow,
  /// with 50 samples or more and more variance than varianceFloor, where the ECC of the triangles around the point then
  /// rises by insertGain, or by more where they have few pixels; insertShare of the points at most. On two cells of
  /// that street, whose meshes are fine already, .6 % come with a gain of .002, and held-out views gain .004 dB. Under
  /// strong noise (16 levels) some come that only fit it.
  bool insertPoints = false;
  double insertBelow = 0.95;  // [-1, 1]
  double insertGain = 0.005;  // [0, 1]
  double insertShare = 0.25;  // [0, 4]
  std::uint64_t seed = 1;     // same alignment, options and seed: same mesh
  int threads = 0;            // of the processor; 0 = all cores
  AlignmentGuard guard;       // none: nothing is refused
};

/// Faults of the values above, for people; empty when there is none.
std::string optionsFault(const AlignmentOptions& options);

struct AlignmentCycle {
  double radiusPx = 0;          // R
  double ecc = 0;               // mean over points and pictures after the cycle, in the options' definition
  std::uint64_t mutations = 0;  // candidates that were judged
  std::uint64_t pixels = 0;     // pairs of samples that were compared for them
  std::size_t moved = 0;        // points, a picture each
  std::size_t refused = 0;      // by the guard
  double seconds = 0;
  std::size_t flipped = 0;   // edges
  std::size_t inserted = 0;  // points
};

/// Means over all stars and pictures, of the points that there were, so that they can be compared; a star whose ECC is
/// undefined (no texture) counts as 0, as in the paper.
struct AlignmentSummary {
  double initialEcc = 0, finalEcc = 0;            // per channel and target
  double initialEccPaper = 0, finalEccPaper = 0;  // [T] eqs 1–3
  /// Of each point of the alignment as it is then, per channel and target, mean over the pictures; NaN: no star, or
  /// (before) inserted.
  std::vector<float> starEccBefore, starEccAfter;
  std::vector<AlignmentCycle> cycles;
  std::size_t bestCycle = 0;   // that the mesh is of; 0 = before the first
  std::size_t flips = 0;       // of edges, until then
  std::size_t insertions = 0;  // of points, until then
  double seconds = 0;
};

/// Moves the points of `alignment`. No triangle folds over in a picture or in a mean of two or all of them; points of
/// the border move along it. The mesh of the best cycle stays. With flipEdges `triangles` change in place: as many as
/// before, of the same points, over the same area; a new one has the index of an old one beside it. With insertPoints
/// there are more points and triangles (Alignment::inserted): new points come last, of triangles those that have no old
/// one's index; edges with a triangle on one side alone, or with a kept one, stay whole. `device` is needed
/// for raster and compute, which submit to its queue and wait; it needs shaderInt64 and, for raster, 64-bit buffer
/// atomics. Throws Error (invalidInput, unsupported, deviceLost, outOfMemory, cancelled by `progress`); then
/// `alignment` is as it was.
AlignmentSummary align(Alignment& alignment, const AlignmentOptions& options, const Device* device = nullptr,
                       const ProgressCallback& progress = {});

}  // namespace ibr
