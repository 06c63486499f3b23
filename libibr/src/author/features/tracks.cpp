// SPDX-License-Identifier: Apache-2.0
#include "author/features/tracks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>
#include <unordered_map>

#include "author/features/feature_cache.h"
#include "author/jobs/cached_file.h"
#include "base/check.h"
#include "base/hash.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kFeaturesVersion = 1;  // raise when features change
constexpr std::uint64_t kMatchesVersion = 1;   // raise when matches change
constexpr int kMaxFeatures = 20000;            // per photograph
constexpr double kMaxResidualPx = 2.0;         // max of an observation

glm::dvec3 rayOf(const Camera& camera, glm::dvec2 pixel) {
  return camera.pose.rotation * unproject(camera.intrinsics, pixel);
}

std::optional<glm::dvec2> seenAt(const Camera& camera, glm::dvec3 point) {
  return project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position));
}

// Point with the least sum of squared distances from the rays.
std::optional<glm::dvec3> nearestToRays(std::span<const Camera> cameras, std::span<const glm::dvec2> pixels) {
  glm::dmat3 sum(0.0);
  glm::dvec3 right(0.0);
  const glm::dvec3 origin = cameras[0].pose.position;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const glm::dvec3 ray = rayOf(cameras[i], pixels[i]);
    const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(ray, ray);
    sum += across;
    right += across * (cameras[i].pose.position - origin);
  }
  const double volume = glm::determinant(sum);
  if (!(std::abs(volume) > 1e-14)) return std::nullopt;
  return origin + glm::inverse(sum) * right;
}

// One Gauss–Newton step for the sum of squared reprojection errors in px.
std::optional<glm::dvec3> refinePoint(std::span<const Camera> cameras, std::span<const glm::dvec2> pixels,
                                      glm::dvec3 point) {
  glm::dmat3 normal(0.0);
  glm::dvec3 right(0.0);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Intrinsics& k = cameras[i].intrinsics;
    const glm::dmat3 toCamera = glm::mat3_cast(glm::inverse(cameras[i].pose.rotation));
    const glm::dvec3 p = toCamera * (point - cameras[i].pose.position);
    if (!(p.z < 0)) return std::nullopt;
    const glm::dvec3 du = glm::transpose(toCamera) * (glm::dvec3(-k.fx / p.z, 0, k.fx * p.x / (p.z * p.z)));
    const glm::dvec3 dv = glm::transpose(toCamera) * (glm::dvec3(0, k.fy / p.z, -k.fy * p.y / (p.z * p.z)));
    const glm::dvec2 error(k.cx - k.fx * p.x / p.z - pixels[i].x, k.cy + k.fy * p.y / p.z - pixels[i].y);
    normal += glm::outerProduct(du, du) + glm::outerProduct(dv, dv);
    right += du * error.x + dv * error.y;
  }
  const glm::dmat3 inverse = glm::inverse(normal);
  const glm::dvec3 next = point - inverse * right;
  return std::isfinite(next.x + next.y + next.z) ? std::optional(next) : std::nullopt;
}

// Disjoint sets of features: union by size. Sets are joined only if they have no photograph in common.
class Sets {
 public:
  using Feature = std::pair<std::uint32_t, std::uint32_t>;  // photograph, index of its feature

  void join(Feature a, Feature b) {
    std::size_t left = rootOf(indexOf(a)), right = rootOf(indexOf(b));
    if (left == right) return;
    if (members_[left].size() < members_[right].size()) std::swap(left, right);
    std::vector<Feature>& into = members_[left];
    for (const Feature& f : members_[right])
      if (std::ranges::any_of(into, [&](const Feature& g) { return g.first == f.first; })) return;
    into.insert(into.end(), members_[right].begin(), members_[right].end());
    std::vector<Feature>().swap(members_[right]);
    parent_[right] = left;
  }
  std::vector<std::vector<Feature>> take() {
    for (auto& set : members_) std::ranges::sort(set);
    std::erase_if(members_, [](const auto& set) { return set.size() < 2; });
    std::ranges::sort(members_);
    return std::move(members_);
  }

 private:
  std::size_t indexOf(Feature f) {
    const auto [found, fresh] = index_.emplace(std::uint64_t(f.first) << 32 | f.second, parent_.size());
    if (fresh) {
      parent_.push_back(parent_.size());
      members_.push_back({f});
    }
    return found->second;
  }
  std::size_t rootOf(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  std::unordered_map<std::uint64_t, std::size_t> index_;
  std::vector<std::size_t> parent_;
  std::vector<std::vector<Feature>> members_;
};

std::uint64_t featureKey(std::uint64_t photograph) {
  Hash hash;
  hash.add(kFeaturesVersion);
  hash.add(photograph);
  return hash.value();
}

fs::path featuresFile(const OwnTracksInput& input, std::uint32_t photograph) {
  return cacheFile(input.cacheFolder, featureKey(input.hashes[photograph]), "features");
}

Features cachedFeatures(const OwnTracksInput& input, std::uint32_t photograph) {
  std::optional<Features> features = fetchFeatures(featuresFile(input, photograph));
  check(features.has_value(), ErrorCode::io, "{}: cached features are missing; build again",
        input.cacheFolder.string());
  return std::move(*features);
}

std::uint64_t matchKey(std::uint64_t a, std::uint64_t b) {
  Hash hash;
  hash.add(kMatchesVersion);
  hash.add(featureKey(a));
  hash.add(featureKey(b));
  return hash.value();
}

void storeMatches(const fs::path& file, const std::vector<FeatureMatch>& matches) {
  const auto bytes = std::as_bytes(std::span(matches));
  storeCached(file, {bytes.begin(), bytes.end()});
}

std::optional<std::vector<FeatureMatch>> fetchMatches(const fs::path& file) {
  const auto bytes = fetchCached(file);
  if (!bytes || bytes->size() % sizeof(FeatureMatch) != 0) return std::nullopt;
  std::vector<FeatureMatch> matches(bytes->size() / sizeof(FeatureMatch));
  if (!matches.empty()) std::memcpy(matches.data(), bytes->data(), bytes->size());
  return matches;
}

// Drops the worst observation until all are within kMaxResidualPx. Returns an empty track if fewer than two remain.
Track trackOf(const PosedModel& model, std::vector<TrackObservation> seen) {
  while (seen.size() >= 2) {
    std::vector<Camera> cameras;
    std::vector<glm::dvec2> pixels;
    for (const TrackObservation& o : seen) {
      cameras.push_back(model.images[o.image].camera);
      pixels.push_back(o.pixel);
    }
    const auto point = triangulate(cameras, pixels);
    if (!point) return {};
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto pixel = seenAt(cameras[i], *point);
      const double error = pixel ? glm::distance(*pixel, pixels[i]) : 1e9;
      if (error > most) most = error, worst = i;
    }
    if (most < kMaxResidualPx) return {*point, std::move(seen)};
    if (seen.size() == 2) return {};
    seen.erase(seen.begin() + std::ptrdiff_t(worst));
  }
  return {};
}

}  // namespace

std::vector<ImagePair> pairsWithoutTracks(const PosedModel& model, const PairOptions& options) {
  const std::size_t count = model.images.size();
  const double cosine = std::cos(options.angleDegrees / 180.0 * std::numbers::pi);
  std::vector<glm::dvec3> axes;
  for (const PosedImage& image : model.images) axes.push_back(viewAxis(image.camera.pose));
  std::map<ImagePair, std::size_t> shared;
  for (const Track& track : model.tracks)
    for (std::size_t i = 0; i < track.observations.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const auto [low, high] = std::minmax(track.observations[i].image, track.observations[j].image);
        if (low != high) ++shared[{low, high}];
      }
  std::set<ImagePair> pairs;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Camera& camera = model.images[i].camera;
    if (camera.intrinsics.model != CameraModel::pinhole) continue;
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t j = 0; j < count; ++j) {
      const Camera& other = model.images[j].camera;
      if (j == i || other.intrinsics.model != CameraModel::pinhole || glm::dot(axes[i], axes[j]) < cosine) continue;
      if (const double d = glm::distance(camera.pose.position, other.pose.position); d > 0) near.push_back({d, j});
    }
    std::ranges::sort(near);
    if (near.size() > options.neighbours) near.resize(options.neighbours);
    for (const auto& [d, j] : near) {
      const ImagePair pair = std::minmax(i, j);
      const auto known = shared.find(pair);
      if (known == shared.end() || known->second < options.enough) pairs.insert(pair);
    }
  }
  return {pairs.begin(), pairs.end()};
}

std::optional<glm::dvec3> triangulate(std::span<const Camera> cameras, std::span<const glm::dvec2> pixels) {
  std::optional<glm::dvec3> point = nearestToRays(cameras, pixels);
  for (int step = 0; step < 5 && point; ++step) point = refinePoint(cameras, pixels, *point);
  if (!point) return std::nullopt;
  for (const Camera& camera : cameras)
    if (!seenAt(camera, *point)) return std::nullopt;
  return point;
}

std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> joinMatches(
    std::span<const ImagePair> pairs, std::span<const std::vector<FeatureMatch>> matches) {
  struct Edge {
    int distance;
    std::uint32_t pair, match;
  };
  std::vector<Edge> edges;
  for (std::uint32_t p = 0; p < pairs.size(); ++p)
    for (std::uint32_t m = 0; m < matches[p].size(); ++m) edges.push_back({matches[p][m].distance, p, m});
  std::ranges::sort(edges, {}, [](const Edge& e) { return std::tuple(e.distance, e.pair, e.match); });
  Sets sets;
  for (const Edge& e : edges)
    sets.join({pairs[e.pair].first, matches[e.pair][e.match].a}, {pairs[e.pair].second, matches[e.pair][e.match].b});
  return sets.take();
}

void findFeatures(const OwnTracksInput& input, std::uint32_t photograph) {
  const fs::path file = featuresFile(input, photograph);
  if (!fetchFeatures(file)) storeFeatures(file, detectFeatures(toGrey(input.view(photograph).picture), kMaxFeatures));
}

double bytesToFindFeatures(const OwnTracksInput& input, double pixels) {
  return input.bytesOfView + std::min(pixels, kFeaturePixels) * kFeatureBytesPerPixel;
}

fs::path matchesFile(const OwnTracksInput& input, ImagePair pair) {
  return cacheFile(input.cacheFolder, matchKey(input.hashes[pair.first], input.hashes[pair.second]), "matches");
}

std::vector<FeatureMatch> matchesOf(const OwnTracksInput& input, ImagePair pair) {
  const auto [a, b] = pair;
  const fs::path file = matchesFile(input, pair);
  if (auto cached = fetchMatches(file)) return std::move(*cached);
  const Features left = cachedFeatures(input, a), right = cachedFeatures(input, b);
  std::vector<FeatureMatch> matches = matchGuided(input.cameras[a], left, input.cameras[b], right);
  storeMatches(file, matches);
  return matches;
}

std::vector<Track> makeTracks(const PosedModel& model, std::span<const ImagePair> pairs, const OwnTracksInput& input,
                              const RunJobs& run) {
  std::set<std::uint32_t> wanted;
  for (const auto& [a, b] : pairs) wanted.insert({a, b});
  const std::vector<std::uint32_t> images(wanted.begin(), wanted.end());
  double pixels = 0;
  for (const std::uint32_t i : images) {
    const Intrinsics& k = model.images[i].camera.intrinsics;
    pixels = std::max(pixels, double(k.width) * k.height);
  }
  std::vector<glm::dvec2> scale(model.images.size());  // from px of the features to px of the model
  for (const std::uint32_t i : images) {
    const Intrinsics &small = input.cameras[i].intrinsics, &whole = model.images[i].camera.intrinsics;
    scale[i] = {double(whole.width) / small.width, double(whole.height) / small.height};
  }
  run("finding features", images.size(), bytesToFindFeatures(input, pixels),
      [&](std::size_t n) { findFeatures(input, images[n]); });

  std::vector<std::vector<FeatureMatch>> matches(pairs.size());
  run("matching features", pairs.size(), kBytesToMatchPair,
      [&](std::size_t p) { matches[p] = matchesOf(input, pairs[p]); });

  const auto sets = joinMatches(pairs, matches);
  std::vector<std::vector<glm::vec2>> places(model.images.size());
  for (const std::uint32_t i : images) {
    places[i] = cachedFeatures(input, i).at;
  }
  std::vector<Track> all(sets.size());
  constexpr std::size_t kBatch = 4096;
  run("triangulating tracks", (sets.size() + kBatch - 1) / kBatch, 1e6, [&](std::size_t batch) {
    for (std::size_t s = batch * kBatch; s < std::min(sets.size(), (batch + 1) * kBatch); ++s) {
      std::vector<TrackObservation> seen;
      for (const auto& [image, feature] : sets[s])
        seen.push_back({image, glm::dvec2(places[image][feature]) * scale[image]});
      all[s] = trackOf(model, std::move(seen));
    }
  });
  std::erase_if(all, [](const Track& track) { return track.observations.empty(); });
  return all;
}

}  // namespace ibr
