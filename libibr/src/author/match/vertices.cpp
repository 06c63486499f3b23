// SPDX-License-Identifier: Apache-2.0
#include "author/match/vertices.h"

#include "author/match/quadtree.h"
#include "author/match/refine_depth.h"

namespace ibr {

MatchedVertices matchedVertices(std::span<const MatchView> views, const DenseMatch& match) {
  if (match.vertices) return *match.vertices;
  MatchedVertices vertices;
  vertices.matched.resize(views.size());
  const DepthRefiner refiner(views, match);
  for (const glm::ivec2 pixel : meshVertices(match.good, match.position)) {
    const glm::dvec2 centre = glm::dvec2(pixel) + 0.5;
    vertices.frame.emplace_back(centre);
    vertices.inverseDepth.push_back(match.refined ? double(match.inverseDepth.pixel(pixel.x, pixel.y)[0])
                                                  : refiner.at(pixel.x, pixel.y));
    for (std::size_t i = 0; i < views.size(); ++i) {
      const auto dense = match.position[i].pixel(pixel.x, pixel.y);
      glm::dvec2 position(dense[0], dense[1]);
      if (!match.refined)
        if (const auto exact = refiner.maps()[i](centre, vertices.inverseDepth.back())) position = *exact;
      vertices.matched[i].emplace_back(position);
    }
  }
  return vertices;
}

}  // namespace ibr
