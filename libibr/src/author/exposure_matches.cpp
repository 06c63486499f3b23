// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

#include "author/exposure.h"
#include "image/srgb.h"

namespace ibr {
namespace {

constexpr std::size_t kMostPoints = 1000;      // of a cell
constexpr int kDarkest = 4, kBrightest = 250;  // levels; what is beyond is clipped, or noise
constexpr double kLeastMean = 0.003;           // linear light
constexpr double kLevelDeviation = 0.7 / 255;  // of an encoded mean: rounding, compression
constexpr double kTextureShare = 0.25;         // of a window's own spread: two photographs do not show the same window
constexpr std::size_t kMostPartners = 12;      // of a photograph in a track
constexpr double kTrackDeviation = 0.02;       // of a log ratio …
constexpr double kTurnDeviation = 0.5;         // … and more of it by the radian between two rays to a point
constexpr double kMostScale = 4;               // of windows
constexpr double kLeastDeviation = 0.01;       // of a log ratio: surfaces shine

// Linear light around a point.
struct Colour {
  glm::vec3 logs{0.0f};
  float variance = -1;  // of the logs, mean over channels; negative: there is none
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

Colour colourAt(const Image8& picture, glm::vec2 at, double scale) {
  const int radius = int(std::lround(scale * (radiusIn(picture) + 0.5) - 0.5)), x = int(std::floor(at.x)),
            y = int(std::floor(at.y));
  if (x < radius || y < radius || x + radius >= picture.width || y + radius >= picture.height) return {};
  const std::array<double, 256>& linear = linearLight();
  glm::dvec3 sum(0), squares(0);
  for (int j = y - radius; j <= y + radius; ++j)
    for (int i = x - radius; i <= x + radius; ++i) {
      const auto pixel = picture.pixel(i, j);
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t level = pixel[std::size_t(c)];
        if (level < kDarkest || level > kBrightest) return {};
        const double light = linear[level];
        sum[c] += light;
        squares[c] += light * light;
      }
    }
  const double count = (2 * radius + 1) * (2 * radius + 1);
  Colour colour{glm::vec3(0.0f), 0};
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / count;
    if (mean < kLeastMean) return {};
    const double spread = std::max(squares[c] / count - mean * mean, 0.0) / (mean * mean);
    const double slope = 2.4 / (linearToSrgb(mean) + 0.055);  // of the log by the encoded value
    colour.logs[c] = float(std::log(mean));
    colour.variance +=
        float((slope * slope * kLevelDeviation * kLevelDeviation + kTextureShare * kTextureShare * spread) / 3);
  }
  return colour;
}

// Vertices of tier 0, evenly chosen.
std::vector<std::uint32_t> pointsOf(const MorphMesh& mesh) {
  std::vector<bool> agrees(mesh.pointCount(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.tier[t] == kTierAgrees)
      for (int k = 0; k < 3; ++k) agrees[mesh.triangles[t][k]] = true;
  std::vector<std::uint32_t> all, points;
  for (std::uint32_t p = 0; p < agrees.size(); ++p)
    if (agrees[p]) all.push_back(p);
  const std::size_t count = std::min(all.size(), kMostPoints);
  for (std::size_t i = 0; i < count; ++i) points.push_back(all[i * all.size() / count]);
  return points;
}

// Where a photograph is looked at, and where its colour goes to.
struct Sample {
  glm::vec2 at;
  double scale;  // of the window
  std::size_t colour;
};

// All of a build's points in all photographs that show them.
class Samples {
 public:
  explicit Samples(std::size_t photographs) : of_(photographs) {}

  // The colour's place.
  std::size_t add(std::uint32_t photograph, glm::vec2 at, double scale = 1) {
    of_[photograph].push_back({at, scale, count_});
    return count_++;
  }

  std::vector<Colour> colours(const std::vector<Photograph>& photographs, const BuildJobs& jobs) const {
    std::vector<Colour> colours(count_);
    double bytes = 0;
    for (const Photograph& photograph : photographs) bytes = std::max(bytes, bytesToLoad(photograph));
    jobs.runAll("comparing exposures", photographs.size(), bytes, [&](std::size_t n) {
      if (of_[n].empty()) return;
      const Image8 picture = loadPhotograph(photographs[n]);
      for (const Sample& sample : of_[n]) colours[sample.colour] = colourAt(picture, sample.at, sample.scale);
    });
    return colours;
  }

 private:
  std::vector<std::vector<Sample>> of_;
  std::size_t count_ = 0;
};

// Two places that show one point.
struct Pair {
  std::uint32_t first, second;  // photographs
  std::size_t firstColour, secondColour;
  double deviation;
};

void addCell(const Cell& cell, Samples& samples, std::vector<Pair>& pairs) {
  const std::vector<std::uint32_t> points = pointsOf(cell.mesh);
  std::vector<std::size_t> begin;
  for (std::size_t i = 0; i < cell.members.size(); ++i)
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t colour = samples.add(cell.members[i], cell.mesh.match[i][points[k]]);
      if (k == 0) begin.push_back(colour);
    }
  for (std::size_t i = 1; i < begin.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < points.size(); ++k)
        pairs.push_back({cell.members[i], cell.members[j], begin[i] + k, begin[j] + k, kLeastDeviation});
}

// Pixels that a patch of the world at a point is wide, per its width, as seen across.
double magnification(const Camera& camera, glm::dvec3 point) {
  const glm::dvec3 ray = glm::conjugate(camera.pose.rotation) * (point - camera.pose.position);
  const Intrinsics& k = camera.intrinsics;
  const double distance = glm::length(ray);
  if (k.model == CameraModel::equirectangular) return k.width / (2 * std::numbers::pi * distance);
  return std::sqrt(k.fx * k.fy) / (distance * std::pow(std::max(-ray.z / distance, 1e-3), 1.5));
}

// Features are spots that are lighter or darker than what is around them: windows that show more of the world would be
// less so. So they show as much in all photographs.
void addTrack(const Track& track, const std::vector<Photograph>& photographs, const std::vector<glm::dvec2>& scale,
              Samples& samples, std::vector<Pair>& pairs) {
  std::vector<double> sizes;
  for (const TrackObservation& o : track.observations)
    sizes.push_back(magnification(photographs[o.image].camera, track.position));
  const double least = *std::ranges::min_element(sizes);
  std::vector<std::pair<std::uint32_t, std::size_t>> seen;  // photograph, colour
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (const TrackObservation& o = track.observations[i]; sizes[i] <= kMostScale * least)
      seen.emplace_back(o.image, samples.add(o.image, glm::vec2(o.pixel * scale[o.image]), sizes[i] / least));
  const auto turn = [&](std::uint32_t a, std::uint32_t b) {
    const auto ray = [&](std::uint32_t n) {
      return glm::normalize(photographs[n].camera.pose.position - track.position);
    };
    return glm::distance(ray(a), ray(b));
  };
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(seen.size(), i + 1 + kMostPartners); ++j)
      if (seen[i].first != seen[j].first)
        pairs.push_back({seen[i].first, seen[j].first, seen[i].second, seen[j].second,
                         kTrackDeviation + kTurnDeviation * turn(seen[i].first, seen[j].first)});
}

}  // namespace

std::vector<ExposureMatch> exposureMatches(const std::vector<Photograph>& photographs, const PosedModel& model,
                                           const std::vector<Cell>& cells, const BuildJobs& jobs) {
  Samples samples(photographs.size());
  std::vector<Pair> pairs;
  for (const Cell& cell : cells) addCell(cell, samples, pairs);
  std::vector<glm::dvec2> scale;  // from the model's pixels to those of the photographs
  for (std::size_t n = 0; n < photographs.size(); ++n) {
    const Intrinsics &from = model.images[n].camera.intrinsics, &to = photographs[n].camera.intrinsics;
    scale.emplace_back(double(to.width) / from.width, double(to.height) / from.height);
  }
  for (const Track& track : model.tracks)
    if (track.observations.size() > 1) addTrack(track, photographs, scale, samples, pairs);
  const std::vector<Colour> colours = samples.colours(photographs, jobs);
  std::vector<ExposureMatch> matches;
  for (const Pair& pair : pairs) {
    const Colour &a = colours[pair.firstColour], &b = colours[pair.secondColour];
    if (a.variance < 0 || b.variance < 0) continue;
    matches.push_back({pair.first, pair.second, glm::dvec3(a.logs) - glm::dvec3(b.logs),
                       std::sqrt(double(a.variance) + double(b.variance) + pair.deviation * pair.deviation)});
  }
  return matches;
}

std::vector<glm::dvec3> exposureGains(const std::vector<Photograph>& photographs, const PosedModel& model,
                                      const std::vector<Cell>& cells, const BuildJobs& jobs) {
  std::vector<CaptureFacts> exif;
  for (const Photograph& photograph : photographs) exif.push_back(photograph.capture);
  return solveExposures(photographs.size(), exposureMatches(photographs, model, cells, jobs), exif);
}

}  // namespace ibr
