// SPDX-License-Identifier: Apache-2.0
// One photograph's backdrop after another, from what the cells found in it (tier 2).
#pragma once

#include <cstdint>
#include <vector>

#include "author/build/build_input.h"
#include "author/build/cell_maker.h"
#include "author/depth/photograph_depth.h"
#include "ibr/scene.h"

namespace ibr {

inline constexpr double kBackdropBytesPerPixel = 100;  // of memory that completing a depth and its mesh take

class BackdropMaker {
 public:
  /// `keys`: what the scene's cells were kept under. All outlive the object and do not change.
  BackdropMaker(const BuildInput& input, const BuildOptions& options, const Scene& scene,
                const std::vector<std::uint64_t>& keys);

  /// Depth of a photograph as the cells show it, of backdropSize; where it is in no cell, as its tracks say. Like
  /// make(): the photograph is no panorama, any thread may call, throws Error.
  ImageF depthOf(std::uint32_t photograph) const;

  struct Made {
    MadeCell backdrop;  // with the evidence in its mesh
    DepthTexture depth;
  };
  /// `known`: depthOf() the photograph; `evidence`: what the others say of it.
  Made make(std::uint32_t photograph, const ImageF& known, const DepthEvidence& evidence) const;

  /// The memory that making one takes at most.
  double bytes() const;

 private:
  const BuildInput& input_;
  const BuildOptions& options_;
  const Scene& scene_;
  std::vector<glm::dvec3> pointsOf(std::uint32_t photograph) const;  // where it is in no cell

  const std::vector<std::uint64_t>& keys_;
  std::vector<std::vector<std::size_t>> cellsWith_;  // of each photograph
  std::vector<double> sizes_;                        // of each cell: its longest edge
  double spacing_ = 1;                               // of the capture, world units
};

}  // namespace ibr
