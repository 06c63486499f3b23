// SPDX-License-Identifier: Apache-2.0
// Comparison of the matching methods on pairs and cells with ground truth. Needs ibr::author.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author/build.h"

namespace ibr {

/// 2 to 4 photographs to match, with at most one kind of ground truth: disparity, homography or depth.
struct MatchCase {
  std::string name;
  std::vector<std::filesystem::path> images;
  std::filesystem::path model;       // COLMAP model folder; images are found by file name. Empty: no poses
  std::filesystem::path disparity;   // of a rectified pair: 8 bits, px to the left, 0: unknown
  std::filesystem::path homography;  // of a pair, from the first photograph to the second: OpenCV's XML
  std::filesystem::path depth;       // folder of views with exact depth: sparse/ (COLMAP), depth/NAME.png (16 bits)
  double depthUnit = 0.01;           // world units of a step in depth/NAME.png
  int maxSize = 0;                   // longest side of the matched images, px; 0: unchanged
};

/// Reads {"cases": [{"name": …, "images": [FILE, …], "model": DIR, "disparity": FILE, …}, …]}; keys are the fields of
/// MatchCase, and paths are relative to `data`. Throws Error (io, invalidInput) with the JSON pointer of the fault.
std::vector<MatchCase> readMatchCases(const std::filesystem::path& file, const std::filesystem::path& data);

/// Score of a method and a filter. NaN: not measured. Errors are those of tier 0's vertices in the worst member, in px
/// of the matched images.
struct MatchScore {
  std::string name;  // of the case
  MatchMethod method = MatchMethod::sweep;
  TriangleFilter filter = TriangleFilter::consistency;
  std::size_t vertices = 0;               // of triangles of tier 0
  double medianPx, within1Px, beyond3Px;  // median error; shares of errors up to 1 px, above 3 px
  // MatchAccuracy's coVisibleTier0 / coVisible and correctTier0 / tier0; of cases with exact depth.
  double completeness, precision;
  double coverage;     // share of the first photograph under tier 0
  double memberPsnr;   // dB between each two members in tier 0, after gain and offset a channel; mean over pairs
  double ecc;          // of triangles of tier 0: worst pair's, area-weighted mean
  double homogeneous;  // share of tier 0's triangles whose corners share a plane
  double cpuSeconds;   // of matching and meshing, on one thread
  Image8 picture;      // mean of the members, warped to the first one; black outside tier 0
};

/// Returns a score for each method and filter: sweep (only with poses), flow, homographic, and homographic with the
/// homogeneous filter. Only one call may run at a time: OpenCV then uses one thread in the whole process. Throws Error
/// (io, invalidInput).
std::vector<MatchScore> compareMatchMethods(const MatchCase& which, std::uint64_t seed = 1);

}  // namespace ibr
