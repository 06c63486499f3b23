// SPDX-License-Identifier: Apache-2.0
#include "author/build/cell_maker.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "author/backdrop/backdrop.h"
#include "author/build/cell_cache.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"
#include "author/match/matcher_choice.h"
#include "author/match/refine_full.h"
#include "author/match/vertices.h"
#include "author/panorama/panorama_cell.h"
#include "author/panorama/panorama_faces.h"
#include "author/photographs/masks.h"
#include "author/poses/local_adjust.h"
#include "author/sweep/sweep_levels.h"
#include "base/check.h"
#include "base/stopwatch.h"
#include "base/usage.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 15;        // of the algorithm: raise when cells change
constexpr double kMaxReprojectionPx = 1.0;    // max median reprojection error, px of the matched images
constexpr std::size_t kMinSharedPoints = 30;  // min points seen by all members; below it, points seen by two are used

// Method, cameras and points with which a cell is matched.
struct CellMatchPlan {
  std::vector<glm::dvec3> points;  // seen by all members; if these are few, by two or more
  std::vector<Camera> cameras;     // at the matched size, poses adjusted; empty for panoramas
  CellMatchOptions match;
  std::vector<MemberDepth> depths;  // of the members; empty: the cell is swept
};

struct SharedPoints {
  std::vector<std::uint32_t> tracks;  // seen by two or more members
  std::vector<glm::dvec3> points;     // seen by all; if these are few, by two or more
};

SharedPoints sharedPoints(const BuildInput& input, const std::vector<std::uint32_t>& members) {
  std::vector<std::uint32_t> tracks;
  for (const std::uint32_t i : members) tracks.insert(tracks.end(), input.tracksOf[i].begin(), input.tracksOf[i].end());
  std::sort(tracks.begin(), tracks.end());
  SharedPoints shared;
  std::vector<glm::dvec3> all, some;
  for (auto first = tracks.begin(); first != tracks.end();) {
    const auto last = std::upper_bound(first, tracks.end(), *first);
    const auto seen = std::size_t(last - first);
    if (seen >= 2) {
      shared.tracks.push_back(*first);
      some.push_back(input.model.tracks[*first].position);
    }
    if (seen == members.size()) all.push_back(input.model.tracks[*first].position);
    first = last;
  }
  shared.points = all.size() >= kMinSharedPoints ? std::move(all) : std::move(some);
  return shared;
}

CellMatchPlan planCellMatch(const BuildInput& input, const BuildOptions& options, const MemberDepths& depths,
                            const std::vector<std::uint32_t>& members) {
  SharedPoints shared = sharedPoints(input, members);
  CellMatchPlan planned;
  planned.points = std::move(shared.points);
  planned.match.refine = input.refine;
  planned.match.seed = options.seed;
  const bool panoramic = isPanorama(input.photographs[members[0]]);
  if (!panoramic) {
    planned.cameras = camerasToMatch(input, members);
    const double error = cellReprojectionError(input.model, members, planned.cameras, shared.tracks);
    planned.match.matcher = resolveMatcher(options.matcher, error);
    planned.match.posesUsable = error <= kMaxSweepErrorPx;
  }
  if (depths && planned.match.matcher == MatchMethod::sweep)
    for (const std::uint32_t i : members) planned.depths.push_back(depths(i));
  return planned;
}

std::uint64_t keyOf(const BuildInput& input, const BuildOptions& options, const std::vector<std::uint32_t>& members,
                    const CellMatchPlan& planned) {
  Hash hash;
  hash.add(kVersion);
  hash.add(options.seed);
  hash.add(input.refine);
  if (input.refine)  // poses are adjusted to the members' tracks
    for (const LocalTrack& track : localTracks(input.model, input.tracksOf, members)) {
      for (int c = 0; c < 3; ++c) hash.add(track.position[c]);
      for (const auto& pixel : track.pixel)
        for (int c = 0; c < 2; ++c) hash.add(pixel ? (*pixel)[c] : -1.0);
    }
  for (const std::uint32_t i : members) addPhotograph(hash, input, i);
  addPoints(hash, planned.points);
  hash.add(int(planned.match.matcher));
  hash.add(planned.match.posesUsable);
  hash.add(int(options.triangleFilter));
  for (const MemberDepth& depth : planned.depths) {
    hash.add(std::as_bytes(std::span(depth.inverseDepth.values)));
    hash.add(depth.step);
  }
  return hash.value();
}

CellMesh pinholeCell(const BuildInput& input, const BuildOptions& options, const std::vector<std::uint32_t>& members,
                     const CellMatchPlan& planned) {
  std::vector<MatchView> views;
  std::vector<Camera> stored;
  std::vector<Image8> full(members.size());
  for (const std::uint32_t i : members) {
    views.push_back(viewOf(input.photographs[i], &full[views.size()]));
    stored.push_back(input.photographs[i].camera);
  }
  for (std::size_t i = 0; i < views.size(); ++i) views[i].camera = planned.cameras[i];
  CellMatchOptions matching = planned.match;
  matching.depths = planned.depths;
  DenseMatch match = matchCell(views, planned.points, matching);
  if (std::ranges::none_of(full, &Image8::empty) && planned.match.matcher == MatchMethod::sweep) {
    match.vertices = matchedVertices(views, match);
    refineAtFullSize(views, full, match, *match.vertices);
    full.clear();
  }
  return buildMesh(stored, views, match, options.triangleFilter);
}

CellMesh cellOfPanoramas(const BuildInput& input, const std::vector<std::uint32_t>& members,
                         const CellMatchPlan& planned) {
  std::vector<PanoramaView> views;
  for (const std::uint32_t i : members)
    views.push_back(
        {input.photographs[i].camera, loadPhotograph(input.photographs[i]), storedMask(input.photographs[i])});
  return makePanoramaCell(views, planned.points, {input.refine, planned.depths});
}

// `work`: as of pinholes.
CellWork workOfPanoramas(const BuildInput& input, const std::vector<std::uint32_t>& members, CellWork work,
                         bool swept) {
  constexpr double kTypicalLevels = 100;
  double largest = 0, face = 0;
  for (const std::uint32_t i : members) {
    const Intrinsics& k = input.photographs[i].camera.intrinsics;
    const double stored = double(k.width) * k.height, side = matchedFaceSide(k.width);
    largest = std::max(largest, stored);
    face = std::max(face, side * side);
    work.heldPixels += stored;
    const glm::ivec2 map = backdropSize(k);
    work.mapPixels += swept ? 0 : double(map.x) * map.y;
  }
  work.pixels = face;
  work.faces = double(cubeRotations().size());
  work.sampledPixels = work.faces * work.pixels * double(members.size());
  work.heldPixels += largest;  // the sampler's copy
  work.levels = swept ? kTypicalLevels : 0;
  return work;
}

}  // namespace

MemberDepths memberDepths(std::span<const PhotographDepth> depths) {
  return [depths](std::uint32_t i) {
    return MemberDepth{depths[i].matched.map.camera, filteredDepth(depths[i]), depths[i].matched.step};
  };
}

std::vector<Camera> camerasToMatch(const BuildInput& input, const std::vector<std::uint32_t>& members) {
  std::vector<Camera> cameras, matched;
  for (const std::uint32_t i : members) {
    cameras.push_back(input.model.images[i].camera);
    matched.push_back(matchedCamera(input.photographs[i].camera));
  }
  if (!input.refine) return matched;
  const double scale = double(cameras[0].intrinsics.width) / double(matched[0].intrinsics.width);
  const std::vector<Pose> poses =
      locallyAdjusted(cameras, localTracks(input.model, input.tracksOf, members), kMaxReprojectionPx * scale);
  for (std::size_t i = 0; i < matched.size(); ++i) matched[i].pose = poses[i];
  return matched;
}

MatchView viewOf(const Photograph& photograph, Image8* whole) {
  MatchView view{matchedCamera(photograph.camera), loadPhotograph(photograph)};
  const Intrinsics& k = view.camera.intrinsics;
  view.mask = resizedMask(storedMask(photograph), k.width, k.height);
  if (k.width == view.picture.width && k.height == view.picture.height) return view;
  if (whole) *whole = toGrey(view.picture);
  view.picture = downscaled(view.picture, k.width, k.height);
  return view;
}

CellResult CellMaker::make(const std::vector<std::uint32_t>& members) const {
  const Stopwatch watch;
  const double before = threadSeconds();
  const CellMatchPlan planned = planCellMatch(input_, options_, depths_, members);
  const std::uint64_t key = keyOf(input_, options_, members, planned);
  const bool panoramic = isPanorama(input_.photographs[members[0]]);
  if (auto cached = fetchCell(buildCacheFolder(options_), key))
    return {std::move(*cached), watch.seconds(), threadSeconds() - before, true, key, planned.match.matcher};
  CellResult made{{}, 0, 0, false, key, planned.match.matcher};
  try {
    made.cell = panoramic ? cellOfPanoramas(input_, members, planned) : pinholeCell(input_, options_, members, planned);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalidInput) throw;
    std::string names;
    for (const std::uint32_t i : members) names += (names.empty() ? "" : ", ") + input_.photographs[i].name;
    fail(error.code(), "the cell of {}: {}", names, error.what());
  }
  storeCell(buildCacheFolder(options_), key, made.cell);
  made.seconds = watch.seconds();
  made.cpuSeconds = threadSeconds() - before;
  return made;
}

CellWork CellMaker::work(const std::vector<std::uint32_t>& members) const {
  CellWork work{.members = members.size()};
  std::vector<Camera> cameras, halves;
  for (const std::uint32_t i : members) {
    const Camera camera = matchedCamera(input_.photographs[i].camera);
    const Photograph& photograph = input_.photographs[i];
    const Intrinsics &k = camera.intrinsics, &stored = photograph.camera.intrinsics;
    const double pixels = double(k.width) * k.height;
    work.readPixels += photograph.sourcePixels;
    work.loadingBytes = std::max(work.loadingBytes, bytesToLoad(photograph));
    work.excessPixels = std::max(work.excessPixels, double(stored.width) * stored.height - pixels);
    work.pixels = std::max(work.pixels, pixels);
    cameras.push_back(camera);
    if (!isPanorama(input_.photographs[i]))
      halves.push_back({resized(k, std::max(k.width / 2, 1), std::max(k.height / 2, 1)), camera.pose});
  }
  work.swept = halves.size() == members.size() &&
               (options_.matcher == MatchMethod::automatic || options_.matcher == MatchMethod::sweep);
  if (halves.size() < members.size()) return workOfPanoramas(input_, members, std::move(work), sweepsCells());
  Camera frame = meanFrame(cameras);
  const Intrinsics& k = frame.intrinsics;
  work.pixels = double(k.width) * k.height;
  if (!sweepsCells()) return work;
  std::vector<double> depths;
  for (const glm::dvec3& point : sharedPoints(input_, members).points)
    if (const double w = inverseDepth(frame, point); w > 0 && std::isfinite(w)) depths.push_back(w);
  if (depths.empty()) return work;
  frame.intrinsics = resized(k, std::max(k.width / 2, 1), std::max(k.height / 2, 1));
  work.levels = sweepLevels(frame, halves, std::move(depths)).count();
  return work;
}

}  // namespace ibr
