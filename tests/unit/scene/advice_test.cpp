// SPDX-License-Identifier: Apache-2.0
// Captures with one defect each: exactly that defect is reported.
#include "ibr/advice.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <set>

#include "base/file.h"
#include "ibr/texture.h"
#include "lab/generate/synthetic.h"
#include "support/error_of.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

using namespace ibr;
using Catch::Contains;

namespace {

using Cells = std::vector<std::vector<std::uint32_t>>;

constexpr double kWall = 5;  // distance of the photographed walls

// A scene of photographs between two walls, named view0, view1, …
SyntheticScene ofWall(const std::vector<Camera>& cameras, Cells cells) {
  SyntheticOptions options;
  options.cameras = cameras;
  options.planes = {{{0, kWall, 0}, {1, 0, 0}, {0, 0, 1}, 40, 20, 1, 0.3},
                    {{0, -kWall, 0}, {1, 0, 0}, {0, 0, 1}, 40, 20, 2, 0.3}};
  options.cells = std::move(cells);
  options.samplesPerAxis = 1;
  options.gridStep = 8;
  return makeScene(options);
}

Camera ahead(double x, double z = 0) {
  return test::lookingAlong({x, 0, z}, {0, 1, 0}, 96, 72);
}

// Two rows of cameras with columns `step` apart: 0, 1, 2, … in the lower row, then the upper row.
std::vector<Camera> grid(int columns, double step) {
  std::vector<Camera> cameras;
  for (int row = 0; row < 2; ++row)
    for (int c = 0; c < columns; ++c) cameras.push_back(ahead(step * c, step * row));
  return cameras;
}
Cells gridCells(std::uint32_t columns) {
  Cells cells;
  for (std::uint32_t c = 0; c + 1 < columns; ++c) {
    cells.push_back({c, c + 1, c + columns});
    cells.push_back({c + 1, c + columns, c + columns + 1});
  }
  return cells;
}

std::set<std::string> kinds(const CaptureAdvice& advice) {
  std::set<std::string> found;
  for (const Advice& one : advice.advice) found.insert(adviceKindName(one.kind));
  return found;
}

std::vector<std::string> sentences(const CaptureAdvice& advice) {
  std::vector<std::string> list;
  for (const Advice& one : advice.advice) list.push_back(one.problem + ' ' + one.remedy);
  return list;
}

void checkViews(const Scene& scene, const CaptureAdvice& advice) {
  CHECK(advice.coverageWithViews >= advice.coverage);
  double last = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < advice.views.size(); ++i) {
    const NextView& view = advice.views[i];
    const Pose& pose = view.camera.pose;
    CHECK(view.gain > 0);
    CHECK(view.gain <= last + 1e-9);
    last = view.gain;
    CHECK(!view.where.empty());
    CHECK(!view.referenceNodes.empty());
    CHECK(std::isfinite(glm::length(pose.position)));
    CHECK(std::abs(glm::length(pose.rotation) - 1) < 1e-9);
    CHECK(viewAxis(pose).y > 0.9);  // towards the wall
    for (const Node& node : scene.nodes) CHECK(glm::distance(pose.position, node.camera.pose.position) > 1e-3);
    for (std::size_t j = 0; j < i; ++j)
      CHECK(glm::distance(pose.position, advice.views[j].camera.pose.position) > 1e-3);
  }
}

}  // namespace

TEST_CASE("a good capture gives no advice and ten next-best views") {
  const Scene scene = ofWall(grid(4, 0.5), gridCells(4)).scene;
  const CaptureAdvice advice = adviseCapture(scene);
  CHECK(sentences(advice).empty());
  CHECK(advice.views.size() == 10);
  CHECK(advice.coverage > 0.85);
  checkViews(scene, advice);
  // A view's gain excludes the gains of previous views, so the gains add up to the growth of the shown share.
  const CaptureAdvice first = adviseCapture(scene, {.views = 1});
  REQUIRE(first.views.size() == 1);
  double gains = 0;
  for (const NextView& view : advice.views) gains += view.gain;
  CHECK((advice.coverageWithViews - advice.coverage) / gains ==
        Approx((first.coverageWithViews - first.coverage) / first.views[0].gain).epsilon(1e-4));
  CHECK(adviseCapture(scene, {.views = 3}).views.size() == 3);
  CHECK(adviseCapture(scene, {.views = 0}).views.empty());
}

TEST_CASE("neighbours too far apart are named, and the next-best view is between them") {
  std::vector<Camera> cameras = grid(4, 0.5);
  for (const std::size_t c : {2, 3, 6, 7}) cameras[c].pose.position.x += 2.5;  // the third column is 3 from the second
  const Scene scene = ofWall(cameras, gridCells(4)).scene;
  const CaptureAdvice advice = adviseCapture(scene);
  CHECK(kinds(advice) == std::set<std::string>{"wide"});
  REQUIRE(advice.advice.size() == 2);
  CHECK_THAT(sentences(advice)[0] + sentences(advice)[1],
             Contains("view1") && Contains("view2") && Contains("view5") && Contains("view6"));
  CHECK(advice.advice[0].value < 0.75);
  REQUIRE(!advice.views.empty());
  CHECK(advice.views[0].camera.pose.position.x > 0.6);
  CHECK(advice.views[0].camera.pose.position.x < 2.9);
  checkViews(scene, advice);

  SECTION("neighbours without a cell between them form separate groups") {
    Cells cells = gridCells(4);
    std::erase_if(cells, [](const auto& cell) {
      const auto x = [](std::uint32_t i) { return i % 4; };
      return std::ranges::min(cell, {}, x) % 4 == 1 && std::ranges::max(cell, {}, x) % 4 == 2;
    });
    const CaptureAdvice apart = adviseCapture(ofWall(cameras, cells).scene);
    CHECK(kinds(apart) == std::set<std::string>{"apart"});
    REQUIRE(apart.advice.size() == 1);
    CHECK(apart.advice[0].severity == Severity::serious);
    CHECK(apart.advice[0].value == 4);
    CHECK_THAT(apart.advice[0].problem, Contains("4") && Contains("view"));
    CHECK(apart.views[0].camera.pose.position.x > 0.6);
  }
  SECTION("neighbours connected through other photographs form a hole") {
    Cells cells = gridCells(4);
    std::erase_if(cells, [](const auto& cell) { return cell == std::vector<std::uint32_t>{1, 2, 5}; });
    std::erase_if(cells, [](const auto& cell) { return cell == std::vector<std::uint32_t>{2, 5, 6}; });
    cells.push_back({1, 6});
    const CaptureAdvice hole = adviseCapture(ofWall(cameras, cells).scene);
    CHECK(kinds(hole) == std::set<std::string>{"hole"});
    REQUIRE(hole.advice[0].nodes.size() == 2);
    for (const std::uint32_t node : hole.advice[0].nodes)
      CHECK_THAT(hole.advice[0].problem, Contains("view" + std::to_string(node)));
  }
}

TEST_CASE("a remedy of one or two photographs agrees with the next-best views") {
  for (const double gap : {1.8, 2.2, 2.6}) {
    std::vector<Camera> cameras = grid(4, 0.5);
    for (const std::size_t c : {2, 3, 6, 7}) cameras[c].pose.position.x += gap - 0.5;
    const CaptureAdvice advice = adviseCapture(ofWall(cameras, gridCells(4)).scene);
    for (const Advice& one : advice.advice) {
      if (one.kind != AdviceKind::wide) continue;
      std::size_t thirds = 0, halves = 0;
      for (const NextView& view : advice.views) {
        const std::set<std::uint32_t> beside(view.referenceNodes.begin(), view.referenceNodes.end());
        if (beside != std::set<std::uint32_t>(one.nodes.begin(), one.nodes.end())) continue;
        thirds += view.where.find("third") != std::string::npos;
        halves += view.where.find("halfway") != std::string::npos;
      }
      INFO(gap << ": " << one.remedy << ' ' << halves << " halfway, " << thirds << " at a third");
      CHECK((one.remedy.find("halfway") != std::string::npos) == (halves == 1 && thirds == 0));
      CHECK((one.remedy.find("third") != std::string::npos) == (thirds > 0 && halves == 0));
    }
  }
}

TEST_CASE("too few photographs, or photographs from one position, are reported") {
  CHECK(kinds(adviseCapture(Scene{})) == std::set<std::string>{"tooFew"});
  Scene one;
  one.nodes.push_back({"view0", ahead(0), {}, {}});
  const CaptureAdvice lonely = adviseCapture(one);
  CHECK(kinds(lonely) == std::set<std::string>{"tooFew"});
  CHECK_THAT(sentences(lonely)[0], Contains("view0"));
  CHECK(lonely.views.empty());

  Scene turned = ofWall({ahead(0), ahead(0.2), ahead(0.4)}, {{0, 1}, {1, 2}}).scene;
  for (Node& node : turned.nodes) node.camera.pose.position = {0, 0, 0};
  CHECK(kinds(adviseCapture(turned)) == std::set<std::string>{"turned"});
  turned.unusedPhotographs = {{"elsewhere.jpg", "the poses do not know it"}};
  CHECK(kinds(adviseCapture(turned)) == std::set<std::string>{"turned", "unused"});

  Scene loose = ofWall({ahead(0), ahead(0.2), ahead(0.4)}, {{0, 1}}).scene;
  loose.cells.clear();
  loose.unusedPhotographs = {{"view1", "it shares nothing"}, {"elsewhere.jpg", "the poses do not know it"}};
  const CaptureAdvice unjoined = adviseCapture(loose);
  CHECK(kinds(unjoined) == std::set<std::string>{"tooFew", "unused"});
  CHECK_THAT(sentences(unjoined)[0], Contains("3"));
  CHECK_THAT(sentences(unjoined)[1] + sentences(unjoined)[2],
             Contains("view1") && Contains("it shares nothing") && Contains("elsewhere.jpg"));
  CHECK(unjoined.advice[0].severity == Severity::serious);

  loose.settings = R"({"draft": true})";
  CHECK(adviseCapture(loose).advice[0].severity == Severity::hint);
  CHECK_THAT(sentences(adviseCapture(loose))[0], Contains("draft"));
  for (const char* settings : {R"({"draft": false})", R"({"draft": 1})", "[]", "{"}) {
    loose.settings = settings;
    CHECK(adviseCapture(loose).advice[0].severity == Severity::serious);
  }
}

TEST_CASE("a single row gives a hint and a next-best view beside the row") {
  const Scene scene = ofWall({ahead(0), ahead(0.5), ahead(1), ahead(1.5)}, {{0, 1}, {1, 2}, {2, 3}}).scene;
  const CaptureAdvice advice = adviseCapture(scene, {.views = 40});
  CHECK(kinds(advice) == std::set<std::string>{"row"});
  CHECK(advice.advice[0].severity == Severity::hint);
  checkViews(scene, advice);
  CHECK(std::ranges::any_of(advice.views, [](const NextView& v) { return std::abs(v.camera.pose.position.z) > 0.4; }));
  CHECK(std::ranges::any_of(advice.views, [](const NextView& v) { return v.where.find("higher") != v.where.npos; }));
}

TEST_CASE("a defect of one photograph is reported for this photograph only") {
  SyntheticScene made = ofWall(grid(4, 0.5), gridCells(4));
  Scene& scene = made.scene;
  const auto only = [&](const char* kind, const char* name) {
    const CaptureAdvice advice = adviseCapture(scene);
    INFO(Catch::StringMaker<std::vector<std::string>>::convert(sentences(advice)));
    CHECK(kinds(advice) == std::set<std::string>{kind});
    REQUIRE(advice.advice.size() == 1);
    CHECK_THAT(advice.advice[0].problem, Contains(name));
    CHECK(!advice.advice[0].remedy.empty());
  };
  SECTION("the photograph is not used") {
    scene.unusedPhotographs = {{"last.jpg", kNotRegistered}};
    only("unused", "last.jpg");
    only("unused", kNotRegistered);
    scene.unusedPhotographs = {
        {"last.heic", "HEIC files are not read: convert them"}};  // the reason contains the remedy
    const Advice unused = adviseCapture(scene).advice.at(0);
    CHECK_THAT(unused.problem, Contains("last.heic") && Contains("HEIC files are not read: convert them"));
    CHECK(unused.remedy.empty());
  }
  SECTION("the photograph repeats another") {
    std::vector<Camera> cameras = grid(4, 0.5);
    cameras.push_back(ahead(0.5));
    scene = ofWall(cameras, gridCells(4)).scene;
    only("twice", "view8");
    only("twice", "view1");
  }
  SECTION("the pose is inaccurate") {
    for (Cell& cell : scene.cells)
      cell.quality.residualPx = std::ranges::count(cell.members, 0u) ? 2 : 0.1;  // photograph 0 is in one cell
    only("pose", "view0");
  }
  SECTION("few matches agree with the neighbours") {
    for (Cell& cell : scene.cells)
      if (std::ranges::count(cell.members, 0u)) {  // photograph 0 is in one cell, at a corner
        MorphMesh& mesh = cell.mesh;
        for (std::size_t t = mesh.triangles.size() / 8; t < mesh.tier.size(); ++t) mesh.tier[t] = kTierRejected;
      }
    only("unmatched", "view0");
  }
  SECTION("all poses are inaccurate") {
    for (Cell& cell : scene.cells) cell.quality.residualPx = 2;
    only("pose", "%");
  }
}

TEST_CASE("a viewing direction missing at a capture site is reported with a neighbour that has it") {
  const auto back = [](double x) { return test::lookingAlong({x, 0, 0}, {0, -1, 0}, 96, 72); };
  // Five capture sites in a row; each has two viewing directions, except the middle one.
  std::vector<Camera> cameras;
  Cells cells;
  for (int i = 0; i < 5; ++i) cameras.push_back(ahead(0.9 * i));
  for (int i : {0, 1, 3, 4}) cameras.push_back(back(0.9 * i));
  for (std::uint32_t i = 0; i < 4; ++i) cells.push_back({i, i + 1});
  cells.push_back({5, 6});
  cells.push_back({7, 8});
  const CaptureAdvice advice = adviseCapture(ofWall(cameras, cells).scene);
  CHECK(kinds(advice) == std::set<std::string>{"direction", "row"});
  REQUIRE(advice.advice[0].nodes.size() == 2);
  for (const std::uint32_t node : advice.advice[0].nodes)
    CHECK_THAT(advice.advice[0].problem, Contains("view" + std::to_string(node)));
  CHECK_THAT(advice.advice[0].problem, Contains("view2"));
  CHECK(std::ranges::any_of(advice.views, [&](const NextView& v) {
    return v.where.find("view2") != v.where.npos &&
           glm::distance(v.camera.pose.position, cameras[2].pose.position) < 1e-6;
  }));
}

TEST_CASE("exposure jumps are detected from the gains") {
  SyntheticScene made = ofWall(grid(4, 0.5), gridCells(4));
  made.scene.nodes[2].gain = glm::dvec3(1.8);
  CHECK(sentences(adviseCapture(made.scene)).empty());
  made.scene.nodes[2].gain = {3.8, 4, 4.4};
  const CaptureAdvice advice = adviseCapture(made.scene);
  REQUIRE(advice.advice.size() == 1);
  CHECK(advice.advice[0].kind == AdviceKind::exposure);
  CHECK_THAT(advice.advice[0].problem, Contains("view2") && Contains("2.0") && Contains("darker"));
  CHECK(advice.advice[0].value == Approx(-2).margin(0.02));
  CHECK((advice.advice[0].nodes == std::vector<std::uint32_t>{2}));
  made.scene.nodes[2].gain = glm::dvec3(0.25);
  CHECK_THAT(sentences(adviseCapture(made.scene))[0], Contains("2.0") && Contains("brighter"));
  for (Node& node : made.scene.nodes) node.gain = glm::dvec3(0.25);
  CHECK(sentences(adviseCapture(made.scene)).empty());
}

TEST_CASE("blur is detected from the textures") {
  test::TemporaryFolder folder;
  SyntheticScene made = ofWall(grid(4, 0.5), gridCells(4));
  made.scene.folder = folder.path();
  const auto store = [&](std::size_t n, const Image8& rgb) {
    Node& node = made.scene.nodes[n];
    node.textureFile = node.name + ".ktx2";
    writeKtx2(folder.path() / node.textureFile, encodeTexture(buildMips(rgb), TextureFormat::rgba8));
  };
  for (std::size_t n = 0; n < made.photographs.size(); ++n) store(n, made.photographs[n]);
  CHECK(sentences(adviseCapture(made.scene)).empty());
  const Image8& good = made.photographs[2];

  SECTION("a blurred photograph is reported") {
    Image8 soft = good;
    for (int y = 0; y < good.height; ++y)
      for (int x = 0; x < good.width; ++x)
        for (int c = 0; c < 3; ++c) {
          int sum = 0, count = 0;
          for (int j = std::max(0, y - 3); j <= std::min(good.height - 1, y + 3); ++j)
            for (int i = std::max(0, x - 3); i <= std::min(good.width - 1, x + 3); ++i, ++count)
              sum += good.pixel(i, j)[std::size_t(c)];
          soft.pixel(x, y)[std::size_t(c)] = std::uint8_t(sum / count);
        }
    store(2, soft);
    const CaptureAdvice advice = adviseCapture(made.scene);
    CHECK(kinds(advice) == std::set<std::string>{"blurred"});
    REQUIRE(advice.advice.size() == 1);
    CHECK_THAT(sentences(advice)[0], Contains("view2"));
    CHECK(adviseCapture(made.scene, {.readTextures = false}).advice.empty());
  }
  SECTION("textures that cannot be read are ignored") {
    writeFile(folder.path() / made.scene.nodes[2].textureFile, std::string_view("no texture"));
    std::filesystem::remove(folder.path() / made.scene.nodes[3].textureFile);
    made.scene.nodes[4].textureFile.clear();
    CHECK(sentences(adviseCapture(made.scene)).empty());
  }
}

TEST_CASE("advice does not depend on the order of nodes and cells or on the world's coordinates") {
  std::vector<Camera> cameras = grid(4, 0.5);
  for (const std::size_t c : {2, 3, 6, 7}) cameras[c].pose.position.x += 2.7;
  const Scene scene = ofWall(cameras, gridCells(4)).scene;
  const CaptureAdvice before = adviseCapture(scene);

  Scene shuffled = scene;
  std::ranges::reverse(shuffled.nodes);
  std::ranges::reverse(shuffled.cells);
  for (Cell& cell : shuffled.cells)
    for (std::uint32_t& m : cell.members) m = std::uint32_t(scene.nodes.size()) - 1 - m;
  const CaptureAdvice reversed = adviseCapture(shuffled);

  Scene moved = scene;
  const glm::dquat turn = glm::normalize(glm::dquat(0.3, -0.5, 0.2, 0.7));
  for (Node& node : moved.nodes) {
    Pose& pose = node.camera.pose;
    pose = {glm::dvec3(500, -20, 80) + turn * pose.position * 64.0, turn * pose.rotation};
  }
  for (Cell& cell : moved.cells)
    for (float& inverse : cell.mesh.inverseDistance) inverse /= 64;
  const CaptureAdvice elsewhere = adviseCapture(moved);

  for (const CaptureAdvice& after : {reversed, elsewhere}) {
    CHECK(sentences(after) == sentences(before));
    CHECK(after.coverage == Approx(before.coverage).epsilon(1e-3));
    REQUIRE(after.views.size() == before.views.size());
    for (std::size_t i = 0; i < after.views.size(); ++i)
      CHECK(after.views[i].gain == Approx(before.views[i].gain).epsilon(0.02));
    CHECK(after.views[0].where == before.views[0].where);
  }
}

TEST_CASE("a scene with a fault is refused, a scene at infinity is not") {
  Scene scene = ofWall(grid(2, 0.5), gridCells(2)).scene;
  scene.cells[0].members[0] = 99;
  CHECK_THAT(test::errorOf([&] { adviseCapture(scene); }).what(), Contains("cells[0].members[0]"));

  Scene far = ofWall(grid(3, 0.5), gridCells(3)).scene;
  for (Cell& cell : far.cells) {
    cell.mesh.inverseDistance.assign(cell.mesh.vertexCount(), 0.0f);
    for (auto& ratio : cell.mesh.ratio) ratio.assign(ratio.size(), 1.0f);
  }
  const CaptureAdvice advice = adviseCapture(far);
  CHECK(sentences(advice).empty());
  CHECK(advice.coverage == 1);
  CHECK(advice.views.empty());
}
