// SPDX-License-Identifier: Apache-2.0
#include "author/cell_maker.h"

#include <algorithm>
#include <glm/vec3.hpp>

#include "author/backdrop.h"
#include "author/cell_cache.h"
#include "author/match.h"
#include "author/own_depth.h"
#include "author/panorama_cell.h"
#include "author/posed_model.h"
#include "author/stopwatch.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 2;   // of the cells' making: raise it when they come out differently
constexpr double kBytesPerPixel = 400;  // that matching takes, of one member's pixels
constexpr std::size_t kEnough = 30;     // points, to do without those that not all members see

// Points that all members see; if they are few, those that two see. In the order of the tracks.
std::vector<glm::dvec3> pointsOf(const BuildInput& input, const std::vector<std::uint32_t>& members) {
  std::vector<std::uint32_t> tracks;
  for (const std::uint32_t i : members)
    tracks.insert(tracks.end(), input.tracksOf[i].begin(), input.tracksOf[i].end());
  std::sort(tracks.begin(), tracks.end());
  std::vector<glm::dvec3> all, some;
  for (auto first = tracks.begin(); first != tracks.end();) {
    const auto last = std::upper_bound(first, tracks.end(), *first);
    const auto seen = std::size_t(last - first);
    if (seen >= 2) some.push_back(input.model.tracks[*first].position);
    if (seen == members.size()) all.push_back(input.model.tracks[*first].position);
    first = last;
  }
  return all.size() >= kEnough ? all : some;
}

std::uint64_t keyOf(const BuildInput& input, const BuildOptions& options, const std::vector<std::uint32_t>& members,
                    const std::vector<glm::dvec3>& points) {
  Hash hash;
  hash.add(kVersion);
  hash.add(options.seed);
  hash.add(input.refine);
  for (const std::uint32_t i : members) addPhotograph(hash, input, i);
  addPoints(hash, points);
  return hash.value();
}

CellMesh pinholeCell(const BuildInput& input, const BuildOptions& options, const std::vector<std::uint32_t>& members,
                     const std::vector<glm::dvec3>& points, std::uint64_t key) {
  std::vector<MatchView> views;
  std::vector<Camera> stored;
  for (const std::uint32_t i : members) {
    views.push_back(viewOf(input.photographs[i]));
    stored.push_back(input.photographs[i].camera);
  }
  const DenseMatch match = matchViews(views, points, {input.refine});
  if (options.backdrops) {
    std::vector<ImageF> depths;
    for (std::size_t i = 0; i < views.size(); ++i)
      depths.push_back(ownDepth(match, views[i].camera, i, backdropSize(stored[i].intrinsics)));
    storeDepths(keptFolder(options), key, depths);
  }
  return buildMesh(stored, views, match);
}

CellMesh cellOfPanoramas(const BuildInput& input, const std::vector<std::uint32_t>& members,
                         const std::vector<glm::dvec3>& points) {
  std::vector<PanoramaView> views;
  for (const std::uint32_t i : members)
    views.push_back({input.photographs[i].camera, loadPhotograph(input.photographs[i])});
  return panoramaCell(views, points, {input.refine});
}

}  // namespace

MatchView viewOf(const Photograph& photograph) {
  MatchView view{matchedCamera(photograph.camera), loadPhotograph(photograph)};
  const Intrinsics& k = view.camera.intrinsics;
  if (k.width != view.picture.width || k.height != view.picture.height)
    view.picture = shrunk(view.picture, k.width, k.height);
  return view;
}

MadeCell CellMaker::make(const std::vector<std::uint32_t>& members) const {
  const Stopwatch watch;
  const std::vector<glm::dvec3> points = pointsOf(input_, members);
  const std::uint64_t key = keyOf(input_, options_, members, points);
  const bool panoramic = isPanorama(input_.photographs[members[0]]);
  if (auto kept = fetchCell(keptFolder(options_), key);
      kept && (panoramic || !options_.backdrops || fetchDepths(keptFolder(options_), key).has_value()))
    return {std::move(*kept), watch.seconds(), true, key};
  MadeCell made{panoramic ? cellOfPanoramas(input_, members, points)
                          : pinholeCell(input_, options_, members, points, key),
                0, false, key};
  storeCell(keptFolder(options_), key, made.cell);
  made.seconds = watch.seconds();
  return made;
}

double CellMaker::bytes() const {
  double pixels = 0;
  for (const Photograph& photograph : input_.photographs)
    pixels = std::max(pixels, double(photograph.camera.intrinsics.width) * photograph.camera.intrinsics.height);
  return kBytesPerPixel * std::min(pixels, kMatchPixels);
}

}  // namespace ibr
