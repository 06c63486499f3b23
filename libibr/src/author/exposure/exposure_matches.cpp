// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <utility>

#include "author/exposure/exposure.h"
#include "author/exposure/exposure_overlap.h"
#include "author/exposure/vignetting.h"
#include "author/geometry/disjoint_sets.h"
#include "author/photographs/masks.h"
#include "base/srgb.h"

namespace ibr {
namespace {

constexpr int kMinLevel = 4, kMaxLevel = 250;  // 8-bit levels; beyond: clipped, or noise
constexpr double kMinMean = 0.003;             // linear light
constexpr double kLevelDeviation = 0.7 / 255;  // standard deviation of an encoded mean: rounding, compression
constexpr double kTextureShare = 0.5;          // share of a window's own variation: two windows never match exactly
constexpr std::size_t kMaxPartners = 12;       // per photograph in a track
constexpr double kTrackDeviation = 0.02;       // of a log ratio, from a track …
constexpr double kTurnDeviation = 0.5;         // … plus this per radian between the two rays to the point
constexpr double kOverlapDeviation = 0.005;    // of a log ratio, from an overlap: JPEG errors
constexpr double kMaxSizeRatio = 4;            // max ratio of window sizes

// Mean linear light of a window around a point.
struct Colour {
  glm::vec3 logs{0.0f};
  float noise = -1;   // variance of the logs, mean over channels; negative: unusable
  float texture = 0;  // variance of the window's pixels over their squared mean
  float radius = 0;   // ExposureMatch::firstRadius
};

const std::array<double, 256>& linearLight() {
  static const auto table = [] {
    std::array<double, 256> t{};
    for (std::size_t v = 0; v < t.size(); ++v) t[v] = srgbToLinear(double(v) / 255);
    return t;
  }();
  return table;
}

int radiusIn(const Image8& picture) {
  return std::clamp(std::max(picture.width, picture.height) / 400, 2, 8);
}

// A window of a photograph, and the index of its Colour. The window's points are at + i·right + j·down.
struct Sample {
  glm::vec2 at, right, down;  // px
  std::size_t colour;
};

// Bilinear linear light; nullopt if one of the four pixels is clipped or noise.
std::optional<glm::dvec3> linearLightAt(const Image8& picture, glm::vec2 at) {
  const std::array<double, 256>& linear = linearLight();
  const double u = double(at.x) - 0.5, v = double(at.y) - 0.5;
  const int x = int(std::floor(u)), y = int(std::floor(v));
  if (x < 0 || y < 0 || x + 1 >= picture.width || y + 1 >= picture.height) return std::nullopt;
  glm::dvec3 light(0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const double weight = (i ? u - x : 1 - (u - x)) * (j ? v - y : 1 - (v - y));
      const auto pixel = picture.pixel(x + i, y + j);
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t level = pixel[std::size_t(c)];
        if (level < kMinLevel || level > kMaxLevel) return std::nullopt;
        light[c] += weight * linear[level];
      }
    }
  return light;
}

Colour colourAt(const Image8& picture, const Image8& mask, const Sample& sample) {
  const int radius = radiusIn(picture);
  glm::dvec3 sum(0), squares(0);
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) {
      const glm::vec2 at = sample.at + float(i) * sample.right + float(j) * sample.down;
      const auto light = linearLightAt(picture, at);
      if (!light || isIgnored(mask, at)) return {};
      sum += *light;
      squares += *light * *light;
    }
  const double count = (2 * radius + 1) * (2 * radius + 1);
  Colour colour{glm::vec3(0.0f), 0, 0, 0};
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / count;
    if (mean < kMinMean) return {};
    const double slope = 2.4 / (linearToSrgb(mean) + 0.055);  // of the log with respect to the encoded value
    colour.logs[c] = float(std::log(mean));
    colour.noise += float(slope * slope * kLevelDeviation * kLevelDeviation / 3);
    colour.texture += float(std::max(squares[c] / count - mean * mean, 0.0) / (mean * mean) / 3);
  }
  return colour;
}

// All windows of a build, by photograph.
class Samples {
 public:
  explicit Samples(std::size_t photographs) : of_(photographs) {}

  // Returns the index of the window's Colour.
  std::size_t add(std::uint32_t photograph, glm::vec2 at, glm::vec2 right, glm::vec2 down) {
    of_[photograph].push_back({at, right, down, count_});
    return count_++;
  }

  std::vector<Colour> colours(const std::vector<Photograph>& photographs, const BuildJobs& jobs) const {
    std::vector<Colour> colours(count_);
    double bytes = 0;
    for (const Photograph& photograph : photographs) bytes = std::max(bytes, bytesToLoad(photograph));
    jobs.runAll("comparing exposures", photographs.size(), bytes, [&](std::size_t n) {
      if (of_[n].empty()) return;
      const Image8 picture = loadPhotograph(photographs[n]), mask = storedMask(photographs[n]);
      for (const Sample& sample : of_[n]) {
        colours[sample.colour] = colourAt(picture, mask, sample);
        colours[sample.colour].radius =
            float(vignettingRadius(photographs[n].camera.intrinsics, glm::dvec2(sample.at)));
      }
    });
    return colours;
  }

 private:
  std::vector<std::vector<Sample>> of_;
  std::size_t count_ = 0;
};

// Two windows that show one point.
struct Pair {
  std::uint32_t first, second;  // photographs
  std::size_t firstColour, secondColour;
  double deviation;  // of the log ratio …
  double texture;    // … plus this share of the windows' own variation, since windows never match exactly
};

// A small square in the world, or in the sky.
struct Patch {
  glm::dvec4 centre;       // homogeneous
  glm::dvec3 right, down;  // unit, orthogonal
};

// Patch perpendicular to `ray`, on which its centre lies.
Patch patchAcross(glm::dvec4 centre, glm::dvec3 ray) {
  const glm::dvec3 other = std::abs(ray.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(ray, other));
  return {centre, right, glm::cross(ray, right)};
}

// Projection of a patch into a photograph: its centre, and px per world unit (in the sky: per radian) along its
// sides.
struct PatchView {
  glm::dvec2 at, right, down;

  double size() const { return std::sqrt(std::abs(right.x * down.y - right.y * down.x)); }
};

std::optional<PatchView> viewOf(const Camera& camera, const Patch& patch) {
  const glm::dvec3 ray = glm::dvec3(patch.centre) - patch.centre.w * camera.pose.position;
  const double step = 1e-4 * glm::length(ray);
  const auto seen = [&](glm::dvec3 direction) {
    return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * direction);
  };
  const auto at = seen(ray), right = seen(ray + step * patch.right), down = seen(ray + step * patch.down);
  if (!at || !right || !down) return std::nullopt;
  return PatchView{*at, (*right - *at) / step, (*down - *at) / step};
}

// Adds windows of equal extent in the world in all photographs, with the resolution of the coarsest. Windows of
// different extent would have different means, since features are brighter or darker than their surroundings.
void addPatch(const Patch& patch, const std::vector<std::uint32_t>& seenBy, const std::vector<Photograph>& photographs,
              const std::vector<glm::dvec2>* places, double deviation, Samples& samples, std::vector<Pair>& pairs,
              DisjointSets* parts = nullptr) {
  std::vector<PatchView> views;
  std::vector<std::uint32_t> seen;
  for (std::size_t i = 0; i < seenBy.size(); ++i)
    if (auto view = viewOf(photographs[seenBy[i]].camera, patch)) {
      if (places) view->at = (*places)[i];
      views.push_back(*view);
      seen.push_back(seenBy[i]);
    }
  if (views.empty()) return;
  const double least = std::ranges::min(views, {}, &PatchView::size).size();
  std::vector<std::size_t> colours(views.size());
  std::vector<bool> used(views.size(), false);
  for (std::size_t i = 0; i < views.size(); ++i)
    if (used[i] = least > 0 && views[i].size() <= kMaxSizeRatio * least; used[i])
      colours[i] = samples.add(seen[i], views[i].at, views[i].right / least, views[i].down / least);
  const auto ray = [&](std::uint32_t n) {
    return glm::normalize(patch.centre.w * photographs[n].camera.pose.position - glm::dvec3(patch.centre));
  };
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(seen.size(), i + 1 + kMaxPartners); ++j)
      if (used[i] && used[j] && seen[i] != seen[j] && (!parts || parts->find(seen[i]) != parts->find(seen[j])))
        pairs.push_back({seen[i], seen[j], colours[i], colours[j],
                         deviation + kTurnDeviation * glm::distance(ray(seen[i]), ray(seen[j])), kTextureShare});
}

// Adds pairs of photographs that overlaps leave unconnected: tracks are small features seen from afar, less reliable.
void addTrack(const Track& track, const std::vector<Photograph>& photographs, const std::vector<glm::dvec2>& scale,
              DisjointSets& parts, Samples& samples, std::vector<Pair>& pairs) {
  std::vector<std::uint32_t> seenBy;
  std::vector<glm::dvec2> places;
  glm::dvec3 mean(0);
  for (const TrackObservation& o : track.observations) {
    seenBy.push_back(o.image);
    places.push_back(o.pixel * scale[o.image]);
    mean += glm::normalize(track.position - photographs[o.image].camera.pose.position);
  }
  if (!(glm::length(mean) > 1e-6)) return;
  addPatch(patchAcross(glm::dvec4(track.position, 1), glm::normalize(mean)), seenBy, photographs, &places,
           kTrackDeviation, samples, pairs, &parts);
}

void addOverlap(const OverlapPoint& point, const std::vector<Photograph>& photographs, Samples& samples,
                std::vector<Pair>& pairs) {
  const glm::dvec3 position = photographs[point.first].camera.pose.position;
  const glm::dvec4 centre(point.ray + point.inverseDistance * position, point.inverseDistance);
  addPatch(patchAcross(centre, point.ray), {point.first, point.second}, photographs, nullptr, kOverlapDeviation,
           samples, pairs);
}

}  // namespace

std::vector<ExposureMatch> exposureMatches(const std::vector<Photograph>& photographs, const PosedModel& model,
                                           const std::vector<PhotographDepth>& depths, const BuildJobs& jobs) {
  Samples samples(photographs.size());
  std::vector<Pair> pairs;
  for (const OverlapPoint& point : overlapPoints(photographs, model, depths, jobs))
    addOverlap(point, photographs, samples, pairs);
  DisjointSets parts(photographs.size());
  for (const Pair& pair : pairs) parts.unite(pair.first, pair.second);
  std::vector<glm::dvec2> modelScale;  // from px of the model to px of the photographs
  for (std::size_t n = 0; n < photographs.size(); ++n) {
    const Intrinsics &from = model.images[n].camera.intrinsics, &to = photographs[n].camera.intrinsics;
    modelScale.emplace_back(double(to.width) / from.width, double(to.height) / from.height);
  }
  for (const Track& track : model.tracks)
    if (track.observations.size() > 1) addTrack(track, photographs, modelScale, parts, samples, pairs);
  const std::vector<Colour> colours = samples.colours(photographs, jobs);
  std::vector<ExposureMatch> matches;
  for (const Pair& pair : pairs) {
    const Colour &a = colours[pair.firstColour], &b = colours[pair.secondColour];
    if (a.noise < 0 || b.noise < 0) continue;
    const double texture = pair.texture * pair.texture * (double(a.texture) + double(b.texture));
    matches.push_back({pair.first, pair.second, glm::dvec3(a.logs) - glm::dvec3(b.logs),
                       std::sqrt(double(a.noise) + double(b.noise) + texture + pair.deviation * pair.deviation),
                       a.radius, b.radius});
  }
  return matches;
}

}  // namespace ibr
