// SPDX-License-Identifier: Apache-2.0
// Backdrops: gathering depth, completing depth, and meshing.
#include "author/backdrop/backdrop.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <random>

#include "author/backdrop/complete_depth.h"
#include "author/backdrop/known_depth.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Noise, so that colours carry no information about depth.
Image8 speckled(int width, int height) {
  Image8 colours(width, height, 3);
  std::mt19937 random(5);
  for (std::uint8_t& c : colours.values) c = std::uint8_t(random() & 255);
  return colours;
}

// Two surfaces of different inverse depth; each pixel is known with probability `share`.
ImageF patchy(int width, int height, double share) {
  ImageF depth(width, height, 1, kUnknownDepth);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (uniform(random) < share)
        depth.pixel(x, y)[0] = float((x < width / 3 ? 0.5 : 0.02) * (1 + 0.1 * uniform(random)));
  return depth;
}

// Checks the mesh and returns the share of the picture that its triangles cover.
double checkedShare(const Camera& camera, const CellMesh& backdrop) {
  const MorphMesh& mesh = backdrop.mesh;
  Scene scene;
  scene.nodes.push_back({"a", camera, {}, {}});
  scene.backdrops.push_back({{0}, mesh, backdrop.quality});
  for (const Fault& fault : validate(scene)) FAIL_CHECK(fault.field << " " << fault.message);
  double area = 0;
  std::size_t turned = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec2 a(mesh.match[0][t.x]), b(mesh.match[0][t.y]), c(mesh.match[0][t.z]);
    const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    turned += !(twice > 0);
    area += 0.5 * twice;
  }
  CHECK(turned == 0);
  CHECK(mesh.tier0Count() == mesh.triangles.size());
  const double width = camera.intrinsics.width, height = camera.intrinsics.height;
  glm::vec2 low(1e9f), high(-1e9f);
  for (const glm::vec2 at : mesh.match[0]) low = glm::min(low, at), high = glm::max(high, at);
  CHECK(low == glm::vec2(0));
  CHECK(high == glm::vec2(width, height));
  return area / (width * height);
}

// Checks that the mesh covers the picture without gap or overlap. All triangles have the same orientation and lie
// inside the picture; their areas then sum to the picture's area.
void checkClosed(const Camera& camera, const CellMesh& backdrop) {
  CHECK(checkedShare(camera, backdrop) == Approx(1).epsilon(1e-6));
}

}  // namespace

TEST_CASE("completed depth keeps known depth, and stays within the range of known depth") {
  for (const double share : {0.002, 0.05, 0.5, 0.95}) {
    const ImageF depth = patchy(90, 70, share);
    const Image8 colours = speckled(90, 70);
    const ImageF completed = completeDepth(depth, colours);
    const float nearest = *std::max_element(depth.values.begin(), depth.values.end());
    float farthest = nearest;
    for (const float w : depth.values)
      if (w >= 0) farthest = std::min(farthest, w);
    for (std::size_t at = 0; at < depth.values.size(); ++at) {
      if (depth.values[at] >= 0) CHECK(completed.values[at] == depth.values[at]);
      REQUIRE(completed.values[at] >= farthest);
      REQUIRE(completed.values[at] <= nearest);
    }
    CHECK(completeDepth(depth, colours) == completed);
  }
}

TEST_CASE("a completed hole stays within the depth range of its rim") {
  ImageF depth(60, 60, 1, 5.0f);
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) {
      const bool rim = x == 20 || x == 39 || y == 20 || y == 39;
      depth.pixel(x, y)[0] = rim ? (x < 30 ? 0.1f : 0.2f) : kUnknownDepth;
    }
  const ImageF completed = completeDepth(depth, speckled(60, 60));
  for (int y = 21; y < 39; ++y)
    for (int x = 21; x < 39; ++x) {
      CHECK(completed.pixel(x, y)[0] >= 0.1f);
      CHECK(completed.pixel(x, y)[0] <= 0.2f);
    }
}

TEST_CASE("completed depth follows the photograph's edges, and is linear in inverse depth elsewhere") {
  ImageF depth(80, 40, 1, kUnknownDepth);
  Image8 edge(80, 40, 3, 60), flat(80, 40, 3, 60);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 80; ++x) {
      if (x < 5) depth.pixel(x, y)[0] = 0.5f;
      if (x >= 75) depth.pixel(x, y)[0] = 0.1f;
      if (x >= 60) std::ranges::fill(edge.pixel(x, y), std::uint8_t(200));
    }
  const ImageF followed = completeDepth(depth, edge), smooth = completeDepth(depth, flat);
  CHECK(followed.pixel(50, 20)[0] > 0.45f);
  CHECK(followed.pixel(65, 20)[0] < 0.11f);
  for (int x = 5; x < 75; ++x) CHECK(smooth.pixel(x, 20)[0] == Approx(0.5 - 0.4 * (x - 4) / 71.0).margin(0.01));
}

TEST_CASE("completed depth is biased neither to the near nor to the far rim of a hole") {
  const Image8 flat(64, 48, 3, 90);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(0.05f, 0.95f);
  ImageF rims(64, 48, 1, kUnknownDepth), swapped = rims;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      if (x < 6 || x >= 58 || y < 6 || y >= 42) {
        rims.pixel(x, y)[0] = uniform(random);
        swapped.pixel(x, y)[0] = 1.0f - rims.pixel(x, y)[0];  // exchanges near and far
      }
  const ImageF completed = completeDepth(rims, flat), completedSwapped = completeDepth(swapped, flat);
  for (std::size_t at = 0; at < completed.values.size(); ++at)
    REQUIRE(completedSwapped.values[at] == Approx(1.0 - double(completed.values[at])).margin(1e-4));
}

TEST_CASE("depth is completed from no, one or all pixels") {
  const Image8 colours = speckled(40, 30);
  ImageF depth(40, 30, 1, kUnknownDepth);
  for (const float w : completeDepth(depth, colours).values) CHECK(w == 0);
  depth.pixel(39, 0)[0] = 0.25f;
  for (const float w : completeDepth(depth, colours).values) CHECK(w == 0.25f);
  depth.pixel(39, 0)[0] = 0;
  for (const float w : completeDepth(depth, colours).values) CHECK(w == 0);
  const ImageF all = patchy(40, 30, 1.1);
  CHECK(completeDepth(all, colours) == all);
  CHECK(completeDepth(ImageF(1, 1, 1, kUnknownDepth), Image8(1, 1, 3)).values == std::vector<float>{0});
}

TEST_CASE("a backdrop covers the image exactly, except where it is stretched over completed depth") {
  const Camera camera = lookingAlong({0, 0, 0}, {0, 1, 0}, 301, 203);
  const glm::ivec2 size = backdropSize(camera.intrinsics);
  CHECK(size == glm::ivec2(301, 203));
  CHECK(backdropSize(resized(camera.intrinsics, 3000, 1000)) == glm::ivec2(kBackdropSide, 171));
  CHECK(backdropSize(resized(camera.intrinsics, 5000, 1)) == glm::ivec2(kBackdropSide, 1));
  const Image8 colours = speckled(size.x, size.y);
  ImageF one(size.x, size.y, 1, kUnknownDepth);
  one.pixel(100, 100)[0] = 0.3f;
  const auto built = [&](const ImageF& depth, double step) {
    return buildBackdrop(camera, depth, colours, {.step = step, .spacing = 8});
  };
  for (const ImageF& depth : {ImageF(size.x, size.y, 1, kUnknownDepth), one, patchy(size.x, size.y, 1.1)})
    for (const double step : {0.0, 1.0, 1e3}) checkClosed(camera, built(depth, step));
  const ImageF some = patchy(size.x, size.y, 0.3);
  checkClosed(camera, built(some, 0));
  for (const double step : {1.0, 1e3}) CHECK(checkedShare(camera, built(some, step)) < 0.99);
  std::size_t last = 0;
  for (const int spacing : {32, 16, 8, 4, 2}) {
    const CellMesh backdrop =
        buildBackdrop(camera, patchy(size.x, size.y, 1.1), colours, {.step = 1.0, .spacing = spacing});
    checkClosed(camera, backdrop);
    CHECK(backdrop.mesh.vertexCount() > last);
    last = backdrop.mesh.vertexCount();
  }
  for (const glm::ivec2 tiny : {glm::ivec2(1, 1), {3, 2}, {1, 40}}) {
    const Camera small{resized(camera.intrinsics, tiny.x, tiny.y), camera.pose};
    checkClosed(small, buildBackdrop(small, ImageF(tiny.x, tiny.y, 1, 0.5f), Image8(tiny.x, tiny.y, 3),
                                     {.step = 1.0, .spacing = 8}));
  }
}

TEST_CASE("a backdrop's vertices are at the given depth, and its coverage counts known depth") {
  const Camera camera = lookingAlong({1, 2, 3}, {0.2, 1, 0.1}, 1024, 768);
  const glm::ivec2 size = backdropSize(camera.intrinsics);
  ImageF depth(size.x, size.y, 1, 0.25f);
  for (int y = 0; y < size.y / 2; ++y)
    for (int x = 0; x < size.x; ++x) depth.pixel(x, y)[0] = kUnknownDepth;
  const CellMesh backdrop = buildBackdrop(camera, depth, speckled(size.x, size.y), {.step = 1.0, .spacing = 8});
  CHECK(backdrop.quality.coverage == Approx(0.5));
  Scene scene;
  scene.nodes.push_back({"a", camera, {}, {}});
  for (std::size_t p = 0; p < backdrop.mesh.vertexCount(); ++p) {
    const auto point = vertexPosition(scene, {{0}, backdrop.mesh, {}}, p);
    REQUIRE(point);
    CHECK(glm::dot(*point - camera.pose.position, viewAxis(camera.pose)) == Approx(4.0).epsilon(1e-4));
  }
}

TEST_CASE("a panorama's backdrop is closed across its seam and at its poles") {
  const Camera camera{{CameraModel::equirectangular, 256, 128}, {{1, 2, 3}, {1, 0, 0, 0}}};
  CHECK(backdropSize(camera.intrinsics) == glm::ivec2(256, 128));
  CHECK(backdropSize({CameraModel::equirectangular, 8192, 4096}) == glm::ivec2(kPanoramaSide, kPanoramaSide / 2));
  ImageF depth(256, 128, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.2f, 0.3f);
  for (float& w : depth.values) w = uniform(random);
  const CellMesh backdrop = buildBackdrop(camera, depth, speckled(256, 128), {.step = 0.1, .spacing = 8});
  checkClosed(camera, backdrop);
  const MorphMesh& mesh = backdrop.mesh;
  std::map<float, std::vector<float>> left, right, poles;  // inverse distances by row
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    const glm::vec2 at = mesh.match[0][p];
    if (at.y == 0 || at.y == 128) poles[at.y].push_back(mesh.inverseDistance[p]);
    if (at.x == 0) left[at.y].push_back(mesh.inverseDistance[p]);
    if (at.x == 256) right[at.y].push_back(mesh.inverseDistance[p]);
  }
  CHECK(left.size() > 8);
  CHECK(left == right);
  REQUIRE(poles.size() == 2);
  for (const auto& [row, distances] : poles)
    CHECK(std::ranges::all_of(distances, [&](float w) { return w == distances.front(); }));
}

TEST_CASE("a panorama's vertices are at the given distance along their rays") {
  const Camera camera{{CameraModel::equirectangular, 256, 128}, {{1, 2, 3}, {0.6, 0, 0.8, 0}}};
  const CellMesh backdrop =
      buildBackdrop(camera, ImageF(256, 128, 1, 0.25f), speckled(256, 128), {.step = 1.0, .spacing = 8});
  CHECK(backdrop.quality.coverage == 1);
  CHECK(backdrop.mesh.tier0Count() == backdrop.mesh.triangles.size());
  Scene scene;
  scene.nodes.push_back({"a", camera, {}, {}});
  for (std::size_t p = 0; p < backdrop.mesh.vertexCount(); ++p) {
    const auto point = vertexPosition(scene, {{0}, backdrop.mesh, {}}, p);
    REQUIRE(point);
    CHECK(glm::distance(*point, camera.pose.position) == Approx(4.0).epsilon(1e-4));
  }
}

// Depth map of a near surface left of column 100 and a far surface right of the column.
ImageF depthEdge() {
  ImageF depth(256, 192, 1, 0.1f);
  for (int y = 0; y < 192; ++y)
    for (int x = 0; x < 100; ++x) depth.pixel(x, y)[0] = 1.0f;
  return depth;
}

TEST_CASE("both surfaces at a known depth edge extend to the edge") {
  const Camera camera = lookingAlong({0, 0, 0}, {0, 1, 0}, 256, 192);
  const CellMesh backdrop = buildBackdrop(camera, depthEdge(), speckled(256, 192), {.step = 1.0, .spacing = 8});
  checkClosed(camera, backdrop);
  const MorphMesh& mesh = backdrop.mesh;
  const auto isNear = [&](std::uint32_t v) {
    const double w = double(mesh.inverseDistance[v]) / -unproject(camera.intrinsics, mesh.match[0][v]).z;
    CHECK((w == Approx(1.0) || w == Approx(0.1)));
    return w > 0.5;
  };
  float lastNear = 0, firstFar = 256;
  for (const glm::uvec3& t : mesh.triangles) {
    REQUIRE(isNear(t.x) == isNear(t.y));
    REQUIRE(isNear(t.x) == isNear(t.z));
    for (const std::uint32_t v : {t.x, t.y, t.z}) {
      const float x = mesh.match[0][v].x;
      if (isNear(v)) lastNear = std::max(lastNear, x);
      if (!isNear(v)) firstFar = std::min(firstFar, x);
    }
  }
  // The mesh follows the depth edge to 1 px, although vertices are 8 px apart.
  CHECK(lastNear == Approx(100).margin(1));
  CHECK(firstFar == Approx(100).margin(1));
}

TEST_CASE("triangles that are stretched over completed depth are left out") {
  const Camera camera = lookingAlong({0, 0, 0}, {0, 1, 0}, 256, 192);
  for (const auto& [from, cut] : {std::pair{60, false}, {200, true}}) {
    CAPTURE(from);
    ImageF holed = depthEdge();
    for (int y = 0; y < 192; ++y)
      for (int x = 0; x < 256; ++x) holed.pixel(x, y)[0] = x < from ? 1.0f : x < 250 ? kUnknownDepth : 0.1f;
    const CellMesh guessed = buildBackdrop(camera, holed, speckled(256, 192), {.step = 1.0, .spacing = 8});
    const double share = checkedShare(camera, guessed);
    CHECK((share < 1 - 1e-6) == cut);
    CHECK(share > 0.6);  // blocks are at most 32 px wide, so columns left of 168 are all covered
    const MorphMesh& mesh = guessed.mesh;
    const auto inverseDepthAt = [&](std::uint32_t v) {
      return double(mesh.inverseDistance[v]) / -unproject(camera.intrinsics, mesh.match[0][v]).z;
    };
    std::size_t stretched = 0;
    for (const glm::uvec3& t : mesh.triangles)
      for (const auto& [a, b] : {std::pair{t.x, t.y}, {t.y, t.z}, {t.z, t.x}}) {
        const double parallax = camera.intrinsics.fx * std::abs(inverseDepthAt(a) - inverseDepthAt(b));
        stretched += parallax > 1.51 * glm::distance(mesh.match[0][a], mesh.match[0][b]);
      }
    CHECK(stretched == 0);
  }
}

TEST_CASE("points give depth where they are seen, and none behind the camera") {
  const Camera camera = lookingAlong({0, 0, 0}, {0, 1, 0}, 40, 30);
  const std::vector<glm::dvec3> points{{0.01, 4, 0.01}, {0.02, 8, 0.02}, {0, -3, 0}, {100, 1, 0}, {0, 0, 0}};
  const ImageF depth = depthOfPoints(camera, points);
  CHECK(std::ranges::count(depth.values, kUnknownDepth) == 40 * 30 - 1);
  CHECK(depth.pixel(20, 14)[0] == Approx(0.125));
}
