// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/layers.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "author/geometry/orientation.h"

namespace ibr {
namespace {

class Cutter {
 public:
  Cutter(const SilhouetteFinder& finder, std::span<const glm::vec2> frame, std::span<const double> inverseDepth,
         double maxExtrapolation)
      : finder_(finder), frame_(frame), inverseDepth_(inverseDepth), maxExtrapolation_(maxExtrapolation) {}

  Layers run(std::span<const glm::uvec3> triangles, const std::vector<bool>& wanted) {
    std::vector<std::pair<std::size_t, SplitTriangle>> parted;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (wanted[t])
        if (const auto parts = part(triangles[t])) {
          parted.emplace_back(t, *parts);
          for (unsigned n = 0; n < parts->nearCount; ++n)
            for (unsigned f = parts->nearCount; f < 3; ++f) extrapolateBehind(parts->corner[n], parts->corner[f]);
        }
    for (const auto& [t, parts] : parted) layers_.splits.push_back(split(t, parts));
    return std::move(layers_);
  }

 private:
  // A triangle, rotated so that its near corners come first or its only far one last.
  struct SplitTriangle {
    std::array<unsigned, 3> corner;
    unsigned nearCount;
  };
  using Edge = std::pair<unsigned, unsigned>;  // near, far
  struct Cut {
    std::optional<double> part;
    unsigned nearSide = 0, farSide = 0;  // vertices, valid once made
    bool made = false;
  };

  const SurfaceSample& surface(unsigned v) {
    auto found = surfaces_.find(v);
    if (found == surfaces_.end())
      found = surfaces_.emplace(v, finder_.surface(glm::dvec2(frame_[v]), inverseDepth_[v])).first;
    return found->second;
  }

  Cut& cut(unsigned near, unsigned far) {
    const auto [found, fresh] = cuts_.try_emplace(Edge(near, far));
    if (fresh) found->second.part = finder_.between(surface(near), surface(far));
    return found->second;
  }

  std::optional<SplitTriangle> part(const glm::uvec3& t) {
    std::array<unsigned, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](unsigned a, unsigned b) { return inverseDepth_[t[int(a)]] > inverseDepth_[t[int(b)]]; });
    const auto depth = [&](unsigned k) { return inverseDepth_[t[int(order[k])]]; };
    const bool oneNear = depth(0) - depth(1) > depth(1) - depth(2);
    const unsigned first = oneNear ? order[0] : (order[2] + 1) % 3;
    SplitTriangle parts{{t[int(first)], t[int((first + 1) % 3)], t[int((first + 2) % 3)]}, oneNear ? 1u : 2u};
    for (unsigned n = 0; n < parts.nearCount; ++n)
      for (unsigned f = parts.nearCount; f < 3; ++f)
        if (!cut(parts.corner[n], parts.corner[f]).part) return std::nullopt;
    return parts;
  }

  // Averages the depth behind a near corner, extrapolated from the far corners around it.
  void extrapolateBehind(unsigned near, unsigned far) {
    auto& [sum, count, surfaceVertex] = behind_[near];
    sum += surface(far).at(glm::dvec2(frame_[near]), maxExtrapolation_);
    if (count++ == 0) surfaceVertex = far;
  }

  unsigned add(glm::dvec2 pixel, double inverseDepth, glm::dvec2 slope, unsigned surfaceVertex) {
    layers_.vertices.push_back({{pixel, inverseDepth, slope}, surfaceVertex});
    return unsigned(frame_.size() + layers_.vertices.size() - 1);
  }

  const Cut& made(unsigned near, unsigned far) {
    Cut& c = cut(near, far);
    if (c.made) return c;
    const SurfaceSample &a = surface(near), &b = surface(far);
    const glm::dvec2 pixel(snapped(a.pixel + *c.part * (b.pixel - a.pixel)));
    c.nearSide = add(pixel, a.at(pixel, maxExtrapolation_), a.slope, near);
    c.farSide = add(pixel, b.at(pixel, maxExtrapolation_), b.slope, far);
    c.made = true;
    return c;
  }

  unsigned behind(unsigned near) {
    const auto found = behindVertices_.find(near);
    if (found != behindVertices_.end()) return found->second;
    const auto& [sum, count, surfaceVertex] = behind_.at(near);
    return behindVertices_[near] =
               add(glm::dvec2(frame_[near]), sum / count, surface(surfaceVertex).slope, surfaceVertex);
  }

  LayerSplit split(std::size_t triangle, const SplitTriangle& parts) {
    const auto [a, b, c] = parts.corner;
    LayerSplit result{triangle, {}, {}};
    if (parts.nearCount == 1) {
      const Cut ab = made(a, b), ac = made(a, c);
      result.surface = {{a, ab.nearSide, ac.nearSide}, {ab.farSide, b, c}, {ab.farSide, c, ac.farSide}};
      result.behind = {{behind(a), ab.farSide, ac.farSide}};
    } else {
      const Cut ac = made(a, c), bc = made(b, c);
      result.surface = {{a, b, bc.nearSide}, {a, bc.nearSide, ac.nearSide}, {ac.farSide, bc.farSide, c}};
      result.behind = {{behind(a), behind(b), bc.farSide}, {behind(a), bc.farSide, ac.farSide}};
    }
    return result;
  }

  struct Behind {
    double sum = 0;
    int count = 0;
    unsigned surfaceVertex = 0;
  };

  const SilhouetteFinder& finder_;
  std::span<const glm::vec2> frame_;
  std::span<const double> inverseDepth_;
  double maxExtrapolation_;
  std::map<unsigned, SurfaceSample> surfaces_;
  std::map<Edge, Cut> cuts_;
  std::map<unsigned, Behind> behind_;
  std::map<unsigned, unsigned> behindVertices_;
  Layers layers_;
};

}  // namespace

Layers cutAtSilhouettes(const SilhouetteFinder& finder, std::span<const glm::vec2> frame,
                        std::span<const double> inverseDepth, std::span<const glm::uvec3> triangles,
                        const std::vector<bool>& wanted) {
  return Cutter(finder, frame, inverseDepth, finder.maxExtrapolation()).run(triangles, wanted);
}

}  // namespace ibr
