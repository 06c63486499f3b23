// SPDX-License-Identifier: Apache-2.0
#include "reference/composer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "base/check.h"
#include "base/median.h"
#include "base/parallel.h"
#include "reference/composer_gather.h"
#include "reference/composer_photograph.h"
#include "reference/composer_vote.h"
#include "reference/fill.h"
#include "scene/capture_spacing.h"
#include "shared/cell.h"

namespace ibr::reference {
namespace {

// Constants are fixed, because results for different depth maps are compared.
constexpr double kStepPx = 2;                     // px of the photograph: 1 px at half its size
constexpr double kAngleFloor = 0.03;              // radians: as the gather's
constexpr std::array kCandidateDepths{1.6, 0.4};  // of the median ρ
constexpr int kCandidateColumns = 16, kCandidateRows = 9;
constexpr double kFadeShare = 0.25;  // a candidate whose gain exceeds that of rank K + 1 by this share counts in full

// Largest ρ in each block that is one pixel at a quarter of the photograph's resolution.
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

// A view to compose.
struct Job {
  Camera view;
  std::vector<Candidate> candidates;
  std::function<HypothesisMesh(std::size_t)> mesh;  // of a candidate; thread-safe
  double step = 0;                                  // for the vote's tolerance
  double voteScale = 1;
  std::size_t colours = 4, layers = kMaxGatherLayers;
  double detail = 1;  // of the photographs' textures
  int maxTier = kTierFilled;
  int threads = 1;
};

// Calls row(y) for all rows of an image, in parallel bands.
void forRows(int height, int threads, const std::function<void(int)>& row) {
  constexpr int kRows = 8;  // per band
  runJobs(
      std::size_t((height + kRows - 1) / kRows), threads,
      [&](std::size_t band) {
        for (int y = int(band) * kRows; y < std::min(height, (int(band) + 1) * kRows); ++y) row(y);
      },
      [](std::size_t) { return true; });
}

std::vector<Surfaces> surfacesOf(const Job& job, const Camera& vote) {
  const int width = vote.intrinsics.width, height = vote.intrinsics.height;
  std::vector<std::vector<Hypothesis>> layers(job.candidates.size());
  runJobs(
      layers.size(), job.threads, [&](std::size_t k) { layers[k] = drawLayer(vote, job.candidates[k], job.mesh(k)); },
      [](std::size_t) { return true; });
  std::vector<Surfaces> surfaces(std::size_t(width) * std::size_t(height));
  forRows(height, job.threads, [&](int y) {
    std::vector<Vote> votes;
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      votes.clear();
      for (std::size_t k = 0; k < layers.size(); ++k) {
        const Hypothesis& here = layers[k][at];
        const double weight = voteWeight(job.candidates[k].weight, here.trust, job.candidates[k].distance);
        if (weight > 0) votes.push_back({here.inverseDepth, weight, here.trust, here.consensus});
      }
      surfaces[at] = reference::vote(votes, job.step, job.layers);
    }
  });
  fillHoles(surfaces, width, height);
  return surfaces;
}

void setColour(Composed& view, int x, int y, const glm::dvec3& levels, int tier) {
  for (std::size_t c = 0; c < 3; ++c) {
    view.colour.pixel(x, y)[c] = float(levels[int(c)]);
    view.picture.pixel(x, y)[c] = std::uint8_t(std::lround(levels[int(c)]));
  }
  view.picture.pixel(x, y)[3] = std::uint8_t(255 - 64 * tier);
}

void composePixel(const Job& job, const Gather& gather, const Surfaces& surfaces, int x, int y, Composed& result) {
  result.supportMargin.pixel(x, y)[0] = float(surfaces.margin);
  double behind = 1, sum = 0, most = -1;
  glm::dvec3 colour(0);
  const Surface* shown = nullptr;
  double variance = 0;  // of its colours
  for (std::size_t l = 0; l < surfaces.count; ++l) {
    const Surface& surface = surfaces.surface[l];
    const Gathered gathered = gather.at({x + 0.5, y + 0.5}, surface.inverseDepth, surface.uncertainty);
    if (!gathered.known) continue;
    const double opacity = l + 1 == surfaces.count ? 1.0 : surface.opacity;
    const double weight = behind * opacity / (1 + gathered.variance / (kColourSpread * kColourSpread));
    behind *= 1 - opacity;
    sum += weight;
    colour += weight * gathered.colour;
    if (weight > most) {
      most = weight;
      shown = &surface;
      variance = gathered.variance;
    }
  }
  if (!(sum > 0)) return;
  const int tier = surfaces.filled ? kTierFilled : shown->completed ? kTierCompleted : kTierConsistent;
  if (tier > job.maxTier) return;
  result.inverseDepth.pixel(x, y)[0] = float(shown->inverseDepth);
  result.opaqueInverseDepth.pixel(x, y)[0] = float(opaqueSurface(surfaces).inverseDepth);
  result.deviation.pixel(x, y)[0] = float(deviationOf(surfaces, tier == kTierConsistent, job.step, variance));
  setColour(result, x, y, glm::clamp(colour * (255 / sum), 0.0, 255.0), tier);
}

Composed composed(const Job& job) {
  const int width = job.view.intrinsics.width, height = job.view.intrinsics.height;
  const auto scaled = [&](int side) { return std::max(1, int(std::lround(job.voteScale * side))); };
  Camera vote = job.view;
  vote.intrinsics = resized(vote.intrinsics, scaled(width), scaled(height));
  const int voteWidth = vote.intrinsics.width, voteHeight = vote.intrinsics.height;
  const std::vector<Surfaces> surfaces = surfacesOf(job, vote);
  const Gather gather(job.view, job.candidates, job.colours, job.detail);
  const auto one = [&](int channels) { return ImageF(width, height, channels, 0.0f); };
  Composed result{Image8(width, height, 4, 0), one(3), one(1), one(1), one(1), one(1)};
  forRows(height, job.threads, [&](int y) {
    const int row = std::min(int((y + 0.5) * voteHeight / height), voteHeight - 1);
    for (int x = 0; x < width; ++x) {
      const int column = std::min(int((x + 0.5) * voteWidth / width), voteWidth - 1);
      composePixel(job, gather, surfaces[std::size_t(row) * std::size_t(voteWidth) + std::size_t(column)], x, y,
                   result);
    }
  });
  return result;
}

// Median; for an even number of values, the mean of the middle two. Precondition: not empty.
double middle(std::vector<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

// Checks a planned photograph and converts it to a candidate.
Candidate candidateOf(const Scene& scene, const FramePlan& plan, const PlannedPhotograph& planned,
                      const GatherTextures& textures) {
  check(planned.node < scene.nodes.size() && planned.backdrop < scene.backdrops.size(), ErrorCode::invalidInput,
        "planned photograph of node {}, backdrop {}: not in the scene", planned.node, planned.backdrop);
  const Node& node = scene.nodes[planned.node];
  const Cell& backdrop = scene.backdrops[planned.backdrop];
  const std::size_t points = backdrop.mesh.vertexCount();
  check(backdrop.members == std::vector{planned.node} && backdrop.mesh.confirmations.size() == points &&
            backdrop.mesh.consensus.size() == points,
        ErrorCode::invalidInput,
        "planned photograph of node {}: backdrop {} belongs to another node, or its mesh has no evidence", planned.node,
        planned.backdrop);
  Candidate candidate;
  candidate.camera = node.camera;
  candidate.weight = planned.weight;
  candidate.distance = planned.distance / plan.gather.spacing;
  const double px = focalPx(node.camera.intrinsics) * plan.gather.spacing;  // displacement of a point per unit of ρ
  candidate.step = kStepPx / px;
  candidate.residual = plan.gather.residualPx / px;
  candidate.levels = &textures.photograph(planned.node);
  check(!candidate.levels->empty() && candidate.levels->front().channels == 4, ErrorCode::invalidInput,
        "node {}: the texture is empty or not RGBA", planned.node);
  candidate.cubic = textures.filter == TextureFilter::bicubic;
  candidate.masked = !node.maskFile.empty();
  candidate.depth = &textures.depth(planned.node);
  check(!candidate.depth->empty() && node.depthScale > 0, ErrorCode::invalidInput,
        "node {}: the depth texture is empty, or depthScale {} is not positive", planned.node, node.depthScale);
  candidate.depthScale = node.depthScale;
  if (plan.settings.exposure != Exposure::off) candidate.gain = plan.exposure * node.gain;
  return candidate;
}

// Mip chain of one level, in RGBA.
std::vector<Image8> finestLevel(const Image8& picture) {
  if (picture.channels == 4) return {picture};
  Image8 result(picture.width, picture.height, 4, 255);
  for (std::size_t p = 0; p < result.values.size() / 4; ++p)
    std::copy_n(&picture.values[3 * p], 3, &result.values[4 * p]);
  return {std::move(result)};
}

}  // namespace

Composed composeGathered(const Scene& scene, const FramePlan& plan, std::size_t view, const GatherTextures& textures,
                         int threads) {
  const RenderSettings& settings = plan.settings;
  check(view < plan.views.size(), ErrorCode::invalidInput, "the plan has {} views, no view {}", plan.views.size(),
        view);
  check(settings.renderScale == 1, ErrorCode::invalidInput, "renderScale {} must be 1", settings.renderScale);
  check(plan.gather.spacing > 0 && std::isfinite(plan.gather.spacing), ErrorCode::invalidInput,
        "gather.spacing {} must be positive and finite", plan.gather.spacing);
  check(settings.gatherColours >= 1 && settings.gatherColours <= kMaxGatherColours && settings.gatherLayers >= 1 &&
            settings.gatherLayers <= kMaxGatherLayers,
        ErrorCode::invalidInput, "gatherColours {} or gatherLayers {} is out of range", settings.gatherColours,
        settings.gatherLayers);
  Job job;
  job.view = plan.views[view];
  std::vector<double> steps;
  for (const PlannedPhotograph& planned : plan.photographs) {
    job.candidates.push_back(candidateOf(scene, plan, planned, textures));
    steps.push_back(job.candidates.back().step);
  }
  if (!steps.empty()) job.step = middle(std::move(steps));
  job.mesh = [&](std::size_t k) {
    const PlannedPhotograph& planned = plan.photographs[k];
    return hypothesisMesh(scene.nodes[planned.node].camera.intrinsics, scene.backdrops[planned.backdrop].mesh);
  };
  job.voteScale = settings.voteScale;
  job.colours = settings.gatherColours;
  job.layers = settings.gatherLayers;
  job.detail = double(shader::kFinerDetail) / settings.textureScale;
  job.maxTier = settings.maxTier;
  job.threads = threads;
  return composed(job);
}

void fillColours(Composed& view) {
  FillLevel<glm::dvec3> colours(view.picture.width, view.picture.height);
  for (int y = 0; y < colours.height; ++y)
    for (int x = 0; x < colours.width; ++x) {
      if (view.picture.pixel(x, y)[3] == 0) continue;
      const auto colour = view.colour.pixel(x, y);
      colours.value[colours.index(x, y)] = {colour[0], colour[1], colour[2]};
      colours.weight[colours.index(x, y)] = 1;
    }
  if (!fill(colours)) return;
  for (int y = 0; y < colours.height; ++y)
    for (int x = 0; x < colours.width; ++x)
      if (view.picture.pixel(x, y)[3] == 0) setColour(view, x, y, colours.value[colours.index(x, y)], kTierFilled);
}

Composer::Composer(std::vector<ComposerPhotograph> photographs, const ComposerOptions& options)
    : photographs_(std::move(photographs)), options_(options) {
  check(!photographs_.empty(), ErrorCode::invalidInput, "composer: there are no photographs");
  std::vector<Camera> cameras;
  std::vector<double> steps, depths;
  for (std::size_t i = 0; i < photographs_.size(); ++i) {
    const auto& [camera, depth] = photographs_[i];
    check(camera.intrinsics.model == CameraModel::pinhole, ErrorCode::invalidInput,
          "photograph {}: the camera model must be pinhole", i);
    const ImageF& map = depth.inverseDepth;
    check(!map.empty() && depth.confirmations.values.size() == map.values.size() &&
              depth.consensus.values.size() == map.values.size(),
          ErrorCode::invalidInput, "photograph {}: depth maps are empty or differ in size", i);
    check(depth.step > 0 && std::isfinite(depth.step), ErrorCode::invalidInput,
          "photograph {}: step {} must be positive and finite", i, depth.step);
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

std::vector<Composer::Choice> Composer::candidates(const Camera& view) const {
  constexpr std::size_t kPoints = kCandidateColumns * kCandidateRows * kCandidateDepths.size();
  std::vector<std::array<double, kPoints>> value(photographs_.size());
  for (std::size_t i = 0; i < photographs_.size(); ++i) {
    Candidate candidate;
    candidate.camera = photographs_[i].camera;
    const PhotographSampler sampler(view, candidate);
    std::size_t point = 0;
    for (const double depth : kCandidateDepths)
      for (int row = 0; row < kCandidateRows; ++row)
        for (int column = 0; column < kCandidateColumns; ++column, ++point) {
          value[i][point] = 0;
          const glm::dvec3 ray = sampler.ray({(column + 0.5) / kCandidateColumns * view.intrinsics.width,
                                              (row + 0.5) / kCandidateRows * view.intrinsics.height}),
                           direction = ray + depth * medianInverseDepth_ * sampler.shift();
          const auto pixel = sampler.pixel(direction);
          if (!pixel) continue;
          const double angle = std::atan2(glm::length(glm::cross(ray, direction)), glm::dot(ray, direction));
          value[i][point] = sampler.border(*pixel) / (kAngleFloor + angle);
        }
  }
  std::array<double, kPoints> sum{};
  const auto gain = [&](std::size_t i) {
    double total = 0;
    for (std::size_t p = 0; p < kPoints; ++p) total += std::sqrt(sum[p] + value[i][p]) - std::sqrt(sum[p]);
    return total;
  };
  std::vector<bool> taken(photographs_.size(), false);
  std::vector<Choice> result;
  std::vector<double> gains;
  while (gains.size() <= options_.candidates) {
    std::size_t best = photographs_.size();
    double most = 0;
    for (std::size_t i = 0; i < photographs_.size(); ++i)
      if (!taken[i])
        if (const double g = gain(i); g > most) most = g, best = i;
    gains.push_back(most);  // the last one is that of rank K + 1
    if (best == photographs_.size() || gains.size() > options_.candidates) break;
    taken[best] = true;
    for (std::size_t p = 0; p < kPoints; ++p) sum[p] += value[best][p];
    result.push_back({best, 1.0});
  }
  const double next = gains.back();
  for (std::size_t k = 0; k < result.size() && next > 0; ++k)
    result[k].weight = std::clamp((gains[k] / next - 1) / kFadeShare, 0.0, 1.0);
  return result;
}

Composed Composer::compose(const Camera& view, const PictureSource& pictures) const {
  const std::vector<Choice> choices = candidates(view);
  std::vector<std::vector<Image8>> textures;
  Job job;
  job.view = view;
  for (const Choice& choice : choices) {
    const Image8& picture = pictures(choice.photograph);
    textures.push_back(finestLevel(picture));
    const auto& [camera, depth] = photographs_[choice.photograph];
    Candidate& candidate = job.candidates.emplace_back();
    candidate.camera = camera;
    candidate.weight = choice.weight;
    candidate.distance = glm::distance(view.pose.position, camera.pose.position) / spacing_;
    candidate.step = depth.step;
    candidate.residual = depth.residualPx / (focalPx(camera.intrinsics) * spacing_);
    candidate.masked = picture.channels == 4;
    candidate.depth = &occluders_[choice.photograph];
  }
  for (std::size_t k = 0; k < textures.size(); ++k) job.candidates[k].levels = &textures[k];
  job.mesh = [&](std::size_t k) {
    const auto& [camera, depth] = photographs_[choices[k].photograph];
    return hypothesisMesh(camera.intrinsics, depth);
  };
  job.step = step_;
  job.colours = options_.gathered;
  job.threads = options_.threads;
  return composed(job);
}

}  // namespace ibr::reference
