// SPDX-License-Identifier: Apache-2.0
// Depth of a build's pinhole photographs, each swept against all that see the same places, and refined in pictures of
// twice the size.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_sweep.h"
#include "author/jobs/build_jobs.h"
#include "ibr/image.h"

namespace ibr {

/// Bytes that are held of a photograph by the pixel of its depth: grey pictures and masks.
inline constexpr double kHeldBytesPerPixel = 10;

class DepthMatcher {
 public:
  /// Reads the photographs. `input` and `options` must outlive the object. Throws as loadPhotograph and
  /// BuildJobs::runAll do.
  DepthMatcher(const BuildInput& input, const BuildOptions& options, const BuildJobs& jobs);

  /// Of half the size at which photographs are matched, and at most backdropSize. nullopt of panoramas, and where no
  /// other photograph sees the same places. Finished depth is kept as cells are. Any number of threads.
  std::optional<SweptDepth> match(std::uint32_t photograph) const;

  /// Memory that `match` takes at most, bytes, beside what is held of each photograph from the beginning on.
  double bytesToMatch() const;

 private:
  struct Picture {
    Camera camera;
    Image8 grey, mask;  // empty: of a panorama; without a mask

    SweepView view() const;
  };
  static Picture pictureOf(const Photograph& photograph, const Image8& colours, glm::ivec2 size, int window);

  std::uint64_t keyOf(std::uint32_t photograph, const std::vector<std::uint32_t>& sources,
                      const std::vector<double>& trackInverseDepths) const;

  const BuildInput& input_;
  const BuildOptions& options_;
  std::vector<Camera> cameras_;        // of the photographs as they are stored
  std::vector<Picture> small_, fine_;  // to sweep, and to refine
};

}  // namespace ibr
