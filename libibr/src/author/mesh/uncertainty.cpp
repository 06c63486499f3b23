// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/uncertainty.h"

#include <cmath>
#include <vector>

namespace ibr {

void widenUncertainty(MorphMesh& mesh, std::span<const double> level) {
  std::vector<double> apart(mesh.vertexCount(), 0.0), neighbours(mesh.vertexCount(), 0.0);
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const unsigned a = t[k], b = t[(k + 1) % 3];
      const double difference = std::abs(double(mesh.inverseDistance[a]) - double(mesh.inverseDistance[b]));
      for (const unsigned v : {a, b}) {
        apart[v] += difference;
        ++neighbours[v];
      }
    }
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
    const double own = mesh.uncertainty[v], around = neighbours[v] > 0 ? apart[v] / neighbours[v] : 0.0;
    mesh.uncertainty[v] =
        float(std::sqrt(own * own + around * around + kUncertaintyLevels * kUncertaintyLevels * level[v] * level[v]));
  }
}

}  // namespace ibr
