// SPDX-License-Identifier: Apache-2.0
// Makes the backdrop and the depth texture of one photograph at a time, from the depth maps of all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "author/build/build_input.h"
#include "author/build/cell_maker.h"
#include "author/depth/photograph_depth.h"
#include "ibr/scene.h"

namespace ibr {

inline constexpr double kBackdropBytesPerPixel = 100;  // memory for completing a depth map and meshing it
// Memory for a photograph's scaled image and mask, matched depth, sky and evidence.
inline constexpr double kDepthBytesPerPixel = 10;

struct BackdropResult {
  CellResult made;                  // with evidence, which is not cached
  std::filesystem::path depthFile;  // relative to the scene's folder
  double depthScale = 0;            // Node::depthScale
};

/// World points of the photograph's tracks.
std::vector<glm::dvec3> pointsSeenBy(const BuildInput& input, std::uint32_t photograph);

class BackdropMaker {
 public:
  /// All arguments must outlive the object and must not change.
  BackdropMaker(const BuildInput& input, const BuildOptions& options, const Scene& scene);

  /// `depth`: the photograph's (depthOfPhotographs). Writes the depth texture into the scene's folder. Thread-safe.
  /// Throws Error.
  BackdropResult make(std::uint32_t photograph, const PhotographDepth& depth) const;

  /// Peak memory of one make(), bytes.
  double bytes() const;

 private:
  const BuildInput& input_;
  const BuildOptions& options_;
  std::vector<std::vector<std::size_t>> cellsWith_;  // cells of each photograph
  std::vector<double> sizes_;                        // longest edge of each cell, world units
  double spacing_ = 1;                               // of the capture sites, world units
};

}  // namespace ibr
