// SPDX-License-Identifier: Apache-2.0
#include "reference/htm/htm_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "ibr/texture.h"
#include "support/bumpy_model.h"

namespace ibr::test::reference {
namespace {

struct Blend {
  glm::dvec4 sum{0.0};
  double reference = 0;

  void add(double logWeight, double share, glm::dvec3 value) {
    if (!(sum.w > 0)) reference = logWeight;
    sum += share * std::exp(logWeight - reference) * glm::dvec4(value, 1);
  }
  bool settled(double logRemainingWeight, double cut) const {
    return sum.w > 0 && std::exp(logRemainingWeight - reference) <= cut * sum.w;
  }
};

// Blends of the cameras that see a point, and of all cameras with weight there, for points that no camera sees.
struct Shown {
  Blend seen, hidden;

  void add(double logWeight, double counts, double visible, const glm::dvec4& read) {
    seen.add(logWeight, counts * visible * read.a, glm::dvec3(read));
    hidden.add(logWeight, counts, glm::dvec3(read));
  }
  glm::dvec4 sum() const { return seen.sum.w > 0 ? seen.sum : hidden.sum; }
  bool isClear() const { return !(seen.sum.w > 0 && seen.sum.w < 0.1); }
};

bool has(CameraSet members, std::size_t camera) {
  return members >> camera & 1;
}

// Bilinear sample with clamped borders.
glm::dvec4 sampleLevel(const Image8& image, glm::dvec2 at) {
  const glm::dvec2 low = glm::floor(at - 0.5), share = at - 0.5 - low;
  glm::dvec4 sum(0.0);
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const auto pixel = image.pixel(std::clamp(int(low.x) + dx, 0, image.width - 1),
                                     std::clamp(int(low.y) + dy, 0, image.height - 1));
      const double weight = (dx ? share.x : 1 - share.x) * (dy ? share.y : 1 - share.y);
      for (int c = 0; c < 4; ++c) sum[c] += weight * pixel[std::size_t(c)] / 255;
    }
  return sum;
}

glm::dvec4 sample(const std::vector<Image8>& mips, glm::dvec2 at, double level) {
  level = std::clamp(level, 0.0, double(mips.size() - 1));
  const auto low = std::size_t(level), high = std::min(low + 1, mips.size() - 1);
  const auto read = [&](std::size_t l) {
    const glm::dvec2 scale(double(mips[l].width) / mips[0].width, double(mips[l].height) / mips[0].height);
    return sampleLevel(mips[l], at * scale);
  };
  return glm::mix(read(low), read(high), level - double(low));
}

std::vector<Image8> mipsOf(const HtmImage& picture, int width, int height) {
  Image8 page(width, height, 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int fromX = std::min(x, picture.photograph.width - 1), fromY = std::min(y, picture.photograph.height - 1);
      for (std::size_t c = 0; c < 3; ++c) page.pixel(x, y)[c] = picture.photograph.pixel(fromX, fromY)[c];
      page.pixel(x, y)[3] = picture.visibility.empty() ? 255 : picture.visibility.pixel(fromX, fromY)[0];
    }
  return buildMips(page);
}

// Ray hits of the unshifted camera, and of cameras shifted by kShift in the four diagonal directions.
std::vector<std::vector<SurfaceHit>> shiftedHits(const TriangleMesh& mesh, const Camera& camera) {
  constexpr double kShift = 0.01;  // px
  std::vector<std::vector<SurfaceHit>> all;
  for (const glm::dvec2 shift : {glm::dvec2(0), glm::dvec2(kShift, kShift), glm::dvec2(kShift, -kShift),
                                 glm::dvec2(-kShift, kShift), glm::dvec2(-kShift, -kShift)}) {
    Camera shifted = camera;
    shifted.intrinsics.cx += shift.x;
    shifted.intrinsics.cy += shift.y;
    all.push_back(surfaceHits(mesh, shifted));
  }
  return all;
}

double focal(const Intrinsics& k) {
  return std::sqrt(k.fx * k.fy);
}

struct Source {
  Camera camera;
  std::vector<Image8> mips;
  std::vector<std::vector<SurfaceHit>> hits;  // shiftedHits

  glm::dvec3 toCamera(const glm::dvec3& point) const {
    return glm::conjugate(camera.pose.rotation) * (point - camera.pose.position);
  }
  double inside(glm::dvec2 at) const {
    const glm::dvec2 size(camera.intrinsics.width, camera.intrinsics.height), border = 2.0 * glm::min(at, size - at);
    return std::clamp(std::min(border.x, border.y), 0.0, 1.0);
  }
  // Inverse depth, interpolated between pixel centres. 0 outside the image on the texture array; clamped at borders.
  double nearest(glm::dvec2 at, std::size_t shift) const {
    const Intrinsics& k = camera.intrinsics;
    const glm::dvec2 low = glm::floor(at - 0.5), share = at - 0.5 - low;
    double sum = 0;
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        const int x = std::max(int(low.x) + dx, 0), y = std::max(int(low.y) + dy, 0);
        const bool onPage = x < mips[0].width && y < mips[0].height;
        const int cx = onPage ? x : std::min(x, mips[0].width - 1), cy = onPage ? y : std::min(y, mips[0].height - 1);
        if (cx >= k.width || cy >= k.height) continue;
        sum += (dx ? share.x : 1 - share.x) * (dy ? share.y : 1 - share.y) *
               hits[shift][std::size_t(cy) * std::size_t(k.width) + std::size_t(cx)].inverseDepth;
      }
    return sum;
  }
  // Visibility, 0 to 1, of the point q in the camera frame. isSafe becomes false where shifted images disagree.
  double inView(const glm::dvec3& q, glm::dvec2 projected, double depthTolerance, bool& isSafe) const {
    const double tolerance = depthTolerance - q.z / focal(camera.intrinsics);
    const auto by = [&](std::size_t shift) {
      const double behind = -q.z - 1 / std::max(nearest(projected, shift), 1e-30);
      return std::clamp(2 - behind / tolerance, 0.0, 1.0);
    };
    for (std::size_t shift = 1; shift < hits.size(); ++shift) isSafe = isSafe && std::abs(by(shift) - by(0)) <= 0.02;
    return by(0);
  }
};

// Colours of HtmMethod::vertexColours. w is 0 where a vertex has none.
struct VertexColours {
  std::vector<glm::dvec4> colour;
  std::vector<bool> safe;
};

VertexColours vertexColours(const HtmModel& model, const std::vector<Source>& sources, const HtmFramePlan& plan,
                            double tolerance) {
  VertexColours all;
  for (std::size_t v = 0; v < model.vertexCount(); ++v) {
    Shown shown;
    bool isSafe = true;
    for (const PlannedHtmCamera& k : plan.cameras) {
      const Source& source = sources[k.camera];
      const glm::dvec3 q = source.toCamera(model.surface.mesh.positions[v]);
      const auto at = project(source.camera.intrinsics, q);
      const double counts = at && has(model.surface.members[v], k.camera) ? source.inside(*at) : 0;
      if (counts > 0)
        shown.add(k.logWeight, counts, source.inView(q, *at, tolerance, isSafe), sample(source.mips, *at, 0));
      if (shown.seen.settled(k.logRemainingWeight, plan.settings.weightCut)) break;
    }
    const glm::dvec4 sum = shown.sum();
    all.colour.push_back(sum.w > 0 ? sum / sum.w : glm::dvec4(0));
    all.safe.push_back(isSafe && shown.isClear());
  }
  return all;
}

}  // namespace

std::vector<std::vector<glm::dvec2>> harmonise(const HtmModel& model, const HtmFramePlan& plan) {
  std::vector<std::vector<glm::dvec2>> displaced(plan.cameras.size(),
                                                 std::vector<glm::dvec2>(model.vertexCount(), glm::dvec2(0)));
  if (model.complements.empty() || plan.settings.method != HtmMethod::harmonised) return displaced;
  for (std::size_t i = 0; i < plan.cameras.size(); ++i)
    for (std::size_t v = 0; v < model.vertexCount(); ++v) {
      Blend mean;
      for (const PlannedHtmCamera& j : plan.cameras) {
        const glm::dvec2 complement(model.complements[model.complementIndex(plan.cameras[i].camera, j.camera, v)]);
        mean.add(j.logWeight, has(model.surface.members[v], j.camera), glm::dvec3(complement, 0));
        if (mean.settled(j.logRemainingWeight, plan.settings.weightCut)) break;
      }
      if (mean.sum.w > 0) displaced[i][v] = glm::dvec2(mean.sum) / mean.sum.w;
    }
  return displaced;
}

HtmReferenceImage render(const HtmModel& model, const std::vector<HtmImage>& pictures, const HtmFramePlan& plan) {
  int pageWidth = 1, pageHeight = 1;
  for (const HtmImage& picture : pictures) {
    pageWidth = std::max(pageWidth, picture.photograph.width);
    pageHeight = std::max(pageHeight, picture.photograph.height);
  }
  std::vector<Source> sources;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    sources.push_back({model.cameras[i].camera, mipsOf(pictures[i], pageWidth, pageHeight),
                       shiftedHits(model.surface.mesh, model.cameras[i].camera)});
  const std::vector<std::vector<glm::dvec2>> displaced = harmonise(model, plan);
  const double tolerance = plan.settings.depthTolerance * plan.bounds.radius;

  VertexColours coloured;
  if (plan.settings.method == HtmMethod::vertexColours) coloured = vertexColours(model, sources, plan, tolerance);

  HtmReferenceImage ref;
  ref.width = plan.view.intrinsics.width;
  ref.height = plan.view.intrinsics.height;
  const glm::dvec4 background(glm::dvec3(plan.settings.background), 0);
  const std::vector<std::vector<SurfaceHit>> hits = shiftedHits(model.surface.mesh, plan.view);
  for (std::size_t pixel = 0; pixel < hits[0].size(); ++pixel) {
    const SurfaceHit& hit = hits[0][pixel];
    bool safe = true;
    for (const std::vector<SurfaceHit>& shifted : hits) safe = safe && shifted[pixel].triangle == hit.triangle;
    if (hit.triangle < 0) {
      ref.safe.push_back(safe);
      ref.colour.push_back(background);
      continue;
    }
    const glm::uvec3 corner = model.surface.mesh.triangles[std::size_t(hit.triangle)];
    const glm::dvec3 point = pointOf(model.surface.mesh, hit);
    glm::dvec4 sum(0.0);
    if (plan.settings.method == HtmMethod::vertexColours) {
      for (int c = 0; c < 3; ++c) {
        sum += hit.share[c] * coloured.colour[corner[c]];
        safe = safe && coloured.safe[corner[c]];
      }
      safe = safe && !(sum.w > 0 && sum.w < 0.1);
    } else {
      Shown shown;
      for (std::size_t k = 0; k < plan.cameras.size(); ++k) {
        const PlannedHtmCamera& planned = plan.cameras[k];
        const Source& source = sources[planned.camera];
        const glm::dvec3 q = source.toCamera(point);
        const auto projected = project(source.camera.intrinsics, q);
        if (projected) {
          glm::dvec2 at = *projected;
          double takesPart = 0;
          for (int c = 0; c < 3; ++c) {
            at += hit.share[c] * displaced[k][corner[c]];
            takesPart += hit.share[c] * has(model.surface.members[corner[c]], planned.camera);
          }
          const double counts = takesPart * source.inside(at);
          const double detail = focal(source.camera.intrinsics) / focal(plan.view.intrinsics);
          if (counts > 0)
            shown.add(planned.logWeight, counts, source.inView(q, *projected, tolerance, safe),
                      sample(source.mips, at, std::log2(detail / (hit.inverseDepth * -q.z))));
        }
        if (shown.seen.settled(planned.logRemainingWeight, plan.settings.weightCut)) break;
      }
      safe = safe && shown.isClear();
      sum = shown.sum();
    }
    ref.safe.push_back(safe);
    ref.colour.push_back(sum.w > 0 ? sum / sum.w : background);
  }
  return ref;
}

}  // namespace ibr::test::reference
