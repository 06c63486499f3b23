// SPDX-License-Identifier: Apache-2.0
// optimiseScene() with stub aligners that make chosen changes.
#include "ibr/author/optimise_scene.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

#include "author/align/alignment_grid.h"
#include "author/align/range_solver.h"
#include "author/geometry/epipolar_direction.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/mesh_signs.h"
#include "author/mesh/uncertainty.h"
#include "base/file.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/contents_below.h"
#include "support/error_of.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

// Scene folder: three cameras before a wall, and three cells, two of two members and one of three.
class Wall {
 public:
  Wall() {
    SyntheticOptions options;
    for (const double x : {0.0, 0.5, 1.0})
      options.cameras.push_back(lookingAlong({x, 0, 0.1 * x}, {0, 1, 0}, 160, 120));
    options.planes = {{{0.5, 4, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.2}};
    options.cells = {{0, 1}, {1, 2}, {0, 1, 2}};
    options.gridStep = 16;
    options.samplesPerAxis = 1;
    SyntheticScene made = makeScene(options);
    scene = std::move(made.scene);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
      Node& node = scene.nodes[i];
      node.imageFile = fs::path("images") / (node.name + ".png");
      node.textureFile = fs::path("textures") / (node.name + ".ktx2");
      makeFolders(folder / "scene/images");
      makeFolders(folder / "scene/textures");
      writeImage(folder / "scene" / node.imageFile, made.photographs[i]);
      writeKtx2(folder / "scene" / node.textureFile,
                encodeTexture(buildMips(made.photographs[i]), TextureFormat::rgba8));
    }
    for (Cell& cell : scene.cells) {
      cell.quality = {};
      cell.quality.ecc = cell.quality.score = 0.5;
      for (float& u : cell.mesh.uncertainty) u = 0.01f;
    }
    saveScene(scene, folder / "scene");
    scene = loadScene(folder / "scene");
  }
  OptimiseSceneOptions options(const std::string& output = "out") const {
    OptimiseSceneOptions o{folder / "scene", folder / output, {}};
    o.cells.alignment.method = AlignmentMethod::cpu;
    o.cells.threads = 1;
    return o;
  }

  TemporaryFolder folder;
  Scene scene;
};

AlignmentSummary summaryOf(const Alignment& a) {
  AlignmentSummary summary;
  summary.initialEcc = 0.5;
  summary.finalEcc = 0.75;
  summary.initialStarEcc.assign(a.position[0].size(), 0.25f);
  summary.finalStarEcc.assign(a.position[0].size(), 0.5f);
  summary.cycles.push_back({5, 0.75, 10, 100, 1, 0, 0.1});
  return summary;
}

AlignmentSummary doNothing(Alignment& a, const AlignmentOptions&, const ProgressCallback&) {
  return summaryOf(a);
}

// Moves every `every`-th point in picture 0. With `asks`, only moves that the guard allows are made.
Aligner moving(glm::ivec2 by, std::size_t every = 3, bool asks = true) {
  return [by, every, asks](Alignment& a, const AlignmentOptions& o, const ProgressCallback&) {
    for (std::size_t p = 0; p < a.position[0].size(); p += every) {
      if (a.fixed[p]) continue;
      std::vector<glm::ivec2> match;
      for (const auto& list : a.position) match.push_back(list[p]);
      match[0] += by;
      if (!asks || o.guard(std::uint32_t(p), match)) a.position[0][p] = match[0];
    }
    return summaryOf(a);
  };
}

// First two triangles that share an edge, by index: (from, to, c) and (to, from, d).
struct Neighbours {
  std::size_t s, t;
  unsigned from, to, c, d;
};
Neighbours firstNeighbours(const Alignment& a) {
  for (std::size_t s = 0; s < a.triangles.size(); ++s)
    for (std::size_t t = 0; t < s; ++t)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) {
          const glm::uvec3 one = a.triangles[s], other = a.triangles[t];
          const unsigned from = one[k], to = one[(k + 1) % 3];
          if (other[l] == to && other[(l + 1) % 3] == from)
            return {s, t, from, to, one[(k + 2) % 3], other[(l + 2) % 3]};
        }
  throw std::logic_error("no two triangles share an edge");
}

// Flips the edge of the first two neighbours, without comparing photographs.
AlignmentSummary flipOne(Alignment& a, const AlignmentOptions&, const ProgressCallback&) {
  const auto [s, t, from, to, c, d] = firstNeighbours(a);
  a.triangles[s] = {from, d, c};
  a.triangles[t] = {d, to, c};
  return summaryOf(a);
}

// Splits the shared edge of the first two neighbours in its middle; the new point is moved by `off` in picture 0.
Aligner insertingOne(glm::ivec2 off) {
  return [off](Alignment& a, const AlignmentOptions&, const ProgressCallback&) {
    const auto [s, t, from, to, c, d] = firstNeighbours(a);
    const auto n = unsigned(a.position[0].size());
    for (auto& at : a.position) at.push_back((at[from] + at[to]) / 2);
    a.position[0][n] += off;
    a.fixed.push_back(0);
    a.inserted.push_back({{from, to, to}, {0.5, 0.5, 0}});
    a.triangles[s] = {c, from, n};
    a.triangles[t] = {d, to, n};
    a.triangles.insert(a.triangles.end(), {{to, c, n}, {from, d, n}});
    AlignmentSummary summary = summaryOf(a);
    summary.initialStarEcc.back() = std::nanf("");
    return summary;
  };
}

bool sameMesh(const MorphMesh& a, const MorphMesh& b) {
  return a.match == b.match && a.ratio == b.ratio && a.inverseDistance == b.inverseDistance &&
         a.uncertainty == b.uncertainty && a.triangles == b.triangles && a.tier == b.tier && a.ecc == b.ecc;
}

}  // namespace

TEST_CASE("if no point moves, the output scene equals the input scene") {
  const Wall wall;
  const auto report = optimiseScene(wall.options(), doNothing);
  REQUIRE(report.cells.size() == 3);
  CHECK(report.cells[2].cell == 2);
  CHECK(report.cells[2].members.size() == 3);
  CHECK(report.cells[0].width == 160);
  CHECK(report.cells[0].evaluated > 20);
  CHECK(report.cells[0].moved == 0);
  CHECK(report.cells[0].summary.finalEcc == 0.75);
  const Scene after = loadScene(wall.folder / "out");
  REQUIRE(after.cells.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(sameMesh(wall.scene.cells[c].mesh, after.cells[c].mesh));
    CHECK(after.cells[c].quality.score == 0.5);
  }
  CHECK_THAT(after.settings, Contains(R"("optimised")") && Contains(R"("cpu")"));
  CHECK(validateSceneFiles(wall.folder / "out").empty());
  for (const Node& node : wall.scene.nodes) {
    CHECK(fs::equivalent(wall.folder / "scene" / node.textureFile, wall.folder / "out" / node.textureFile));
    CHECK(readImage(wall.folder / "out" / node.imageFile) == readImage(wall.folder / "scene" / node.imageFile));
  }
  CHECK(!fs::exists(wall.folder / "out/.optimise"));
}

TEST_CASE("an optimised scene keeps depth and the evidence of backdrops, not that of its cells") {
  const Wall wall;
  Scene scene = wall.scene;
  const auto addTo = [](MorphMesh& mesh) {
    mesh.confirmations.assign(mesh.vertexCount(), 2);
    mesh.consensus.assign(mesh.vertexCount(), 0.75f);
  };
  addTo(scene.cells[2].mesh);
  Cell backdrop;
  backdrop.members = {1};
  backdrop.mesh.match = {{{0, 0}, {160, 0}, {0, 120}}};
  backdrop.mesh.ratio = {{1, 1, 1}};
  backdrop.mesh.inverseDistance = backdrop.mesh.uncertainty = {0.25f, 0.25f, 0.25f};
  backdrop.mesh.triangles = {{0, 2, 1}};
  backdrop.mesh.tier = {kTierConsistent};
  backdrop.mesh.ecc = {1};
  addTo(backdrop.mesh);
  scene.backdrops = {backdrop};
  scene.nodes[1].depthFile = "depth/one.ktx2";
  scene.nodes[1].depthScale = 0.25;
  makeFolders(wall.folder / "scene/depth");
  writeKtx2(wall.folder / "scene/depth/one.ktx2",
            depthTexture({ImageF(40, 30, 1, 0.25f), ImageF(40, 30, 1, 0.75f)}, 160).texture);
  saveScene(scene, wall.folder / "scene");
  optimiseScene(wall.options(), doNothing);
  CHECK(validateSceneFiles(wall.folder / "out").empty());
  const Scene after = loadScene(wall.folder / "out");
  CHECK(after.nodes[1].depthScale == 0.25);
  CHECK(fs::equivalent(wall.folder / "scene/depth/one.ktx2", wall.folder / "out" / after.nodes[1].depthFile));
  CHECK(after.backdrops.at(0).mesh.confirmations == backdrop.mesh.confirmations);
  CHECK(after.backdrops.at(0).mesh.consensus == backdrop.mesh.consensus);
  CHECK(after.cells.at(2).mesh.confirmations.empty());
}

TEST_CASE("moved points get a new distance and labels, all others are unchanged") {
  const Wall wall;
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  // Moves along the baseline bring a point nearer by a known amount.
  const auto report = optimiseScene(options, moving({kAlignmentUnitsPerPixel, 0}));
  const Scene after = loadScene(wall.folder / "out");
  CHECK(sameMesh(wall.scene.cells[1].mesh, after.cells[1].mesh));
  const MorphMesh &was = wall.scene.cells[0].mesh, &is = after.cells[0].mesh;
  std::size_t moved = 0;
  const Camera &first = wall.scene.nodes[0].camera, &second = wall.scene.nodes[1].camera;
  for (std::size_t p = 0; p < was.vertexCount(); ++p) {
    CHECK(is.match[1][p] == was.match[1][p]);
    if (is.match[0][p] == was.match[0][p]) {
      CHECK(is.inverseDistance[p] == was.inverseDistance[p]);
      CHECK(is.uncertainty[p] == was.uncertainty[p]);
      CHECK(is.ratio[0][p] == was.ratio[0][p]);
      continue;
    }
    ++moved;
    CHECK(double(is.match[0][p].x) == Approx(double(was.match[0][p].x) + 1).margin(0.5 / kAlignmentUnitsPerPixel));
    // The distance along the ray of picture 0 where the two rays are closest must be the point's distance.
    const glm::dvec3 a = first.pose.rotation * unproject(first.intrinsics, is.match[0][p]);
    const glm::dvec3 b = second.pose.rotation * unproject(second.intrinsics, is.match[1][p]);
    const glm::dvec3 base = second.pose.position - first.pose.position, n = glm::cross(a, b);
    const double s = glm::dot(glm::cross(base, b), n) / glm::dot(n, n);
    CHECK(double(is.ratio[0][p]) / double(is.inverseDistance[p]) == Approx(s).epsilon(0.05));
    CHECK(is.inverseDistance[p] > was.inverseDistance[p]);
  }
  CHECK(moved == report.cells[0].moved);
  CHECK(moved > 10);
  // A corner that is off by a pixel lowers the ECC of nearly all triangles around the corner.
  std::size_t worse = 0, touched = 0;
  for (std::size_t t = 0; t < was.triangles.size(); ++t) {
    const bool corner = is.match[0][was.triangles[t].x] != was.match[0][was.triangles[t].x] ||
                        is.match[0][was.triangles[t].y] != was.match[0][was.triangles[t].y] ||
                        is.match[0][was.triangles[t].z] != was.match[0][was.triangles[t].z];
    if (!corner) CHECK(is.ecc[t] == was.ecc[t]);
    touched += corner;
    worse += corner && is.ecc[t] < was.ecc[t];
  }
  CHECK(worse > touched * 9 / 10);
  CHECK(after.cells[0].quality.score == Approx(0.5 * after.cells[0].quality.ecc / 0.5).epsilon(1e-6));
  CHECK(after.cells[0].quality.ecc < 1);
}

TEST_CASE("moves to diverging rays, or to rays that miss their point by more than 3 px, are rejected") {
  const Wall wall;
  const auto moves = [&](glm::ivec2 px) {
    const fs::path out = wall.folder / "moves";
    fs::remove_all(out);
    OptimiseSceneOptions options = wall.options("moves");
    options.cells.cells = {0};
    return optimiseScene(options, moving(px * kAlignmentUnitsPerPixel, 9)).cells[0].moved;
  };
  CHECK(moves({1, 0}) > 5);
  CHECK(moves({0, 5}) > 5);     // 2.5 px from the best-fitting point
  CHECK(moves({0, 7}) == 0);    // 3.5 px
  CHECK(moves({-40, 0}) == 0);  // the wall has 16 px of parallax, so the rays diverge
}

TEST_CASE("no triangle flips, although unmoved points are off the grid") {
  const Wall wall;
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {2};
  const auto report = optimiseScene(options, moving({0, -16 * kAlignmentUnitsPerPixel}, 5, false));
  CHECK(report.cells[0].reverted > 3);
  const MorphMesh &was = wall.scene.cells[2].mesh, is = loadScene(wall.folder / "out").cells[2].mesh;
  for (const glm::uvec3& t : was.triangles) CHECK((meshSigns(was.match, t) & ~meshSigns(is.match, t)) == 0);
}

TEST_CASE("moves that would fold triangles are reverted") {
  Wall wall;
  const auto collapse = [](Alignment& a, const AlignmentOptions&, const ProgressCallback&) {
    const glm::uvec3 t = a.triangles[a.triangles.size() / 2];
    for (auto& list : a.position) list[t.x] = list[t.y] + list[t.y] - list[t.x];  // far beyond the opposite edge
    return summaryOf(a);
  };
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  const auto report = optimiseScene(options, collapse);
  CHECK(report.cells[0].reverted == 1);
  CHECK(report.cells[0].moved == 0);
  CHECK(sameMesh(loadScene(wall.folder / "out").cells[0].mesh, wall.scene.cells[0].mesh));
}

TEST_CASE("flipped edges are stored with new labels, and all else is unchanged") {
  Wall wall;
  const bool kept = GENERATE(false, true);
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  options.cells.cacheFolder = wall.folder / "finished";
  if (kept) optimiseScene(wall.options("other"), doNothing), optimiseScene(options, flipOne);
  const auto report = optimiseScene(options, flipOne);
  CHECK(report.cells[0].cached == kept);
  CHECK(report.cells[0].moved == 0);
  CHECK(report.cells[0].flipped == 2);
  const MorphMesh &was = wall.scene.cells[0].mesh, is = loadScene(wall.folder / "out").cells[0].mesh;
  REQUIRE(is.triangles.size() == was.triangles.size());
  CHECK(is.match == was.match);
  CHECK(is.tier == was.tier);
  CHECK(is.inverseDistance == was.inverseDistance);
  std::set<unsigned> corners;
  std::size_t changed = 0;
  for (std::size_t t = 0; t < is.triangles.size(); ++t) {
    if (is.triangles[t] == was.triangles[t]) {
      CHECK(is.ecc[t] == was.ecc[t]);
      continue;
    }
    ++changed;
    for (int k = 0; k < 3; ++k) corners.insert(is.triangles[t][k]);
    CHECK(is.tier[t] == kTierConsistent);
    CHECK(is.ecc[t] != was.ecc[t]);
    // The new triangle has the orientation of the mesh's triangles.
    CHECK((meshSigns(is.match, is.triangles[t]) & 1u) == (meshSigns(was.match, was.triangles[t]) & 1u));
  }
  CHECK(changed == 2);
  CHECK(corners.size() == 4);
  CHECK(validateSceneFiles(wall.folder / "out").empty());
  options.cells.alignment.flipEdges = true;
  CHECK(!optimiseScene(options, flipOne).cells[0].cached);
  options.cells.alignment.flipGain = 0.02;
  CHECK(!optimiseScene(options, flipOne).cells[0].cached);
  CHECK_THAT(loadScene(wall.folder / "out").settings, Contains(R"("flipEdges":true,"flipGain":0.02)"));
}

TEST_CASE("edges are flipped back where new triangles would fold over") {
  Wall wall;
  const auto foldsOne = [](Alignment& a, const AlignmentOptions& o, const ProgressCallback& p) {
    const AlignmentSummary summary = flipOne(a, o, p);
    for (glm::uvec3& t : a.triangles) std::swap(t.y, t.z);
    return summary;
  };
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  const auto report = optimiseScene(options, foldsOne);
  CHECK(report.cells[0].flipped == 0);
  CHECK(sameMesh(loadScene(wall.folder / "out").cells[0].mesh, wall.scene.cells[0].mesh));
}

TEST_CASE("an inserted point gets all attributes, and the other points are unchanged") {
  Wall wall;
  MorphMesh& mesh = wall.scene.cells[0].mesh;
  for (std::size_t t = mesh.triangles.size() - 6; t < mesh.triangles.size(); ++t) mesh.tier[t] = kTierRejected;
  mesh.planes.assign(mesh.vertexCount(), {2, 5, 0, 0});
  saveScene(wall.scene, wall.folder / "scene");
  wall.scene = loadScene(wall.folder / "scene");
  const MorphMesh was = wall.scene.cells[0].mesh;
  const std::size_t n = was.vertexCount();
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  options.cells.cacheFolder = wall.folder / "kept";
  const bool kept = GENERATE(false, true);
  const Aligner insertsOne = insertingOne({kAlignmentUnitsPerPixel, 0});
  if (kept) optimiseScene(options, insertsOne);
  const auto report = optimiseScene(options, insertsOne);
  const OptimisedCell& facts = report.cells[0];
  CHECK(facts.cached == kept);
  CHECK(facts.inserted == 1);
  CHECK(facts.points == n);
  CHECK(facts.moved == 0);
  CHECK(facts.flipped == 0);
  CHECK(facts.summary.initialStarEcc.size() == n + 1);
  CHECK(validateSceneFiles(wall.folder / "out").empty());
  const MorphMesh is = loadScene(wall.folder / "out").cells[0].mesh;
  REQUIRE(is.vertexCount() == n + 1);
  const auto first = [&](const auto& list) { return std::vector(list.begin(), list.begin() + std::ptrdiff_t(n)); };
  CHECK(first(is.inverseDistance) == was.inverseDistance);
  CHECK(first(is.uncertainty) == was.uncertainty);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(first(is.match[i]) == was.match[i]);
    CHECK(first(is.ratio[i]) == was.ratio[i]);
  }
  CHECK(is.planes.at(n) == glm::u16vec4(2, 5, 0, 0));
  // The inserted point's distance is that of the closest approach of its two rays.
  const Camera &one = wall.scene.nodes[0].camera, &other = wall.scene.nodes[1].camera;
  const glm::dvec3 a = one.pose.rotation * unproject(one.intrinsics, is.match[0][n]);
  const glm::dvec3 b = other.pose.rotation * unproject(other.intrinsics, is.match[1][n]);
  const glm::dvec3 base = other.pose.position - one.pose.position, normal = glm::cross(a, b);
  const double distance = glm::dot(glm::cross(base, b), normal) / glm::dot(normal, normal);
  CHECK(double(is.ratio[0][n]) / double(is.inverseDistance[n]) == Approx(distance).epsilon(0.05));
  CHECK(is.uncertainty[n] > 0);
  CHECK(double(is.uncertainty[n]) < 0.2 * double(is.inverseDistance[n]));
  // Two tier-0 triangles become four; they precede the tier-1 triangles, which are unchanged.
  REQUIRE(is.triangles.size() == was.triangles.size() + 2);
  CHECK(is.tier0Count() == was.tier0Count() + 2);
  std::size_t around = 0, old = 0;
  std::set<unsigned> corners;
  for (std::size_t t = 0; t < is.triangles.size(); ++t) {
    const glm::uvec3& corner = is.triangles[t];
    CHECK(is.tier[t] == (t < was.tier0Count() + 2 ? kTierConsistent : kTierRejected));
    CHECK((meshSigns(is.match, corner) & 1u) == (meshSigns(was.match, was.triangles[0]) & 1u));
    if (std::max({corner.x, corner.y, corner.z}) == n) {
      ++around;
      corners.insert({corner.x, corner.y, corner.z});
      CHECK(is.ecc[t] < 1);
      CHECK(is.ecc[t] > 0);
      continue;
    }
    const auto same = std::ranges::find(was.triangles, corner);
    REQUIRE(same != was.triangles.end());
    CHECK(is.ecc[t] == was.ecc[std::size_t(same - was.triangles.begin())]);
    ++old;
  }
  CHECK(around == 4);
  CHECK(corners.size() == 5);
  CHECK(old == was.triangles.size() - 2);
  options.cells.alignment.insertPoints = true;
  CHECK(!optimiseScene(options, insertsOne).cells[0].cached);
  for (double AlignmentOptions::*const value :
       {&AlignmentOptions::insertBelow, &AlignmentOptions::insertGain, &AlignmentOptions::insertShare}) {
    options.cells.alignment.*value += 0.01;
    CHECK(!optimiseScene(options, insertsOne).cells[0].cached);
  }
  CHECK_THAT(loadScene(wall.folder / "out").settings, Contains(R"("insertPoints":true)"));
}

TEST_CASE("an inserted point that would fold a triangle is removed, with all flips") {
  const Wall wall;
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  const auto report = optimiseScene(options, insertingOne({60 * kAlignmentUnitsPerPixel, 0}));
  CHECK(report.cells[0].inserted == 0);
  CHECK(report.cells[0].flipped == 0);
  CHECK(sameMesh(loadScene(wall.folder / "out").cells[0].mesh, wall.scene.cells[0].mesh));
}

TEST_CASE("the guard also rejects positions of inserted points") {
  const Wall wall;
  OptimiseSceneOptions options = wall.options();
  options.cells.cells = {0};
  const Aligner asks = [](Alignment& a, const AlignmentOptions& o, const ProgressCallback&) {
    const auto n = std::uint32_t(a.position[0].size());
    for (std::uint32_t p = 0; p < n; p += 7) {
      const auto may = [&](glm::ivec2 px) {
        const std::vector<glm::ivec2> match{a.position[0][p] + px * kAlignmentUnitsPerPixel, a.position[1][p]};
        return o.guard(n + 5, match);
      };
      CHECK(may({0, 0}));
      CHECK(may({8, 0}));
      CHECK(may({0, 5}));
      CHECK(!may({0, 7}));
      CHECK(!may({-40, 0}));
    }
    return summaryOf(a);
  };
  optimiseScene(options, asks);
}

TEST_CASE("a cancelled run continues and gives the same bytes") {
  const Wall wall;
  const Aligner move = moving({64, 0});
  int calls = 0;
  const Aligner stopsAtThird = [&](Alignment& a, const AlignmentOptions& o, const ProgressCallback& p) {
    if (++calls == 3) throw Error(ErrorCode::cancelled, "stop");
    return move(a, o, p);
  };
  CHECK(errorOf([&] { optimiseScene(wall.options(), stopsAtThird); }).code() == ErrorCode::cancelled);
  CHECK(!fs::exists(wall.folder / "out/scene.gltf"));
  calls = 10;
  const auto report = optimiseScene(wall.options(), stopsAtThird);
  CHECK(calls == 11);
  CHECK(report.cells[0].cached);
  CHECK(report.cells[1].cached);
  CHECK(!report.cells[2].cached);
  CHECK(report.cells[0].summary.finalStarEcc[3] == 0.5f);
  CHECK(report.cells[0].summary.cycles.at(0).pixels == 100);
  CHECK(report.cells[0].members.size() == 2);
  optimiseScene(wall.options("whole"), move);
  CHECK(contentsBelow(wall.folder / "out") == contentsBelow(wall.folder / "whole"));

  // Cells of other options are other cache entries.
  OptimiseSceneOptions kept = wall.options("again");
  kept.cells.cacheFolder = wall.folder / "kept";
  optimiseScene(kept, stopsAtThird);
  calls = 10;
  CHECK(optimiseScene(kept, stopsAtThird).cells[2].cached);
  CHECK(calls == 10);
  kept.cells.alignment.rigidity = 4;
  CHECK(!optimiseScene(kept, stopsAtThird).cells[2].cached);
  kept.cells.alignment.seed = 2;
  CHECK(!optimiseScene(kept, stopsAtThird).cells[2].cached);
}

TEST_CASE("progress can cancel a run, and reaches the optimiser") {
  const Wall wall;
  std::set<std::string> stages;
  const ProgressCallback no = [&](const Progress& p) {
    stages.insert(std::string(p.stage));
    CHECK(p.done <= p.total);
    return false;
  };
  CHECK(errorOf([&] { optimiseScene(wall.options(), doNothing, no); }).code() == ErrorCode::cancelled);
  CHECK(stages == std::set<std::string>{"optimising cells"});
  std::atomic<bool> started = false;
  const Aligner waits = [&](Alignment& a, const AlignmentOptions&, const ProgressCallback& p) {
    started = true;
    while (p({"aligning", 1, 0})) {
    }
    throw Error(ErrorCode::cancelled, "stopped");
    return summaryOf(a);
  };
  const ProgressCallback untilStarted = [&](const Progress&) { return !started; };
  CHECK(errorOf([&] { optimiseScene(wall.options(), waits, untilStarted); }).code() == ErrorCode::cancelled);
}

TEST_CASE("cells run in parallel on the CPU, and one after another on a device") {
  const Wall wall;
  std::atomic<int> running = 0, most = 0, threads = 0;
  const Aligner counts = [&](Alignment& a, const AlignmentOptions& o, const ProgressCallback&) {
    const int now = ++running;
    if (now > most) most = now;
    threads = o.threads;
    for (volatile int spin = 0; spin < 3000000;) spin = spin + 1;
    --running;
    return summaryOf(a);
  };
  OptimiseSceneOptions options = wall.options();
  options.cells.threads = 2;
  optimiseScene(options, counts);
  CHECK(threads == 1);
  CHECK(most <= 2);
  options.cells.threads = 7;  // more threads than cells
  optimiseScene(options, counts);
  CHECK(threads == 2);
  CHECK(most <= 3);
  most = 0;
  options.cells.alignment.method = AlignmentMethod::compute;
  optimiseScene(options, counts);
  CHECK(most == 1);
}

TEST_CASE("panoramas are aligned on cube faces, and moves are mapped back to the sphere") {
  const TemporaryFolder folder;
  SyntheticOptions options;
  for (const double x : {0.0, 0.4}) {
    Camera camera{{CameraModel::equirectangular, 512, 256}, {{x, 0.1 * x, 0}, {1, 0, 0, 0}}};
    camera.pose.rotation = glm::angleAxis(x, glm::normalize(glm::dvec3(0.1, 1, 0)));  // each has its own rotation
    options.cameras.push_back(camera);
  }
  options.planes = roomPlanes({-3, -1.5, -4}, {3, 2, 3}, 0.3);
  options.surfaceStep = 0.5;
  options.samplesPerAxis = 1;
  SyntheticScene made = makeScene(options);
  for (std::size_t i = 0; i < made.scene.nodes.size(); ++i) {
    Node& node = made.scene.nodes[i];
    node.imageFile = node.name + ".png";
    node.textureFile = node.name + ".ktx2";
    makeFolders(folder / "scene");
    writeImage(folder / "scene" / node.imageFile, made.photographs[i]);
    writeKtx2(folder / "scene" / node.textureFile, encodeTexture(buildMips(made.photographs[i]), TextureFormat::rgba8));
  }
  saveScene(made.scene, folder / "scene");
  const Scene before = loadScene(folder / "scene");
  OptimiseSceneOptions task{folder / "scene", folder / "out", {}};
  task.cells.alignment.method = AlignmentMethod::cpu;
  int faces = 0;
  double truth = 0;
  const Aligner half = [&](Alignment& a, const AlignmentOptions& o, const ProgressCallback& p) {
    ++faces;
    CHECK(a.pictures[0]->width == a.pictures[0]->height);
    // The faces keep the panoramas' orientation: matches in the faces show the same colours.
    for (std::size_t v = 0; v < a.position[0].size(); ++v) {
      if (a.fixed[v]) continue;
      glm::dvec3 colour[2];
      for (std::size_t i = 0; i < 2; ++i) {
        const glm::ivec2 at = a.position[i][v] / kAlignmentUnitsPerPixel;
        const auto pixel = a.pictures[i]->pixel(at.x, at.y);
        colour[i] = {pixel[0], pixel[1], pixel[2]};
      }
      truth += glm::distance(colour[0], colour[1]) < 60;
    }
    return moving({32, 0}, 2)(a, o, p);
  };
  const auto report = optimiseScene(task, half);
  const MorphMesh &was = before.cells[0].mesh, is = loadScene(folder / "out").cells[0].mesh;
  const OptimisedCell& facts = report.cells.at(0);
  CHECK(faces == 6);
  const std::size_t movable = facts.points - facts.fixed;
  CHECK(movable > facts.points / 2);
  CHECK(truth > 0.8 * double(movable));
  CHECK(facts.moved > movable / 3);
  CHECK(facts.summary.finalEcc == Approx(0.5));  // mean over movable points
  for (std::size_t p = 0; p < was.vertexCount(); ++p) {
    CHECK(is.match[1][p] == was.match[1][p]);
    const Camera& camera = before.nodes[0].camera;
    const double angle = std::acos(std::min(
        1.0, glm::dot(unproject(camera.intrinsics, is.match[0][p]), unproject(camera.intrinsics, was.match[0][p]))));
    CHECK(angle < 0.26 / 81.6);  // 0.26 px at the middle of a face; the focal length of a face is 81.6 px
    const bool moved = is.match[0][p] != was.match[0][p];
    CHECK((is.inverseDistance[p] != was.inverseDistance[p]) == moved);
    if (moved) CHECK(double(is.inverseDistance[p]) == Approx(was.inverseDistance[p]).epsilon(0.35));
  }
  CHECK(validateSceneFiles(folder / "out").empty());
}

TEST_CASE("invalid input is reported by name, and no scene is written") {
  const Wall wall;
  const auto fault = [&](auto&& change) {
    OptimiseSceneOptions options = wall.options("faulty");
    change(options);
    return errorOf([&] { optimiseScene(options, doNothing); });
  };
  CHECK_THAT(fault([](auto& o) { o.cells.cells = {1, 7}; }).what(), Contains("cell 7"));
  CHECK_THAT(fault([](auto& o) { o.cells.cells = {1, 1}; }).what(), Contains("cell 1"));
  CHECK_THAT(fault([](auto& o) { o.output = o.scene; }).what(), Contains("overwrite"));
  CHECK(fault([](auto& o) { o.output.clear(); }).code() == ErrorCode::invalidInput);
  CHECK(fault([](auto& o) { o.scene = "nowhere"; }).code() == ErrorCode::io);
  CHECK(fault([](auto& o) { o.cells.threads = -1; }).code() == ErrorCode::invalidInput);
  writeImage(wall.folder / "scene" / wall.scene.nodes[1].imageFile, Image8(8, 8, 3));
  CHECK_THAT(fault([](auto&) {}).what(), Contains("view1") && Contains("160"));
  fs::remove(wall.folder / "scene" / wall.scene.nodes[1].imageFile);
  CHECK(fault([](auto&) {}).code() == ErrorCode::io);
  CHECK(!fs::exists(wall.folder / "faulty/scene.gltf"));
}

TEST_CASE("snapping to the grid flips no triangle, and fixes points that it cannot represent") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> jitter(-4, 4);
  double judged = 0, could = 0;
  for (int round = 0; round < 50; ++round) {
    // The rows are so close together that rounding alone would flip triangles.
    MorphMesh mesh;
    mesh.match.resize(2 + std::size_t(round) % 3);
    constexpr int kSide = 12;
    for (auto& match : mesh.match)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
          match.emplace_back(float(20 + 7 * x) + float(jitter(random)) / 512,
                             float(30 + y * 9) / 512 + float(jitter(random)) / 512);
    for (unsigned y = 0; y + 1 < kSide; ++y)
      for (unsigned x = 0; x + 1 < kSide; ++x) {
        const unsigned a = y * kSide + x;
        mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, a + kSide}, {a + 1, a + kSide + 1, a + kSide}});
      }
    mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
    mesh.tier.back() = kTierRejected;
    mesh.inverseDistance.assign(kSide * kSide, 0.0f);
    const std::vector<glm::ivec2> size(mesh.match.size(), {120, 90});
    const AlignmentGrid grid = toAlignmentGrid(mesh, size);
    CHECK(grid.alignment.triangles.size() + grid.alignment.unevaluated.size() == mesh.triangles.size());
    CHECK(!grid.alignment.triangles.empty());
    std::vector<std::vector<glm::vec2>> place(mesh.match.size());
    for (std::size_t i = 0; i < place.size(); ++i)
      for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
        place[i].push_back(glm::vec2(grid.alignment.position[i][p]) / 128.0f);
        CHECK(glm::distance(place[i][p], mesh.match[i][p]) < 0.03f);
      }
    for (const glm::uvec3& t : grid.alignment.triangles) {
      CHECK(meshSigns(place, t) == allPositive(place.size()));
      CHECK(meshSigns(mesh.match, t) == allPositive(place.size()));
      for (int k = 0; k < 3; ++k) CHECK(!grid.alignment.fixed[t[k]]);
    }
    CHECK(std::size_t(std::ranges::count(grid.alignment.fixed, 1)) == grid.fixed);
    judged += double(grid.alignment.triangles.size());
    could += double(std::ranges::count_if(
        mesh.triangles, [&](const glm::uvec3& t) { return meshSigns(mesh.match, t) == allPositive(place.size()); }));
  }
  CHECK(judged > 0.9 * could);
}

TEST_CASE("points outside an image do not move") {
  MorphMesh mesh;
  mesh.match = {{{1, 1}, {9, 1}, {1, 9}, {9, 9.5f}}, {{1, 1}, {9, 1}, {1, 9}, {9, 10.5f}}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  mesh.tier = {0, 0};
  mesh.inverseDistance.assign(4, 0.0f);
  const AlignmentGrid grid = toAlignmentGrid(mesh, {{10, 10}, {10, 10}});
  CHECK(grid.fixed == 1);
  CHECK(grid.alignment.fixed == std::vector<std::uint8_t>{0, 0, 0, 1});
  CHECK(grid.alignment.position[1][3] == glm::ivec2(9 * 128, 10 * 128));
  CHECK(grid.alignment.triangles == std::vector<glm::uvec3>{{0, 1, 2}});
  CHECK(grid.alignment.unevaluated == std::vector<glm::uvec3>{{1, 3, 2}});
}

TEST_CASE("the prior of the sweep is recovered: unmoved points keep their stored inverse distance") {
  const std::vector<Camera> members{lookingAlong({0, 0, 1.5}, {0, 1, 0}, 800, 600),
                                    lookingAlong({0.6, 0, 1.5}, {0.1, 1, 0}, 800, 600),
                                    lookingAlong({0.3, 0.4, 1.7}, {0, 1, 0}, 800, 600)};
  const Camera frame = meanFrame(members);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double level = GENERATE(0.002, 0.01);
  MorphMesh mesh;
  mesh.match.resize(3);
  mesh.ratio.resize(3);
  std::vector<std::vector<glm::dvec2>> match(3);
  std::vector<double> levels;
  for (unsigned p = 0; p < 300; ++p) {
    const double depth = 4 + 0.2 * uniform(random);
    const glm::dvec3 point(0.3 + 1.5 * uniform(random), depth, 1.5 + uniform(random));
    std::vector<glm::dvec2> pixels;
    for (std::size_t i = 0; i < 3; ++i) {
      const Camera& c = members[i];
      const glm::dvec2 at = *project(c.intrinsics, glm::conjugate(c.pose.rotation) * (point - c.pose.position));
      pixels.push_back(at + 0.3 * glm::dvec2(normal(random), normal(random)));
      match[i].push_back(pixels.back());
      mesh.match[i].emplace_back(pixels.back());
    }
    const double sweep = inverseDepth(frame, point) + 0.3 * level * normal(random);
    const RangeFit range = triangulate(frame, members, pixels, {sweep, kPriorLevels * level}, kNoisePx);
    mesh.inverseDistance.push_back(float(range.inverseDistance));
    mesh.uncertainty.push_back(float(range.uncertainty));
    for (std::size_t i = 0; i < 3; ++i) mesh.ratio[i].push_back(float(range.ratio[i]));
    levels.push_back(level * range.perInverseDepth);
    if (p >= 2) mesh.triangles.push_back({p - 2, p - 1, p});
  }
  widenUncertainty(mesh, levels);
  const RangeSolver solver(frame, members, mesh, match, true);
  CHECK(solver.level() == Approx(level).epsilon(0.1));
  for (unsigned p = 0; p < 300; ++p) {
    CHECK(solver.before(p).inverseDistance == Approx(mesh.inverseDistance[p]).epsilon(1e-4));
    for (std::size_t i = 0; i < 3; ++i) CHECK(solver.before(p).ratio[i] == Approx(mesh.ratio[i][p]).epsilon(1e-4));
    const std::vector<glm::dvec2> pixels{match[0][p], match[1][p], match[2][p]};
    CHECK(solver.solve(p, pixels).inverseDistance == solver.before(p).inverseDistance);
  }
}

TEST_CASE("the optimiser gets the epipolar direction of each match") {
  Wall built;
  const Scene& scene = built.scene;
  std::size_t asked = 0;
  const Aligner look = [&](Alignment& a, const AlignmentOptions&, const ProgressCallback&) {
    const Cell& cell = scene.cells[asked++];
    glm::dvec3 centre(0);
    for (const std::uint32_t n : cell.members)
      centre += scene.nodes[n].camera.pose.position / double(cell.members.size());
    REQUIRE(a.epipolar.size() == cell.members.size());
    for (std::size_t i = 0; i < a.epipolar.size(); ++i) {
      REQUIRE(a.epipolar[i].size() == cell.mesh.vertexCount());
      for (std::size_t p = 0; p < cell.mesh.vertexCount(); p += 7) {
        const glm::dvec2 expected =
            epipolarDirection(scene.nodes[cell.members[i]].camera, centre, glm::dvec2(cell.mesh.match[i][p]));
        CHECK(glm::distance(glm::dvec2(a.epipolar[i][p]), expected) < 1e-4);
      }
    }
    return summaryOf(a);
  };
  optimiseScene(built.options(), look);
  CHECK(asked == scene.cells.size());
}
