// SPDX-License-Identifier: Apache-2.0
#include "author/build/depth_matcher.h"

#include <algorithm>
#include <cmath>

#include "author/backdrop/backdrop.h"
#include "author/depth/depth_sources.h"
#include "author/depth/refined_depth.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/kept_file.h"
#include "author/jobs/kept_values.h"
#include "author/photographs/masks.h"
#include "author/pixels/resize.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 2;   // of the depth's making: raise it when it comes out differently
constexpr const char* kKind = "depth";  // of kept file
constexpr int kFiner = 2;               // sides of the pictures that depth is refined in, in the depth's
constexpr int kRefinedWindow = 5;       // px of these: half a patch, and one of interpolation

glm::ivec2 sweptSize(const Intrinsics& stored) {
  const Intrinsics matched = matchedCamera({stored, {}}).intrinsics;
  return glm::max(glm::ivec2(1), glm::min(glm::ivec2(matched.width / 2, matched.height / 2), backdropSize(stored)));
}

void storeDepth(const std::filesystem::path& file, const SweptDepth& depth) {
  KeptWriter out;
  out.value(depth.sky.width);
  out.value(depth.sky.height);
  out.list(depth.inverseDepth.values);
  out.list(depth.sky.values);
  storeKept(file, out.take());
}

std::optional<SweptDepth> fetchDepth(const std::filesystem::path& file) {
  auto bytes = fetchKept(file);
  if (!bytes) return std::nullopt;
  KeptReader in(std::move(*bytes));
  const int width = in.value<int>(), height = in.value<int>();
  SweptDepth depth{ImageF(width, height, 1), Image8(width, height, 1), 0};
  depth.inverseDepth.values = in.list<float>();
  depth.sky.values = in.list<std::uint8_t>();
  return depth;
}

}  // namespace

SweepView DepthMatcher::Picture::view() const {
  SweepView view{camera, ImageF(grey.width, grey.height, 1), mask};
  std::ranges::copy(grey.values, view.grey.values.begin());
  return view;
}

DepthMatcher::Picture DepthMatcher::pictureOf(const Photograph& photograph, const Image8& colours, glm::ivec2 size,
                                              int window) {
  return {{resized(photograph.camera.intrinsics, size.x, size.y), photograph.camera.pose},
          greyOf(shrunk(colours, size.x, size.y)),
          widenedMask(resizedMask(storedMask(photograph), size.x, size.y), window)};
}

DepthMatcher::DepthMatcher(const BuildInput& input, const BuildOptions& options, const BuildJobs& jobs)
    : input_(input), options_(options), small_(input.photographs.size()), fine_(small_.size()) {
  double bytes = 0;
  for (const Photograph& photo : input.photographs) {
    cameras_.push_back(photo.camera);
    bytes = std::max(bytes, bytesToLoad(photo));
  }
  jobs.runAll("reading photographs", small_.size(), bytes, [&](std::size_t i) {
    const Photograph& photo = input_.photographs[i];
    if (isPanorama(photo)) return;
    const Intrinsics& stored = photo.camera.intrinsics;
    const glm::ivec2 size = sweptSize(stored), whole(stored.width, stored.height);
    const Image8 colours = loadPhotograph(photo);
    small_[i] = pictureOf(photo, colours, size, kSweptWindow);
    fine_[i] = pictureOf(photo, colours, glm::min(kFiner * size, whole), kRefinedWindow);
  });
}

std::uint64_t DepthMatcher::keyOf(std::uint32_t photograph, const std::vector<std::uint32_t>& sources,
                                  const std::vector<double>& tracks) const {
  Hash hash;
  hash.add(kVersion);
  addPhotograph(hash, input_, photograph);
  for (const std::uint32_t j : sources) addPhotograph(hash, input_, j);
  for (const double inverse : tracks) hash.add(inverse);
  return hash.value();
}

std::optional<SweptDepth> DepthMatcher::match(std::uint32_t photograph) const {
  if (small_[photograph].grey.empty()) return std::nullopt;
  const Camera& camera = small_[photograph].camera;
  std::vector<double> tracks;
  for (const std::uint32_t t : input_.tracksOf[photograph])
    if (const double w = inverseDepth(camera, input_.model.tracks[t].position); w > 0 && std::isfinite(w))
      tracks.push_back(w);
  const std::vector<std::uint32_t> sources = depthSources(input_.model, cameras_, input_.tracksOf, photograph);
  if (sources.empty() || tracks.empty()) return std::nullopt;
  const std::filesystem::path file = keptFile(keptFolder(options_), keyOf(photograph, sources, tracks), kKind);
  if (auto kept = fetchDepth(file)) return kept;
  const auto viewsIn = [&](const std::vector<Picture>& pictures) {
    std::vector<SweepView> views;
    for (const std::uint32_t j : sources) views.push_back(pictures[j].view());
    return views;
  };
  SweptDepth depth = sweptDepth(small_[photograph].view(), viewsIn(small_), std::move(tracks));
  refineDepth(depth, fine_[photograph].view(), viewsIn(fine_));
  storeDepth(file, depth);
  return depth;
}

double DepthMatcher::bytesToMatch() const {
  double most = 0;
  for (const Picture& small : small_) most = std::max(most, double(small.grey.values.size()));
  return kSweptBytesPerPixel * most;
}

}  // namespace ibr
