// SPDX-License-Identifier: Apache-2.0
// Resources a scene needs: counters against a table written by hand, and images of specialised renderers against images
// of general ones.
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "base/file.h"
#include "gpu/draw/multiview.h"
#include "ibr/requirements.h"
#include "reference/stage.h"
#include "shared/colour_map.h"
#include "shared/gather.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr VkExtent2D kExtent{64, 48};
constexpr std::uint64_t kPixels = 64 * 48;
constexpr std::uint64_t kParameter = 312, kExposure = 96;  // bytes a cell
constexpr std::uint64_t kLeaving = 16;                     // max. cells that are fading out
constexpr std::uint64_t kNoise = 64 * 64 * 4;

Camera view(double x = 0.4) {
  return cameraAt({x, 0.25, 0.1}, 0.02, 0, int(kExtent.width), int(kExtent.height));
}

SyntheticScene pinholes(std::vector<std::vector<std::uint32_t>> cells, std::size_t members = 4) {
  SyntheticOptions options = place(members);
  options.cells = std::move(cells);
  options.gridStep = 40;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

// Three cameras in a room, of which the first `panoramas` are panoramas.
SyntheticScene room(int panoramas) {
  SyntheticOptions options;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {1, 0, 0.1}, {0.4, 0.8, 0.2}}) {
    Camera camera = cameraAt(place, 0, 0, 96, 72);
    if (int(options.cameras.size()) < panoramas) camera.intrinsics = {CameraModel::equirectangular, 128, 64};
    options.cameras.push_back(camera);
  }
  options.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  options.surfaceStep = 1;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

struct Row {
  std::string name;
  SyntheticScene place;
  RenderSettings settings;
  std::size_t views;
  Renderer::Counters expected;  // triangles and working bytes are not compared
  bool multiview = false, buffers = false;
};

RendererOptions optionsOf(const Row& row) {
  RendererOptions options = optionsFor(row.settings, kExtent);
  options.maxViews = std::uint32_t(row.views);
  options.multiview = row.multiview;
  options.uncertaintyScene = &row.place.scene;
  if (row.buffers) options.bufferScene = &row.place.scene;
  return options;
}

RenderSettings with(auto change) {
  RenderSettings settings;
  change(settings);
  return settings;
}

// Expected counters, written by hand. A plain scene has two cell pipelines for each kind of cell (a cell may dissolve),
// one composition (two if switches may be cross-faded), and two passes a view.
std::vector<Row> table() {
  const RenderSettings plain;
  const RenderSettings noFade = with([](auto& s) { s.fadeShare = s.switchSeconds = 0; });
  const RenderSettings dither = with([](auto& s) {
    s.blend = BlendMode::dither;
    s.fadeShare = s.switchSeconds = 0;
  });
  const RenderSettings paper = with([](auto& s) { s.order = DrawOrder::paper; });
  const RenderSettings mapped = with([](auto& s) { s.colourMapping = ColourMapping::ours; });
  const RenderSettings filled = with([](auto& s) { s.maxTier = kTierFilled; });
  SyntheticScene rejected = pinholes({{0, 1, 2}});
  for (Cell& cell : rejected.scene.cells) cell.mesh.tier.back() = kTierRejected;
  const std::uint64_t canvas = 8 * kPixels;
  const std::uint64_t fill = 8 * (32 * 24 + 16 * 12 + 8 * 6 + 4 * 3 + 2 * 2 + 1);
  // A frame's header, the cells' slots, their tables and the identity, and noise.
  const std::uint64_t tables = sizeof(shader::ColourFrame) + 160 * sizeof(shader::ColourSlot) + 161 * 256 * 4 + kNoise +
                               4 * shader::counterCount(2, false);  // room for both ways of counting
  const auto counters = [](std::uint32_t pipelines, std::uint32_t passes, std::uint32_t draws, std::uint32_t dispatches,
                           Renderer::Counters::Bytes bytes) {
    return Renderer::Counters{
        .pipelines = pipelines, .passes = passes, .draws = draws, .dispatches = dispatches, .bytes = bytes};
  };
  std::vector<Row> rows;
  rows.push_back({"a line", pinholes({{0, 1}}), plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"a triangle", pinholes({{0, 1, 2}}), plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"a tetrahedron that never fades", pinholes({{0, 1, 2, 3}}), noFade, 1,
                  counters(1 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, 0})});
  rows.push_back({"a dithered triangle", pinholes({{0, 1, 2}}), dither, 1,
                  counters(1 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"the paper's order", pinholes({{0, 1, 2}}), paper, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"a rejected triangle", rejected, plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"filled", pinholes({{0, 1, 2}}), filled, 1,
                  counters(2 + 2 + 3, 2, 2, 2 * 6 - 1, {canvas, fill, 0, (1 + kLeaving) * kParameter, kNoise})});
  // Both cells, in the current draw order and in the previous one.
  rows.push_back({"a line and a triangle", pinholes({{0, 1, 2}, {0, 3}}), plain, 1,
                  counters(2 * 2 + 2, 2, 3, 0, {2 * canvas, 0, 0, 2 * (2 + kLeaving) * kParameter, kNoise})});
  rows.push_back(
      {"colours of two cells", pinholes({{0, 1, 2}, {2, 1, 0}}), mapped, 1,
       counters(2 * 2 + 2 + 2 + 2, 3, 3 + 2, 2, {2 * canvas, 0, tables, 2 * (2 + kLeaving) * kParameter, kNoise})});
  SyntheticScene gained = pinholes({{0, 1, 2}});
  gained.scene.nodes[1].gain.b = 1.2;
  rows.push_back({"gains", gained, plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * (kParameter + kExposure), kNoise})});
  rows.push_back({"colours of one cell", pinholes({{0, 1, 2}}), mapped, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  RenderSettings sequence = mapped;
  sequence.colourMapping = ColourMapping::paper;
  rows.push_back({"the paper's colours of one cell", pinholes({{0, 1, 2}}), sequence, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"two views", pinholes({{0, 1, 2}}), plain, 2,
                  counters(2 + 1, 4, 4, 0, {canvas, 0, 0, 2 * (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back(
      {"panoramas", room(3), plain, 1, counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"a mixed cell", room(2), plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  // Composition pipelines without and with the additional effect.
  rows.push_back({"a floor", pinholes({{0, 1, 2}}), with([](auto& s) { s.floor = Floor{}; }), 1,
                  counters(2 + 2, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"a wireframe", pinholes({{0, 1, 2}}), with([](auto& s) { s.overlay = Overlay::wireframe; }), 1,
                  counters(2 + 2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  SyntheticScene known = pinholes({{0, 1, 2}});
  const std::uint64_t uncertainties = 4 * known.scene.cells[0].mesh.vertexCount();
  rows.push_back({"confidence", known, with([](auto& s) { s.overlay = Overlay::confidence; }), 1,
                  counters(2 + 2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise, uncertainties})});
  rows.push_back({"overlap, for which hidden cells are drawn", pinholes({{0, 1, 2}, {2, 1, 0}}),
                  with([](auto& s) { s.overlay = Overlay::overlap; }), 1,
                  counters(2 + 2 + 2, 2, 3, 0, {2 * canvas, 0, 0, 2 * (2 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"buffers", known, plain, 1,
                  counters(2 + 2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise, uncertainties}),
                  false, true});
  // One pass for both views, into a canvas of two layers beside the canvas of one view.
  if (multiviewWorks(testDevice()))
    rows.push_back({"two views at once", pinholes({{0, 1, 2}}), plain, 2,
                    counters(2 * 2 + 1, 1 + 2, 1 + 2, 0, {3 * canvas, 0, 0, 2 * (1 + kLeaving) * kParameter, kNoise}),
                    true});
  // A mask needs only its texture's alpha. Aligned cells need only different parameters.
  SyntheticScene masked = pinholes({{0, 1, 2}});
  masked.scene.nodes[1].maskFile = "masks/1.png";
  rows.push_back(
      {"a mask", masked, plain, 1, counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  rows.push_back({"aligned cells", pinholes({{0, 1, 2}, {0, 3}}), with([](auto& s) { s.alignCells = true; }), 1,
                  counters(2 * 2 + 2, 2, 3, 0, {2 * canvas, 0, 0, 2 * (2 + kLeaving) * kParameter, kNoise})});
  // Backdrops without evidence are neither drawn nor used for gathering.
  SyntheticOptions three = place(3);
  three.cells = {{0, 1, 2}};
  three.gridStep = 40;
  three.samplesPerAxis = 1;
  SyntheticScene behind = makeScene(three);
  addBackdrops(behind, three);
  rows.push_back({"backdrops of three photographs", behind, plain, 1,
                  counters(2 + 1, 2, 2, 0, {canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise})});
  // The vote has half the width and height. Its atlas has a tile of ρ, evidence and depth for each of twelve
  // candidates; then come its surfaces and their holes. With Composition::gathered no cell is drawn.
  addEvidence(behind);
  const std::uint64_t voted = kPixels / 4, tiles = 12;
  const std::uint64_t gather =
      sizeof(shader::GatherView) + tiles * (8 + 4) * voted + 16 * voted + 8 * (16 * 12 + 8 * 6 + 4 * 3 + 2 * 2 + 1);
  const auto gathered = [&](std::string name, Composition composition, Overlay overlay, std::uint32_t cells) {
    Renderer::Counters::Bytes bytes{canvas, 0, 0, (1 + kLeaving) * kParameter, kNoise};
    bytes.gather = gather;
    // An overlay needs its own pipelines for cells and gather.
    const std::uint32_t overlays = overlay == Overlay::none ? 0 : 2 + 1;
    return Row{std::move(name), behind, with([&](auto& s) {
                 s.composition = composition;
                 s.overlay = overlay;
               }),
               1,
               // Candidate depths, vote, gather, three for holes; a pass and three draws for candidates.
               counters(2 + 1 + 6 + overlays, 1 + 2, 3 + 1 + cells + 1, 1 + (2 * 5 - 1), bytes)};
  };
  rows.push_back(gathered("gathered from three photographs", Composition::gathered, Overlay::none, 0));
  rows.push_back(gathered("gathered where cells leave holes", Composition::hybrid, Overlay::none, 1));
  rows.push_back(gathered("tiers of what is gathered", Composition::gathered, Overlay::tiers, 0));
  rows.push_back({"no cell", SyntheticScene{}, plain, 1, counters(1, 2, 1, 0, {canvas, 0, 0, kParameter, 0})});
  return rows;
}

FramePlan planOf(const SyntheticScene& place, const RenderSettings& settings, std::size_t views = 1) {
  std::vector<Camera> eyes{view()};
  if (views == 2) eyes.push_back(view(0.46));
  return planFrame(place.scene, sceneBounds(place.scene), {eyes, settings});
}

GpuScene onDevice(const SyntheticScene& place) {
  return GpuScene(testDevice(), place.scene, {.source = photographsOf(place), .depthSource = farDepths});
}

Image8 pictureOf(const GpuScene& scene, const FramePlan& plan, const RendererOptions& options) {
  const Renderer renderer(testDevice(), scene, options);
  Offscreen offscreen(testDevice(), kExtent);
  return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

}  // namespace

TEST_CASE("counted costs of scenes equal the table", "[P12][multiview]") {
  for (const Row& row : table()) {
    INFO(row.name);
    const GpuScene scene = onDevice(row.place);
    const Renderer::Counters counted =
        Renderer(testDevice(), scene, optionsOf(row)).count(planOf(row.place, row.settings, row.views));
    CHECK(counted.pipelines == row.expected.pipelines);
    CHECK(counted.passes == row.expected.passes);
    CHECK(counted.draws == row.expected.draws);
    CHECK(counted.dispatches == row.expected.dispatches);
    CHECK(counted.bytes.canvases == row.expected.bytes.canvases);
    CHECK(counted.bytes.fill == row.expected.bytes.fill);
    CHECK(counted.bytes.colours == row.expected.bytes.colours);
    CHECK(counted.bytes.parameters == row.expected.bytes.parameters);
    CHECK(counted.bytes.noise == row.expected.bytes.noise);
    CHECK(counted.bytes.uncertainties == row.expected.bytes.uncertainties);
    CHECK(counted.bytes.gather == row.expected.bytes.gather);
    CHECK(counted.bytes.hiddenArea == 0);
    CHECK(counted.workingBytes >= counted.bytes.canvases + counted.bytes.fill);
  }
}

TEST_CASE("costs.md has the rows of the table", "[P12]") {
  const std::string page = readTextFile(IBR_COSTS_PAGE);
  for (const Row& row : table()) {
    const auto& e = row.expected;
    const auto& b = e.bytes;
    const std::string line = fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |", row.name,
                                         e.pipelines, e.passes, e.draws, e.dispatches, b.canvases, b.fill, b.colours,
                                         b.parameters, b.noise, b.uncertainties, b.gather);
    INFO(line);
    CHECK((row.multiview || page.find(line + '\n') != std::string::npos));
  }
}

TEST_CASE("a renderer for one setting draws the same image as a renderer for all settings", "[P12]") {
  std::vector<std::pair<SyntheticScene, RenderSettings>> cases;
  for (const Row& row : table())
    if (row.views == 1) cases.emplace_back(row.place, row.settings);
  for (const auto& [place, settings] : cases) {
    const GpuScene scene = onDevice(place);
    const FramePlan plan = planOf(place, settings);
    RendererOptions alone = optionsFor(settings, kExtent);
    alone.uncertaintyScene = &place.scene;
    CHECK(pictureOf(scene, plan, alone) == pictureOf(scene, plan,
                                                     {.maxExtent = {80, 80},
                                                      .maxViews = 2,
                                                      .depth = true,
                                                      .colour = ColourSupport::all,
                                                      .overlays = {settings.overlay},
                                                      .floor = true,
                                                      .uncertaintyScene = &place.scene,
                                                      .orders = {settings.order},
                                                      .blends = {BlendMode::blend, BlendMode::dither, BlendMode::mixed},
                                                      .compositions = {settings.composition},
                                                      .maxRenderScale = 1}));
  }
}

TEST_CASE("requirements follow the scene, and every stage has a reason") {
  SyntheticScene place = pinholes({{0, 1, 2}, {0, 3}, {0, 1, 2, 3}});
  place.scene.cells[1].mesh.tier.back() = kTierRejected;
  RenderSettings settings;
  settings.maxTier = kTierFilled;
  settings.colourMapping = ColourMapping::ours;
  RendererOptions options = optionsFor(settings, kExtent);
  const Requirements r = requirementsOf(place.scene, options);
  CHECK((r.cells == 3 && r.cellsByMemberCount[2] == 1 && r.cellsByMemberCount[3] == 1 && r.cellsByMemberCount[4] == 1));
  CHECK((r.pinholes == 4 && r.panoramas == 0 && r.mixedCells == 0));
  CHECK((r.colourTables && !r.colourSequence && r.crossFadeOrders && r.depthOrder && !r.painterOrder));
  CHECK(r.maxDrawItems == 3 + 16);
  CHECK_FALSE((r.multiview || !r.overlays.empty() || r.buffers || r.floor));
  Cell backdrop = place.scene.cells[0];
  for (std::uint8_t& tier : backdrop.mesh.tier) tier = kTierConsistent;
  place.scene.backdrops.assign(3, backdrop);
  CHECK(requirementsOf(place.scene, options).maxDrawItems == 3 + 16);  // backdrops are not drawn here
  place.scene.backdrops.clear();
  CHECK(requirementsOf(room(2).scene, options).mixedCells == 1);
  CHECK(requirementsOf(room(3).scene, options).panoramas == 3);
  CHECK_FALSE(requirementsOf(room(3).scene, options).colourTables);
  const auto runs = [&](const std::string& name, const Requirements& of) {
    for (const StageExplanation& stage : explain(of, options)) {
      CHECK(!stage.why.empty());
      if (stage.name == name) return stage.runs;
    }
    FAIL(name);
    return false;
  };
  CHECK(runs("colour tables", r));
  CHECK_FALSE(runs("colour tables", requirementsOf(room(3).scene, options)));
  CHECK(runs("panorama coordinates", requirementsOf(room(3).scene, options)));
  CHECK_FALSE(runs("panorama coordinates", r));
  CHECK((r.fill && runs("hole filling", r)));
  place.scene.nodes[2].maskFile = "masks/2.png";  // masked regions are not filled
  const Requirements masked = requirementsOf(place.scene, options);
  CHECK(masked.masked == 1);
  CHECK_FALSE((masked.fill || runs("hole filling", masked)));
}

TEST_CASE("culling hidden cells changes no pixel") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}, {0, 1, 3}};
  options.samplesPerAxis = 1;
  options.planes.resize(1);  // the wall alone, because no mesh covers the surroundings of a board
  SyntheticScene made = makeScene(options);
  for (Cell& cell : made.scene.cells) cell.mesh.tier.back() = kTierRejected;
  for (std::uint8_t& value : made.photographs[3].values) value = std::uint8_t(value * 3 / 4);
  const GpuScene scene = onDevice(made);
  std::size_t hidden = 0;
  for (const ColourMapping mapping : {ColourMapping::off, ColourMapping::ours})
    for (const double fov : {0.3, 0.7})
      for (const Morph morph : {Morph::ours, Morph::paper})
        for (const double x : {0.4, 0.2, -0.3}) {
          RenderSettings settings = withTiers();
          settings.morph = morph;
          settings.colourMapping = mapping;
          settings.colourProxy = 2;
          settings.colourMinSamples = 16;
          settings.fadeShare = 0;
          settings.renderScale = x < 0 ? 0.6 : 1.0;
          const Camera eye = cameraAt({x, 0.3, 0.1}, x / 3, 0, 200, 150, fov);
          FramePlan plan = planFrame(made.scene, sceneBounds(made.scene), {{eye}, settings});
          const Renderer renderer(testDevice(), scene, optionsFor(settings, {200, 150}));
          const auto picture = [&] {
            Offscreen offscreen(testDevice(), {200, 150});
            return offscreen.render(
                [&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
          };
          const Image8 culled = picture();
          for (PlannedCell& cell : plan.cells) {
            hidden += cell.hidden;
            cell.hidden = false;
            cell.colourTableNeeded = true;
          }
          CHECK(picture() == culled);
        }
  CHECK(hidden > 20);
}
