// SPDX-License-Identifier: Apache-2.0
// Colour mapping of whole frames ([T] §2.5.3): our tables against those of the paper and of the reference
// implementation, scenes with known exposures, and convergence with a still camera.
#include "render/passes/colour_map_pass.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "base/vulkan/submit.h"
#include "gpu/transfer/readback.h"
#include "ibr/metrics.h"
#include "image/blue_noise.h"
#include "reference/colour_reference.h"
#include "reference/stage.h"
#include "shared/cell.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Cells of two photographs each, at the same two positions but turned, in front of a wall. Photographs of cell k have
// exposure k.
struct Exposure {
  double gain, gamma;
};

SyntheticScene exposures(const std::vector<Exposure>& of) {
  SyntheticOptions options;
  for (std::size_t k = 0; k < of.size(); ++k)
    for (double x : {-0.5, 0.5}) options.cameras.push_back(cameraAt({x, 0, 0}, 0.25 * double(k), 0, 240, 180, 0.9));
  for (std::uint32_t k = 0; k < of.size(); ++k) options.cells.push_back({2 * k, 2 * k + 1});
  options.planes = {{{0, 0, -8}, {1, 0, 0}, {0, 1, 0}, 60, 40, 5, 0.5}};
  options.gridStep = 16;
  SyntheticScene place = makeScene(options);
  for (std::size_t n = 0; n < place.photographs.size(); ++n)
    for (std::uint8_t& v : place.photographs[n].values) {
      // Dark enough that no exposure saturates levels that another one resolves.
      const double level = 20 + 0.6 * v;
      v = std::uint8_t(
          std::clamp(std::lround(255 * of[n / 2].gain * std::pow(level / 255, of[n / 2].gamma)), 0l, 255l));
    }
  return place;
}

const std::vector<Exposure> kPlanted{{1, 1}, {0.75, 1.1}, {1.3, 0.95}};

RenderSettings mapped(ColourMapping mapping) {
  RenderSettings settings;
  settings.colourMapping = mapping;
  settings.colourProxy = 1;
  settings.colourSamples = 1;
  settings.colourMinSamples = 64;
  settings.fadeShare = 0;
  return settings;
}

const RendererOptions kOptions{.colour = ColourSupport::all, .blends = {BlendMode::blend}};

// The passes alone, with a canvas that holds one full-size tile a cell.
class Passes {
 public:
  Passes(const SyntheticScene& place, std::uint32_t capacity = 0) : Passes(place, capacity, Uploader(testDevice())) {}
  Passes(const SyntheticScene& place, std::uint32_t capacity, Uploader&& uploader)
      : place_(place),
        bounds_(sceneBounds(place_.scene)),
        scene_(testDevice(), place_.scene, {.source = photographsOf(place_)}),
        canvas_(testDevice(), {640, 480}, ColourMapPass::canvasUse(ColourSupport::all)),
        tables_(testDevice(), capacity ? capacity : std::uint32_t(place_.scene.cells.size()), uploader),
        cells_(testDevice(), scene_, canvas_.renderPass(), kOptions, requirementsOf(place_.scene, kOptions), uploader,
               tables_.tables()),
        pass_(testDevice(), tables_, cells_, canvas_, kOptions) {
    uploader.flush();
  }

  FramePlan plan(const Camera& view, const RenderSettings& settings) const {
    return planFrame(place_.scene, bounds_, {{view}, settings});
  }
  VkExtent2D extentOf(const FramePlan& plan) const {
    return {std::uint32_t(plan.views[0].intrinsics.width), std::uint32_t(plan.views[0].intrinsics.height)};
  }
  shader::ColourFrame frameOf(const FramePlan& plan) const {
    return ColourMapPass::frameOf(plan, extentOf(plan), canvas_.largest());
  }

  // Makes the tables. Afterwards the canvas holds the proxy image.
  void makeTables(const FramePlan& plan) {
    const PlanDraws draws(stateOf(scene_), plan);
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      cells_.update(commands, draws);
      pass_.makeTables(commands, draws, 0, extentOf(plan));
    });
  }
  // Draws the whole frame. Afterwards the canvas holds the image.
  void draw(const FramePlan& plan) {
    const bool ours = plan.settings.colourMapping == ColourMapping::ours;
    const PlanDraws draws(stateOf(scene_), plan);
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      cells_.update(commands, draws);
      if (ours) pass_.makeTables(commands, draws, 0, extentOf(plan));
      if (!ours) return pass_.drawSequence(commands, draws, extentOf(plan));
      canvas_.begin(commands, extentOf(plan), {0, 0, 0, 0});
      cells_.draw(commands, draws, Order::current, 0, extentOf(plan));
      canvas_.end(commands);
    });
  }

  Image8 canvas(VkExtent2D extent) const {
    const std::vector<std::byte> bytes = readImage(testDevice(), canvas_.colour(), extent, 4, use::kSampled);
    Image8 picture(int(extent.width), int(extent.height), 4);
    std::memcpy(picture.values.data(), bytes.data(), bytes.size());
    return picture;
  }
  Image8 picture(const FramePlan& plan) {
    draw(plan);
    return canvas(extentOf(plan));
  }
  std::vector<Image8> tiles(const FramePlan& plan) const {
    const shader::ColourFrame frame = frameOf(plan);
    const Image8 atlas = canvas(canvas_.largest());
    std::vector<Image8> all;
    for (std::uint32_t k = 0; k < frame.count; ++k) {
      Image8& tile = all.emplace_back(int(frame.tileWidth), int(frame.tileHeight), 4);
      const int x0 = int(k % frame.tileColumns * frame.tileWidth), y0 = int(k / frame.tileColumns * frame.tileHeight);
      for (int y = 0; y < tile.height; ++y)
        std::copy_n(atlas.pixel(x0, y0 + y).data(), 4 * tile.width, tile.pixel(0, y).data());
    }
    return all;
  }
  std::vector<reference::CellTable> tables(const FramePlan& plan) const {
    const std::vector<std::byte> bytes = readBuffer(testDevice(), tables_.tablesBuffer());
    std::vector<std::uint32_t> entries(bytes.size() / 4);
    std::memcpy(entries.data(), bytes.data(), bytes.size());
    std::vector<reference::CellTable> all;
    for (const PlannedCell& cell : plan.cells) {
      reference::CellTable& table = all.emplace_back();
      for (std::uint32_t i = 0; i < 256; ++i)
        for (std::uint32_t c = 0; c < 3; ++c)
          table[c][i] = std::uint8_t(shader::packedLevel(entries[cell.colourSlot * 256 + i], c));
    }
    return all;
  }
  const ColourTables& colourTables() const { return tables_; }

 private:
  SyntheticScene place_;
  SceneBounds bounds_;
  GpuScene scene_;
  Canvas canvas_;
  ColourTables tables_;
  CellPass cells_;
  ColourMapPass pass_;
};

Camera middle(int width = 160, int height = 120) {
  return cameraAt({0.1, 0, 0}, 0.2, 0, width, height, 0.9);
}

// Tables of the reference implementation for the same tiles. Inputs come from the device, the tables do not.
std::vector<reference::CellTable> ref(const std::vector<Image8>& tiles, const RenderSettings& settings,
                                      const shader::ColourFrame& frame) {
  return reference::tables(
      {tiles, blueNoise(shader::kNoiseSize, 1), frame.kept, frame.method, settings.colourMinSamples});
}

// Mean |difference|, in 8-bit levels, between each cell and the cell that owns the pixel, both after their tables.
double overlapDifference(const std::vector<Image8>& tiles, const std::vector<reference::CellTable>& tables) {
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < tiles[0].height; ++y)
    for (int x = 0; x < tiles[0].width; ++x) {
      std::size_t owner = 0;
      while (owner < tiles.size() && tiles[owner].pixel(x, y)[3] == 0) ++owner;
      for (std::size_t k = owner + 1; k < tiles.size(); ++k)
        for (std::size_t c = 0; tiles[k].pixel(x, y)[3] != 0 && c < 3; ++c, ++count)
          sum += std::abs(tables[k][c][tiles[k].pixel(x, y)[c]] - tables[owner][c][tiles[owner].pixel(x, y)[c]]);
    }
  REQUIRE(count > 3000);
  return sum / double(count);
}

std::vector<reference::CellTable> identities(std::size_t count) {
  reference::CellTable table;
  table.fill(identityTable());
  return std::vector<reference::CellTable>(count, table);
}

}  // namespace

TEST_CASE("tables of the proxy equal the reference implementation and undo planted exposures", "[N9]") {
  Passes passes(exposures(kPlanted));
  for (int proxy : {1, 2, 4})
    for (ColourTable method : {ColourTable::naive, ColourTable::strict, ColourTable::preserving})
      for (double samples : {0.5, 1.0}) {
        RenderSettings settings = mapped(ColourMapping::ours);
        settings.colourProxy = proxy;
        settings.colourTable = method;
        settings.colourSamples = samples;
        settings.colourMinSamples = 32;
        const FramePlan plan = passes.plan(middle(320, 240), settings);
        REQUIRE(plan.cells.size() == 3);
        INFO("proxy " << proxy << ", method " << int(method) << ", samples " << samples);
        passes.makeTables(plan);
        const std::vector<Image8> tiles = passes.tiles(plan);
        const std::vector<reference::CellTable> tables = passes.tables(plan);
        CHECK(tables == ref(tiles, settings, passes.frameOf(plan)));
        if (proxy == 4) continue;  // an overlap of few samples: checked against the reference, not for accuracy
        CHECK(overlapDifference(tiles, identities(3)) > 15);
        CHECK(overlapDifference(tiles, tables) <= 1.5);
      }
}

TEST_CASE("the proxy samples texture at the detail of the full image") {
  // Decimated pixels keep the spread of levels; averaged pixels would not.
  Passes passes(exposures({{1, 1}}));
  RenderSettings settings = mapped(ColourMapping::ours);
  Camera far = cameraAt({0, 0, 3}, 0, 0, 160, 120, 0.9);
  settings.extrapolationLimit = 100;
  // A single cell gets no proxy, so the scene has a second cell.
  Passes pair(exposures({{1, 1}, {1, 1}}));
  const auto spread = [&](int proxy) {
    settings.colourProxy = proxy;
    const FramePlan plan = pair.plan(far, settings);
    pair.makeTables(plan);
    const Image8 tile = pair.tiles(plan)[0];
    double sum = 0, squares = 0, count = 0;
    for (int y = 0; y < tile.height; ++y)
      for (int x = 0; x < tile.width; ++x)
        if (tile.pixel(x, y)[3] != 0) {
          const double v = tile.pixel(x, y)[0];
          sum += v, squares += v * v, ++count;
        }
    REQUIRE(count > 100);
    return std::sqrt(squares / count - sum / count * (sum / count));
  };
  CHECK(spread(8) == Approx(spread(1)).epsilon(0.1));
}

TEST_CASE("our colour mapping and the paper's two methods give the same tables and image", "[N9][T17]") {
  Passes passes(exposures(kPlanted), 64);
  for (double samples : {1.0, 0.5})
    for (ColourTable method : {ColourTable::naive, ColourTable::preserving}) {
      INFO("samples " << samples << ", method " << int(method));
      RenderSettings settings = mapped(ColourMapping::ours);
      settings.colourSamples = samples;
      settings.colourTable = method;
      const FramePlan ours = passes.plan(middle(), settings);
      const Image8 oursPicture = passes.picture(ours);
      const std::vector<reference::CellTable> oursTables = passes.tables(ours);
      CHECK(oursTables != identities(3));
      for (ColourMapping mapping : {ColourMapping::paper, ColourMapping::paperRedraw}) {
        settings.colourMapping = mapping;
        const FramePlan paper = passes.plan(middle(), settings);
        const std::vector<std::byte> before = readBuffer(testDevice(), passes.colourTables().counters());
        const Image8 picture = passes.picture(paper);
        CHECK(passes.tables(paper) == oursTables);
        CHECK(picture == oursPicture);
        // The fragment stage counts only into the histograms of three cells.
        const std::vector<std::byte> after = readBuffer(testDevice(), passes.colourTables().counters());
        const auto used = std::ptrdiff_t(4 * shader::counterCount(3, false));
        CHECK(std::equal(before.begin() + used, before.end(), after.begin() + used));
      }
    }
}

TEST_CASE("rejected triangles are neither drawn nor counted by any mapping method") {
  SyntheticScene place = exposures(kPlanted), without = place;
  for (std::size_t c = 0; c < place.scene.cells.size(); ++c) {
    MorphMesh &mesh = place.scene.cells[c].mesh, &rest = without.scene.cells[c].mesh;
    const std::size_t kept = mesh.triangles.size() * 2 / 3;
    for (std::size_t t = kept; t < mesh.triangles.size(); ++t) mesh.tier[t] = kTierRejected;
    rest.triangles.resize(kept);
    rest.tier.resize(kept);
    rest.ecc.resize(kept);
  }
  Passes passes(place), expected(without), whole(exposures(kPlanted));
  for (const ColourMapping mapping : {ColourMapping::ours, ColourMapping::paper, ColourMapping::paperRedraw}) {
    INFO("mapping " << int(mapping));
    const RenderSettings settings = mapped(mapping);
    const FramePlan plan = passes.plan(middle(), settings), same = expected.plan(middle(), settings);
    const Image8 picture = passes.picture(plan);
    CHECK(picture == expected.picture(same));
    CHECK(passes.tables(plan) == expected.tables(same));
    CHECK(picture != whole.picture(whole.plan(middle(), settings)));
  }
}

TEST_CASE("cells without an accepted triangle keep the identity table, and tiny images are drawn") {
  SyntheticScene place = exposures(kPlanted);
  for (std::uint8_t& tier : place.scene.cells[1].mesh.tier) tier = kTierRejected;
  Passes passes(place);
  for (ColourMapping mapping : {ColourMapping::ours, ColourMapping::paper, ColourMapping::paperRedraw}) {
    const FramePlan plan = passes.plan(middle(), mapped(mapping));
    passes.draw(plan);
    const std::vector<reference::CellTable> tables = passes.tables(plan);
    for (std::size_t k = 0; k < plan.cells.size(); ++k)
      if (plan.cells[k].cell == 1) CHECK(tables[k] == identities(1)[0]);
    const FramePlan tiny = passes.plan(middle(1, 1), mapped(mapping));
    CHECK(passes.picture(tiny).values.size() == 4);
  }
}

TEST_CASE("colour mapping removes seams between cells and keeps photographs of the main cell") {
  const Stage stage(testDevice(), exposures(kPlanted));
  RenderSettings settings = mapped(ColourMapping::ours);
  settings.colourProxy = 2;
  const Stage plain(testDevice(), exposures({{1, 1}, {1, 1}, {1, 1}}));
  const Camera view = middle(320, 240);
  // All cells adopt the main cell's exposure. The truth is the scene generated with that one exposure.
  const FramePlan plan = stage.plan(view, settings);
  const std::uint32_t main = plan.cells[0].cell;
  const Stage oneExposure(testDevice(), exposures({kPlanted[main], kPlanted[main], kPlanted[main]}));
  const Image8 truth = oneExposure.render(view), mappedPicture = stage.render(view, settings);
  const Image8 unmapped = stage.render(view);
  CHECK(difference(unmapped, truth, 0).meanAbsolute > 3);
  CHECK(difference(mappedPicture, truth, 0).meanAbsolute < 0.6);
  for (std::size_t node : {0u, 3u}) {
    const Camera& camera = stage.scene().nodes[node].camera;
    const Image8 picture = stage.render(camera, settings);
    REQUIRE(stage.plan(camera, settings).cells[0].cell == node / 2);
    CHECK(difference(picture, stage.place().photographs[node], 1).shareAbove < 0.25);
  }
}

TEST_CASE("a still camera repeats the same image once colour tables have converged", "[P3]") {
  const SyntheticScene place = exposures(kPlanted);
  const SceneBounds bounds = sceneBounds(place.scene);
  GpuScene scene(testDevice(), place.scene, {.source = photographsOf(place)});
  for (ColourMapping mapping : {ColourMapping::ours, ColourMapping::paper}) {
    RenderSettings settings = mapped(mapping);
    settings.colourProxy = 2;
    const Renderer renderer(testDevice(), scene, {.maxExtent = {160, 120}, .colour = ColourSupport::all});
    Offscreen offscreen(testDevice(), {160, 120});
    PlanState state;
    const auto frame = [&](const Camera& view) {
      const FramePlan plan = planFrame(place.scene, bounds, {{view}, settings, 0.05}, state);
      state = plan.next;
      return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
    };
    Camera view = middle();
    const Image8 first = frame(view);
    CHECK(frame(view) == first);  // the first frame shows the target tables at once
    view.pose = cameraAt({0.2, 0, 0}, 0.5).pose;
    const std::int64_t mainBefore = state.mainCell;
    for (int i = 0; i < 120; ++i) frame(view);
    CHECK(state.mainCell != mainBefore);
    const Image8 rest = frame(view);
    for (int i = 0; i < 3; ++i) CHECK(frame(view) == rest);
    // The converged image equals that of a renderer without previous frames.
    state = {};
    CHECK(frame(view) == rest);
  }
}

TEST_CASE("a switch of the main cell changes the mean colour of an image only a little") {
  const SyntheticScene place = exposures(kPlanted);
  const SceneBounds bounds = sceneBounds(place.scene);
  GpuScene scene(testDevice(), place.scene, {.source = photographsOf(place)});
  const Renderer renderer(testDevice(), scene, {.maxExtent = {160, 120}, .colour = ColourSupport::ours});
  Offscreen offscreen(testDevice(), {160, 120});
  RenderSettings settings = mapped(ColourMapping::ours);
  settings.colourProxy = 2;
  PlanState state;
  Image8 before;
  double largest = 0, withoutFade = 0;
  for (const bool fade : {true, false}) {
    settings.colourFadeSeconds = fade ? 1 : 0;
    settings.colourSmoothSeconds = fade ? 0.15 : 0;
    settings.colourMaxSpeed = fade ? 120 : 1e6;
    settings.switchSeconds = 0;
    state = {};
    before = {};
    int switches = 0;
    for (int i = 0; i <= 30; ++i) {
      const std::int64_t main = state.mainCell;
      const Camera view = cameraAt({0.1, 0, 0}, 0.06 + 0.004 * i, 0, 160, 120, 0.9);
      const FramePlan plan = planFrame(place.scene, bounds, {{view}, settings, 1.0 / 60}, state);
      state = plan.next;
      switches += main >= 0 && main != state.mainCell;
      const Image8 picture =
          offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
      double mean = 0, meanBefore = 0;
      for (std::size_t at = 0; at < picture.values.size(); ++at) {
        mean += picture.values[at];
        if (!before.values.empty()) meanBefore += before.values[at];
      }
      if (i > 0)
        (fade ? largest : withoutFade) =
            std::max(fade ? largest : withoutFade, std::abs(mean - meanBefore) / double(picture.values.size()));
      before = picture;
    }
    CHECK(switches == 1);
  }
  CHECK(withoutFade > 5);
  CHECK(largest < 1.5);
}

TEST_CASE("two views share colour tables in all mapping methods") {
  const SyntheticScene place = exposures(kPlanted);
  const SceneBounds bounds = sceneBounds(place.scene);
  GpuScene scene(testDevice(), place.scene, {.source = photographsOf(place)});
  const Renderer renderer(testDevice(), scene, {.maxExtent = {160, 120}, .maxViews = 2, .colour = ColourSupport::all});
  for (ColourMapping mapping : {ColourMapping::ours, ColourMapping::paper, ColourMapping::paperRedraw}) {
    RenderSettings settings = mapped(mapping);
    settings.colourProxy = 2;
    const FramePlan plan = planFrame(place.scene, bounds, {{middle(), middle()}, settings}, {});
    Offscreen left(testDevice(), {160, 120}), right(testDevice(), {160, 120});
    const std::array targets{left.target(), right.target()};
    const Image8 first = left.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); });
    const Image8 second = right.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); });
    CHECK(first == second);
  }
}

TEST_CASE("colour mapping barely changes photographs of equal exposure") {
  const Stage stage(testDevice(), exposures({{1, 1}, {1, 1}, {1, 1}}));
  const Camera view = middle(320, 240);
  RenderSettings settings = mapped(ColourMapping::ours);
  settings.colourProxy = 2;
  CHECK(difference(stage.render(view, settings), stage.render(view), 2).meanAbsolute < 0.25);
}

TEST_CASE("colour mapping has the counted cost, and none for a single cell") {
  const SyntheticScene place = exposures(kPlanted);
  const SceneBounds bounds = sceneBounds(place.scene);
  GpuScene scene(testDevice(), place.scene, {.source = photographsOf(place)});
  const auto counters = [&](ColourSupport support, ColourMapping mapping) {
    const Renderer renderer(testDevice(), scene,
                            {.maxExtent = {160, 120},
                             .fill = false,
                             .colour = support,
                             .formats = {VK_FORMAT_R8G8B8A8_UNORM},
                             .blends = {BlendMode::blend}});
    return renderer.count(planFrame(place.scene, bounds, {{middle()}, mapped(mapping)}, {}));
  };
  const auto off = counters(ColourSupport::off, ColourMapping::off);
  const auto idle = counters(ColourSupport::ours, ColourMapping::off);
  const auto ours = counters(ColourSupport::ours, ColourMapping::ours);
  const auto paper = counters(ColourSupport::all, ColourMapping::paper);
  const auto redraw = counters(ColourSupport::all, ColourMapping::paperRedraw);
  CHECK(off.pipelines == 2 + 2);           // cells with and without dissolving; composition with and without mixing
  CHECK(ours.pipelines == 4 + 2 + 2 + 2);  // cells also mapped; proxy with and without dissolving; count, tables
  CHECK(paper.pipelines == ours.pipelines + 4 + 4 + 1);  // cells without depth; count and redraw; apply
  CHECK(ours.workingBytes == off.workingBytes);          // the proxy uses the canvas
  CHECK(paper.workingBytes >= off.workingBytes + 160 * 120 * 4);
  CHECK((idle.passes == off.passes && idle.draws == off.draws && idle.dispatches == 0));
  CHECK((off.passes == 2 && off.draws == 4 && off.dispatches == 0));
  CHECK((ours.passes == 3 && ours.draws == 7 && ours.dispatches == 2));
  CHECK((paper.passes == 4 && paper.draws == 4 && paper.dispatches == 3 + 2));
  CHECK((redraw.passes == 6 && redraw.draws == 6 && redraw.dispatches == 3));
  CHECK(ours.triangles == 2 * off.triangles - 1);

  const SyntheticScene one = exposures({{1, 1}});
  GpuScene alone(testDevice(), one.scene, {.source = photographsOf(one)});
  const Renderer renderer(testDevice(), alone,
                          {.maxExtent = {160, 120},
                           .fill = false,
                           .colour = ColourSupport::all,
                           .formats = {VK_FORMAT_R8G8B8A8_UNORM},
                           .blends = {BlendMode::blend}});
  Offscreen offscreen(testDevice(), {160, 120});
  Image8 unmapped;
  for (ColourMapping mapping :
       {ColourMapping::off, ColourMapping::ours, ColourMapping::paper, ColourMapping::paperRedraw}) {
    const FramePlan plan = planFrame(one.scene, sceneBounds(one.scene), {{middle()}, mapped(mapping)}, {});
    const auto counted = renderer.count(plan);
    CHECK((counted.pipelines == 2 + 1 && counted.passes == 2 && counted.draws == 2 && counted.dispatches == 0));
    const Image8 picture =
        offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
    if (mapping == ColourMapping::off) unmapped = picture;
    CHECK(picture == unmapped);
  }
}
