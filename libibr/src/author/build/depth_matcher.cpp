// SPDX-License-Identifier: Apache-2.0
#include "author/build/depth_matcher.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "author/depth/depth_sources.h"
#include "author/depth/refined_depth.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/cached_file.h"
#include "author/jobs/cached_values.h"
#include "author/photographs/masks.h"
#include "base/check.h"
#include "ibr/author/panorama.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 8;   // of the algorithm: raise when depth changes
constexpr const char* kKind = "depth";  // of cache files
constexpr int kRefinedWindow = 5;       // px of the refined image: half a patch, plus 1 for interpolation

// A photograph's image and mask as one of its views sees them, at any size.
class LoadedPhotograph {
 public:
  explicit LoadedPhotograph(const Photograph& photograph)
      : photograph_(photograph), colours_(loadPhotograph(photograph)), mask_(storedMask(photograph)) {
    if (!isPanorama(photograph)) return;
    sphere_.emplace(colours_);
    if (!mask_.empty()) sphereMask_.emplace(mask_);
  }

  Image8 colours(const Camera& camera) const {
    const Intrinsics& k = camera.intrinsics;
    return sphere_ ? sphere_->view(k, turn(camera)) : downscaled(colours_, k.width, k.height);
  }
  Image8 mask(const Camera& camera) const {
    const Intrinsics& k = camera.intrinsics;
    return sphereMask_ ? binaryMask(sphereMask_->view(k, turn(camera))) : resizedMask(mask_, k.width, k.height);
  }

 private:
  glm::dquat turn(const Camera& camera) const {
    return glm::conjugate(photograph_.camera.pose.rotation) * camera.pose.rotation;
  }

  const Photograph& photograph_;
  Image8 colours_, mask_;
  std::optional<PanoramaSampler> sphere_, sphereMask_;
};

void storeDepth(const std::filesystem::path& file, const SweptDepth& depth) {
  CacheWriter out;
  out.value(depth.sky.width);
  out.value(depth.sky.height);
  out.list(depth.inverseDepth.values);
  out.list(depth.sky.values);
  storeCached(file, out.take());
}

std::optional<SweptDepth> fetchDepth(const std::filesystem::path& file) {
  auto bytes = fetchCached(file);
  if (!bytes) return std::nullopt;
  CacheReader in(std::move(*bytes));
  const int width = in.value<int>(), height = in.value<int>();
  SweptDepth depth{ImageF(width, height, 1), Image8(width, height, 1), 0};
  depth.inverseDepth.values = in.list<float>();
  depth.sky.values = in.list<std::uint8_t>();
  return depth;
}

// Nearest-neighbour enlargement: a pixel gets the depth of the small pixel that contains its corner.
SweptDepth enlarged(const SweptDepth& depth, int width, int height) {
  SweptDepth large{ImageF(width, height, 1), Image8(width, height, 1), depth.level};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int u = x * depth.sky.width / width, v = y * depth.sky.height / height;
      large.inverseDepth.pixel(x, y)[0] = depth.inverseDepth.pixel(u, v)[0];
      large.sky.pixel(x, y)[0] = depth.sky.pixel(u, v)[0];
    }
  return large;
}

}  // namespace

double bytesToReadViews(const Photograph& photograph) {
  constexpr double kSphereBytes = 4;  // per pixel: colours and mask with a border
  const Intrinsics& k = photograph.camera.intrinsics;
  return bytesToLoad(photograph) + (isPanorama(photograph) ? kSphereBytes * k.width * k.height : 0);
}

SweepView DepthMatcher::ViewImages::view() const {
  SweepView view{camera, ImageF(grey.width, grey.height, 1), mask};
  std::ranges::copy(grey.values, view.grey.values.begin());
  return view;
}

DepthMatcher::DepthMatcher(const BuildInput& input, ViewSweeps sweeps, DepthSearch search,
                           std::filesystem::path cacheFolder)
    : input_(input), search_(search), cacheFolder_(std::move(cacheFolder)), sweeps_(std::move(sweeps)) {
  std::vector<Camera> cameras;
  for (const Photograph& photo : input.photographs) cameras.push_back(photo.camera);
  views_ = depthViews(cameras);
  sweptImages_.resize(views_.size());
  refinedImages_.resize(views_.size());
}

void DepthMatcher::read(std::span<const std::uint32_t> photographs, const BuildJobs& jobs) {
  double bytes = 0;
  for (const std::uint32_t i : photographs) bytes = std::max(bytes, bytesToReadViews(input_.photographs[i]));
  std::vector<std::size_t> first;  // first view of each photograph
  for (std::size_t v = 0; v < views_.size(); ++v)
    if (views_[v].node == first.size()) first.push_back(v);
  jobs.runAll("reading photographs", photographs.size(), bytes,
              [&](std::size_t i) { readViews(input_.photographs[photographs[i]], first[photographs[i]]); });
}

void DepthMatcher::readViews(const Photograph& photograph, std::size_t first) {
  const LoadedPhotograph loaded(photograph);
  for (std::size_t v = first; v < views_.size() && views_[v].node == views_[first].node; ++v) {
    const Camera& stored = views_[v].camera;
    const glm::ivec2 size = sweptSize(stored.intrinsics), whole(stored.intrinsics.width, stored.intrinsics.height);
    const double share = search_ == DepthSearch::fast ? kFastScale : 1;
    const auto picture = [&](glm::ivec2 at, int window) -> ViewImages {
      const Camera camera{resized(stored.intrinsics, at.x, at.y), stored.pose};
      return {camera, toGrey(loaded.colours(camera)), widenedMask(loaded.mask(camera), window)};
    };
    sweptImages_[v] = picture(glm::max(glm::ivec2(share * glm::dvec2(size)), 1), kSweptWindow);
    if (isRefined()) refinedImages_[v] = picture(glm::min(kFineScale * size, whole), kRefinedWindow);
  }
}

std::uint64_t DepthMatcher::keyOf(std::size_t view, const std::vector<std::uint32_t>& sources, SweepRange range) const {
  Hash hash;
  hash.add(kVersion);
  hash.add(std::uint64_t(search_));
  const auto addView = [&](std::size_t v) {
    addPhotograph(hash, input_, views_[v].node);
    const glm::dquat& turn = views_[v].camera.pose.rotation;
    for (int c = 0; c < 4; ++c) hash.add(turn[c]);
  };
  addView(view);
  for (const std::uint32_t j : sources) addView(j);
  hash.add(range.far);
  hash.add(range.near);
  return hash.value();
}

std::vector<SweepView> DepthMatcher::viewsOf(const std::vector<ViewImages>& pictures,
                                             std::span<const std::uint32_t> which) {
  std::vector<SweepView> views;
  for (const std::uint32_t j : which) views.push_back(pictures[j].view());
  return views;
}

std::filesystem::path DepthMatcher::cachedFile(std::size_t view) const {
  const std::optional<ViewSweep> planned = sweeps_(view);
  return planned ? cacheFile(cacheFolder_, keyOf(view, planned->sources, planned->range), kKind)
                 : std::filesystem::path();
}

std::optional<SweptDepth> DepthMatcher::fetch(std::size_t view) const {
  const std::filesystem::path file = cachedFile(view);
  if (file.empty()) return std::nullopt;
  std::optional<SweptDepth> depth = fetchDepth(file);
  check(depth.has_value(), ErrorCode::io, "{}: the depth of {} is missing or damaged; run its step of depth again",
        file.string(), input_.photographs[views_[view].node].name);
  return depth;
}

std::optional<SweptDepth> DepthMatcher::match(std::size_t view) const {
  const std::optional<ViewSweep> planned = sweeps_(view);
  if (!planned) return std::nullopt;
  const auto& [sources, range] = *planned;
  const std::filesystem::path file = cacheFile(cacheFolder_, keyOf(view, sources, range), kKind);
  if (auto cached = fetchDepth(file)) return cached;
  SweptDepth depth = sweptDepth(sweptImages_[view].view(), viewsOf(sweptImages_, sources), range);
  const Image8& fine = refinedImages_[view].grey;
  if (search_ == DepthSearch::fine) depth = enlarged(depth, fine.width, fine.height);
  if (search_ == DepthSearch::fast) {
    const glm::ivec2 size = sweptSize(views_[view].camera.intrinsics);
    depth = enlarged(depth, size.x, size.y);
  }
  if (isRefined()) refineDepth(depth, refinedImages_[view].view(), viewsOf(refinedImages_, sources));
  storeDepth(file, depth);
  return depth;
}

double DepthMatcher::bytesToMatch() const {
  // Refinement follows the sweep, at up to kFineScale² its pixels, with copies of grey values and masks of all views.
  constexpr double kCopiedBytesPerPixel = (sizeof(float) + 1) * (1 + kNearSources + kWideSources);
  static_assert(kFineScale * kFineScale * (kRefinedBytesPerPixel + kCopiedBytesPerPixel) <= kSweptBytesPerPixel);
  double maxPixels = 0;
  for (const ViewImages& small : sweptImages_) maxPixels = std::max(maxPixels, double(small.grey.values.size()));
  return kSweptBytesPerPixel * maxPixels;
}

}  // namespace ibr
