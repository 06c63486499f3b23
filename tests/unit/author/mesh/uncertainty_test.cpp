// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/uncertainty.h"

#include <catch2/catch.hpp>
#include <vector>

using namespace ibr;

TEST_CASE("disagreeing neighbours raise a vertex's uncertainty, and its match and a sweep level bound it from below") {
  MorphMesh mesh;
  mesh.inverseDistance = {0.2f, 0.2f, 0.2f, 0.9f, 0.2f, 0.5f};
  mesh.uncertainty.assign(6, 0.01f);
  mesh.uncertainty[4] = 0.3f;
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 2, 4}};
  const std::vector<double> level(6, 0.02);
  MorphMesh widened = mesh;
  widenUncertainty(widened, level);
  const std::vector<float>& sigma = widened.uncertainty;
  CHECK(sigma[3] > 0.7f);               // a lone vertex far in front of its neighbours
  CHECK(sigma[1] > sigma[0]);           // neighbour of vertex 3
  CHECK(sigma[4] >= 0.3f);              // the match's own uncertainty is a lower bound
  CHECK(sigma[5] == Approx(sigma[0]));  // in no triangle: same as with agreeing neighbours
  for (const float s : sigma) CHECK(s > 0.02f);

  MorphMesh farther = mesh;  // with levels of 0, only the neighbours count
  widenUncertainty(farther, std::vector<double>(6, 0.0));
  CHECK(farther.uncertainty[5] == 0.01f);
}
