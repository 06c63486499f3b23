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
  /// `sweeps`: of the depthViews() of the input's photographs; thread-safe. `cacheFolder`: of depth maps. `input` must
  /// outlive the object.
  DepthMatcher(const BuildInput& input, ViewSweeps sweeps, DepthSearch search, std::filesystem::path cacheFolder);
  DepthMatcher(const DepthMatcher&) = delete;
  DepthMatcher& operator=(const DepthMatcher&) = delete;

  /// Reads photographs for `match`. Throws as loadPhotograph and BuildJobs::runAll do.
  void read(std::span<const std::uint32_t> photographs, const BuildJobs& jobs);

  const std::vector<DepthView>& views() const { return views_; }

  /// Depth of one of the views, at sweptSize() (DepthSearch::fine: kFineScale times that). Returns
  /// nullopt if no other view overlaps. Uses the cache. Thread-safe. Precondition: the view's photograph and those of
  /// its sources are read.
  std::optional<SweptDepth> match(std::size_t view) const;

  /// Cache file of a view's depth; empty if match() returns nullopt. Thread-safe.
  std::filesystem::path cachedFile(std::size_t view) const;
  /// As `match`, but only from the cache. Throws Error{io} if the depth is not cached.
  std::optional<SweptDepth> fetch(std::size_t view) const;

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
  ViewSweeps sweeps_;
  std::vector<DepthView> views_;
  std::vector<ViewImages> sweptImages_, refinedImages_;  // of the views: to sweep, and to refine (if isRefined)
};

}  // namespace ibr
