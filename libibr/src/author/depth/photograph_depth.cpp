// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "author/backdrop/known_depth.h"
#include "author/depth/depth_views.h"
#include "author/sweep/depth_clean.h"
#include "base/check.h"
#include "base/median.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr double kStepPx = 2;  // px of a photograph: 1 px at half its size

void runSerially(std::size_t count, const std::function<void(std::size_t)>& job) {
  for (std::size_t i = 0; i < count; ++i) job(i);
}

bool isSky(const PhotographDepth& depth, std::size_t pixel) {
  return !depth.sky.empty() && depth.sky.values[pixel];
}

}  // namespace

ImageF filteredDepth(const PhotographDepth& depth) {
  constexpr float kSurfaceSteps = 2;  // max depth step between neighbours of one surface
  ImageF kept = depth.matched.map.inverseDepth;
  const DepthEvidence& evidence = depth.evidence;
  for (std::size_t p = 0; p < kept.values.size(); ++p) {
    const int c = evidence.confirmations.values[p], v = evidence.contradictions.values[p];
    const bool believed = c >= 2 || (c == 1 && v == 0) || evidence.usableSources.values[p] == 0 || isSky(depth, p);
    if (!believed) kept.values[p] = kUnknownDepth;
  }
  if (depth.sparse) return kept;
  const std::vector<bool> speckle =
      speckles(kept, kSurfaceSteps * float(depth.matched.step), kMinSurfacePx * depth.finer * depth.finer);
  for (std::size_t p = 0; p < kept.values.size(); ++p)
    if (speckle[p]) kept.values[p] = kUnknownDepth;
  return kept;
}

namespace {

Camera sizedAs(const Camera& stored, glm::ivec2 size) {
  return {resized(stored.intrinsics, size.x, size.y), stored.pose};
}

bool isPanorama(const Intrinsics& intrinsics) {
  return intrinsics.model == CameraModel::equirectangular;
}
bool isPanorama(const Camera& camera) {
  return isPanorama(camera.intrinsics);
}

double pxPerRadian(const Intrinsics& k) {
  return k.model == CameraModel::equirectangular ? k.width / (2 * std::numbers::pi) : k.fx;
}

// A view's depth before evidence from other views is counted.
struct FoundDepth {
  DepthMap map;
  Image8 sky = {};
  bool sparse = false;
};

FoundDepth depthOf(std::span<const Camera> photographs, const DepthView& view, std::size_t which,
                   const PhotographDepthOptions& options) {
  if (std::optional<SweptDepth> swept = options.matches(which))
    return {
        {sizedAs(view.camera, {swept->inverseDepth.width, swept->inverseDepth.height}), std::move(swept->inverseDepth)},
        std::move(swept->sky)};
  const glm::ivec2 size = backdropSize(photographs[view.node].intrinsics);  // faces: same resolution per angle
  const Camera camera = sizedAs(view.camera, view.isFace ? glm::ivec2(depthFaceSize(size.x)) : size);
  const auto points = options.points ? options.points(view.node) : std::vector<glm::dvec3>{};
  return {{camera, depthOfPoints(camera, points)}, {}, true};
}

int finerThanBackdrop(const Intrinsics& map, const Intrinsics& stored) {
  return std::max(1, int(std::lround(double(map.width) / backdropSize(stored).x)));
}

// Pads a panorama's rows with pixels from the opposite ends, since its left and right ends adjoin.
template <class T>
Image<T> withEnds(const Image<T>& image, int wide) {
  Image<T> result(image.width + 2 * wide, image.height, image.channels);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      std::copy_n(&image.pixel((x - wide + image.width) % image.width, y)[0], image.channels, &result.pixel(x, y)[0]);
  return result;
}

ImageF completedAround(const ImageF& kept, const Image8& colours) {
  const int wide = kept.width / 4;
  const ImageF whole = completeDepth(withEnds(kept, wide), withEnds(colours, wide));
  ImageF result(kept.width, kept.height, 1);
  for (int y = 0; y < kept.height; ++y) std::copy_n(&whole.pixel(wide, y)[0], kept.width, &result.pixel(0, y)[0]);
  return result;
}

// Pixel from which a vertex takes its depth: the nearest one, unless that pixel lies on another surface, as where a
// triangle was split.
glm::ivec2 pixelOfDepth(const ImageF& map, glm::dvec2 at, double inverseDepth) {
  constexpr int kReach = 3;  // px: half the diagonal of the finest blocks of vertices
  constexpr double kSame = 1e-5;
  const auto difference = [&](glm::ivec2 pixel) {
    return std::abs(double(map.pixel(pixel.x, pixel.y)[0]) - inverseDepth);
  };
  const glm::ivec2 last(map.width - 1, map.height - 1), nearest = glm::clamp(glm::ivec2(glm::floor(at)), {0, 0}, last);
  glm::ivec2 best = nearest;
  if (difference(best) <= kSame * inverseDepth) return best;
  for (int y = std::max(nearest.y - kReach, 0); y <= std::min(nearest.y + kReach, last.y); ++y)
    for (int x = std::max(nearest.x - kReach, 0); x <= std::min(nearest.x + kReach, last.x); ++x)
      if (difference({x, y}) < difference(best)) best = {x, y};
  return best;
}

}  // namespace

std::vector<PhotographDepth> depthOfPhotographs(std::span<const Camera> cameras,
                                                const PhotographDepthOptions& options) {
  if (cameras.empty()) return {};
  const std::vector<DepthView> views = depthViews(cameras);
  const double spacing = captureSpacing(cameras);
  std::vector<FoundDepth> found(views.size());
  std::vector<ConsistentDepth> matched(views.size());
  const JobRunner runDepths = options.depths ? options.depths : runSerially,
                  runEvidence = options.evidence ? options.evidence : runSerially;
  runDepths(views.size(), [&](std::size_t i) {
    found[i] = depthOf(cameras, views[i], i, options);
    const double storedFocal = pxPerRadian(cameras[views[i].node].intrinsics);
    const double scale = found[i].map.camera.intrinsics.fx / storedFocal;
    matched[i] = {std::move(found[i].map), kStepPx / (storedFocal * spacing), options.residualPx * scale};
  });
  std::vector<DepthEvidence> evidence = depthEvidence(matched, kDepthSources, runEvidence);

  std::vector<PhotographDepth> result;
  std::vector<MatchedDepth> faces;
  bool sparse = true;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto [node, isFace] = std::pair(views[i].node, views[i].isFace);
    MatchedDepth depth{std::move(matched[i]), std::move(found[i].sky), std::move(evidence[i])};
    sparse = sparse && found[i].sparse;
    if (isFace) {
      faces.push_back(std::move(depth));
      if (i + 1 < views.size() && views[i + 1].isFace && views[i + 1].node == node) continue;
      depth = onSphere(sizedAs(cameras[node], backdropSize(cameras[node].intrinsics)), faces);
      faces.clear();
    }
    const int finer = finerThanBackdrop(depth.matched.map.camera.intrinsics, cameras[node].intrinsics);
    result.push_back({std::move(depth), node, std::exchange(sparse, true), finer});
  }
  return result;
}

CompletedDepth completed(const PhotographDepth& depth, const Image8& colours) {
  constexpr int kSkyConfirmations = 2;
  ImageF kept = filteredDepth(depth);
  const int width = kept.width, height = kept.height;
  CompletedDepth result{
      {isPanorama(depth.matched.map.camera) ? completedAround(kept, colours) : completeDepth(kept, colours),
       ImageF(width, height, 1, kCompletedConsensus)},
      {},
      Image8(width, height, 1, 0)};
  for (std::size_t p = 0; p < kept.values.size(); ++p) {
    if (kept.values[p] < 0) continue;
    const bool sky = isSky(depth, p);
    const int c = sky ? kSkyConfirmations : depth.evidence.confirmations.values[p];
    const int v = sky ? 0 : depth.evidence.contradictions.values[p];
    result.confirmations.values[p] = std::uint8_t(c);
    result.maps.consensus.values[p] = float((c + 0.25) / (c + v + 0.5));
  }
  result.kept = std::move(kept);
  return result;
}

void addEvidence(MorphMesh& mesh, const Intrinsics& stored, const CompletedDepth& depth) {
  check(mesh.memberCount() == 1, ErrorCode::invalidInput, "evidence is added to backdrops, not to a mesh of {} members",
        mesh.memberCount());
  const ImageF& map = depth.maps.inverseDepth;
  const glm::dvec2 scale(double(map.width) / stored.width, double(map.height) / stored.height);
  mesh.confirmations.clear();
  mesh.consensus.clear();
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    const glm::dvec2 match = mesh.match[0][i];
    const double along = isPanorama(stored) ? 1.0 : -unproject(stored, match).z;
    const glm::ivec2 pixel = pixelOfDepth(map, match * scale, double(mesh.inverseDistance[i]) / along);
    mesh.confirmations.push_back(depth.confirmations.pixel(pixel.x, pixel.y)[0]);
    mesh.consensus.push_back(depth.maps.consensus.pixel(pixel.x, pixel.y)[0]);
  }
}

}  // namespace ibr
