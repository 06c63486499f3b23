// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_segment.h"

#include <catch2/catch.hpp>
#include <set>

#include "htm_object.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::lookingAt;
using test::plainView;

std::set<std::uint32_t> shown(const std::vector<SegmentPixel>& segment, const ProjectedMesh& view) {
  std::set<std::uint32_t> faces;
  for (const SegmentPixel& pixel : segment) faces.insert(view.raster.face.pixel(pixel.x, pixel.y)[0]);
  return faces;
}

struct Grid {
  TriangleMesh mesh = test::flatGrid(8);
  Lists faces = facesAtVertices(mesh);
  // A square measures about 10 px.
  HtmView view = plainView(lookingAt({4, 4, 10}, {4, 4, 0}, 120, 90, 0.84));
  ProjectedMesh projected = projectedMeshes(mesh, {&view, 1}).front();
};
constexpr std::size_t kMiddle = 4 * 9 + 4;

}  // namespace

TEST_CASE("the faces and neighbours of each vertex are listed") {
  const TriangleMesh mesh = test::cube();
  const Lists faces = facesAtVertices(mesh), neighbours = neighboursOfVertices(mesh);
  for (std::uint32_t v = 0; v < 8; ++v) {
    std::vector<std::uint32_t> at;
    std::set<std::uint32_t> others;
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (int k = 0; k < 3; ++k)
        if (mesh.triangles[f][k] == v) {
          at.push_back(f);
          others.insert({mesh.triangles[f][(k + 1) % 3], mesh.triangles[f][(k + 2) % 3]});
        }
    CHECK(std::ranges::equal(faces[v], at));
    CHECK(std::ranges::equal(neighbours[v], others));
  }
  TriangleMesh lonely;
  lonely.positions.resize(3);
  CHECK(facesAtVertices(lonely)[2].empty());
  CHECK(neighboursOfVertices(lonely)[0].empty());
}

TEST_CASE("a segment is the pixels of the faces at its vertex, in row order") {
  const Grid grid;
  Segments segments(grid.mesh, grid.faces, grid.projected, {2, 40});
  const std::vector<SegmentPixel> segment = segments.of(kMiddle);
  REQUIRE(!segment.empty());
  const auto around = grid.faces[kMiddle];
  CHECK(shown(segment, grid.projected) == std::set<std::uint32_t>(around.begin(), around.end()));
  std::size_t pixels = 0;
  for (const std::uint32_t face : grid.projected.raster.face.values) pixels += std::ranges::count(around, face) > 0;
  CHECK(segment.size() == pixels);
  for (std::size_t k = 0; k < segment.size(); ++k) {
    CHECK(std::ranges::count(around, grid.projected.raster.face.pixel(segment[k].x, segment[k].y)[0]) == 1);
    if (k > 0) CHECK(std::pair(segment[k - 1].y, segment[k - 1].x) < std::pair(segment[k].y, segment[k].x));
  }
  // The segment of another vertex is separate, and a repeated request gives the same segment.
  segments.of(0);
  CHECK(segments.of(kMiddle).size() == segment.size());
}

TEST_CASE("segments grow by rings to the minimum radius, and end at the maximum radius") {
  const Grid grid;
  const auto sizeOf = [&](double least, double most) {
    return Segments(grid.mesh, grid.faces, grid.projected, {least, most}).of(kMiddle).size();
  };
  const auto facesOf = [&](double least) {
    Segments segments(grid.mesh, grid.faces, grid.projected, {least, 100});
    return shown(segments.of(kMiddle), grid.projected).size();
  };
  CHECK(facesOf(2) == 6);
  CHECK(facesOf(14) > 6);
  CHECK(facesOf(14) < 60);
  CHECK(facesOf(25) > facesOf(14));
  CHECK(facesOf(1000) > 100);
  Segments near(grid.mesh, grid.faces, grid.projected, {1000, 12});
  const glm::dvec2 middle = grid.projected.view.seen(grid.mesh.positions[kMiddle])->pixel;
  std::size_t disc = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) disc += glm::distance(glm::dvec2(x + 0.5, y + 0.5), middle) <= 12;
  CHECK(near.of(kMiddle).size() == disc);
  for (const SegmentPixel& pixel : near.of(kMiddle)) CHECK(glm::distance(glm::dvec2(pixel) + 0.5, middle) <= 12);
  CHECK(sizeOf(14, 24) > sizeOf(2, 24));
  // the default is within the limit of the template search
  CHECK(3.15 * 24.5 * 24.5 < kMaxTemplateSampleCount);
}

TEST_CASE("a vertex that is not seen has no segment") {
  Grid grid;
  const auto emptyFrom = [&](const Camera& camera, std::size_t v) {
    const HtmView view = plainView(camera);
    const ProjectedMesh projected = projectedMeshes(grid.mesh, {&view, 1}).front();
    return Segments(grid.mesh, grid.faces, projected, {}).of(v).empty();
  };
  CHECK(!emptyFrom(lookingAt({4, 4, 10}, {4, 4, 0}), kMiddle));
  CHECK(emptyFrom(lookingAt({4, 4, 10}, {4, 4, 20}), kMiddle));  // behind the camera
  CHECK(emptyFrom(lookingAt({4, 4, 10}, {90, 4, 0}), kMiddle));  // outside the picture
  CHECK(emptyFrom(lookingAt({-4, 4, 1e-9}, {-5, 4, 0}), kMiddle));
  grid.mesh.positions.emplace_back(4, 4, 0);  // the vertex belongs to no face
  grid.faces = facesAtVertices(grid.mesh);
  CHECK(emptyFrom(lookingAt({4, 4, 10}, {4, 4, 0}), grid.mesh.positions.size() - 1));
}

TEST_CASE("a segment takes another camera's colours where that camera sees it") {
  const Grid grid;
  HtmView other = plainView(lookingAt({6, 4, 10}, {4, 4, 0}));
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) other.picture.pixel(x, y)[0] = std::uint8_t(2 * x);
  Segments segments(grid.mesh, grid.faces, grid.projected, {});
  const std::vector<SegmentPixel> segment = segments.of(kMiddle);
  const ProjectedMesh from = projectedMeshes(grid.mesh, {&other, 1}).front();
  const std::vector<TemplateSample> samples = Recoloured(grid.projected, from).of(segment);
  REQUIRE(samples.size() == segment.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    CHECK(glm::ivec2(samples[k].x, samples[k].y) == glm::ivec2(segment[k]));
    const double depth = grid.projected.raster.depth.pixel(segment[k].x, segment[k].y)[0];
    const glm::dvec3 point = grid.projected.view.point(glm::dvec2(segment[k]) + 0.5, depth);
    CHECK(std::abs(point.z) < 1e-5);
    CHECK(std::abs(samples[k].red - 2 * (from.view.seen(point)->pixel.x - 0.5)) <= 0.51);
    CHECK(samples[k].green == 100);
  }
  // Results are independent of earlier requests, here of a neighbour's segment.
  Recoloured often(grid.projected, from);
  for (const std::size_t v : {kMiddle + 1, kMiddle, kMiddle}) {
    const auto again = often.of(segments.of(v));
    const auto alone = Recoloured(grid.projected, from).of(segments.of(v));
    CHECK(std::ranges::equal(again, alone, [](const TemplateSample& a, const TemplateSample& b) {
      return a.x == b.x && a.y == b.y && a.red == b.red && a.green == b.green && a.blue == b.blue;
    }));
  }
  other.mask = Image8(120, 90, 1);
  CHECK(Recoloured(grid.projected, projectedMeshes(grid.mesh, {&other, 1}).front()).of(segment).empty());
  for (int y = 0; y < 90; ++y)
    for (int x = 60; x < 120; ++x) other.mask.pixel(x, y)[0] = 255;
  const auto half = Recoloured(grid.projected, projectedMeshes(grid.mesh, {&other, 1}).front()).of(segment);
  CHECK(half.size() > segment.size() / 4);
  CHECK(half.size() < 3 * segment.size() / 4);
}

}  // namespace ibr
