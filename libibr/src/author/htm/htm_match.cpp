// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_match.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "author/htm/htm_refine.h"
#include "base/check.h"
#include "base/parallel.h"

namespace ibr {
namespace {

constexpr std::uint32_t kMinSamples = 24;  // of a template at full size
constexpr double kMinVisibleShare = 0.4;   // of a segment: the other camera must see at least this share

// One scale of the search.
struct Level {
  Level(std::span<const ProjectedMesh> projected, double ofFullSize, const TemplateSearchFactory& makeSearch)
      : views(projected), scale(ofFullSize) {
    std::vector<const Image8*> pictures;
    for (const ProjectedMesh& view : views) pictures.push_back(view.picture.get());
    search = makeSearch(pictures);
  }

  std::span<const ProjectedMesh> views;
  TemplateSearch search;
  double scale;  // px of this level per px of the full size
};

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

  // Searches the vertices of camera i; displacements in px at full size. Displacements without a task are kept.
  void searchAt(const Level& level, std::size_t i, double radius, std::vector<glm::dvec2>& displacement) const {
    const int window = std::clamp(int(std::ceil(radius * level.scale)), 1, kMaxTemplateRadius);
    forPortionsAt(level, i, displacement, [&](const Templates& portion) {
      const auto matches = level.search(portion.tasks, portion.samples, window, options_.measure);
      for (std::size_t t = 0; t < matches.size(); ++t)
        displacement[local(portion.index[t], i)] = glm::dvec2(matches[t].displacement) / level.scale;
    });
  }

  void refineAt(const Level& level, std::size_t i, const std::vector<glm::dvec2>& displacement,
                std::span<VertexMatch> result) const {
    forPortionsAt(level, i, displacement, [&](const Templates& portion) {
      const auto matches = level.search(portion.tasks, portion.samples, 2, options_.measure);
      for (std::size_t t = 0; t < matches.size(); ++t) {
        const TemplateTask& task = portion.tasks[t];
        VertexMatch& match = result[portion.index[t]];
        match = refinedMatch(*level.views[i].picture, std::span(portion.samples).subspan(task.first, task.count),
                             matches[t].displacement, options_.minTexture);
        match.cost = matches[t].cost;
      }
    });
  }

  // Maximum bytes that a camera takes: a portion, its segments, its displacements and another camera's colours.
  double bytesAt(std::size_t i, const Level& level) const {
    constexpr double kBytesPerTask = sizeof(TemplateTask) + sizeof(std::size_t) + sizeof(TemplateMatch);
    const double vertices = double(mesh_.positions.size()), across = 2 * options_.segment.maxRadiusPx + 1;
    return double(options_.portion) * (sizeof(TemplateSample) + kBytesPerTask / kMinSamples) +
           vertices * (across * across * sizeof(SegmentPixel) + double(cameras_) * sizeof(glm::dvec2)) +
           double(level.views[i].raster.depth.values.size()) * Recoloured::kBytesPerPixel;
  }

 private:
  std::size_t local(std::size_t index, std::size_t i) const { return index - i * cameras_ * mesh_.positions.size(); }

  // Calls visit(templates) for camera i, portion by portion. Entries of `start` that belong to a portion are not read
  // again afterwards, so visit may change them.
  template <class Visit>
  void forPortionsAt(const Level& level, std::size_t i, const std::vector<glm::dvec2>& start, Visit&& visit) const {
    const SegmentOptions scaled{options_.segment.minRadiusPx * (level.scale < 1 ? 0.75 : 1),
                                options_.segment.maxRadiusPx * (level.scale < 1 ? 0.75 : 1)};
    const auto least = std::uint32_t(kMinSamples * (level.scale < 1 ? 0.5 : 1));
    const auto segments = segmentsOf(mesh_, faces_, level.views[i], scaled, members_, i);
    Templates templates;
    templates.samples.reserve(options_.portion);  // reserved memory that is not written is not committed
    for (std::size_t j = 0; j < cameras_; ++j) {
      if (j == i) continue;
      Recoloured recoloured(level.views[i], level.views[j]);
      for (std::size_t v = 0; v < segments.size(); ++v) {
        const std::vector<SegmentPixel>& segment = segments[v];
        if (!(members_[v] >> j & 1) || segment.size() < least) continue;
        const std::vector<TemplateSample> samples = recoloured.of(segment);
        if (samples.size() < least || double(samples.size()) < kMinVisibleShare * double(segment.size())) continue;
        if (!templates.tasks.empty() && templates.samples.size() + samples.size() > options_.portion) {
          visit(std::as_const(templates));
          templates.samples.clear();
          templates.tasks.clear();
          templates.index.clear();
        }
        const std::size_t index = (i * cameras_ + j) * mesh_.positions.size() + v;
        const glm::dvec2 at = glm::round(start[local(index, i)] * level.scale);
        templates.tasks.push_back(
            {std::uint32_t(i), std::uint32_t(templates.samples.size()), std::uint32_t(samples.size()), glm::ivec2(at)});
        templates.index.push_back(index);
        templates.samples.insert(templates.samples.end(), samples.begin(), samples.end());
      }
    }
    if (!templates.tasks.empty()) visit(std::as_const(templates));
  }

  const TriangleMesh& mesh_;
  const Lists& faces_;
  std::span<const CameraSet> members_;
  const VertexMatchOptions& options_;
  std::size_t cameras_;
};

}  // namespace

std::vector<VertexMatch> matchVertices(const TriangleMesh& mesh, std::span<const HtmView> views,
                                       std::span<const ProjectedMesh> projected, std::span<const CameraSet> members,
                                       std::span<const glm::vec2> start, const VertexMatchOptions& options,
                                       const TemplateSearchFactory& makeSearch, const ProgressCallback& progress) {
  const std::size_t n = mesh.positions.size(), cameras = views.size();
  const Lists faces = facesAtVertices(mesh);
  const std::vector<ProjectedMesh> halved = projectedMeshes(mesh, views, 1, options.threads);
  const Level coarse(halved, 0.5, makeSearch), fine(projected, 1, makeSearch);
  const CameraMatcher matcher(mesh, faces, members, options, cameras);
  std::vector<VertexMatch> matches(cameras * cameras * n);
  double bytes = 0;
  for (std::size_t i = 0; i < cameras; ++i) bytes = std::max(bytes, matcher.bytesAt(i, fine));
  const bool finished = runJobs(
      cameras, threadsFor(options.threads, bytes),
      [&](std::size_t i) {
        std::vector<glm::dvec2> displacement(cameras * n, glm::dvec2(0.0));
        if (!start.empty())
          for (std::size_t k = 0; k < cameras * n; ++k) displacement[k] = start[i * cameras * n + k];
        matcher.searchAt(coarse, i, options.radius, displacement);
        matcher.refineAt(fine, i, displacement, matches);
      },
      [&](std::size_t done) {
        return !progress || progress({"matching vertices", done, cameras});
      });
  check(finished, ErrorCode::cancelled, "cancelled while matching vertices");
  return matches;
}

}  // namespace ibr
