// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/gathered_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "author/backdrop/scene_depth.h"
#include "author/depth/depth_consistency.h"
#include "author/eval/exposed_picture.h"
#include "author/photographs/masks.h"
#include "author/pixels/resize.h"
#include "base/median.h"
#include "base/parallel.h"
#include "ibr/panorama.h"
#include "io/image_file.h"
#include "scene/capture_spacing.h"

namespace ibr::app {
namespace {

constexpr double kFaceFov = 105 * std::numbers::pi / 180;  // faces of a cube overlap: their borders fade

// A pinhole picture that the composer takes: a photograph, or a face of a panorama.
struct Source {
  std::uint32_t node = 0;
  Camera camera;
  std::optional<glm::dquat> face;  // rotation from the face's axes to the panorama's
};

std::vector<Source> sourcesOf(const Scene& scene) {
  std::vector<Source> sources;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    const Camera& camera = scene.nodes[n].camera;
    if (camera.intrinsics.model == CameraModel::pinhole) {
      sources.push_back({n, camera, std::nullopt});
      continue;
    }
    const Intrinsics face = faceIntrinsics(faceSize(camera.intrinsics.width, kFaceFov), kFaceFov);
    for (const PanoramaFace& one : cubeFaces())
      sources.push_back({n, {face, {camera.pose.position, camera.pose.rotation * one.rotation}}, one.rotation});
  }
  return sources;
}

// As stored, with a mask as alpha.
Image8 pictureOf(const Scene& scene, const Source& source) {
  const Node& node = scene.nodes[source.node];
  Image8 picture = readImage(scene.folder / node.imageFile);
  if (!node.maskFile.empty()) {
    const Image8 mask = readMask(scene.folder / node.maskFile, node.camera.intrinsics);
    Image8 masked(picture.width, picture.height, 4);
    for (std::size_t p = 0; p < mask.values.size(); ++p) {
      std::copy_n(&picture.values[3 * p], 3, &masked.values[4 * p]);
      masked.values[4 * p + 3] = mask.values[p];
    }
    picture = std::move(masked);
  }
  return source.face ? PanoramaSampler(picture).view(source.camera.intrinsics, *source.face) : picture;
}

// Median over the cells, px; 0 where none says.
double residualOf(const Scene& scene) {
  std::vector<double> residuals;
  for (const Cell& cell : scene.cells) residuals.push_back(cell.quality.residualPx);
  const double middle = residuals.empty() ? 0 : median(std::move(residuals));
  return std::isfinite(middle) ? middle : 0;
}

}  // namespace

struct GatheredViews::State {
  State(const Scene& s, int wanted)
      : scene(s),
        threads(wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()))),
        sources(sourcesOf(s)),
        composer(photographs(), {.threads = threads}) {}

  std::vector<reference::ComposerPhotograph> photographs() {
    std::vector<Camera> cameras;
    for (const Source& source : sources) cameras.push_back(source.camera);
    const double spacing = captureSpacing(cameras), residual = residualOf(scene);
    std::vector<ConsistentDepth> matched(sources.size());
    std::vector<Image8> colours(sources.size());
    pictures.resize(sources.size());
    const auto all = [&](auto&& job) { runJobs(sources.size(), threads, job, [](std::size_t) { return true; }); };
    all([&](std::size_t i) {
      const Source& source = sources[i];
      pictures[i] = pictureOf(scene, source);
      const glm::ivec2 size = backdropSize(source.camera.intrinsics);
      Camera small = source.camera;
      small.intrinsics = resized(small.intrinsics, size.x, size.y);
      Image8 opaque = pictures[i];
      if (opaque.channels == 4) opaque = withoutAlpha(opaque);
      colours[i] = shrunk(opaque, size.x, size.y);
      const double scale = double(size.x) / source.camera.intrinsics.width;
      matched[i] = {
          {small, source.face ? depthInScene(scene, source.node, small) : depthInScene(scene, source.node, size)},
          2 / (source.camera.intrinsics.fx * spacing),
          residual * scale};
    });
    const std::vector<DepthEvidence> evidence = depthEvidence(matched, 10, threads);
    std::vector<reference::ComposerPhotograph> result(sources.size());
    all([&](std::size_t i) {
      const ImageF& known = matched[i].map.inverseDepth;
      reference::PhotographDepth depth{completeDepth(known, colours[i]), evidence[i].confirmations,
                                       ImageF(known.width, known.height, 1), matched[i].step, residual};
      for (std::size_t p = 0; p < known.values.size(); ++p) {
        const double c = evidence[i].confirmations.values[p], v = evidence[i].contradictions.values[p];
        depth.consensus.values[p] = known.values[p] < 0 ? 0.1f : float((c + 0.25) / (c + v + 0.5));
      }
      result[i] = {sources[i].camera, std::move(depth)};
    });
    return result;
  }

  static Image8 withoutAlpha(const Image8& picture) {
    Image8 result(picture.width, picture.height, 3);
    for (std::size_t p = 0; p < result.values.size() / 3; ++p)
      std::copy_n(&picture.values[4 * p], 3, &result.values[3 * p]);
    return result;
  }

  // As it is shown, in this view.
  const Image8& shown(std::size_t i) {
    if (!exposure) return pictures[i];
    exposed = exposedPicture(pictures[i], *exposure * scene.nodes[sources[i].node].gain);
    return exposed;
  }

  const Scene& scene;
  int threads;
  std::vector<Source> sources;
  std::vector<Image8> pictures;  // by source
  reference::Composer composer;
  std::optional<glm::dvec3> exposure;
  Image8 exposed;
};

GatheredViews::GatheredViews(const Scene& scene, int threads) : state_(std::make_unique<State>(scene, threads)) {}
GatheredViews::~GatheredViews() = default;

void GatheredViews::expose(const std::optional<glm::dvec3>& exposure) {
  state_->exposure = exposure;
}

reference::Composed GatheredViews::compose(const Camera& view) {
  return state_->composer.compose(view, [this](std::size_t i) -> const Image8& { return state_->shown(i); });
}

}  // namespace ibr::app
