// SPDX-License-Identifier: Apache-2.0
// The matching methods side by side, on pairs and cells of which some truth is known. Needs ibr::author.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author.h"

namespace ibr {

/// 2 to 4 photographs to match. At most one kind of truth.
struct MatchCase {
  std::string name;
  std::vector<std::filesystem::path> images;
  std::filesystem::path model;       // COLMAP; its images are found by their files' names. Empty: no poses
  std::filesystem::path disparity;   // of a rectified pair: 8 bits, px to the left, 0 = unknown
  std::filesystem::path homography;  // from the first photograph to the second: OpenCV's XML
  std::filesystem::path depth;       // views with exact depth: sparse/ and depth/, 16 bits in steps of …
  double depthUnit = 0.01;           // … world units
  int maxSize = 0;                   // longest side that is matched, px; 0 = as it is
};

/// From {"cases": [{"name": …, "images": [FILE, …], "model": DIR, "disparity": FILE, …}, …]}; paths start from `data`.
/// Throws Error (io, invalidInput) with the JSON pointer of the fault.
std::vector<MatchCase> readMatchCases(const std::filesystem::path& file, const std::filesystem::path& data);

/// NaN where there is nothing to measure it by. Errors are those of the vertices of tier 0, in px of the matched
/// pictures, the worst member's.
struct MatchScore {
  std::string name;  // of the case
  MatchMethod method = MatchMethod::sweep;
  TriangleFilter filter = TriangleFilter::consistency;
  std::size_t vertices = 0;  // of triangles of tier 0
  double medianPx, within1Px, beyond3Px;
  double kept, precision;  // as MatchAccuracy; of cases with exact depth
  double coverage;         // share of the first photograph under tier 0
  double memberPsnr;       // dB over that: each two members there, after gain and offset a channel; mean over pairs
  double ecc;              // of triangles of tier 0, area-weighted, worst pair's
  double homogeneous;      // share of them whose corners share a plane
  double cpuSeconds;       // of matching and meshing, on one thread
  Image8 picture;          // the members' mean in the first one's picture; black where there is no tier 0
};

/// One for each method and filter: the sweep (only with poses), flow, homographic, homographic with the homogeneous
/// filter. Throws Error (io, invalidInput).
std::vector<MatchScore> compareMethods(const MatchCase& which, std::uint64_t seed = 1);

}  // namespace ibr
