// SPDX-License-Identifier: Apache-2.0
#include "author/build/backdrop_maker.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "author/backdrop/scene_depth.h"
#include "author/build/cell_cache.h"
#include "author/geometry/posed_model.h"
#include "author/geometry/simplex.h"
#include "author/pixels/resize.h"
#include "base/stopwatch.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 3;  // of their making: raise it when they come out differently

// Of the capture spacing: depth edges are cut that tear when a view is so far from the photograph. Of .35, .5 and .7
// the middle; the whole step of a backdrop loses .5 dB on path_lund_street where views are gathered.
constexpr double kCut = 0.5;

// How far a virtual camera is likely to be away from a photograph: the longest edge of its cells, or of all; median.
double stepOf(const std::vector<std::size_t>& cells, const std::vector<double>& sizes) {
  std::vector<double> its;
  for (const std::size_t c : cells) its.push_back(sizes[c]);
  if (its.empty()) its = sizes;
  return its.empty() ? 0.0 : median(its);
}

std::vector<glm::dvec3> pointsSeenBy(const BuildInput& input, std::uint32_t photograph) {
  std::vector<glm::dvec3> points;
  for (const std::uint32_t t : input.tracksOf[photograph]) points.push_back(input.model.tracks[t].position);
  return points;
}

}  // namespace

BackdropMaker::BackdropMaker(const BuildInput& input, const BuildOptions& options, const Scene& scene,
                             const std::vector<std::uint64_t>& keys)
    : input_(input), options_(options), scene_(scene), keys_(keys), cellsWith_(scene.nodes.size()) {
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

std::vector<glm::dvec3> BackdropMaker::pointsOf(std::uint32_t photograph) const {
  return cellsWith_[photograph].empty() ? pointsSeenBy(input_, photograph) : std::vector<glm::dvec3>{};
}

ImageF BackdropMaker::depthOf(std::uint32_t photograph) const {
  Camera camera = input_.photographs[photograph].camera;
  const glm::ivec2 size = backdropSize(camera.intrinsics);
  camera.intrinsics = resized(camera.intrinsics, size.x, size.y);
  return cellsWith_[photograph].empty() ? depthOfPoints(camera, pointsOf(photograph))
                                        : depthInScene(scene_, photograph, size);
}

BackdropMaker::Made BackdropMaker::make(std::uint32_t photograph, const ImageF& known,
                                        const DepthEvidence& evidence) const {
  const Stopwatch watch;
  const Photograph& photo = input_.photographs[photograph];
  const double step = stepOf(cellsWith_[photograph], sizes_);
  Hash hash;
  hash.add(kVersion);
  hash.add(options_.backdropSpacing);
  hash.add(step);
  hash.add(spacing_);
  addPhotograph(hash, input_, photograph);
  for (const std::size_t c : cellsWith_[photograph]) hash.add(keys_[c]);
  addPoints(hash, pointsOf(photograph));
  const std::uint64_t key = hash.value();

  const ImageF completed = completeDepth(known, shrunk(loadPhotograph(photo), known.width, known.height));
  Made made;
  made.backdrop.key = key;
  if (auto kept = fetchCell(keptFolder(options_), key)) {
    made.backdrop.cell = std::move(*kept);
    made.backdrop.resumed = true;
  } else {
    made.backdrop.cell = buildBackdrop(photo.camera, known, completed,
                                       {.step = step, .cut = kCut * spacing_, .spacing = options_.backdropSpacing});
    storeCell(keptFolder(options_), key, made.backdrop.cell);
  }
  // Evidence hangs on all photographs: it is not kept with the mesh.
  addEvidence(made.backdrop.cell.mesh, photo.camera, known, evidence);
  made.depth = depthTexture(completed, consensusOf(known, evidence), photo.camera.intrinsics.width);
  made.backdrop.seconds = watch.seconds();
  return made;
}

double BackdropMaker::bytes() const {
  double most = 0;
  for (std::size_t i = 0; i < cellsWith_.size(); ++i) {
    const glm::ivec2 size = backdropSize(input_.photographs[i].camera.intrinsics);
    const double pixel = kBackdropBytesPerPixel + double(sizeof(float)) * double(cellsWith_[i].size());
    most = std::max(most, pixel * size.x * size.y + bytesToLoad(input_.photographs[i]));
  }
  return most;
}

}  // namespace ibr
