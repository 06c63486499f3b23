// SPDX-License-Identifier: Apache-2.0
// Depth of a build's photographs and of its panoramas' faces. Each view is swept against all that overlap it and,
// depending on DepthSearch, refined at twice the size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "author/build/build_input.h"
#include "author/build/sweep_plan.h"
#include "author/depth/depth_views.h"
#include "author/depth/photograph_sweep.h"
#include "author/jobs/build_jobs.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// Sides of the images that DepthSearch::fast sweeps, relative to sweptSize.
inline constexpr double kFastScale = 0.5;
/// Sides of the images that refine depth, relative to sweptSize, if the photograph is that large.
inline constexpr int kFineScale = 2;
/// Max number of depth pixels per swept pixel.
inline int finePixelFactor(DepthSearch depth) {
  return depth == DepthSearch::fine ? kFineScale * kFineScale : 1;
}
/// Max memory held for a view, bytes per pixel of sweptSize: grey images and masks.
inline constexpr double kViewBytesPerPixel = 10;

/// Peak memory of reading the images of a photograph's views, bytes.
double bytesToReadViews(const Photograph& photograph);

class DepthMatcher {
 public:
  /// Reads the photographs. `cacheFolder`: of depth maps. `input` must outlive the object. Throws as loadPhotograph and
  /// BuildJobs::runAll do.
  DepthMatcher(const BuildInput& input, DepthSearch search, std::filesystem::path cacheFolder, const BuildJobs& jobs);
  DepthMatcher(const DepthMatcher&) = delete;
  DepthMatcher& operator=(const DepthMatcher&) = delete;

  /// Depth of one of the photographs' depthViews(), at sweptSize() (DepthSearch::fine: kFineScale times that). Returns
  /// nullopt if no other view overlaps. Uses the cache. Thread-safe.
  std::optional<SweptDepth> match(std::size_t view) const;

  /// Peak memory of `match`, bytes, in addition to the data held of each photograph from the beginning.
  double bytesToMatch() const;

 private:
  struct ViewImages {
    Camera camera;
    Image8 grey, mask;  // mask: empty if there is none

    SweepView view() const;
  };
  void readViews(const Photograph& photograph, std::size_t first);

  bool isRefined() const { return search_ >= DepthSearch::refined; }
  static std::vector<SweepView> viewsOf(const std::vector<ViewImages>& pictures, std::span<const std::uint32_t> which);
  std::uint64_t keyOf(std::size_t view, const std::vector<std::uint32_t>& sources, SweepRange range) const;

  const BuildInput& input_;
  DepthSearch search_;
  std::filesystem::path cacheFolder_;
  SweepPlan plan_;
  const std::vector<DepthView>& views_ = plan_.views();
  std::vector<ViewImages> sweptImages_, refinedImages_;  // of the views: to sweep, and to refine (if isRefined)
};

}  // namespace ibr
