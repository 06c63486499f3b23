// SPDX-License-Identifier: Apache-2.0
// Tests whether cameras that were fitted to some points also fit other points better than before.
//
// Every fit suits the points that were fitted. So the points are split in two halves: cameras fitted to one half are
// tested on the other. Errors of neighbours are correlated: halves consist of patches, which are directions from the
// cameras' mean centre, and a patch counts as one independent sample.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/poses/bundle_adjust.h"

namespace ibr {

/// Returns each point's patch number; a patch is about a twelfth of a photograph wide. Half of the numbers are even,
/// half odd. Cameras are pinholes.
std::vector<std::uint32_t> patchesOf(std::span<const Camera> cameras, std::span<const BundlePoint> points);

/// Returns the cameras with fixed poses and intrinsics: bundle adjustment then only triangulates points.
std::vector<BundleCamera> withFixedCameras(std::span<const BundleCamera> cameras);

/// Returns each point's cost at its best position: Cauchy's loss of scale `px`, summed over its observations. Errors up
/// to 0.01 px cost nothing, since numbers are rounded; points that a bundle adjustment does not count cost 0.
std::vector<double> costsOf(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points, double px);

/// Returns the decrease of the costs' sum in standard errors, with patches taken as independent: above 3, hardly by
/// chance. NaN if fewer than 8 patches have a cost.
double significance(std::span<const double> before, std::span<const double> after,
                    std::span<const std::uint32_t> patches);

}  // namespace ibr
