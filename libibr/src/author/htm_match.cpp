// SPDX-License-Identifier: Apache-2.0
#include "author/htm_match.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "author/parallel.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr std::uint32_t kLeastSamples = 24;  // of a template at full size
constexpr double kLeastShare = 0.4;          // of a segment that the other camera must see

// One scale of the search.
struct Level {
  std::vector<ProjectedMesh> views;
  TemplateSearch search;
  double scale;  // px of it in one of the full size
};

Level levelOf(const TriangleMesh& mesh, std::span<const HtmView> views, int halvings,
              const MakeTemplateSearch& makeSearch) {
  Level level{projectedMeshes(mesh, views, halvings), {}, std::pow(0.5, halvings)};
  std::vector<const Image8*> pictures;
  for (const ProjectedMesh& view : level.views) pictures.push_back(&view.picture);
  level.search = makeSearch(pictures);
  return level;
}

struct Templates {
  std::vector<TemplateSample> samples;
  std::vector<TemplateTask> tasks;
  std::vector<std::size_t> index;  // complementIndex of each task
};

class CameraMatcher {
 public:
  CameraMatcher(const TriangleMesh& mesh, const Lists& faces, std::span<const CameraSet> members,
                const VertexMatchOptions& options, std::size_t cameras)
      : mesh_(mesh), faces_(faces), members_(members), options_(options), cameras_(cameras) {}

  // Displacements of camera i's vertices, px at full size, where they are searched; those of no task stay.
  void searchAt(const Level& level, std::size_t i, double radius, std::vector<glm::dvec2>& displacement) const {
    const Templates templates = templatesAt(level, i, displacement);
    const int window = std::clamp(int(std::ceil(radius * level.scale)), 1, kLargestTemplateRadius);
    const auto matches = level.search(templates.tasks, templates.samples, window, options_.measure);
    for (std::size_t t = 0; t < matches.size(); ++t)
      displacement[local(templates.index[t], i)] = glm::dvec2(matches[t].displacement) / level.scale;
  }

  void refineAt(const Level& level, std::size_t i, std::vector<glm::dvec2>& displacement,
                std::span<VertexMatch> result) const {
    const Templates templates = templatesAt(level, i, displacement);
    const auto matches = level.search(templates.tasks, templates.samples, 2, options_.measure);
    for (std::size_t t = 0; t < matches.size(); ++t) {
      const TemplateTask& task = templates.tasks[t];
      VertexMatch& match = result[templates.index[t]];
      match = refinedMatch(level.views[i].picture, std::span(templates.samples).subspan(task.first, task.count),
                           matches[t].displacement, options_.leastTexture);
      match.cost = matches[t].cost;
    }
  }

  std::size_t local(std::size_t index, std::size_t i) const { return index - i * cameras_ * mesh_.positions.size(); }

 private:
  Templates templatesAt(const Level& level, std::size_t i, const std::vector<glm::dvec2>& start) const {
    const SegmentOptions scaled{options_.segment.leastRadius * (level.scale < 1 ? 0.75 : 1),
                                options_.segment.mostRadius * (level.scale < 1 ? 0.75 : 1)};
    const auto least = std::uint32_t(kLeastSamples * (level.scale < 1 ? 0.5 : 1));
    Segments segments(mesh_, faces_, level.views[i], scaled);
    Templates templates;
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
      if (!(members_[v] >> i & 1)) continue;
      const std::vector<SegmentPixel>& segment = segments.of(v);
      if (segment.size() < least) continue;
      for (std::size_t j = 0; j < cameras_; ++j) {
        if (j == i || !(members_[v] >> j & 1)) continue;
        const std::vector<TemplateSample> samples = coloured(segment, level.views[j]);
        if (samples.size() < least || double(samples.size()) < kLeastShare * double(segment.size())) continue;
        const std::size_t index = (i * cameras_ + j) * mesh_.positions.size() + v;
        const glm::dvec2 at = glm::round(start[local(index, i)] * level.scale);
        templates.tasks.push_back(
            {std::uint32_t(i), std::uint32_t(templates.samples.size()), std::uint32_t(samples.size()), glm::ivec2(at)});
        templates.index.push_back(index);
        templates.samples.insert(templates.samples.end(), samples.begin(), samples.end());
      }
    }
    return templates;
  }

  const TriangleMesh& mesh_;
  const Lists& faces_;
  std::span<const CameraSet> members_;
  const VertexMatchOptions& options_;
  std::size_t cameras_;
};

// A picture's colour and how it changes, between pixels.
struct Sampled {
  glm::dvec3 value, alongX, alongY;
};
Sampled sampledAt(const Image8& picture, glm::dvec2 at) {
  const double u = std::clamp(at.x - 0.5, 0.0, picture.width - 1.0), v = std::clamp(at.y - 0.5, 0.0, picture.height - 1.0);
  const int x = std::min(int(u), std::max(0, picture.width - 2)), y = std::min(int(v), std::max(0, picture.height - 2));
  const double s = u - x, t = v - y;
  const auto colour = [&](int column, int row) {
    const auto p = picture.pixel(std::clamp(column, 0, picture.width - 1), std::clamp(row, 0, picture.height - 1));
    return glm::dvec3(p[0], p[1], p[2]);
  };
  // Central differences at the four pixels around, mixed as the values are.
  const auto mixed = [&](auto&& at4) {
    return (1 - t) * ((1 - s) * at4(x, y) + s * at4(x + 1, y)) + t * ((1 - s) * at4(x, y + 1) + s * at4(x + 1, y + 1));
  };
  return {mixed(colour), mixed([&](int c, int r) { return (colour(c + 1, r) - colour(c - 1, r)) * 0.5; }),
          mixed([&](int c, int r) { return (colour(c, r + 1) - colour(c, r - 1)) * 0.5; })};
}

// A linearised difference between template and picture at one displacement.
struct Normal {
  glm::dvec3 structure{0.0};  // Σ ∇I ∇Iᵀ: xx, xy, yy
  glm::dvec2 side{0.0};       // Σ ∇I r
  double squares = 0;         // Σ r²
};
Normal normalAt(const Image8& picture, std::span<const TemplateSample> samples, glm::dvec2 at) {
  std::vector<Sampled> sampled;
  sampled.reserve(samples.size());
  glm::dvec3 mean(0.0);
  for (const TemplateSample& s : samples) {
    sampled.push_back(sampledAt(picture, glm::dvec2(s.x + 0.5, s.y + 0.5) + at));
    mean += glm::dvec3(s.red, s.green, s.blue) - sampled.back().value;
  }
  mean /= double(samples.size());
  Normal normal;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const TemplateSample& s = samples[k];
    const glm::dvec3 r = glm::dvec3(s.red, s.green, s.blue) - sampled[k].value - mean;
    const glm::dvec3 &gx = sampled[k].alongX, &gy = sampled[k].alongY;
    normal.structure += glm::dvec3(glm::dot(gx, gx), glm::dot(gx, gy), glm::dot(gy, gy));
    normal.side += glm::dvec2(glm::dot(gx, r), glm::dot(gy, r));
    normal.squares += glm::dot(r, r);
  }
  return normal;
}

// Eigenvalues, the larger first, and the unit eigenvector of the larger.
struct Eigen {
  double large, small;
  glm::dvec2 direction;
};
Eigen eigenOf(const glm::dvec3& m) {
  const double mean = 0.5 * (m.x + m.z), half = 0.5 * (m.x - m.z), radius = std::hypot(half, m.y);
  const double angle = 0.5 * std::atan2(m.y, half);
  return {mean + radius, std::max(0.0, mean - radius), {std::cos(angle), std::sin(angle)}};
}

}  // namespace

VertexMatch refinedMatch(const Image8& picture, std::span<const TemplateSample> samples, glm::dvec2 start,
                         double leastTexture) {
  constexpr int kSteps = 6;
  constexpr double kFarthest = 1.0;   // px from the start
  constexpr double kLeastNoise = 2;   // levels, one standard deviation
  constexpr double kMostPrecise = 0.15;  // px
  if (samples.empty()) return {};
  const double n = double(samples.size());
  const double gate = std::max(leastTexture * leastTexture, 1e-6) * n;  // never 0: what is flat is not divided by
  glm::dvec2 at = start;
  Normal normal = normalAt(picture, samples, at);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen eigen = eigenOf(normal.structure);
    if (!(eigen.large >= gate)) break;
    const glm::dvec2 across(-eigen.direction.y, eigen.direction.x);
    glm::dvec2 move = eigen.direction * (glm::dot(eigen.direction, normal.side) / eigen.large);
    if (eigen.small >= gate) move += across * (glm::dot(across, normal.side) / eigen.small);
    const glm::dvec2 next = glm::clamp(at + move, start - kFarthest, start + kFarthest);
    const Normal there = normalAt(picture, samples, next);
    if (!(there.squares < normal.squares)) break;
    const double moved = glm::distance(next, at);
    at = next;
    normal = there;
    if (moved < 1e-3) break;
  }
  const Eigen eigen = eigenOf(normal.structure);
  if (!(eigen.large >= gate)) return {};
  const double noise = std::max(normal.squares / (3 * n), kLeastNoise * kLeastNoise);
  const double most = 1 / (kMostPrecise * kMostPrecise);
  const double along = std::min(eigen.large / noise, most);
  const double across = eigen.small >= gate ? std::min(eigen.small / noise, most) : 0.0;
  const glm::dvec2 d = eigen.direction, e(-d.y, d.x);
  if (across == 0) at = d * glm::dot(d, at);  // what is not measured is not displaced
  const glm::dvec3 information = along * glm::dvec3(d.x * d.x, d.x * d.y, d.y * d.y) +
                                 across * glm::dvec3(e.x * e.x, e.x * e.y, e.y * e.y);
  return {glm::vec2(at), glm::vec3(information), 0};
}

std::vector<VertexMatch> matchVertices(const TriangleMesh& mesh, std::span<const HtmView> views,
                                       std::span<const CameraSet> members, std::span<const glm::vec2> start,
                                       const VertexMatchOptions& options, const MakeTemplateSearch& makeSearch,
                                       const ProgressCallback& progress) {
  const std::size_t n = mesh.positions.size(), cameras = views.size();
  const Lists faces = facesAtVertices(mesh);
  const Level coarse = levelOf(mesh, views, 1, makeSearch), fine = levelOf(mesh, views, 0, makeSearch);
  const CameraMatcher matcher(mesh, faces, members, options, cameras);
  std::vector<VertexMatch> matches(cameras * cameras * n);
  const bool finished = runJobs(
      cameras, threadsFor(options.threads, 3e8),
      [&](std::size_t i) {
        std::vector<glm::dvec2> displacement(cameras * n, glm::dvec2(0.0));
        if (!start.empty())
          for (std::size_t k = 0; k < cameras * n; ++k) displacement[k] = start[i * cameras * n + k];
        matcher.searchAt(coarse, i, options.radius, displacement);
        matcher.refineAt(fine, i, displacement, matches);
      },
      [&](std::size_t done) { return !progress || progress({"matching vertices", done, cameras}); });
  check(finished, ErrorCode::cancelled, "stopped while vertices were matched");
  return matches;
}

}  // namespace ibr
