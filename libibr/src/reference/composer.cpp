// SPDX-License-Identifier: Apache-2.0
#include "reference/composer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/median.h"
#include "base/parallel.h"
#include "ibr/scene.h"
#include "image/bilinear.h"
#include "image/raster.h"
#include "scene/capture_spacing.h"
#include "scene/reprojection.h"

namespace ibr::reference {
namespace {

// Fixed: depth maps are compared by them.
constexpr double kAngleFloor = 0.03;              // radians, added to every angle
constexpr double kBorderShare = 0.04;             // of the width, along which a photograph comes and goes
constexpr double kDistanceCost = 0.001;           // radians a spacing
constexpr double kLargestResolution = 1.5;        // of the view's: a finer photograph is no better
constexpr double kVisibilityFloor = 0.002;        // a hidden photograph is better than none
constexpr double kBehindVisibility = 0.25;        // where the photograph's own surface stands behind the point
constexpr double kOwnPlace = 0.01;                // radians of cost within which hiding and borders stop to count
constexpr double kSupportShare = 0.05;            // of the largest support of a pixel: less is no layer
constexpr double kFullConsensus = 0.9;            // consensus from which on a layer hides all behind it
constexpr double kColourSpread = 15;              // 8-bit levels; a layer whose colours differ by this counts half
constexpr double kStepTolerance = 2;              // t: steps …
constexpr double kShareTolerance = 0.01;          // … and a share of ρ
constexpr double kLargestJump = 2;                // steps between neighbours of a depth map that one surface joins
constexpr double kNearestRay = 0.05;              // cosine-like limit: geometry beside the view is not drawn
constexpr std::array kCandidateDepths{1.6, 0.4};  // of the median ρ
constexpr int kCandidateColumns = 16, kCandidateRows = 9;
constexpr double kFadeShare = 0.25;  // a candidate whose gain exceeds that of rank K + 1 by this share counts in full
constexpr std::size_t kLayers = 2;

double trustOf(int confirmations) {
  constexpr std::array kTrust{0.06, 0.25, 0.7, 1.0};
  return kTrust[std::size_t(std::clamp(confirmations, 0, 3))];
}

double smoothstep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double toleranceOf(double step, double inverseDepth) {
  return kStepTolerance * step + kShareTolerance * inverseDepth;
}

double borderWeight(const Intrinsics& k, glm::dvec2 pixel) {
  const double inside = std::min(std::min(pixel.x, k.width - pixel.x), std::min(pixel.y, k.height - pixel.y));
  return std::clamp(inside / (kBorderShare * k.width), 0.0, 1.0);
}

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Camera scaledTo(Camera camera, int width, int height) {
  camera.intrinsics = resized(camera.intrinsics, width, height);
  return camera;
}

float bilinear(const ImageF& map, double x, double y) {
  const double u = std::clamp(x - 0.5, 0.0, map.width - 1.0), v = std::clamp(y - 0.5, 0.0, map.height - 1.0);
  const int left = int(u), top = int(v), right = std::min(left + 1, map.width - 1),
            below = std::min(top + 1, map.height - 1);
  const double s = u - left, t = v - top;
  return float((1 - t) * ((1 - s) * double(map.pixel(left, top)[0]) + s * double(map.pixel(right, top)[0])) +
               t * ((1 - s) * double(map.pixel(left, below)[0]) + s * double(map.pixel(right, below)[0])));
}

// The largest ρ in each block that a quarter of the photograph's resolution has as one pixel.
ImageF blockMaxima(const ImageF& map, int photographWidth) {
  const int block = std::max(1, int(std::lround(4.0 * map.width / photographWidth)));
  ImageF result((map.width + block - 1) / block, (map.height + block - 1) / block, 1, 0.0f);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      float& most = result.pixel(x / block, y / block)[0];
      most = std::max(most, map.pixel(x, y)[0]);
    }
  return result;
}

// What one candidate says of a pixel of the view.
struct Hypothesis {
  float inverseDepth = -1;  // −1: nothing
  float trust = 0, consensus = 0;
  bool completed = false;
};
using Layer = std::vector<Hypothesis>;

// A depth map as a grid of triangles, as the view sees it; the nearest surface wins.
Layer drawn(const Camera& view, const ComposerPhotograph& photograph) {
  const PhotographDepth& depth = photograph.depth;
  const ImageF& map = depth.inverseDepth;
  const Reprojection towards(scaledTo(photograph.camera, map.width, map.height), view);
  struct Vertex {
    glm::dvec2 pixel{0};
    double inverseDepth = -1;  // in the view; −1: not before it
  };
  std::vector<Vertex> vertices(map.values.size());
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const double w = double(map.pixel(x, y)[0]);
      const glm::dvec3 direction = towards.ray({x + 0.5, y + 0.5}) + w * towards.shift();
      if (direction.z < -kNearestRay)
        vertices[std::size_t(y) * std::size_t(map.width) + std::size_t(x)] = {towards.pixel(direction),
                                                                              w / -direction.z};
    }
  const int width = view.intrinsics.width, height = view.intrinsics.height;
  Layer layer(std::size_t(width) * std::size_t(height));
  const auto draw = [&](std::array<std::size_t, 3> corner) {
    std::array<double, 3> rho, trust, consensus;
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      rho[k] = vertices[corner[k]].inverseDepth;
      if (rho[k] < 0) return;
      const double own = double(map.values[corner[k]]);
      low = std::min(low, own);
      high = std::max(high, own);
      trust[k] = trustOf(depth.confirmations.values[corner[k]]);
      consensus[k] = double(depth.consensus.values[corner[k]]);
    }
    if (high - low > kLargestJump * depth.step) return;
    forPixelsIn(
        vertices[corner[0]].pixel, vertices[corner[1]].pixel, vertices[corner[2]].pixel, width, height,
        [&](int x, int y, const glm::dvec3& weight) {
          const auto mean = [&](const std::array<double, 3>& of) {
            return float(weight.x * of[0] + weight.y * of[1] + weight.z * of[2]);
          };
          Hypothesis& here = layer[std::size_t(y) * std::size_t(width) + std::size_t(x)];
          const float inverseDepth = mean(rho);
          if (inverseDepth <= here.inverseDepth) return;
          const std::size_t nearest = weight.x >= weight.y && weight.x >= weight.z ? 0 : weight.y >= weight.z ? 1 : 2;
          here = {inverseDepth, mean(trust), mean(consensus), depth.confirmations.values[corner[nearest]] == 0};
        });
  };
  for (int y = 0; y + 1 < map.height; ++y)
    for (int x = 0; x + 1 < map.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(map.width) + std::size_t(x),
                        below = at + std::size_t(map.width);
      draw({at, at + 1, below});
      draw({at + 1, below + 1, below});
    }
  return layer;
}

// A surface of the view that colours are gathered for.
struct Surface {
  double inverseDepth = 0;
  double opacity = 0;  // 0 to 1, of what lies behind
  bool completed = false;
};
struct Surfaces {
  std::array<Surface, kLayers> layer;
  std::size_t count = 0;
};

// The pixel's layers, nearest first. `hypotheses`: those that there are, with `weight` u each; sorted here.
struct Vote {
  double inverseDepth, weight, consensus;
  bool completed;
};
Surfaces vote(std::vector<Vote>& votes, double step) {
  Surfaces result;
  if (votes.empty()) return result;
  std::sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) { return a.inverseDepth > b.inverseDepth; });
  const std::size_t n = votes.size();
  const auto tolerance = [&](std::size_t i) { return toleranceOf(step, votes[i].inverseDepth); };
  const auto kernel = [&](std::size_t i, std::size_t j) {
    const double off = (votes[i].inverseDepth - votes[j].inverseDepth) / tolerance(i);
    return std::max(0.0, 1 - off * off);
  };
  std::vector<double> support(n, 0.0);
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) support[i] += votes[j].weight * kernel(i, j);
    most = std::max(most, support[i]);
  }
  const auto isPeak = [&](std::size_t i) {
    if (support[i] <= kSupportShare * most) return false;
    for (std::size_t j = 0; j < n; ++j)
      if (kernel(i, j) > 0 && (support[j] > support[i] || (support[j] == support[i] && j < i))) return false;
    return true;
  };
  for (std::size_t i = 0; i < n && result.count < kLayers; ++i) {
    if (!isPeak(i)) continue;
    double sum = 0, depth = 0, consensus = 0, completed = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double weight = votes[j].weight * kernel(i, j);
      sum += weight;
      depth += weight * votes[j].inverseDepth;
      consensus += weight * votes[j].consensus;
      completed += votes[j].completed ? weight : 0.0;
    }
    result.layer[result.count++] = {depth / sum, std::clamp(consensus / sum / kFullConsensus, 0.0, 1.0),
                                    completed > 0.5 * sum};
  }
  return result;
}

// Values where `known`, elsewhere those of ever coarser means: pull, then push.
void fillHoles(ImageF& map, const std::vector<bool>& known) {
  struct Level {
    int width, height;
    std::vector<double> value, weight;
  };
  std::vector<Level> levels{{map.width, map.height, {}, {}}};
  for (std::size_t at = 0; at < map.values.size(); ++at) {
    levels[0].value.push_back(known[at] ? double(map.values[at]) : 0.0);
    levels[0].weight.push_back(known[at] ? 1.0 : 0.0);
  }
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Level& fine = levels.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
    coarse.value.assign(std::size_t(coarse.width) * std::size_t(coarse.height), 0.0);
    coarse.weight = coarse.value;
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        const std::size_t from = std::size_t(y) * std::size_t(fine.width) + std::size_t(x),
                          to = std::size_t(y / 2) * std::size_t(coarse.width) + std::size_t(x / 2);
        coarse.value[to] += fine.weight[from] * fine.value[from];
        coarse.weight[to] += fine.weight[from];
      }
    for (std::size_t at = 0; at < coarse.value.size(); ++at)
      if (coarse.weight[at] > 0)
        coarse.value[at] /= coarse.weight[at], coarse.weight[at] = std::min(coarse.weight[at], 1.0);
    levels.push_back(std::move(coarse));
  }
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    Level& fine = levels[l];
    const Level& coarse = levels[l + 1];
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(fine.width) + std::size_t(x);
        if (fine.weight[at] >= 1) continue;
        const double u = std::clamp((x + 0.5) / 2 - 0.5, 0.0, coarse.width - 1.0),
                     v = std::clamp((y + 0.5) / 2 - 0.5, 0.0, coarse.height - 1.0);
        const int left = int(u), top = int(v), right = std::min(left + 1, coarse.width - 1),
                  below = std::min(top + 1, coarse.height - 1);
        const auto value = [&](int i, int j) {
          return coarse.value[std::size_t(j) * std::size_t(coarse.width) + std::size_t(i)];
        };
        const double s = u - left, t = v - top,
                     around = (1 - t) * ((1 - s) * value(left, top) + s * value(right, top)) +
                              t * ((1 - s) * value(left, below) + s * value(right, below));
        fine.value[at] = fine.weight[at] * fine.value[at] + (1 - fine.weight[at]) * around;
      }
  }
  for (std::size_t at = 0; at < map.values.size(); ++at)
    if (!known[at]) map.values[at] = float(levels[0].value[at]);
}

// A candidate as a view uses it.
struct Used {
  std::size_t photograph;
  double weight;    // as a whole
  double distance;  // of the two centres, world units
  Reprojection towards;
  double residual;  // ρ that moves a point by the photograph's reprojection residual over the spacing
};

// A colour that a layer may take.
struct Offer {
  double weight = 0;
  std::size_t candidate = 0;
  glm::dvec2 pixel{0};
};

struct Colour {
  glm::dvec3 mean{0};   // 8-bit levels
  double variance = 0;  // levels², mean over channels
  bool known = false;
};

}  // namespace

Composer::Composer(std::vector<ComposerPhotograph> photographs, const ComposerOptions& options)
    : photographs_(std::move(photographs)), options_(options) {
  check(!photographs_.empty(), ErrorCode::invalidInput, "there are no photographs to compose a view from");
  std::vector<Camera> cameras;
  std::vector<double> steps, depths;
  for (std::size_t i = 0; i < photographs_.size(); ++i) {
    const auto& [camera, depth] = photographs_[i];
    check(camera.intrinsics.model == CameraModel::pinhole, ErrorCode::invalidInput, "photograph {}: is no pinhole", i);
    const ImageF& map = depth.inverseDepth;
    check(!map.empty() && depth.confirmations.values.size() == map.values.size() &&
              depth.consensus.values.size() == map.values.size(),
          ErrorCode::invalidInput, "photograph {}: its depth maps are empty or of different sizes", i);
    check(depth.step > 0 && std::isfinite(depth.step), ErrorCode::invalidInput,
          "photograph {}: step {} is not positive", i, depth.step);
    cameras.push_back(camera);
    steps.push_back(depth.step);
    occluders_.push_back(blockMaxima(map, camera.intrinsics.width));
    constexpr std::size_t kEvery = 97;  // enough for a median
    for (std::size_t at = kEvery / 2; at < map.values.size(); at += kEvery)
      if (depth.confirmations.values[at] > 0) depths.push_back(double(map.values[at]));
  }
  spacing_ = captureSpacing(cameras);
  step_ = median(steps);
  medianInverseDepth_ = depths.empty() ? 0 : median(depths);
}

std::vector<Composer::Candidate> Composer::candidates(const Camera& view) const {
  constexpr std::size_t kPlaces = kCandidateColumns * kCandidateRows * kCandidateDepths.size();
  std::vector<std::array<double, kPlaces>> value(photographs_.size());
  for (std::size_t i = 0; i < photographs_.size(); ++i) {
    const Reprojection towards(view, photographs_[i].camera);
    std::size_t place = 0;
    for (const double depth : kCandidateDepths)
      for (int row = 0; row < kCandidateRows; ++row)
        for (int column = 0; column < kCandidateColumns; ++column, ++place) {
          value[i][place] = 0;
          const glm::dvec3 ray = towards.ray({(column + 0.5) / kCandidateColumns * view.intrinsics.width,
                                              (row + 0.5) / kCandidateRows * view.intrinsics.height}),
                           direction = ray + depth * medianInverseDepth_ * towards.shift();
          if (!(direction.z < 0)) continue;
          const glm::dvec2 pixel = towards.pixel(direction);
          if (!towards.inside(pixel)) continue;
          value[i][place] =
              borderWeight(photographs_[i].camera.intrinsics, pixel) / (kAngleFloor + angleBetween(ray, direction));
        }
  }
  std::array<double, kPlaces> sum{};
  const auto gain = [&](std::size_t i) {
    double total = 0;
    for (std::size_t p = 0; p < kPlaces; ++p) total += std::sqrt(sum[p] + value[i][p]) - std::sqrt(sum[p]);
    return total;
  };
  std::vector<bool> taken(photographs_.size(), false);
  std::vector<Candidate> result;
  std::vector<double> gains;
  while (gains.size() <= options_.candidates) {
    std::size_t best = photographs_.size();
    double most = 0;
    for (std::size_t i = 0; i < photographs_.size(); ++i)
      if (!taken[i])
        if (const double g = gain(i); g > most) most = g, best = i;
    gains.push_back(most);  // the last one's is that of rank K + 1
    if (best == photographs_.size() || gains.size() > options_.candidates) break;
    taken[best] = true;
    for (std::size_t p = 0; p < kPlaces; ++p) sum[p] += value[best][p];
    result.push_back({best, 1.0});
  }
  const double next = gains.back();
  for (std::size_t k = 0; k < result.size() && next > 0; ++k)
    result[k].weight = std::clamp((gains[k] / next - 1) / kFadeShare, 0.0, 1.0);
  return result;
}

Composed Composer::compose(const Camera& view, const PictureSource& pictures) const {
  const int width = view.intrinsics.width, height = view.intrinsics.height;
  const auto pixels = std::size_t(width) * std::size_t(height);
  std::vector<Used> used;
  std::vector<Image8> pictureOf;
  for (const Candidate& candidate : candidates(view)) {
    const ComposerPhotograph& photograph = photographs_[candidate.photograph];
    used.push_back({candidate.photograph, candidate.weight,
                    glm::distance(view.pose.position, photograph.camera.pose.position),
                    Reprojection(view, photograph.camera),
                    photograph.depth.residualPx / (photograph.camera.intrinsics.fx * spacing_)});
    pictureOf.push_back(pictures(candidate.photograph));
  }
  std::vector<Layer> layers(used.size());
  const auto always = [](std::size_t) { return true; };
  runJobs(
      used.size(), options_.threads, [&](std::size_t k) { layers[k] = drawn(view, photographs_[used[k].photograph]); },
      always);

  constexpr int kRows = 8;  // of a job
  const auto inBands = [&](const auto& row) {
    runJobs(
        std::size_t((height + kRows - 1) / kRows), options_.threads,
        [&](std::size_t band) {
          for (int y = int(band) * kRows; y < std::min(height, (int(band) + 1) * kRows); ++y) row(y);
        },
        always);
  };

  std::vector<Surfaces> surfaces(pixels);
  inBands([&](int y) {
    std::vector<Vote> votes;
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      votes.clear();
      for (std::size_t k = 0; k < used.size(); ++k) {
        const Hypothesis& here = layers[k][at];
        const double far = used[k].distance / spacing_,
                     weight = used[k].weight * double(here.trust) / (0.3 + far * far);
        if (here.inverseDepth >= 0 && weight > 0)
          votes.push_back({double(here.inverseDepth), weight, double(here.consensus), here.completed});
      }
      surfaces[at] = vote(votes, step_);
    }
  });

  // Holes.
  ImageF first(width, height, 1, 0.0f);
  std::vector<bool> known(pixels), filled(pixels);
  for (std::size_t at = 0; at < pixels; ++at) {
    known[at] = surfaces[at].count > 0;
    filled[at] = !known[at];
    if (known[at]) first.values[at] = float(surfaces[at].layer[0].inverseDepth);
  }
  fillHoles(first, known);
  for (std::size_t at = 0; at < pixels; ++at)
    if (filled[at]) surfaces[at] = {{{{double(first.values[at]), 1.0, true}}}, 1};

  Composed result{Image8(width, height, 4, 0), ImageF(width, height, 1, 0.0f)};
  const auto gather = [&](glm::dvec2 at, double inverseDepth) {
    std::vector<Offer> offers;
    for (std::size_t k = 0; k < used.size(); ++k) {
      const Used& candidate = used[k];
      const ComposerPhotograph& photograph = photographs_[candidate.photograph];
      const Intrinsics& intrinsics = photograph.camera.intrinsics;
      const glm::dvec3 ray = candidate.towards.ray(at), direction = ray + inverseDepth * candidate.towards.shift();
      if (!(direction.z < 0)) continue;
      const glm::dvec2 pixel = candidate.towards.pixel(direction);
      if (!candidate.towards.inside(pixel)) continue;
      const double cost = kAngleFloor + angleBetween(ray, direction) + kDistanceCost * candidate.distance / spacing_;
      const double resolution = std::min(
          intrinsics.fx * glm::length(ray) / (view.intrinsics.fx * glm::length(direction)), kLargestResolution);
      const double here = inverseDepth / -direction.z;
      const ImageF& occluder = occluders_[candidate.photograph];
      const double own = double(bilinear(occluder, pixel.x / intrinsics.width * occluder.width,
                                         pixel.y / intrinsics.height * occluder.height));
      const double tolerance = 2 * toleranceOf(photograph.depth.step, here) + candidate.residual;
      const double before = std::clamp((own - here) / tolerance - 1, 0.0, 1.0),
                   behind = std::clamp((here - own) / tolerance - 1, 0.0, 1.0);
      const double visible = std::max((1 - before) * (1 - (1 - kBehindVisibility) * behind), kVisibilityFloor);
      const double apart = smoothstep(0, kOwnPlace, cost - kAngleFloor);
      constexpr double kLeastApart = 1e-6;
      double weight = candidate.weight * resolution * resolution *
                      glm::mix(1.0, borderWeight(intrinsics, pixel), apart) * glm::mix(1.0, visible, apart) /
                      (cost * std::max(apart, kLeastApart));
      const Image8& picture = pictureOf[k];
      if (picture.channels == 4 &&
          picture.pixel(std::min(int(pixel.x), picture.width - 1), std::min(int(pixel.y), picture.height - 1))[3] == 0)
        weight = 0;
      if (weight > 0) offers.push_back({weight, k, pixel});
    }
    std::sort(offers.begin(), offers.end(), [](const Offer& a, const Offer& b) { return a.weight > b.weight; });
    const double least = offers.size() > options_.gathered ? offers[options_.gathered].weight : 0.0;
    Colour colour;
    double sum = 0;
    glm::dvec3 square(0);
    for (std::size_t k = 0; k < std::min(offers.size(), options_.gathered); ++k) {
      const double weight = offers[k].weight - least;
      if (!(weight > 0)) continue;
      const glm::dvec3 sample = ibr::bilinear(pictureOf[offers[k].candidate], offers[k].pixel);
      sum += weight;
      colour.mean += weight * sample;
      square += weight * sample * sample;
    }
    if (!(sum > 0)) return colour;
    colour.known = true;
    colour.mean /= sum;
    const glm::dvec3 variance = square / sum - colour.mean * colour.mean;
    colour.variance = std::max(0.0, (variance.x + variance.y + variance.z) / 3);
    return colour;
  };
  inBands([&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const Surfaces& here = surfaces[at];
      double behind = 1, sum = 0, most = -1;
      glm::dvec3 colour(0);
      bool completed = false;
      for (std::size_t l = 0; l < here.count; ++l) {
        const Surface& surface = here.layer[l];
        const bool last = l + 1 == here.count;
        const Colour gathered = gather({x + 0.5, y + 0.5}, surface.inverseDepth);
        if (!gathered.known) continue;
        const double opacity = last ? 1.0 : surface.opacity;
        const double weight = behind * opacity / (1 + gathered.variance / (kColourSpread * kColourSpread));
        behind *= 1 - opacity;
        sum += weight;
        colour += weight * gathered.mean;
        if (weight > most) {
          most = weight;
          result.inverseDepth.pixel(x, y)[0] = float(surface.inverseDepth);
          completed = surface.completed;
        }
      }
      if (!(sum > 0)) continue;
      const auto to = result.picture.pixel(x, y);
      for (int c = 0; c < 3; ++c)
        to[std::size_t(c)] = std::uint8_t(std::lround(std::clamp(colour[c] / sum, 0.0, 255.0)));
      const int tier = filled[at] ? kTierFilled : completed ? kTierBackdrop : kTierAgrees;
      to[3] = std::uint8_t(255 - 64 * tier);
    }
  });
  return result;
}

}  // namespace ibr::reference
