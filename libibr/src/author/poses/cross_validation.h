// SPDX-License-Identifier: Apache-2.0
// Whether cameras that were fitted to some points suit others better than they did before.
//
// Every fit suits the points that it was made with. So the points are parted in two halves: cameras that are fitted to
// one are asked about the other. Neighbours err alike, and one place is found from several photographs: halves are made
// of patches, all points in one direction from the middle of the cameras, and what a patch says counts once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/poses/bundle_adjust.h"

namespace ibr {

/// Of each point: the number of its patch, about a twelfth of a photograph wide. Half of them are even, half odd.
/// Cameras are pinholes.
std::vector<std::uint32_t> patchesOf(std::span<const Camera> cameras, std::span<const BundlePoint> points);

/// With poses and intrinsics that stay: bundle adjustment then only places points.
std::vector<BundleCamera> still(std::span<const BundleCamera> cameras);

/// How badly each point suits the cameras where it suits them best: Cauchy's loss of the scale `px`, summed over those
/// that see it; 0 for points that count nothing in a bundle adjustment, and up to 0.01 px, for numbers are rounded.
std::vector<double> costsOf(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points, double px);

/// By how many standard errors the costs' sum went down, patches being taken for independent: beyond 3, hardly by
/// chance. NaN where fewer than 8 patches cost anything.
double significance(std::span<const double> before, std::span<const double> after,
                    std::span<const std::uint32_t> patches);

}  // namespace ibr
