// SPDX-License-Identifier: Apache-2.0
#include "author/surface/collapse_mesh.h"

#include <catch2/catch.hpp>

#include "author/surface/degenerate_faces.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

TEST_CASE("collapses that would change the topology are detected", "[N15]") {
  const CollapseMesh four(
      TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
  CHECK_FALSE(four.keepsTopology(0, 1));
  const CollapseMesh one(TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  CHECK_FALSE(one.keepsTopology(0, 1));
  const CollapseMesh grid(test::flatGrid(4));
  CHECK(grid.keepsTopology(6, 7));
  CHECK(grid.keepsTopology(6, 12));
  CHECK(grid.keepsTopology(0, 1));        // along the border
  CHECK(grid.keepsTopology(1, 6));        // from the border inwards
  CHECK_FALSE(grid.keepsTopology(6, 8));  // not an edge
  CHECK_FALSE(grid.keepsTopology(6, 6));
  // A collapse across the inside, from border to border, would leave two parts joined at one vertex.
  const CollapseMesh strip(test::flatGrid(1));
  CHECK_FALSE(strip.keepsTopology(0, 3));
  // A triangle of edges around a tube bounds no face.
  const CollapseMesh tube(TriangleMesh{
      {{1, 0, 0}, {0, 1, 0}, {-1, -1, 0}, {1, 0, 1}, {0, 1, 1}, {-1, -1, 1}, {1, 0, 2}, {0, 1, 2}, {-1, -1, 2}},
      {{0, 1, 3},
       {1, 4, 3},
       {1, 2, 4},
       {2, 5, 4},
       {2, 0, 5},
       {0, 3, 5},
       {3, 4, 6},
       {4, 7, 6},
       {4, 5, 7},
       {5, 8, 7},
       {5, 3, 8},
       {3, 6, 8}}});
  CHECK_FALSE(tube.keepsTopology(3, 4));
  CHECK(tube.keepsTopology(0, 3));
}

TEST_CASE("collapses that tilt, flip or flatten faces are detected", "[N15][P8]") {
  const CollapseMesh grid(test::flatGrid(4));
  CHECK(grid.keepsNormals(6, 7, {1.5, 1, 0}, 0.5));
  CHECK(grid.keepsNormals(6, 7, {1.5, 1, 0.25}, 0.5));
  CHECK_FALSE(grid.keepsNormals(6, 7, {1.5, 1, 0.25}, 0.99));  // tilted
  CHECK_FALSE(grid.keepsNormals(6, 7, {3.5, 1, 0}, 0.5));      // turned over
  CHECK_FALSE(grid.keepsNormals(6, 7, {1.5, 0, 0}, 0.5));      // no area
  CHECK_FALSE(grid.keepsNormals(6, 7, {1.5, 1e-5, 0}, 0.5));   // almost no area
}

TEST_CASE("a merged vertex stays on the border, and otherwise moves to where the planes meet") {
  CollapseMesh grid(test::flatGrid(4));
  CHECK(grid.isBorder(1));
  CHECK_FALSE(grid.isBorder(6));
  const Quadric none;
  CHECK(grid.placement(6, 1, none) == glm::dvec3(1, 0, 0));
  CHECK(grid.placement(6, 7, none) == glm::dvec3(1.5, 1, 0));
  Quadric planes;
  planes.addPlane({0, 0, 1}, {0, 0, 2}, 1);
  planes.addPlane({1, 0, 0}, {1.75, 0, 0}, 3);
  const glm::dvec3 meeting = grid.placement(6, 7, planes);
  CHECK(glm::distance(meeting, {1.75, 1, 2}) < 1e-4);
  CHECK(planes.at(meeting) < 1e-8);
  CHECK(planes.at({0, 0, 0}) == Approx(4 + 3 * 1.75 * 1.75));

  grid.collapse(6, 7, {1.5, 1, 0});
  CHECK(grid.faceCount() == 30);
  CHECK(grid.facesAt(7).empty());
  const TriangleMesh after = grid.compact();
  CHECK(after.positions.size() == 24);
  CHECK(test::isOrientedManifold(after));
  CHECK(test::areaOf(after) == Approx(16.0));
}

TEST_CASE("a flat face is detected by its height, at any size", "[N15]") {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    TriangleMesh mesh{{{0, 0, 0}, {scale, 0, 0}, {scale / 2, 0, 0}}, {{0, 1, 2}}};
    CHECK(isDegenerate(mesh, mesh.triangles[0]));
    mesh.positions[2].y = 1e-7 * scale;
    CHECK_FALSE(isDegenerate(mesh, mesh.triangles[0]));
  }
}

TEST_CASE("a flat face stays if flipping its edge would make another flat face") {
  // The short side of the sliver is so short that an edge flip would make the face across that side flat.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1e-12, 0, 0}, {1, 1, 0}, {1, -1, 0}};
  mesh.triangles = {{0, 2, 3}, {2, 1, 3}, {0, 1, 2}, {1, 0, 4}};
  const DegenerateFaceCounts result = removeDegenerateFaces(mesh);
  CHECK(result.removed == 1);  // the flat face at the border
  CHECK(result.left == 1);
  CHECK(mesh.triangles == std::vector<glm::uvec3>{{2, 1, 3}, {0, 1, 2}, {1, 0, 4}});
}

}  // namespace
}  // namespace ibr
