// SPDX-License-Identifier: Apache-2.0
// Aligns the photographs inside the triangles of a morphing mesh ([T] chapter 3): moves points within each picture
// until the enhanced correlation coefficient (ECC) of the triangles around them stops rising.
//
// A star is a point with its triangles. Its ECC compares the picture in which the point moves (the source) with each
// other picture (a target), at the morph half-way between them. Every pixel centre of the mean of the two meshes is one
// sample of both photographs ([T] §3.6). All sums are integers, so each method gives bit-identical sums on every
// device; `cpu` and `compute` give the same mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "ibr/conventions.h"
#include "ibr/ecc.h"
#include "ibr/export.h"
#include "ibr/image.h"
#include "ibr/log.h"

namespace ibr {

class Device;

/// Unit of an Alignment's positions, which are integers: 1/128 px. So the mean of two positions is exact in units of
/// 1/256 px, and signs of areas are exact.
inline constexpr int kAlignmentUnitsPerPixel = 128;

/// A point that the optimiser added. In every picture it started at the weighted mean of earlier points.
struct InsertedPoint {
  glm::uvec3 parent;  // indices of the earlier points
  glm::dvec3 weight;  // weights of these points, sum 1
};

/// One cell as the optimiser sees it: d pictures and a mesh of n points over them. Poses are not used.
struct Alignment {
  std::vector<const Image8*> pictures;            // d: 2 to 4; RGB, at most 16384 px a side; must outlive the run
  std::vector<std::vector<glm::ivec2>> position;  // d × n, 1/128 px from the picture's top-left corner, inside it
  std::vector<glm::uvec3> triangles;    // triangles that are evaluated; their signed area is positive in all pictures
  std::vector<glm::uvec3> unevaluated;  // further triangles; kept from folding over where they are not folded
  std::vector<std::uint8_t> fixed;      // n, or empty; nonzero: the point must not move
  /// gradient: d × n, or empty: unit direction of the epipolar line, along which a match may slide; (0, 0) = any.
  std::vector<std::vector<glm::vec2>> epipolar;
  std::vector<InsertedPoint> inserted;  // inserted points: the last of all points, in order; align() appends to it
};

/// How candidates of a point's position are found and evaluated.
enum class AlignmentMethod : std::uint8_t {
  raster,    // the paper's: the rasteriser draws candidates as instances, one point after another
  compute,   // one lane per candidate; points that share no triangle move at once, chosen on the device
  cpu,       // the same on the CPU
  gradient,  // a step of forward-additive ECC after a few random candidates, on the CPU
};

/// Accepts or rejects the match of a point that moved, by its positions in all pictures (`position[i]`, 1/128 px).
/// False undoes the move. Called from the thread that runs the optimiser. Inserted points have new indices, from the
/// previous number of points on. The guard is called for them before Alignment::inserted has them, and also for some
/// that are then discarded.
using AlignmentGuard = std::function<bool(std::uint32_t point, std::span<const glm::ivec2> position)>;

/// Options of align(). Defaults are those of [T] §3.8.1 where the paper has the setting.
struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::compute;   // how candidates are evaluated
  EccDefinition definition = EccDefinition::channels;  // ECC that is maximised
  int instances = 64;         // M, candidates per point, including its current position; 2 to 256
  double radiusPx = 5;        // R, maximum displacement of a candidate in the first cycle; (0, 64]
  double decay = 0.5;         // D, factor of R from cycle to cycle; (0, 1]
  double threshold = 0.005;   // t, relative gain of the mean ECC at or below which a cycle is the last; >= 0
  int maxCycles = 50;         // maximum number of cycles, >= 1
  double varianceFloor = 25;  // for EccDefinition::channels, variance added to that of the samples, grey²; [0, 1000]
  /// grey²/px², for EccDefinition::channels; [0, 10000]. A match at d px from its initial position must explain
  /// rigidity·d² more of the photographs' variance, per sample and channel. So matches without texture stay. Moving
  /// back is neither charged nor rewarded. The paper has no such term: 0.
  double rigidity = 1;
  bool prune = false;           // compute, cpu: evaluate all candidates on every 8th row, then the best 8 in full
  bool scaledInstances = true;  // M′ = M·r²/R² ([T] §3.7), at least 8; r: how far the point can move
  int levels = 1;               // gradient: levels of the scale space, one per cycle, full resolution last; 1 to 8
  int escape = 12;              // gradient: random candidates before a step; 0 to 256
  /// gradient: as rigidity, for the distance from the epipolar line (Alignment::epipolar).
  double epipolarWeight = 0;
  /// Flips edges after each full-resolution cycle, where the ECC of the two adjacent triangles rises by more than
  /// flipGain. With n < 1024 samples the threshold is flipGain·32/√n.
  bool flipEdges = false;
  double flipGain = 0.005;  // minimum rise of the ECC for a flip; [0, 1]
  /// Inserts points after each full-resolution cycle, into triangles whose ECC is below insertBelow, with at least 50
  /// samples and a variance of at least varianceFloor. A point is kept if the ECC of the triangles around it rises by
  /// more than insertGain (with few samples as flipGain). At most insertShare of the initial points are inserted. Under
  /// strong noise (16 8-bit levels) some inserted points only fit the noise.
  bool insertPoints = false;
  double insertBelow = 0.95;  // ECC below which a triangle gets a point; [-1, 1]
  double insertGain = 0.005;  // minimum rise of the ECC for a point; [0, 1]
  double insertShare = 0.25;  // maximum number of inserted points, as a share of the initial ones; [0, 4]
  std::uint64_t seed = 1;     // same alignment, options and seed: same mesh
  int threads = 0;            // threads of the CPU; 0: all cores
  AlignmentGuard guard;       // accepts or rejects moves; empty: accepts all
};

/// Returns the first option out of range, for people; empty if there is none.
IBR_API std::string firstInvalidOption(const AlignmentOptions& options);

/// One cycle of align().
struct AlignmentCycle {
  double radiusPx = 0;          // R, maximum displacement of a candidate, px
  double ecc = 0;               // mean ECC over points and pictures after the cycle, by AlignmentOptions::definition
  std::uint64_t mutations = 0;  // number of evaluated candidates
  std::uint64_t pixels = 0;     // number of pairs of samples compared for these candidates
  std::size_t moved = 0;        // number of moves; a point counts once per picture
  std::size_t refused = 0;      // number of moves that the guard rejected
  double seconds = 0;           // elapsed time
  std::size_t flipped = 0;      // number of flipped edges
  std::size_t inserted = 0;     // number of inserted points
};

/// Result of align(). Mean ECCs are over all stars and pictures. Inserted points are left out, so that means are
/// comparable. A star whose ECC is undefined (no texture) counts as 0, as in the paper.
struct AlignmentSummary {
  double initialEcc = 0, finalEcc = 0;            // mean ECC before and after, by EccDefinition::channels
  double initialEccPaper = 0, finalEccPaper = 0;  // mean ECC before and after, by EccDefinition::concatenated
  /// ECC of each point of the resulting alignment before and after, by EccDefinition::channels, mean over the pictures.
  /// NaN for a point without a star, and before also for inserted points.
  std::vector<float> initialStarEcc, finalStarEcc;
  std::vector<AlignmentCycle> cycles;  // all cycles, in order
  std::size_t bestCycle = 0;           // cycle whose mesh is returned; 0 = the initial mesh
  std::size_t flips = 0;               // number of flipped edges, up to bestCycle
  std::size_t insertions = 0;          // number of inserted points, up to bestCycle
  double seconds = 0;                  // elapsed time
};

/// Moves the points of `alignment` and leaves the mesh of the best cycle. No triangle folds over in a picture or in the
/// mean of two or all of them. Border points move along the border.
///
/// flipEdges changes `triangles` in place: same number, same points, same area; the two new triangles of a flip have
/// the indices of the two old ones. insertPoints appends points (Alignment::inserted). Of each split triangle, one part
/// keeps the index; other parts are appended. Border edges and edges of an unevaluated triangle are not split.
///
/// raster and compute need `device`, submit to its queue and wait. They need Device::supportsInt64, raster also
/// Device::supportsInt64Atomics. Throws Error (invalidInput, unsupported, deviceLost, outOfMemory, cancelled by
/// `progress`); then `alignment` is unchanged.
IBR_API AlignmentSummary align(Alignment& alignment, const AlignmentOptions& options, const Device* device = nullptr,
                               const ProgressCallback& progress = {});

}  // namespace ibr
