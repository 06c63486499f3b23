// SPDX-License-Identifier: Apache-2.0
// Depth of a build's photographs and of its panoramas' faces, each swept against all that see the same places and, as
// DepthSearch asks, refined in pictures of twice the size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "author/build/build_input.h"
#include "author/depth/depth_views.h"
#include "author/depth/photograph_sweep.h"
#include "author/jobs/build_jobs.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// The size at which a view's depth is matched: half of that of matchedCamera, at most backdropSize.
glm::ivec2 sweptSize(const Intrinsics& stored);
/// Sides of the pictures that DepthSearch::fast sweeps, of those of sweptSize.
inline constexpr double kFastSides = 0.5;
/// Sides of the pictures that depth is refined in, in those of sweptSize, if the photograph is as large.
inline constexpr int kFinerSides = 2;
/// Pixels of a view's depth, at most, by those that it is swept at.
inline int finerPixels(DepthSearch depth) {
  return depth == DepthSearch::fine ? kFinerSides * kFinerSides : 1;
}
/// Bytes that are held of a view by the pixel of that size, at most: grey pictures and masks.
inline constexpr double kHeldBytesPerPixel = 10;

/// The memory that it takes at most to read the pictures of a photograph's views, bytes.
double bytesToReadViews(const Photograph& photograph);

class DepthMatcher {
 public:
  /// Reads the photographs. `kept`: folder of the finished depth. `input` must outlive the object. Throws as
  /// loadPhotograph and BuildJobs::runAll do.
  DepthMatcher(const BuildInput& input, DepthSearch search, std::filesystem::path kept, const BuildJobs& jobs);

  /// Of one of the photographs' depthViews(), at sweptSize(); DepthSearch::fine: kFinerSides of it. nullopt where no
  /// other view sees the same places. Finished depth is kept as cells are. Any number of threads.
  std::optional<SweptDepth> match(std::size_t view) const;

  /// Memory that `match` takes at most, bytes, beside what is held of each photograph from the beginning on.
  double bytesToMatch() const;

 private:
  struct Picture {
    Camera camera;
    Image8 grey, mask;  // mask: empty without one

    SweepView view() const;
  };
  void readViews(const Photograph& photograph, std::size_t first);

  // Inverse depths of what a view sees, along its axis.
  std::vector<double> tracksSeenBy(std::size_t view) const;
  bool isRefined() const { return search_ >= DepthSearch::refined; }
  static std::vector<SweepView> viewsOf(const std::vector<Picture>& pictures, std::span<const std::uint32_t> which);
  std::uint64_t keyOf(std::size_t view, const std::vector<std::uint32_t>& sources, SweepRange range) const;

  const BuildInput& input_;
  DepthSearch search_;
  std::filesystem::path kept_;
  PosedModel model_;  // the input's; photographs without tracks have assumed ones
  std::vector<std::vector<std::uint32_t>> tracksOf_;
  std::vector<DepthView> views_;
  bool fromInfinity_ = false;          // most views of the scene reach it: those that look up at roofs see the sky too
  std::vector<Picture> small_, fine_;  // of the views: to sweep, and to refine (isRefined)
};

}  // namespace ibr
