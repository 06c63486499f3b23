// SPDX-License-Identifier: Apache-2.0
#include "author/build/backdrop_maker.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <span>

#include "author/backdrop/backdrop.h"
#include "author/build/cell_cache.h"
#include "author/build/depth_matcher.h"
#include "author/geometry/posed_model.h"
#include "author/geometry/simplex.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "ibr/author/photographs.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 7;  // of the algorithm: raise when results change

// Baseline, as a share of the capture spacing, at which stretched depth edges are cut. Tuned: gathered views gain 0.3
// dB on object_vespasian and lose 0.2 dB on street.
constexpr double kCutShare = 0.5;

// Typical distance of a virtual camera from a photograph: median of the longest edges of its cells, or of all cells if
// the photograph is in none. In a scene without cells, the capture spacing.
double stepOf(const std::vector<std::size_t>& cells, const std::vector<double>& sizes, double spacing) {
  std::vector<double> its;
  for (const std::size_t c : cells) its.push_back(sizes[c]);
  if (its.empty()) its = sizes;
  return its.empty() ? spacing : median(its);
}

}  // namespace

std::vector<glm::dvec3> pointsSeenBy(const BuildInput& input, std::uint32_t photograph) {
  std::vector<glm::dvec3> points;
  for (const std::uint32_t t : input.tracksOf[photograph]) points.push_back(input.model.tracks[t].position);
  return points;
}

BackdropMaker::BackdropMaker(const BuildInput& input, const BuildOptions& options, const Scene& scene)
    : input_(input), options_(options), cellsWith_(scene.nodes.size()) {
  for (std::size_t c = 0; c < scene.cells.size(); ++c) {
    std::vector<glm::dvec3> corners;
    for (const std::uint32_t i : scene.cells[c].members) {
      cellsWith_[i].push_back(c);
      corners.push_back(scene.nodes[i].camera.pose.position);
    }
    sizes_.push_back(longestEdge(corners));
  }
  std::vector<Camera> cameras;
  for (const Photograph& photograph : input.photographs) cameras.push_back(photograph.camera);
  if (!cameras.empty()) spacing_ = captureSpacing(cameras);
}

BackdropResult BackdropMaker::make(std::uint32_t photograph, const PhotographDepth& depth) const {
  const Stopwatch watch;
  const Photograph& photo = input_.photographs[photograph];
  const double step = stepOf(cellsWith_[photograph], sizes_, spacing_);
  const Intrinsics& size = depth.matched.map.camera.intrinsics;
  const CompletedDepth whole = completed(depth, downscaled(loadPhotograph(photo), size.width, size.height));
  const int spacing = std::min(32, options_.backdropSpacing * int(std::bit_floor(unsigned(depth.finer))));
  Hash hash;
  hash.add(kVersion);
  hash.add(spacing);
  hash.add(step);
  hash.add(spacing_);
  addPhotograph(hash, input_, photograph);
  hash.add(std::as_bytes(std::span(whole.kept.values)));
  const std::uint64_t key = hash.value();
  BackdropResult result;
  result.made.key = key;
  if (auto cached = fetchCell(buildCacheFolder(options_), key)) {
    result.made.cell = std::move(*cached);
    result.made.cached = true;
  } else {
    result.made.cell = buildBackdrop(photo.camera, whole.kept, whole.maps.inverseDepth,
                                     {.step = step, .cut = kCutShare * spacing_, .spacing = spacing});
    storeCell(buildCacheFolder(options_), key, result.made.cell);
  }
  addEvidence(result.made.cell.mesh, photo.camera.intrinsics, whole);
  const DepthTexture texture = depthTexture(whole.maps, photo.camera.intrinsics.width);
  result.depthFile = std::filesystem::path("depth") / (photo.name + ".ktx2");
  result.depthScale = texture.scale;
  makeFolders((options_.output / result.depthFile).parent_path());
  writeKtx2(options_.output / result.depthFile, texture.texture);
  result.made.seconds = watch.seconds();
  return result;
}

double BackdropMaker::bytes() const {
  double most = 0;
  for (const Photograph& photo : input_.photographs) {
    const glm::ivec2 size = backdropSize(photo.camera.intrinsics);
    most =
        std::max(most, kBackdropBytesPerPixel * finePixelFactor(options_.depth) * size.x * size.y + bytesToLoad(photo));
  }
  return most;
}

}  // namespace ibr
