// SPDX-License-Identifier: Apache-2.0
// Non-finite and extreme numbers in the planner's input: each plan is finite, or an Error names the faulty
// field.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ibr/error.h"
#include "ibr/frame_plan.h"
#include "lab/generate/synthetic.h"
#include "support/extremes.h"

using namespace ibr;

namespace {

SyntheticScene place() {
  SyntheticOptions options;
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0.4, 0.9, 0.1}}) {
    Camera camera{pinholeFromFov(64, 48, 1), {}};
    camera.pose.position = at;
    options.cameras.push_back(camera);
  }
  options.planes = {{{0, 0, -6}, {1, 0, 0}, {0, 1, 0}, 40, 30, 1, 0.5}};
  options.gridStep = 16;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

bool finite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Every number of a cell that reaches a device or the next plan.
bool finite(const PlannedCell& cell) {
  bool all = std::isfinite(cell.extrapolationDistance) && std::isfinite(cell.rotationalDistance) &&
             std::isfinite(cell.photographDistance) && cell.opacity >= 0 && cell.opacity <= 1 &&
             finite(cell.correction.pivot) && finite(cell.correction.shift);
  for (const PlannedCell::View& view : cell.view)
    for (std::size_t m = 0; m < 4; ++m)
      all = all && std::isfinite(view.position[m]) && view.blend[m] >= 0 && view.blend[m] <= 1;
  return all;
}

bool finite(const FramePlan& plan) {
  bool all = std::isfinite(plan.previousWeight) && finite(plan.exposure) && std::isfinite(plan.nearDistance) &&
             std::isfinite(plan.colour.mainShare) && std::isfinite(plan.colour.share) && plan.colour.maxStep >= 0 &&
             std::isfinite(plan.next.secondsSinceSwitch) && std::isfinite(plan.next.colourFadeSecondsLeft) &&
             (!plan.next.exposure || finite(*plan.next.exposure));
  for (const PlannedCell& cell : plan.cells) all = all && finite(cell);
  for (const PlannedCell& cell : plan.previous) all = all && finite(cell);
  for (const DrawOrderEntry& cell : plan.next.cells) all = all && cell.opacity >= 0 && cell.opacity <= 1;
  return all;
}

}  // namespace

TEST_CASE("a plan is finite or refused for extreme input numbers", "[N16][P4]") {
  const SyntheticScene made = place();
  const SceneBounds bounds = sceneBounds(made.scene);
  Camera view{pinholeFromFov(64, 48, 1), {}};
  view.pose.position = {0.4, 0.3, 0.1};
  RenderSettings mapped;
  mapped.colourMapping = ColourMapping::ours;
  mapped.alignCells = true;
  const FrameInput usual{{view}, mapped, 0.02};
  const PlanState before = planFrame(made.scene, bounds, usual).next;

  using Field = std::pair<std::string, std::function<double&(FrameInput&)>>;
  const std::vector<Field> fields{
      {"fx", [](FrameInput& i) -> double& { return i.views[0].intrinsics.fx; }},
      {"fy", [](FrameInput& i) -> double& { return i.views[0].intrinsics.fy; }},
      {"cx", [](FrameInput& i) -> double& { return i.views[0].intrinsics.cx; }},
      {"cy", [](FrameInput& i) -> double& { return i.views[0].intrinsics.cy; }},
      {"x", [](FrameInput& i) -> double& { return i.views[0].pose.position.x; }},
      {"z", [](FrameInput& i) -> double& { return i.views[0].pose.position.z; }},
      {"rotation.w", [](FrameInput& i) -> double& { return i.views[0].pose.rotation.w; }},
      {"rotation.y", [](FrameInput& i) -> double& { return i.views[0].pose.rotation.y; }},
      {"dtSeconds", [](FrameInput& i) -> double& { return i.dtSeconds; }},
      {"extrapolationLimit", [](FrameInput& i) -> double& { return i.settings.extrapolationLimit; }},
      {"fadeShare", [](FrameInput& i) -> double& { return i.settings.fadeShare; }},
      {"switchSeconds", [](FrameInput& i) -> double& { return i.settings.switchSeconds; }},
      {"textureScale", [](FrameInput& i) -> double& { return i.settings.textureScale; }},
      {"renderScale", [](FrameInput& i) -> double& { return i.settings.renderScale; }},
      {"exposureSeconds", [](FrameInput& i) -> double& { return i.settings.exposureSeconds; }},
      {"colourSamples", [](FrameInput& i) -> double& { return i.settings.colourSamples; }},
      {"colourFadeSeconds", [](FrameInput& i) -> double& { return i.settings.colourFadeSeconds; }},
      {"colourSmoothSeconds", [](FrameInput& i) -> double& { return i.settings.colourSmoothSeconds; }},
      {"colourMaxSpeed", [](FrameInput& i) -> double& { return i.settings.colourMaxSpeed; }},
  };
  int planned = 0, refused = 0;
  for (const auto& [name, field] : fields)
    for (const double value : test::kExtremes)
      for (const bool first : {true, false}) {
        FrameInput input = usual;
        field(input) = value;
        INFO(name << " = " << value << (first ? ", first frame" : ""));
        try {
          const FramePlan plan = planFrame(made.scene, bounds, input, first ? PlanState{} : before);
          CHECK(finite(plan));
          ++planned;
        } catch (const Error& e) {
          CHECK(e.code() == ErrorCode::invalidInput);
          ++refused;
        }
      }
  CHECK(planned > 50);
  CHECK(refused > 50);
}

TEST_CASE("extreme numbers in a scene are faults or leave its vertices finite", "[N16][P4]") {
  const SyntheticScene made = place();
  using Spoil = std::pair<std::string, std::function<void(Scene&, double)>>;
  const std::vector<Spoil> spoils{
      {"position", [](Scene& s, double v) { s.nodes[1].camera.pose.position.y = v; }},
      {"rotation", [](Scene& s, double v) { s.nodes[1].camera.pose.rotation.x = v; }},
      {"fx", [](Scene& s, double v) { s.nodes[1].camera.intrinsics.fx = v; }},
      {"cy", [](Scene& s, double v) { s.nodes[1].camera.intrinsics.cy = v; }},
      {"gain", [](Scene& s, double v) { s.nodes[1].gain.g = v; }},
      {"match", [](Scene& s, double v) { s.cells[0].mesh.match[1][2].x = float(v); }},
      {"ratio", [](Scene& s, double v) { s.cells[0].mesh.ratio[1][2] = float(v); }},
      {"inverseDistance", [](Scene& s, double v) { s.cells[0].mesh.inverseDistance[2] = float(v); }},
      {"uncertainty", [](Scene& s, double v) { s.cells[0].mesh.uncertainty[2] = float(v); }},
      {"ecc", [](Scene& s, double v) { s.cells[0].mesh.ecc[1] = float(v); }},
  };
  int faulty = 0, valid = 0;
  for (const auto& [name, spoil] : spoils)
    for (const double value : test::kExtremes) {
      if (name == "ecc" && value != value) continue;  // NaN: not known
      Scene scene = made.scene;
      spoil(scene, value);
      INFO(name << " = " << value);
      if (!validate(scene).empty()) {
        ++faulty;
        continue;
      }
      ++valid;
      for (std::size_t p = 0; p < scene.cells[0].mesh.vertexCount(); ++p)
        if (const auto position = vertexPosition(scene, scene.cells[0], p)) CHECK(finite(*position));
      Camera view{pinholeFromFov(64, 48, 1), {}};
      CHECK(finite(planFrame(scene, sceneBounds(scene), {{view}, {}, 0.02})));
    }
  CHECK(faulty > 40);
  CHECK(valid > 5);
}
