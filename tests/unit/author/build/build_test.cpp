// SPDX-License-Identifier: Apache-2.0
// build() from input files to the scene's files, on a small synthetic set.
#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "author/build/cell_cache.h"
#include "author/exposure/vignetting.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/srgb.h"
#include "base/usage.h"
#include "ibr/author/build.h"
#include "ibr/error.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/error_of.h"
#include "support/extremes.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

// Photographs of four cameras before a wall, their COLMAP model, and a photograph that the model does not contain.
class Set {
 public:
  explicit Set(int scale = 1) {
    std::vector<Camera> cameras;
    for (const glm::dvec2 at : {glm::dvec2(0, 0), {0.4, 0}, {0, 0.4}, {0.4, 0.4}})
      cameras.push_back(lookingAlong({at.x, 0, at.y}, {0, 1, 0}, 128, 96));
    SyntheticOptions options;
    options.cameras = cameras;
    options.cells = {{0, 1}};  // not used
    options.planes = {{{0, 4, 0}, {1, 0, 0}, {0, 0.2, 0.98}, 20, 20, 1, 0.2}};
    options.planes[0].v = glm::normalize(options.planes[0].v);
    options.samplesPerAxis = 2;
    for (Camera& camera : options.cameras) camera.intrinsics = resized(camera.intrinsics, 128 * scale, 96 * scale);
    scene = makeScene(options);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 400; ++i)
      points.push_back(options.planes[0].origin + options.planes[0].u * (0.15 * (i % 20) - 1.4) +
                       options.planes[0].v * (0.12 * (i / 20) - 1.1));
    model = modelOf(cameras, points);
    fs::create_directories(folder / "photos/sub");
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == 3) model.images[i].name = "sub/003.png";
      writeImage(folder / "photos" / model.images[i].name, scene.photographs[i]);
    }
    writeImage(folder / "photos/stranger.png", scene.photographs[0]);
    writeColmapModel(model, folder / "model");
  }
  BuildOptions options(const std::string& output = "scene") const {
    BuildOptions o;
    o.photographs = folder / "photos";
    o.model = folder / "model";
    o.output = folder / output;
    return o;
  }

  TemporaryFolder folder;
  PosedModel model;
  SyntheticScene scene;
};

std::map<std::string, std::vector<std::byte>> filesBelow(const fs::path& folder) {
  std::map<std::string, std::vector<std::byte>> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = readFile(entry.path());
  return files;
}

// Resamples all but the last photograph through a lens (f, c, k = 0.15), from source images of three times the size.
Lens throughLens(Set& set) {
  const Intrinsics k = set.model.images[0].camera.intrinsics, large = set.scene.scene.nodes[0].camera.intrinsics;
  const Lens lens(LensModel::simpleRadial, k.width, k.height, std::vector<double>{k.fx, k.cx, k.cy, 0.15});
  for (std::size_t i = 0; i < 3; ++i) {
    Image8 taken(k.width, k.height, 3);
    for (int y = 0; y < k.height; ++y)
      for (int x = 0; x < k.width; ++x) {
        const glm::dvec2 at = project(large, lens.unproject({x + 0.5, y + 0.5}).value()).value() - 0.5;
        const int u = std::min(int(at.x), large.width - 2), v = std::min(int(at.y), large.height - 2);
        const double fx = at.x - u, fy = at.y - v;
        for (std::size_t c = 0; c < 3; ++c) {
          const auto value = [&](int dx, int dy) { return double(set.scene.photographs[i].pixel(u + dx, v + dy)[c]); };
          taken.pixel(x, y)[c] = std::uint8_t(std::lround((1 - fy) * ((1 - fx) * value(0, 0) + fx * value(1, 0)) +
                                                          fy * ((1 - fx) * value(0, 1) + fx * value(1, 1))));
        }
      }
    writeImage(set.folder / "photos" / set.model.images[i].name, taken);
  }
  for (Track& track : set.model.tracks)
    for (TrackObservation& o : track.observations)
      if (o.image < 3)
        if (const auto moved = lens.project(unproject(k, o.pixel))) o.pixel = *moved;
  writeColmapModel(set.model, set.folder / "model");
  // The first three photographs share a camera with a distorting lens.
  writeFile(set.folder / "model/cameras.txt",
            readTextFile(set.folder / "model/cameras.txt") +
                fmt::format("99 SIMPLE_RADIAL {} {} {} {} {} 0.15\n", k.width, k.height, k.fx, k.cx, k.cy));
  std::string images = readTextFile(set.folder / "model/images.txt");
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t name = images.find(" " + set.model.images[i].name + "\n");
    REQUIRE(name != images.npos);
    const std::size_t number = images.rfind(' ', name - 1) + 1;
    images.replace(number, name - number, "99");
  }
  writeFile(set.folder / "model/images.txt", images);
  return lens;
}

}  // namespace

TEST_CASE("a single photograph with own tracks gives a scene of one backdrop") {
  const Set set;
  BuildOptions options = set.options();
  options.tracks = TrackSource::own;
  options.exclude = {set.model.images[1].name, set.model.images[2].name, set.model.images[3].name};
  const BuildReport report = build(options);
  CHECK(report.cells.empty());
  CHECK(report.backdrops.size() == 1);
}

TEST_CASE("a build does not overwrite its source photographs") {
  const Set set;
  BuildOptions options = set.options();
  options.output = set.folder / "workspace";
  options.photographs = options.output / "images";
  fs::create_directories(options.output);
  fs::copy(set.folder / "photos", options.photographs, fs::copy_options::recursive);
  options.maxSize = 64;
  const auto before = readFile(options.photographs / set.model.images[0].name);
  const Error error = test::errorOf([&] { build(options); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains("workspace/images"));
  CHECK(readFile(options.photographs / set.model.images[0].name) == before);

  options.photographs = options.output = set.folder / "photos";
  const auto files = filesBelow(options.output);
  CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("the folder of the photographs"));
  CHECK(filesBelow(options.output) == files);
}

TEST_CASE("only unused cache files are removed from the folder .build") {
  const Set set;
  const fs::path folder = set.options().output / ".build", notes = folder / "notes.txt";
  fs::create_directories(folder);
  writeFile(notes, "mine");
  const auto kept = [&](std::string_view kind) {
    return std::ranges::count_if(fs::directory_iterator(folder),
                                 [&](const auto& entry) { return entry.path().extension() == kind; });
  };
  build(set.options());
  const std::ptrdiff_t depths = kept(".depth"), cells = kept(".cell");
  CHECK(depths == 4);
  CHECK(cells >= 4);  // cells, and the meshes of photographs
  const fs::path unfinished = folder / "0123456789abcdef.cell.77.tmp", unused = folder / "0123456789abcdef.depth";
  for (const fs::path& file : {unfinished, unused}) {
    writeFile(file, "of a build before");
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  const BuildReport again = build(set.options());
  CHECK(std::ranges::all_of(again.cells, [](const auto& cell) { return cell.cached; }));
  CHECK(readTextFile(notes) == "mine");
  CHECK_FALSE(fs::exists(unfinished));
  CHECK_FALSE(fs::exists(unused));
  CHECK(kept(".depth") == depths);
  CHECK(kept(".cell") == cells);
}

TEST_CASE("photographs and a model give a valid scene with accurate matches") {
  const Set set;
  std::vector<std::string> stages;
  const BuildReport report = build(set.options(), [&](const Progress& p) {
    if (stages.empty() || stages.back() != p.stage) stages.emplace_back(p.stage);
    CHECK(p.done <= p.total);
    return true;
  });
  CHECK(stages.size() >= 4);
  REQUIRE(report.cells.size() == 2);
  CHECK(report.dropped.empty());
  REQUIRE(report.unusedPhotographs.size() == 1);
  CHECK(report.unusedPhotographs[0].name == "stranger.png");
  CHECK(report.unusedPhotographs[0].reason == kNotRegistered);

  CHECK(validateSceneFiles(set.options().output).empty());
  const Scene scene = loadScene(set.options().output);
  REQUIRE(scene.nodes.size() == 4);
  REQUIRE(scene.cells.size() == 2);
  REQUIRE(scene.unusedPhotographs.size() == 1);
  CHECK(scene.unusedPhotographs[0].name == "stranger.png");
  CHECK(readFile(scene.folder / scene.nodes[0].imageFile) == readFile(set.folder / "photos/000.png"));
  const Texture texture = readKtx2(scene.folder / scene.nodes[3].textureFile);
  REQUIRE(texture.levels.size() == 8);
  CHECK(texture.width == 128);

  for (std::size_t c = 0; c < 2; ++c) {
    const Cell& cell = scene.cells[c];
    CHECK(cell.members.size() == 3);
    CHECK(cell.quality.coverage > 0.6);
    CHECK(cell.quality.score > 0);
    CHECK(cell.quality.score <= cell.quality.coverage * cell.quality.ecc);
    CHECK(report.cells[c].points == cell.mesh.vertexCount());
    CHECK(report.cells[c].tier0 == cell.mesh.tier0Count());
    CHECK_FALSE(report.cells[c].cached);
    const TexturedPlane& wall = set.scene.planes[0];
    const glm::dvec3 normal = glm::cross(wall.u, wall.v);
    std::size_t good = 0;
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
      const Camera& first = scene.nodes[cell.members[0]].camera;
      const glm::dvec3 ray = first.pose.rotation * unproject(first.intrinsics, cell.mesh.match[0][p]);
      const glm::dvec3 point =
          first.pose.position + ray * (glm::dot(wall.origin - first.pose.position, normal) / glm::dot(ray, normal));
      double worst = 0;
      for (std::size_t i = 1; i < 3; ++i) {
        const Camera& camera = scene.nodes[cell.members[i]].camera;
        const auto pixel =
            project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position));
        worst = std::max(worst, pixel ? glm::distance(*pixel, glm::dvec2(cell.mesh.match[i][p])) : 1e9);
      }
      good += worst < 0.3;
    }
    CHECK(double(good) > 0.8 * double(cell.mesh.vertexCount()));
  }
}

TEST_CASE("the output does not depend on the thread count or on an earlier cancelled build", "[P3]") {
  const Set set;
  BuildOptions one = set.options("one"), two = set.options("two"), stopped = set.options("stopped");
  one.threads = stopped.threads = 1;
  two.threads = 2;
  build(one);
  build(two);
  const auto expected = filesBelow(one.output);
  CHECK(filesBelow(two.output) == expected);

  const Error error = test::errorOf(
      [&] { build(stopped, [](const Progress& p) { return !(p.stage == "matching cells" && p.done >= 1); }); });
  CHECK(error.code() == ErrorCode::cancelled);
  CHECK_FALSE(fs::exists(stopped.output / "scene.gltf"));
  CHECK(std::distance(fs::directory_iterator(stopped.output / ".build"), fs::directory_iterator()) >= 1);
  const BuildReport report = build(stopped);
  CHECK(std::count_if(report.cells.begin(), report.cells.end(), [](const auto& c) { return c.cached; }) >= 1);
  CHECK(filesBelow(stopped.output) == expected);

  // Cancelling before the first stage leaves no partial output.
  BuildOptions early = set.options("early");
  CHECK(test::errorOf([&] { build(early, [](const Progress&) { return false; }); }).code() == ErrorCode::cancelled);
  CHECK_FALSE(fs::exists(early.output));
}

TEST_CASE("photographs of a distorting lens are undistorted, others are stored byte for byte") {
  Set set(3);
  const Lens lens = throughLens(set);
  const BuildReport report = build(set.options());
  CHECK(report.cells.size() == 2);
  const Scene scene = loadScene(set.options().output);
  CHECK(validateSceneFiles(set.options().output).empty());
  REQUIRE(scene.nodes.size() == 4);
  CHECK(scene.nodes[0].camera.intrinsics == undistorted(lens));
  const Image8 stored = readImage(scene.folder / scene.nodes[0].imageFile);
  CHECK(stored == undistort(readImage(set.folder / "photos/000.png"), lens, undistorted(lens)));
  CHECK(readFile(scene.folder / scene.nodes[3].imageFile) == readFile(set.folder / "photos/sub/003.png"));
  for (const auto& cell : report.cells) CHECK(cell.quality.coverage > 0.5);
  for (const Cell& cell : scene.cells) CHECK(cell.quality.residualPx < 0.3);

  BuildOptions smaller = set.options("smaller");
  smaller.maxSize = 100;
  build(smaller);
  const Intrinsics small = loadScene(smaller.output).nodes[0].camera.intrinsics;
  CHECK(std::max(small.width, small.height) == 100);
  CHECK(small.fx / small.width == Approx(undistorted(lens).fx / undistorted(lens).width));
}

TEST_CASE("if the border is kept, the whole photograph is stored, and no mesh covers the border") {
  Set set(3);
  const Lens lens = throughLens(set);
  BuildOptions options = set.options();
  options.keepBorder = true;
  const BuildReport report = build(options);
  REQUIRE(report.cells.size() == 2);
  const Scene scene = loadScene(options.output);
  CHECK(validateSceneFiles(options.output).empty());
  const Intrinsics& k = scene.nodes[0].camera.intrinsics;
  CHECK(k == undistorted(lens, Border::keep));
  CHECK_FALSE(photographed({0.5, 0.5}, lens, k));
  std::size_t triangles = 0;
  const auto look = [&](const Cell& cell) {
    for (const glm::uvec3 t : cell.mesh.triangles)
      for (std::size_t i = 0; i < cell.members.size(); ++i) {
        if (cell.members[i] == 3) continue;  // photograph 3 is a pinhole: it has no distortion
        const auto& match = cell.mesh.match[i];
        const glm::dvec2 a = match[t.x], b = match[t.y], c = match[t.z];
        for (const glm::dvec2 at : {a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0})
          CHECK(photographed(at, lens, k));
        ++triangles;
      }
  };
  for (const Cell& cell : scene.cells) look(cell);
  for (const Cell& backdrop : scene.backdrops) look(backdrop);
  CHECK(triangles > 100);
  REQUIRE(scene.backdrops.size() == report.backdrops.size());
  for (std::size_t b = 0; b < scene.backdrops.size(); ++b) {
    CHECK(scene.backdrops[b].quality.coverage == report.backdrops[b].matchedShare);
    CHECK(std::isnan(scene.backdrops[b].quality.ecc));
  }
}

TEST_CASE("every photograph has a backdrop, built or cached, unless backdrops are disabled") {
  const Set set;
  BuildOptions whole = set.options("whole"), stopped = set.options("stopped"), none = set.options("none");
  stopped.threads = 1;
  none.backdrops = false;
  const BuildReport report = build(whole);
  const Scene scene = loadScene(whole.output);
  REQUIRE(scene.backdrops.size() == 4);
  REQUIRE(report.backdrops.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Cell& backdrop = scene.backdrops[i];
    CHECK(backdrop.members == std::vector<std::uint32_t>{std::uint32_t(i)});
    CHECK(report.backdrops[i].photograph == scene.nodes[i].name);
    CHECK(report.backdrops[i].triangles == backdrop.mesh.triangles.size());
    CHECK(report.backdrops[i].matchedShare > 0.4);
    CHECK_FALSE(report.backdrops[i].cached);
  }
  const auto stop = [](const Progress& p) { return !(p.stage == "completing backdrops" && p.done >= 2); };
  CHECK(test::errorOf([&] { build(stopped, stop); }).code() == ErrorCode::cancelled);
  const BuildReport cached = build(stopped);
  CHECK(std::ranges::count(cached.backdrops, true, &BuildReport::BackdropReport::cached) >= 2);
  CHECK(filesBelow(stopped.output) == filesBelow(whole.output));

  CHECK(build(none).backdrops.empty());
  CHECK(loadScene(none.output).backdrops.empty());
  CHECK(loadScene(none.output).nodes[0].depthFile.empty());
  // A build without backdrops is cancelled late; the cached results must not be used for a build with backdrops.
  fs::remove_all(none.output);
  const auto late = [](const Progress& p) { return p.stage != "writing the scene"; };
  CHECK(test::errorOf([&] { build(none, late); }).code() == ErrorCode::cancelled);
  none.backdrops = true;
  build(none);
  CHECK(filesBelow(none.output) == filesBelow(whole.output));
}

TEST_CASE("a built scene has depth and evidence of every pinhole, independent of the thread count") {
  const Set set;
  BuildOptions options = set.options("one"), threads = set.options("three");
  options.threads = 1;
  threads.threads = 3;
  build(options);
  std::set<std::string> stages;
  build(threads, [&](const Progress& p) {
    stages.insert(std::string(p.stage));
    return true;
  });
  CHECK(filesBelow(options.output) == filesBelow(threads.output));
  for (const char* stage : {"finding depth", "confirming depth"}) CHECK(stages.contains(stage));
  for (const Fault& fault : validateSceneFiles(options.output)) FAIL(fault.field << " " << fault.message);
  const Scene scene = loadScene(options.output);
  CHECK(scene.nodes[3].depthFile == "depth/sub/003.png.ktx2");
  std::size_t confirmed = 0, points = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Node& node = scene.nodes[i];
    const DepthMaps maps = readDepthTexture(readKtx2(options.output / node.depthFile), node.depthScale);
    CHECK(maps.inverseDepth.width == 32);
    CHECK(maps.inverseDepth.height == 24);
    CHECK(*std::ranges::max_element(maps.inverseDepth.values) == float(node.depthScale));
    CHECK(maps.inverseDepth.pixel(16, 12)[0] == Approx(0.25).epsilon(0.1));  // the wall is 4 units away
    const MorphMesh& mesh = scene.backdrops[i].mesh;
    REQUIRE(mesh.confirmations.size() == mesh.vertexCount());
    points += mesh.vertexCount();
    confirmed += mesh.vertexCount() - std::size_t(std::ranges::count(mesh.confirmations, std::uint8_t(0)));
    for (std::size_t p = 0; p < mesh.vertexCount(); ++p) CHECK(mesh.consensus[p] <= 3.25f / 3.5f);
  }
  CHECK(confirmed > points / 8);  // the other points are completed
  for (const Cell& cell : scene.cells) CHECK(cell.mesh.confirmations.empty());
}

TEST_CASE("panoramas have depth and a backdrop in all directions, confirmed by the others") {
  const TemporaryFolder folder;
  SyntheticOptions rendered;
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {0.6, 0, 0}, {0.3, 0.05, -0.5}})
    rendered.cameras.push_back({{CameraModel::equirectangular, 256, 128}, {at, {1, 0, 0, 0}}});
  rendered.planes = roomPlanes({-2.5, -1.6, -3.5}, {3.6, 1.9, 2.2}, 0.25, 7);
  rendered.surfaceStep = 1;
  rendered.samplesPerAxis = 2;
  const SyntheticScene room = makeScene(rendered);
  std::vector<glm::dvec3> points;
  for (const glm::dvec3 direction : pointsAround({0, 0, 0}, 1, 300))
    points.push_back(distanceAlong(room, {0, 0, 0}, direction).value() * direction);
  const PosedModel model = modelOf(rendered.cameras, points);
  fs::create_directories(folder / "photos");
  for (std::size_t i = 0; i < 3; ++i) writeImage(folder / "photos" / model.images[i].name, room.photographs[i]);
  writeColmapModel(model, folder / "model");
  BuildOptions options;
  options.photographs = folder / "photos";
  options.model = folder / "model";
  options.output = folder / "scene";
  const BuildReport report = build(options);
  CHECK(report.cells.size() == 1);
  CHECK(report.backdrops.size() == 3);
  for (const Fault& fault : validateSceneFiles(options.output)) FAIL(fault.field << " " << fault.message);
  const Scene scene = loadScene(options.output);
  for (std::size_t n = 0; n < 3; ++n) {
    CAPTURE(n);
    const Camera& camera = scene.nodes[n].camera;
    const DepthMaps maps =
        readDepthTexture(readKtx2(options.output / scene.nodes[n].depthFile), scene.nodes[n].depthScale);
    const Intrinsics k = resized(camera.intrinsics, maps.inverseDepth.width, maps.inverseDepth.height);
    CHECK(k.width == 2 * k.height);
    std::size_t right = 0;
    for (int y = 0; y < k.height; ++y)
      for (int x = 0; x < k.width; ++x) {
        const glm::dvec3 ray = camera.pose.rotation * unproject(k, {x + 0.5, y + 0.5});
        const double truth = 1 / distanceAlong(room, camera.pose.position, ray).value();
        right += std::abs(double(maps.inverseDepth.pixel(x, y)[0]) / truth - 1) < 0.1;
      }
    CHECK(double(right) > 0.9 * k.width * k.height);
    const MorphMesh& mesh = scene.backdrops[n].mesh;
    const auto confirmed = mesh.vertexCount() - std::size_t(std::ranges::count(mesh.confirmations, std::uint8_t(0)));
    CHECK(confirmed > mesh.vertexCount() / 2);
  }
}

TEST_CASE("a build that is cancelled while finding depth continues to the same result") {
  const Set set;
  const BuildOptions whole = set.options("whole"), stopped = set.options("stopped");
  build(whole);
  for (const char* stage : {"finding depth", "choosing depth sources", "confirming depth", "finding contradictions"})
    CHECK(test::errorOf([&] { build(stopped, [&](const Progress& p) { return p.stage != stage; }); }).code() ==
          ErrorCode::cancelled);
  build(stopped);
  CHECK(filesBelow(stopped.output) == filesBelow(whole.output));
}

TEST_CASE("a photograph that is in no cell has a backdrop from its tracks") {
  const Set set;
  BuildOptions options = set.options();
  options.exclude = {"001.png", "002.png", "sub/003.png"};
  const BuildReport report = build(options);
  CHECK(report.cells.empty());
  REQUIRE(report.backdrops.size() == 1);
  CHECK(report.backdrops[0].matchedShare > 0);
  const MorphMesh mesh = loadScene(options.output).backdrops.at(0).mesh;
  for (const float rho : mesh.inverseDistance) {
    CHECK(rho > 0.1f);
    CHECK(rho < 0.4f);
  }
}

TEST_CASE("images of a scene inside the photographs' folder are not reported as unused") {
  const Set set;
  BuildOptions options = set.options();
  options.output = set.folder / "photos/scene";
  build(options);
  const BuildReport again = build(options);
  REQUIRE(again.unusedPhotographs.size() == 1);
  CHECK(again.unusedPhotographs[0].name == "stranger.png");
}

TEST_CASE("a failed cell is replaced by its faces and then by its edges") {
  // The last photograph does not show the content that its pose predicts.
  Set set;
  writeImage(set.folder / "photos/sub/003.png", Image8(128, 96, 3, 90));
  BuildOptions options = set.options();
  const BuildReport report = build(options);
  const Scene scene = loadScene(options.output);
  REQUIRE_FALSE(report.dropped.empty());
  for (const auto& dropped : report.dropped) {
    CHECK_THAT(dropped.cell, Contains("003.png"));
    CHECK_THAT(dropped.reason, Contains(" %"));
  }
  for (const Cell& cell : scene.cells) CHECK(std::ranges::count(cell.members, 3u) == 0);
  CHECK(std::ranges::any_of(scene.unusedPhotographs, [](const auto& u) { return u.name == "sub/003.png"; }));
  std::set<std::uint32_t> used;
  for (const Cell& cell : scene.cells) used.insert(cell.members.begin(), cell.members.end());
  CHECK(used == std::set<std::uint32_t>{0, 1, 2});
}

TEST_CASE("a model whose photographs share no point is reported") {
  const Set set;
  PosedModel model = set.model;
  for (Track& track : model.tracks) track.observations.resize(1);
  writeColmapModel(model, set.folder / "model");
  std::string logged;
  BuildOptions options = set.options();
  options.tracks = TrackSource::model;
  const BuildReport report =
      build(options, {}, [&](LogLevel, std::string_view message) { logged += std::string(message) + "\n"; });
  CHECK(report.cells.empty());
  CHECK_THAT(logged, Contains("points3D"));
  REQUIRE(report.unusedPhotographs.size() == 5);
  CHECK_THAT(report.unusedPhotographs[1].reason, Contains("points"));
}

TEST_CASE("photographs may be excluded, downsampled, or larger than the model's camera") {
  const Set set(2);  // twice the size of the model's cameras
  BuildOptions options = set.options();
  options.exclude = {"sub/003.png"};
  options.maxSize = 200;
  const BuildReport report = build(options);
  CHECK(report.cells.size() == 1);
  const Scene scene = loadScene(options.output);
  REQUIRE(scene.nodes.size() == 3);
  CHECK(scene.nodes[0].camera.intrinsics.width == 200);
  CHECK(scene.nodes[0].camera.intrinsics.height == 150);
  CHECK(scene.nodes[0].camera.intrinsics.fx == Approx(set.model.images[0].camera.intrinsics.fx * 200 / 128));
  CHECK(probeImage(scene.folder / scene.nodes[0].imageFile).width == 200);
  CHECK(validateSceneFiles(options.output).empty());
  CHECK(std::none_of(report.unusedPhotographs.begin(), report.unusedPhotographs.end(),
                     [](const auto& u) { return u.name == "sub/003.png"; }));
}

TEST_CASE("masks are stored in the scene and in the textures' alpha, in every format") {
  const Set set;
  Image8 mask(128, 96, 1, 255);
  for (int y = 32; y < 64; ++y)
    for (int x = 40; x < 72; ++x) mask.pixel(x, y)[0] = 0;
  fs::create_directories(set.folder / "masks/sub");
  writeImage(set.folder / "masks/001.png", mask);
  writeImage(set.folder / "masks/sub/003.png.png", Image8(128, 96, 1, 255));
  writeImage(set.folder / "masks/nobody.png", mask);
  BuildOptions options = set.options();
  options.masks = set.folder / "masks";
  for (const TextureFormat format : {TextureFormat::rgba8, TextureFormat::bc1, TextureFormat::bc7}) {
    INFO(textureFormatName(format));
    options.texture = format;
    std::string logged;
    const BuildReport report = build(options, {}, [&](LogLevel level, std::string_view text) {
      if (level == LogLevel::warning) logged += text;
    });
    CHECK_THAT(logged, Contains("nobody.png") && !Contains("001.png") && !Contains("003.png"));
    CHECK_THAT(logged, Contains("000.png") && Contains("2 of the 4"));
    REQUIRE(report.masks.size() == 1);
    CHECK(report.masks[0].photograph == "001.png");
    CHECK(report.masks[0].givenShare == Approx(1.0 / 12));
    CHECK(report.masks[0].movingShare == 0);
    const Scene scene = loadScene(options.output);
    CHECK(validateSceneFiles(options.output).empty());
    CHECK(scene.nodes[0].maskFile.empty());
    REQUIRE(scene.nodes[1].maskFile == "masks/001.png.png");
    CHECK(scene.nodes[3].maskFile == "masks/sub/003.png.png");
    CHECK((readImage(options.output / scene.nodes[1].maskFile).values ==
           Image8(readImage(set.folder / "masks/001.png")).values));
    CHECK(probeKtx2(options.output / scene.nodes[0].textureFile).format == format);
    const Texture texture = readKtx2(options.output / scene.nodes[1].textureFile);
    CHECK(texture.format == (format == TextureFormat::bc1 ? TextureFormat::bc7 : format));
    const Image8 shown = decodeTexture(texture)[0];
    std::size_t wrong = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 128; ++x) wrong += (shown.pixel(x, y)[3] > 128) != (mask.pixel(x, y)[0] != 0);
    CHECK(wrong == 0);
    // No match lies under the mask: no agreeing triangle has its centre in the mask's interior.
    for (const Cell& cell : scene.cells)
      for (std::size_t m = 0; m < cell.members.size(); ++m) {
        if (cell.members[m] != 1 || cell.members.size() > 2) continue;
        for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t) {
          const glm::uvec3 v = cell.mesh.triangles[t];
          const glm::vec2 c = (cell.mesh.match[m][v.x] + cell.mesh.match[m][v.y] + cell.mesh.match[m][v.z]) / 3.0f;
          CHECK_FALSE((c.x > 46 && c.x < 66 && c.y > 38 && c.y < 58));
        }
      }
  }
  // A mask of the wrong polarity excludes nearly the whole photograph; the message names the photograph.
  Image8 inverted = mask;
  for (std::uint8_t& value : inverted.values) value = value ? 0 : 255;
  writeImage(set.folder / "masks/001.png", inverted);
  std::string logged;
  build(options, {}, [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) logged += text;
  });
  CHECK_THAT(logged, Contains("001.png") && Contains("8 %"));
  options.masks = set.folder / "photos/nowhere";
  CHECK_THAT(errorOf([&] { build(options); }).what(), Contains("nowhere") && Contains("masks"));
  options.masks = set.folder / "masks";
  writeImage(set.folder / "masks/001.png", Image8(64, 48, 1, 255));
  CHECK_THAT(errorOf([&] { build(options); }).what(), Contains("masks/001.png") && Contains("64 × 48"));
}

TEST_CASE("invalid input is reported by name, before anything is written") {
  const Set set;
  BuildOptions options = set.options();
  SECTION("a photograph is missing") {
    fs::remove(set.folder / "photos/001.png");
    const Error error = test::errorOf([&] { build(options); });
    CHECK(error.code() == ErrorCode::io);
    CHECK_THAT(error.what(), Contains("001.png") && Contains("--exclude"));
  }
  SECTION("two photographs would be stored under one name") {
    PosedModel model = set.model;
    fs::copy(set.folder / "photos/000.png", set.folder / "photos/000.tif.png");
    // The model names the file .tif; its content is PNG, which the first bytes of the file tell.
    fs::rename(set.folder / "photos/001.png", set.folder / "photos/000.tif");
    model.images[0].name = "000.tif.png";
    model.images[1].name = "000.tif";
    writeColmapModel(model, set.folder / "model");
    const Error error = test::errorOf([&] { build(options); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Contains("000.tif") && Contains("images/000.tif.png"));
  }
  SECTION("a missing photograph is excluded") {
    fs::remove(set.folder / "photos/001.png");
    options.exclude = {"001.png"};
    CHECK_NOTHROW(build(options));
    return;
  }
  SECTION("a photograph has another aspect ratio") {
    writeImage(set.folder / "photos/001.png", Image8(96, 96, 3, 9));
    const Error error = test::errorOf([&] { build(options); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Contains("001.png") && Contains("96x96") && Contains("128x96"));
  }
  SECTION("a photograph is damaged") {
    writeFile(set.folder / "photos/001.png", "no picture");
    CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("001.png"));
  }
  SECTION("an image of the model is outside of the folder") {
    PosedModel model = set.model;
    model.images[0].name = "../model/cameras.txt";
    writeColmapModel(model, set.folder / "model");
    CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("../model/cameras.txt"));
  }
  SECTION("an unknown photograph is excluded") {
    options.exclude = {"nobody.png"};
    CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("nobody.png"));
  }
  SECTION("no photograph is left") {
    options.exclude = {"000.png", "001.png", "002.png", "sub/003.png"};
    CHECK(test::errorOf([&] { build(options); }).code() == ErrorCode::invalidInput);
  }
  SECTION("a folder is missing") {
    options.photographs = set.folder / "nowhere";
    CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("nowhere"));
    options = set.options();
    options.model = set.folder / "nowhere";
    CHECK_THAT(test::errorOf([&] { build(options); }).what(), Contains("nowhere"));
  }
  SECTION("an option is invalid") {
    options.dimension = 5;
    CHECK(test::errorOf([&] { build(options); }).code() == ErrorCode::invalidInput);
    options = set.options();
    options.maxSize = -1;
    CHECK(test::errorOf([&] { build(options); }).code() == ErrorCode::invalidInput);
    for (const int spacing : {0, 1, 3, 64, -8}) {
      options = set.options();
      options.backdropSpacing = spacing;
      const Error error = test::errorOf([&] { build(options); });
      CHECK(error.code() == ErrorCode::invalidInput);
      CHECK_THAT(error.what(), Contains(std::to_string(spacing)));
    }
  }
  CHECK_FALSE(fs::exists(set.folder / "scene/scene.gltf"));
}

TEST_CASE("a cached cell is read back whole or not at all") {
  TemporaryFolder folder;
  CellMesh cell;
  cell.mesh.match = {{{1, 2}, {3, 4}, {5, 6}}, {{7, 8}, {9, 10}, {11, 12}}};
  cell.mesh.ratio = {{1, 2, 3}, {4, 5, 6}};
  cell.mesh.inverseDistance = {0, 0.5f, 1};
  cell.mesh.uncertainty = {1, 2, 3};
  cell.mesh.triangles = {{0, 1, 2}};
  cell.mesh.tier = {1};
  cell.mesh.ecc = {-0.5f};
  cell.quality.coverage = 0.25;
  CHECK_FALSE(fetchCell(folder.path(), 77));
  storeCell(folder.path(), 77, cell);
  const auto back = fetchCell(folder.path(), 77);
  REQUIRE(back);
  CHECK(back->mesh.match == cell.mesh.match);
  CHECK(back->mesh.ratio == cell.mesh.ratio);
  CHECK(back->mesh.triangles == cell.mesh.triangles);
  CHECK(back->mesh.ecc == cell.mesh.ecc);
  CHECK(back->quality.coverage == 0.25);
  const fs::path file = fs::directory_iterator(folder.path())->path();
  const std::vector<std::byte> whole = readFile(file);
  for (const std::size_t length : {std::size_t(0), std::size_t(7), whole.size() / 2, whole.size() - 1}) {
    writeFile(file, std::span(whole).first(length));
    CHECK_FALSE(fetchCell(folder.path(), 77));
  }
  std::vector<std::byte> changed = whole;
  changed[whole.size() / 2] ^= std::byte(1);
  writeFile(file, changed);
  CHECK_FALSE(fetchCell(folder.path(), 77));
}

TEST_CASE("jobs run once each, can be cancelled, and pass on the first error") {
  for (const int threads : {1, 3}) {
    std::vector<std::atomic<int>> ran(50);
    CHECK(runJobs(
        50, threads, [&](std::size_t i) { ++ran[i]; }, [](std::size_t) { return true; }));
    for (const auto& r : ran) CHECK(r == 1);

    std::atomic<int> started = 0;
    CHECK_FALSE(runJobs(
        1000, threads, [&](std::size_t) { ++started; }, [](std::size_t done) { return done == 0; }));
    CHECK(started <= 1000);

    const auto failing = [](std::size_t i) {
      if (i >= 5) throw Error(ErrorCode::io, std::to_string(i));
    };
    CHECK_THAT(test::errorOf([&] { runJobs(50, threads, failing, [](std::size_t) { return true; }); }).what(),
               Contains("5"));
  }
  CHECK(runJobs(
      0, 4, [](std::size_t) { FAIL("there is no job"); }, [](std::size_t) { return true; }));
}

TEST_CASE("the thread count is limited by the memory budget, and is at least one") {
  const double memory = memoryLimit();
  CHECK(memoryBudget(0) == memory / 2);
  CHECK(memoryBudget(7e9) == 7e9);
  CHECK(threadsFor(64, 1e9, 8.5e9) == 8);
  CHECK(threadsFor(2, 1e9, 8.5e9) == 2);
  CHECK(threadsFor(64, 1e9, 1) == 1);
  CHECK(threadsFor(64, 1) == 64);
  CHECK(threadsFor(64, 0) == 64);
  CHECK(threadsFor(64, memory / 21) == 10);
  CHECK(threadsFor(3, memory / 21) == 3);
  CHECK(threadsFor(64, 100 * memory) == 1);
  CHECK(threadsFor(0, 1) >= 1);
}

TEST_CASE("cached cells do not change later builds") {
  const Set set;
  BuildOptions whole = set.options("whole"), part = set.options("part"), alone = set.options("alone");
  part.exclude = alone.exclude = {"001.png"};  // one of the square's two triangles remains
  // Plane matching depends on the members only. Members' depth would depend on all photographs of the same area.
  for (BuildOptions* options : {&whole, &part, &alone}) options->matcher = MatchMethod::homographic;
  whole.cacheFolder = part.cacheFolder = set.folder / "cells";
  CHECK(std::ranges::none_of(build(whole).cells, [](const auto& cell) { return cell.cached; }));
  const BuildReport shared = build(part);
  REQUIRE(shared.cells.size() == 1);
  CHECK(shared.cells[0].cached);
  CHECK_FALSE(build(alone).cells[0].cached);
  auto kept = filesBelow(alone.output);
  std::erase_if(kept, [](const auto& file) { return file.first.starts_with(".build/"); });
  CHECK(filesBelow(part.output) == kept);
  CHECK_FALSE(filesBelow(set.folder / "cells").empty());
}

TEST_CASE("photographs that are added to a cached build are matched with their neighbours only") {
  const Set set;
  BuildOptions part = set.options("part"), whole = set.options("whole"), alone = set.options("alone");
  part.exclude = {"001.png"};
  part.cacheFolder = whole.cacheFolder = set.folder / "cells";
  build(part);
  const auto depths = [&] {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(set.folder / "cells"))
      count += entry.path().extension() == ".depth";
    return count;
  };
  const std::size_t before = depths();
  CHECK(before == 3);
  const BuildReport added = build(whole);
  const auto cached = [](const auto& cell) { return cell.cached; };
  CHECK(std::ranges::none_of(added.cells, cached));  // all have members whose depth has one more source
  build(alone);
  auto scene = filesBelow(alone.output);
  std::erase_if(scene, [](const auto& file) { return file.first.starts_with(".build/"); });
  CHECK(filesBelow(whole.output) == scene);
  // All four photographs see the same area, so each uses the new photograph as a source.
  CHECK(depths() == before + 4);
  CHECK(std::ranges::all_of(build(whole).cells, cached));
  CHECK(depths() == before + 4);
}

TEST_CASE("photographs are added to a scene by building it again in place") {
  const Set set;
  BuildOptions part = set.options("scene"), whole = part, alone = set.options("alone");
  part.exclude = {"001.png"};
  build(part);
  CHECK(loadScene(part.output).nodes.size() == 3);
  build(whole);
  build(alone);
  CHECK(filesBelow(whole.output) == filesBelow(alone.output));
  // A photograph that looks in the opposite direction changes no depth.
  Set more;
  PosedImage back{"back.png", lookingAlong({0.2, 0, 0.2}, {0, -1, 0}, 128, 96)};
  writeImage(more.folder / "photos" / back.name, Image8(128, 96, 3, 90));
  more.model.images.push_back(back);
  BuildOptions near = more.options("scene"), all = near;
  near.exclude = {back.name};
  near.tracks = all.tracks = TrackSource::model;
  writeColmapModel(more.model, near.model);
  build(near);
  const auto depths = [&] {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(all.output / ".build"))
      if (entry.path().extension() == ".depth") names.insert(entry.path().filename());
    return names;
  };
  const std::set<std::string> before = depths();
  CHECK(before.size() == 4);
  const BuildReport added = build(all);
  CHECK(loadScene(all.output).nodes.size() == 5);
  CHECK(added.cells.size() == 2);
  CHECK(depths() == before);
}

TEST_CASE("a draft has depth and no cells, and does not change the next build") {
  const Set set;
  BuildOptions draft = set.options("scene"), whole = draft, alone = set.options("alone");
  draft.draft = true;
  draft.maskMovingObjects = true;       // a draft skips this
  draft.refinePoses = RefinePoses::on;  // and this
  draft.postProcess = [](Scene&, const fs::path&, const ProgressCallback&, const LogCallback&) {
    FAIL("post-processed a draft");
  };
  std::set<std::string> stages;
  std::vector<std::string> warnings;
  const BuildReport report = build(
      draft, [&](const Progress& p) { return stages.emplace(p.stage), true; },
      [&](LogLevel level, std::string_view text) {
        if (level == LogLevel::warning) warnings.emplace_back(text);
      });
  CHECK(warnings.empty());
  CHECK(report.cells.empty());
  CHECK(report.dropped.empty());
  REQUIRE(report.unusedPhotographs.size() == 1);  // the photograph without a pose
  CHECK(report.prediction.cells == 0);
  CHECK(report.prediction.cellCountKnown);
  CHECK_FALSE(stages.contains("matching cells"));
  CHECK_FALSE(stages.contains("finding features"));  // the model already has points
  CHECK(validateSceneFiles(draft.output).empty());
  const Scene scene = loadScene(draft.output);
  CHECK(scene.cells.empty());
  REQUIRE(scene.backdrops.size() == 4);
  CHECK_THAT(scene.settings, Contains(R"("draft":true)") && Contains(R"("depth":"fast")"));
  for (const Node& node : scene.nodes) {
    const DepthMaps maps = readDepthTexture(readKtx2(draft.output / node.depthFile), node.depthScale);
    CHECK(maps.inverseDepth.pixel(16, 12)[0] == Approx(0.25).epsilon(0.1));
  }
  for (const Cell& mesh : scene.backdrops) CHECK(mesh.mesh.vertexCount() > 50);
  build(whole);
  build(alone);
  CHECK(filesBelow(whole.output) == filesBelow(alone.output));
  // A draft over a complete scene deletes only files that the next build restores from the cache.
  build(draft);
  CHECK(loadScene(draft.output).cells.empty());
  const BuildReport again = build(whole);
  CHECK(again.cells.size() == 2);
  CHECK(std::ranges::all_of(again.cells, [](const auto& cell) { return cell.cached; }));
  CHECK(filesBelow(whole.output) == filesBelow(alone.output));

  BuildOptions nothing = set.options("nothing");
  nothing.draft = true;
  nothing.backdrops = false;
  CHECK(test::errorOf([&] { build(nothing); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("each depth search gives correct depth, with separate cache files") {
  const Set set;
  std::size_t kept = 0;
  std::map<DepthSearch, std::uintmax_t> bytes;  // size of cached depth
  for (const DepthSearch search : {DepthSearch::fast, DepthSearch::swept, DepthSearch::refined, DepthSearch::fine}) {
    CAPTURE(depthSearchName(search));
    BuildOptions options = set.options(depthSearchName(search));
    options.depth = search;
    options.cacheFolder = set.folder / "cells";
    build(options);
    const Scene scene = loadScene(options.output);
    CHECK_THAT(scene.settings, Contains(fmt::format(R"("depth":"{}")", depthSearchName(search))));
    CHECK(scene.backdrops.size() == 4);
    for (const Node& node : scene.nodes) {
      const DepthMaps maps = readDepthTexture(readKtx2(options.output / node.depthFile), node.depthScale);
      CHECK((maps.inverseDepth.width == 32 && maps.inverseDepth.height == 24));
      CHECK(maps.inverseDepth.pixel(16, 12)[0] == Approx(0.25).epsilon(0.1));  // the wall is 4 units away
    }
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(options.cacheFolder)) {
      if (entry.path().extension() != ".depth") continue;
      ++files;
      bytes[search] += entry.file_size();
    }
    CHECK(files == kept + 4);
    kept = files;
  }
  // `bytes` is cumulative over the searches up to that one; the last search has four times the pixels.
  CHECK(bytes[DepthSearch::swept] == 2 * bytes[DepthSearch::fast]);
  CHECK(bytes[DepthSearch::refined] == 3 * bytes[DepthSearch::fast]);
  CHECK(double(bytes[DepthSearch::fine] - bytes[DepthSearch::refined]) ==
        Approx(4.0 * double(bytes[DepthSearch::fast])).epsilon(0.01));
}

TEST_CASE("posed photographs equal those that a build stores") {
  const Set set(2);
  BuildOptions options = set.options();
  options.maxSize = 100;
  options.exclude = {"001.png"};
  const PosedPhotographs photographs(options);
  REQUIRE(photographs.images().size() == 3);
  CHECK(photographs.images()[2].name == "sub/003.png");
  build(options);
  const Scene scene = loadScene(options.output);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(photographs.images()[i].camera.intrinsics == scene.nodes[i].camera.intrinsics);
    CHECK(photographs.photograph(i) == readImage(scene.folder / scene.nodes[i].imageFile));
  }
  CHECK_THROWS_AS(photographs.photograph(3), std::out_of_range);
  options.exclude = {"none.png"};
  CHECK_THROWS_AS(PosedPhotographs(options), Error);
}

// Rewrites the photographs with these exposures and this vignetting. Returns the number of clipped values.
std::size_t develop(const Set& set, std::span<const glm::dvec3> factors, glm::dvec2 vignetting = glm::dvec2(0.0)) {
  std::size_t clipped = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    Image8 photograph = set.scene.photographs[n];
    const Intrinsics& k = set.scene.scene.nodes[n].camera.intrinsics;
    for (int y = 0; y < photograph.height; ++y)
      for (int x = 0; x < photograph.width; ++x)
        for (int c = 0; c < 3; ++c) {
          std::uint8_t& level = photograph.pixel(x, y)[std::size_t(c)];
          const double shade = std::exp(logVignetting(vignetting, vignettingRadius(k, {x + 0.5, y + 0.5})));
          const double light = shade * factors[n][c] * srgbToLinear(level / 255.0);
          clipped += light > 1;
          level = std::uint8_t(std::lround(255 * linearToSrgb(std::min(light, 1.0))));
        }
    writeImage(set.folder / "photos" / set.model.images[n].name, photograph);
  }
  return clipped;
}

TEST_CASE("a build measures the exposures of its photographs, also with clipped pixels") {
  const Set set(2);
  const glm::dvec3 factors[]{{1.5, 1.3, 1.4}, {0.6, 0.7, 0.5}, {1, 1.1, 0.9}, {2.2, 2, 2.4}};
  CHECK(develop(set, factors) > 1000);
  build(set.options());
  const Scene scene = loadScene(set.folder / "scene");
  for (int c = 0; c < 3; ++c) {
    double mean = 0;
    for (const glm::dvec3& factor : factors) mean += std::log(factor[c]) / 4;
    double gauge = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      INFO(n << ", channel " << c << ": " << scene.nodes[n].gain[c]);
      CHECK(scene.nodes[n].gain[c] * factors[n][c] == Approx(std::exp(mean)).epsilon(0.01));
      gauge += std::log(scene.nodes[n].gain[c]);
    }
    CHECK(std::abs(gauge) < 1e-9);  // the mean brightness and tint are unchanged
  }
}

TEST_CASE("exposures are not measured if disabled") {
  const Set set;
  const glm::dvec3 factors[]{{1, 1, 1}, {0.6, 0.7, 0.5}, {1, 1.1, 0.9}, {0.8, 0.9, 0.9}};
  develop(set, factors);
  BuildOptions options = set.options();
  options.matchExposures = false;
  std::set<std::string> stages;
  const BuildReport report =
      build(options, [&](const Progress& progress) { return stages.emplace(progress.stage), true; });
  CHECK(report.exposures.text.empty());
  for (const Node& node : loadScene(set.folder / "scene").nodes) CHECK(node.gain == glm::dvec3(1.0));
  CHECK(stages.contains("matching cells"));
  CHECK(!stages.contains("comparing exposures"));
}

TEST_CASE("photographs of equal exposure have no gains") {
  const Set set(2);
  const BuildReport::ExposureSummary exposures = build(set.options()).exposures;
  CHECK((exposures.alike && exposures.measured == 4 && exposures.parts == 1));
  CHECK_THAT(exposures.text, Contains("alike"));
  for (const Node& node : loadScene(set.folder / "scene").nodes) CHECK(node.gain == glm::dvec3(1.0));
}

TEST_CASE("a build removes vignetting from stored photographs if enabled") {
  const Set set(2);
  const glm::dvec3 factors[]{{1, 1, 1}, {0.6, 0.7, 0.5}, {0.9, 1, 0.9}, {0.8, 0.9, 0.9}};
  develop(set, factors, {-0.5, -0.3});  // corners receive 45 % of the light
  BuildOptions options = set.options();
  const auto meanError = [&](std::size_t n) {
    const Image8 stored = readImage(options.output / loadScene(options.output).nodes[n].imageFile);
    double sum = 0;
    for (int y = 0; y < stored.height; ++y)
      for (int x = 0; x < stored.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const double light =
              factors[n][c] * srgbToLinear(set.scene.photographs[n].pixel(x, y)[std::size_t(c)] / 255.0);
          sum += std::abs(stored.pixel(x, y)[std::size_t(c)] - 255 * linearToSrgb(light));
        }
    return sum / double(stored.values.size());
  };
  build(options);
  CHECK(meanError(0) > 10);
  options.fitVignetting = true;
  const BuildReport::ExposureSummary exposures = build(options).exposures;
  for (std::size_t n = 0; n < 4; ++n) CHECK(meanError(n) < 2);
  CHECK_THAT(exposures.vignetting, Catch::Matches(".*4 of 4.* 4[0-9] %.*"));
  const Scene scene = loadScene(options.output);
  CHECK(scene.nodes[0].gain.g / scene.nodes[1].gain.g == Approx(0.7).epsilon(0.01));
}

TEST_CASE("extreme numbers of a build are rejected by name, or give a finite scene", "[N16]") {
  const Set set;
  const auto attempt = [&](double BuildOptions::*field, const char* name) {
    int refused = 0, made = 0;
    for (const double value : kExtremes) {
      INFO(name << " = " << value);
      BuildOptions options = set.options(fmt::format("{}{}", name, refused + made));
      options.backdrops = false;
      options.*field = value;
      try {
        build(options);
        CHECK(validate(loadScene(options.output)).empty());
        ++made;
      } catch (const Error& e) {
        CHECK(e.code() == ErrorCode::invalidInput);
        CHECK_THAT(e.what(), Contains(name));
        CHECK(!fs::exists(options.output));
        ++refused;
      }
    }
    return std::pair(refused, made);
  };
  CHECK(attempt(&BuildOptions::thetaDegrees, "theta") == std::pair(6, 4));
  CHECK(attempt(&BuildOptions::memory, "memory") == std::pair(5, 5));
}
