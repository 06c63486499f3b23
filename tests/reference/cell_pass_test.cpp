// SPDX-License-Identifier: Apache-2.0
// The GPU's cell pass against the double-precision reference implementation.
#include <algorithm>

#include "reference/compare_pictures.h"

using namespace ibr;
using namespace ibr::test;

TEST_CASE("the cell pass equals the reference implementation", "[P9]") {
  for (std::size_t members : {2u, 3u, 4u}) {
    const Stage stage(testDevice(), makeScene(place(members)));
    for (BlendMode blend : {BlendMode::blend, BlendMode::dither})
      for (Morph morph : {Morph::ours, Morph::paper}) {
        RenderSettings settings = withTiers();
        settings.blend = blend;
        settings.morph = morph;
        INFO(members << " members, blend " << int(blend) << ", morph " << int(morph));
        compareWithReference(stage, stage.plan(cameraAt({0.4, 0.25, 0.1}, 0.03), settings));  // inside
        compareWithReference(stage, stage.plan(cameraAt({1.3, -0.4, 0.5}, 0.1), settings));   // outside
      }
  }
}

TEST_CASE("the cell pass draws odd sizes, wide angles and off-centre principal points", "[N6][P9]") {
  const Stage stage(testDevice(), makeScene(place(3)));
  Camera view = cameraAt({0.4, 0.3, 0}, 0, 0, 333, 201, 1.9);
  compareWithReference(stage, stage.plan(view, withTiers()), 0.05);
  view.intrinsics.cx = 40;
  view.intrinsics.cy = 170;
  compareWithReference(stage, stage.plan(view, withTiers()), 0.05);
}

TEST_CASE("cells with rejected triangles: rank decides between cells, depth within a cell") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  SyntheticScene place = makeScene(options);
  for (Cell& cell : place.scene.cells) {
    // Rejects the last third of the triangles.
    MorphMesh& mesh = cell.mesh;
    for (std::size_t t = mesh.triangles.size() * 2 / 3; t < mesh.triangles.size(); ++t) mesh.tier[t] = kTierRejected;
  }
  const Stage stage(testDevice(), place);
  const Camera view = cameraAt({0.45, 0.3, 0.2}, 0.02);
  REQUIRE(stage.plan(view).cells.size() == 3);
  compareWithReference(stage, stage.plan(view, withTiers()));
}

TEST_CASE("dissolving cells with mixed blending equal the reference implementation") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {0, 3}};
  const Stage stage(testDevice(), makeScene(options));
  RenderSettings settings = withTiers();
  settings.blend = BlendMode::mixed;
  settings.extrapolationLimit = 1;
  settings.fadeShare = 0.9;
  const Camera view = cameraAt({0.45, -0.11, 0.2});
  const FramePlan plan = stage.plan(view, settings);
  REQUIRE(plan.cells.size() == 2);
  CHECK(plan.cells[0].opacity < 1);
  CHECK(plan.cells[0].opacity > 0);
  compareWithReference(stage, plan, 0.25, 0.1);  // noise leaves few pixels whose neighbours show the same draw item
  settings.fadeShare = 0;
  CHECK(stage.render(plan) != stage.render(view, settings));
}

TEST_CASE("aligned cells equal the reference implementation") {
  SyntheticScene place = twoCells();
  glm::dquat& rotation = place.scene.nodes[3].camera.pose.rotation;
  rotation = glm::angleAxis(0.02, glm::normalize(glm::dvec3(0.3, 1, 0.2))) * rotation;
  const Stage stage(testDevice(), place);
  const Camera view = cameraAt({0.5, 0.5, 0.3});
  RenderSettings settings = withTiers();
  settings.alignCells = true;
  const FramePlan plan = stage.plan(view, settings);
  REQUIRE(plan.cells.size() == 2);
  for (const PlannedCell& cell : plan.cells) CHECK_FALSE((cell.correction == Correction{}));
  compareWithReference(stage, plan);
  CHECK_FALSE((stage.render(plan).values == stage.render(view, withTiers()).values));
}

TEST_CASE("a half transparent cell shows half of the pixels behind it") {
  SyntheticScene place = twoCells();
  for (std::uint8_t& level : place.photographs[0].values) level = std::uint8_t(level / 2);  // of the first cell only
  const Stage stage(testDevice(), place);
  FramePlan plan = stage.plan(cameraAt({0.4, 0.25, 0.1}), withTiers());
  REQUIRE(plan.cells.size() == 2);
  const std::vector<PlannedCell> cells = plan.cells;
  const auto with = [&](std::vector<PlannedCell> drawn) {
    plan.cells = std::move(drawn);
    return stage.render(plan);
  };
  PlannedCell faded = cells[0];
  faded.opacity = 0.5;
  const Image8 front = with({cells[0]}), behind = with({cells[1]}), half = with({faded, cells[1]});
  std::size_t differ = 0, fromFront = 0, fromBehind = 0;
  for (int y = 40; y < half.height - 40; ++y)
    for (int x = 40; x < half.width - 40; ++x) {
      const auto same = [&](const Image8& a, const Image8& b) {
        return std::ranges::equal(a.pixel(x, y), b.pixel(x, y));
      };
      if (front.pixel(x, y)[3] == 0 || behind.pixel(x, y)[3] == 0 || same(front, behind)) continue;
      ++differ;
      fromFront += same(half, front);
      fromBehind += same(half, behind);
    }
  REQUIRE(differ > 1000);
  CHECK(fromFront + fromBehind == differ);
  CHECK(double(fromFront) / double(differ) == Approx(0.5).margin(0.1));
}

TEST_CASE("a cross-fade of a switch shows both draw orders") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  FramePlan before = stage.plan(cameraAt({0.3, 0.2, 0.0}), withTiers());
  FramePlan plan = stage.plan(cameraAt({0.6, 0.45, 0.35}), withTiers());
  REQUIRE(plan.cells[0].cell != before.cells[0].cell);
  plan.previous = plan.cells;
  std::swap(plan.previous[0], plan.previous[1]);
  plan.previousWeight = 0.4;
  compareWithReference(stage, plan);
}

TEST_CASE("the new draw order is shown at once where the previous order shows nothing") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  const FramePlan plan = stage.plan(cameraAt({0.6, 0.45, 0.35}), withTiers());
  FramePlan mixing = plan;
  mixing.previous.clear();
  mixing.previousWeight = 0.7;
  CHECK(stage.render(mixing) == stage.render(plan));
  mixing.previous = {plan.cells.back()};  // covers a part of the view
  compareWithReference(stage, mixing);
}

TEST_CASE("cells that fade out are drawn at their previous rank") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  FramePlan plan = stage.plan(cameraAt({0.3, 0.2, 0.0}), withTiers());
  REQUIRE(plan.cells.size() == 2);
  PlannedCell gone = plan.cells[1];
  gone.opacity = 0.97;  // noise leaves pixels whose neighbour shows another draw item
  plan.fadingOut = {{gone, 0}, {plan.cells[0], 2}};
  compareWithReference(stage, plan, 0.25, 0.1);
  const FramePlan without = stage.plan(cameraAt({0.3, 0.2, 0.0}), withTiers());
  CHECK(stage.render(plan) != stage.render(without));
}

TEST_CASE("a renderer without a second canvas does not cross-fade") {
  const Stage stage(testDevice(), makeScene(place(3)));  // one cell, so that no main cell switch can occur
  const SceneBounds bounds = sceneBounds(stage.scene());
  const PlanState state = planFrame(stage.scene(), bounds, {{cameraAt({0.3, 0.2, 0.0})}, withTiers(), 0.05}).next;
  const FramePlan away = planFrame(stage.scene(), bounds, {{cameraAt({0.3, 0.2, 60.0})}, withTiers(), 0.05}, state);
  REQUIRE(away.cells.empty());
  REQUIRE(away.previousWeight == 1);
  const Image8 picture = stage.render(away);
  CHECK(picture.pixel(160, 60)[3] == 0);
}

TEST_CASE("both views of a stereo plan equal their single views") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const Camera left = cameraAt({0.37, 0.25, 0.1}), right = cameraAt({0.43, 0.25, 0.1});
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {{left, right}, withTiers()});
  const std::vector<Image8> pictures = stage.renderViews(plan);
  REQUIRE(pictures.size() == 2);
  CHECK(pictures[0] == stage.render(left, withTiers()));
  CHECK(pictures[1] == stage.render(right, withTiers()));
  CHECK(pictures[0] != pictures[1]);
}
