// SPDX-License-Identifier: Apache-2.0
// One photograph's backdrop and depth texture after another, from the depth of all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "author/build/build_input.h"
#include "author/build/cell_maker.h"
#include "author/depth/photograph_depth.h"
#include "ibr/scene.h"

namespace ibr {

inline constexpr double kBackdropBytesPerPixel = 100;  // of memory that completing a depth and its mesh take
// Of memory that a photograph's small picture and mask, matched depth, sky and evidence hold.
inline constexpr double kDepthBytesPerPixel = 10;

struct MadeBackdrop {
  MadeCell made;                    // with evidence, which is not cached
  std::filesystem::path depthFile;  // relative to the scene's folder
  double depthScale = 0;            // Node::depthScale
};

/// The world points of the photograph's tracks.
std::vector<glm::dvec3> pointsSeenBy(const BuildInput& input, std::uint32_t photograph);

class BackdropMaker {
 public:
  /// All outlive the object and do not change.
  BackdropMaker(const BuildInput& input, const BuildOptions& options, const Scene& scene);

  /// `depth`: the photograph's (depthOfPhotographs). Writes the depth texture into the scene's folder. May be called
  /// from several threads. Throws Error.
  MadeBackdrop make(std::uint32_t photograph, const PhotographDepth& depth) const;

  /// The memory that making one takes at most.
  double bytes() const;

 private:
  const BuildInput& input_;
  const BuildOptions& options_;
  std::vector<std::vector<std::size_t>> cellsWith_;  // of each photograph
  std::vector<double> sizes_;                        // of each cell: its longest edge
  double spacing_ = 1;                               // of the capture, world units
};

}  // namespace ibr
