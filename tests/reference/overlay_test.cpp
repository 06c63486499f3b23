// SPDX-License-Identifier: Apache-2.0
// Overlays over or in place of the image: the wireframe of [T] fig. 4, and all overlays of shared/overlay.h.
#include "shared/overlay.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "ibr/metrics.h"
#include "reference/cell_pass_reference.h"
#include "reference/gather_device.h"
#include "reference/morph.h"
#include "reference/stage.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr std::array kAll{Overlay::wireframe, Overlay::tiers,   Overlay::weights,  Overlay::confidence,
                          Overlay::depth,     Overlay::overlap, Overlay::agreement};

RenderSettings with(Overlay overlay, RenderSettings settings = withTiers()) {
  settings.overlay = overlay;
  return settings;
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  return glm::distance(p, a + t * (b - a));
}

double distance(std::span<const std::uint8_t> pixel, shader::vec3 colour) {
  double most = 0;
  for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(pixel[std::size_t(c)] - 255.0 * double(colour[c])));
  return most;
}

bool is(std::span<const std::uint8_t> pixel, shader::vec3 colour) {
  return distance(pixel, colour) <= 1;
}

// CIE L* of a display-encoded colour.
double lightness(shader::vec3 colour) {
  const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  const double y =
      0.2126 * linear(double(colour.x)) + 0.7152 * linear(double(colour.y)) + 0.0722 * linear(double(colour.z));
  return 116 * std::cbrt(y) - 16;
}

// Two cells with rejected triangles, which leave holes, and photographs that all differ. Made once, because generating
// them takes longer than rendering an image.
const SyntheticScene& richScene() {
  static const SyntheticScene place = [] {
    SyntheticScene made = twoCells();
    for (std::size_t i = 0; i < made.photographs.size(); ++i) {
      Image8& photograph = made.photographs[i];
      for (int y = 0; y < photograph.height; ++y)
        for (int x = 0; x < photograph.width; ++x)  // noise of varying strength
          for (std::uint8_t& v : photograph.pixel(x, y))
            v = std::uint8_t(v / 2 + 20 * i + (x / 40 % 2 == 0 ? std::size_t(x * 7919 + y * 104729) % 50 : 0));
    }
    for (Cell& cell : made.scene.cells)
      for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p)
        cell.mesh.uncertainty[p] = cell.mesh.inverseDistance[p] * std::pow(10.0f, -float(p % 7) / 2);
    for (Cell& cell : made.scene.cells)
      for (std::size_t t = 0; t < cell.mesh.triangles.size(); ++t)
        if (t % 16 > 12) cell.mesh.tier[t] = kTierRejected;
    return made;
  }();
  return place;
}

// A view of two cells and of holes.
Camera richView() {
  return cameraAt({0.6, 0.4, 0.2}, 0.25, 0.1, 240, 180);
}

// Colour that an overlay shows at a pixel, from the reference implementation.
shader::vec3 expected(const reference::RenderedImage& ref, const FramePlan& plan, std::size_t at) {
  const reference::BufferValues& known = ref.known[at];
  const shader::vec3 picture(ref.colour[at]);
  shader::vec3 members(0.0f);
  for (int i = 0; i < 4; ++i) members += float(known.shares[std::size_t(i)]) * shader::memberColour(i);
  switch (plan.settings.overlay) {
    case Overlay::tiers:
      return shader::tinted(shader::tierColour(std::uint32_t(known.tier)), picture);
    case Overlay::weights:
      return shader::tinted(members, picture);
    case Overlay::confidence:
      return shader::confidenceColour(float(known.inverseDistance), float(known.uncertainty));
    case Overlay::depth:
      return shader::depthColour(float(1 / known.depth), float(plan.nearDistance));
    case Overlay::overlap:
      return shader::overlapColour(ref.overlap[at]);
    case Overlay::agreement:
      return shader::agreementColour(float(known.agreement));
    default:
      return picture;
  }
}

// Colour that an overlay shows at a gathered pixel, from the buffers. For cell pixels: tiers, weights and depth.
shader::vec3 gatheredOverlay(Overlay overlay, shader::vec3 picture, const FrameBuffers& buffers, glm::ivec2 at,
                             float nearDistance) {
  const auto surface = buffers.surface.pixel(at.x, at.y), weights = buffers.weights.pixel(at.x, at.y);
  const float inverseDepth = 1 / surface[0];
  shader::vec3 members(0.0f);
  for (int i = 0; i < 4; ++i) members += weights[std::size_t(i)] * shader::memberColour(i);
  switch (overlay) {
    case Overlay::tiers:
      return shader::tinted(shader::tierColour(std::uint32_t(surface[1])), picture);
    case Overlay::weights:
      return shader::tinted(members, picture);
    case Overlay::confidence:
      return shader::confidenceColour(inverseDepth, buffers.confidence.pixel(at.x, at.y)[1]);
    case Overlay::depth:
      return shader::depthColour(inverseDepth, nearDistance);
    case Overlay::agreement:
      return shader::unknownColour();
    default:
      return picture;
  }
}

}  // namespace

TEST_CASE("wireframe edges have the colour of their cell's rank, and other pixels are unchanged") {
  SyntheticOptions options = place(3);
  options.planes.resize(1);  // no surface hides an edge
  options.gridStep = 40;
  for (const Morph morph : {Morph::ours, Morph::paper}) {
    const Stage stage(testDevice(), makeScene(options));
    RenderSettings settings = withTiers();
    settings.morph = morph;
    const Camera view = cameraAt({0.45, 0.3, 0.1}, 0.05);
    const Image8 plain = stage.render(view, settings);
    const FramePlan plan = stage.plan(view, with(Overlay::wireframe, settings));
    const Image8 picture = stage.render(plan);

    // Expected edges, from the reference implementation of the morph.
    const Cell& cell = stage.scene().cells[0];
    std::vector<std::pair<glm::dvec2, glm::dvec2>> edges;
    for (const glm::uvec3& t : cell.mesh.triangles) {
      glm::dvec2 corner[3];
      for (int v = 0; v < 3; ++v)
        corner[v] = *project(
            view.intrinsics,
            glm::conjugate(view.pose.rotation) *
                reference::morph(stage.scene(), cell, t[v], plan.cells[0].view[0].position, morph, view.pose.position));
      for (int v = 0; v < 3; ++v) edges.emplace_back(corner[v], corner[(v + 1) % 3]);
    }
    const shader::vec3 yellow = shader::rankColour(0, 1);
    std::size_t on = 0, off = 0, wrongOn = 0, wrongOff = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        if (plain.pixel(x, y)[3] == 0) continue;
        wrongOff += picture.pixel(x, y)[3] != plain.pixel(x, y)[3];
        double nearest = 1e9;
        for (const auto& [a, b] : edges) nearest = std::min(nearest, distanceToSegment({x + 0.5, y + 0.5}, a, b));
        for (int c = 0; c < 3; ++c) {
          if (nearest < 0.2) {
            ++on;
            wrongOn += std::abs(picture.pixel(x, y)[c] - 255 * yellow[c]) > 2;
          } else if (nearest > 1.5) {
            ++off;
            wrongOff += picture.pixel(x, y)[c] != plain.pixel(x, y)[c];
          }
        }
      }
    INFO("morph " << int(morph));
    CHECK(on > 1000);
    CHECK(off > 10000);
    CHECK(double(wrongOn) < 0.01 * double(on));
    CHECK(double(wrongOff) < 0.001 * double(off));
  }
}

TEST_CASE("colours of ranks darken, and edges of the better cell hide other edges") {
  const auto brightness = [](shader::vec3 c) { return c.x + c.y + c.z; };
  for (int ranks : {2, 5, 12})
    for (int r = 1; r < ranks; ++r)
      CHECK(brightness(shader::rankColour(float(r), float(ranks))) <
            brightness(shader::rankColour(float(r - 1), float(ranks))));
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  const Image8 ours = stage.render(cameraAt({0.6, 0.4, 0.2}, 0.1), with(Overlay::wireframe));
  std::size_t seen[2] = {};
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x)
      for (int r = 0; r < 2; ++r) seen[r] += distance(ours.pixel(x, y), shader::rankColour(float(r), 2)) <= 2;
  CHECK(seen[0] > 200);
  CHECK(seen[1] > 20);
}

TEST_CASE("overlay scales brighten evenly, and category colours differ") {
  const auto evenly = [](auto colour, double from, double to, double least, double most) {
    constexpr int kSteps = 64;
    for (int i = 0; i < kSteps; ++i) {
      const auto at = [&](int step) { return lightness(colour(float(from + (to - from) * step / kSteps))); };
      const double rise = at(i + 1) - at(i);
      if (rise < least || rise > most) FAIL("a step of " << rise << " at " << i);
    }
  };
  evenly(shader::rampColour, 0, 1, 0.6, 1.6);
  CHECK(lightness(shader::rampColour(0)) < 20);
  CHECK(lightness(shader::rampColour(1)) > 85);
  evenly([](float t) { return shader::confidenceColour(1, shader::kMaxUncertainty * std::pow(0.001f, t)); }, 0, 1, 0.6,
         1.6);
  evenly([](float t) { return shader::depthColour(std::exp2(-11 + 8 * t), 1); }, 0, 1, 0.6, 1.6);
  evenly(shader::agreementColour, 0, 1, 0.6, 1.6);
  for (int n = 0; n < 21; ++n) {
    INFO(n << " cells");
    CHECK(lightness(shader::overlapColour(n + 1)) > lightness(shader::overlapColour(n)));
  }
  const auto differ = [](std::vector<shader::vec3> colours) {
    for (std::size_t i = 0; i < colours.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) CHECK(glm::distance(colours[i], colours[j]) > 0.3f);
  };
  differ({shader::tierColour(0), shader::tierColour(2), shader::tierColour(3)});
  differ({shader::memberColour(0), shader::memberColour(1), shader::memberColour(2), shader::memberColour(3)});
}

TEST_CASE("overlays equal the reference implementation") {
  const Stage stage(testDevice(), richScene());
  for (const Overlay overlay :
       {Overlay::tiers, Overlay::weights, Overlay::confidence, Overlay::depth, Overlay::overlap, Overlay::agreement})
    for (const BlendMode blend : {BlendMode::blend, BlendMode::dither, BlendMode::mixed}) {
      if (blend != BlendMode::blend && overlay != Overlay::weights) continue;
      RenderSettings settings = with(overlay);
      settings.blend = blend;
      const FramePlan plan = stage.plan(richView(), settings);
      const Image8 picture = stage.render(plan);
      const reference::RenderedImage ref = reference::render(stage.scene(), stage.textures(), plan);
      std::size_t compared = 0, wrong = 0, wrongTier = 0;
      std::set<std::uint32_t> colours;
      for (int y = 0; y < ref.height; ++y)
        for (int x = 0; x < ref.width; ++x) {
          const std::size_t at = std::size_t(y) * std::size_t(ref.width) + std::size_t(x);
          if (!ref.safe[at] || ref.known[at].tier < 0) continue;
          ++compared;
          const auto pixel = picture.pixel(x, y);
          wrongTier += pixel[3] != std::lround(ref.colour[at].a * 255);
          colours.insert(std::uint32_t(pixel[0]) << 16 | std::uint32_t(pixel[1]) << 8 | pixel[2]);
          wrong += distance(pixel, expected(ref, plan, at)) > (overlay == Overlay::agreement ? 12 : 4);
        }
      INFO("overlay " << int(overlay) << ", blending " << int(blend));
      CHECK(compared > 15000);
      CHECK(colours.size() >= (overlay == Overlay::overlap ? 2 : 20));  // one cell or two
      CHECK(double(wrong) <= 0.01 * double(compared));
      CHECK(wrongTier == 0);
    }
}

TEST_CASE("the agreement overlay compares photographs with their gains") {
  SyntheticScene made = richScene();
  for (std::size_t n = 0; n < made.scene.nodes.size(); ++n)
    made.scene.nodes[n].gain = std::array<glm::dvec3, 3>{{{0.05, 6, 0.1}, {1, 1, 1}, {8, 0.1, 2}}}[n % 3];
  const Stage stage(testDevice(), made);
  RenderSettings settings = with(Overlay::agreement);
  settings.exposure = Exposure::scene;
  const FramePlan plan = stage.plan(richView(), settings);
  const Image8 picture = stage.render(plan);
  const reference::RenderedImage ref = reference::render(stage.scene(), stage.textures(), plan);
  std::size_t compared = 0, wrong = 0;
  for (int y = 0; y < ref.height; ++y)
    for (int x = 0; x < ref.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(ref.width) + std::size_t(x);
      if (!ref.safe[at] || ref.known[at].tier != 0) continue;
      ++compared;
      wrong += distance(picture.pixel(x, y), expected(ref, plan, at)) > 12;
    }
  CHECK(compared > 5000);
  CHECK(double(wrong) <= 0.02 * double(compared));
}

TEST_CASE("overlays keep the tiers of the image in both draw orders") {
  const Stage stage(testDevice(), richScene());
  for (const Camera& view : {richView(), cameraAt({-1.9, 0.4, 0.2}, -0.1, 0, 240, 180)}) {  // inside, and fading out
    const Image8 plain = stage.render(view, withTiers());
    for (const Overlay overlay : kAll) {
      INFO("overlay " << int(overlay));
      const FramePlan plan = stage.plan(view, with(overlay));
      const Image8 picture = stage.render(plan);
      FramePlan painted = plan;
      painted.settings.order = DrawOrder::paper;
      CHECK(difference(stage.render(painted), picture, 2).shareAbove < (overlay == Overlay::overlap ? 1e-9 : 0.02));
      std::size_t wrong = 0, same = 0;
      for (int y = 0; y < plain.height; ++y)
        for (int x = 0; x < plain.width; ++x) {
          wrong += picture.pixel(x, y)[3] != plain.pixel(x, y)[3];
          same += std::ranges::equal(picture.pixel(x, y), plain.pixel(x, y));
        }
      CHECK(wrong == 0);
      CHECK(same < plain.values.size() / 4);
    }
  }
}

TEST_CASE("overlays do not fill holes, except beneath a wireframe") {
  const Stage stage(testDevice(), richScene());
  for (const Overlay overlay : kAll) {
    INFO("overlay " << int(overlay));
    RenderSettings settings = with(overlay);
    settings.background = {0.2f, 0.4f, 0.6f};
    settings.maxTier = kTierFilled;
    const Image8 picture = stage.render(richView(), settings);
    std::size_t holes = 0, filled = 0, wrong = 0;
    const shader::vec3 hole = overlay == Overlay::tiers ? shader::tierColour(3) : settings.background;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        filled += picture.pixel(x, y)[3] == 63;
        if (picture.pixel(x, y)[3] != 0) continue;
        ++holes;
        wrong += !is(picture.pixel(x, y), hole);
      }
    CHECK((overlay == Overlay::wireframe ? filled : holes) > 1000);
    CHECK((overlay == Overlay::wireframe ? holes : filled) == 0);
    CHECK(wrong == 0);
  }
}

TEST_CASE("overlap counts the cells that cover a pixel when drawn alone") {
  const Stage stage(testDevice(), richScene());
  const Camera view = richView();
  FramePlan plan = stage.plan(view, with(Overlay::overlap));
  const Image8 picture = stage.render(plan);
  for (std::size_t c = 1; c < plan.cells.size(); ++c) plan.cells[c].hidden = true;  // hidden cells count as well
  CHECK(stage.render(plan) == picture);
  std::vector<int> shown(picture.values.size() / 4, 0);
  std::size_t counts[3] = {}, wrong = 0;
  for (std::uint32_t c = 0; c < stage.scene().cells.size(); ++c) {
    RenderSettings alone = withTiers();
    alone.soloCells = {c};
    const Image8 one = stage.render(view, alone);
    for (std::size_t at = 0; at < shown.size(); ++at) shown[at] += one.values[4 * at + 3] == 255;
  }
  for (std::size_t at = 0; at < shown.size(); ++at) {
    ++counts[shown[at]];
    if (picture.values[4 * at + 3] > 0)
      wrong += !is(std::span(picture.values).subspan(4 * at, 4), shader::overlapColour(shown[at]));
  }
  CHECK(std::ranges::min(counts) > 500);
  CHECK(wrong == 0);
}

TEST_CASE("tiers and depth overlays equal the buffers") {
  const Stage stage(testDevice(), richScene());
  const FramePlan plan = stage.plan(richView(), with(Overlay::depth));
  const VkExtent2D extent{240, 180};
  const Renderer renderer(
      testDevice(), stage.gpuScene(),
      {.maxExtent = extent, .overlays = {Overlay::tiers, Overlay::depth}, .bufferScene = &stage.scene()});
  OffscreenBuffers floats(testDevice(), extent);
  const FrameBuffers buffers =
      floats.render([&](VkCommandBuffer commands) { renderer.recordBuffers(commands, plan, 0, floats.targets()); });
  const auto picture = [&](Overlay overlay) {
    FramePlan other = plan;
    other.settings.overlay = overlay;
    Offscreen offscreen(testDevice(), extent);
    return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, other, offscreen.target()); });
  };
  const Image8 tiers = picture(Overlay::tiers), depth = picture(Overlay::depth);
  std::size_t wrong = 0, drawn = 0;
  for (int y = 0; y < tiers.height; ++y)
    for (int x = 0; x < tiers.width; ++x) {
      const auto surface = buffers.surface.pixel(x, y);
      if (surface[1] < 0) continue;
      ++drawn;
      wrong += !is(depth.pixel(x, y), shader::depthColour(1 / surface[0], float(plan.nearDistance)));
      // The tier's hue, scaled by any lightness of the image.
      const auto pixel = tiers.pixel(x, y);
      const shader::vec3 colour = shader::tierColour(std::uint32_t(surface[1])), shown(pixel[0], pixel[1], pixel[2]);
      const float light = std::max({shown.x, shown.y, shown.z}) / std::max({colour.x, colour.y, colour.z});
      wrong += !is(pixel, light / 255.0f * colour);
      wrong += light < 0.29f * 255 || light > 255.5f;
    }
  CHECK(drawn > 20000);
  CHECK(wrong == 0);
}

TEST_CASE("the tiers overlay tints the colour-mapped image") {
  const Stage stage(testDevice(), richScene());
  RenderSettings settings = withTiers();
  settings.colourMapping = ColourMapping::ours;
  const Image8 plain = stage.render(richView(), settings),
               tiers = stage.render(richView(), with(Overlay::tiers, settings));
  CHECK(difference(plain, stage.render(richView(), withTiers()), 5).shareAbove > 5e-4);
  std::size_t wrong = 0;
  for (int y = 0; y < plain.height; ++y)
    for (int x = 0; x < plain.width; ++x) {
      const auto pixel = plain.pixel(x, y);
      if (pixel[3] == 0) continue;
      const shader::vec3 picture = shader::vec3(pixel[0], pixel[1], pixel[2]) / 255.0f;
      wrong += distance(tiers.pixel(x, y), shader::tinted(shader::tierColour((255u - pixel[3]) / 64), picture)) > 2;
    }
  CHECK(wrong == 0);
}

TEST_CASE("equal photographs agree, flat photographs are unknown, and different photographs disagree") {
  SyntheticOptions options;
  options.cameras = {cameraAt({0, 0, 0}), cameraAt({1, 0, 0}), cameraAt({0, 1, 0})};
  options.planes = {{{0, 0, -8}, {1, 0, 0}, {0, 1, 0}, 40, 30, 1, 0.3}};
  options.atInfinity = true;  // the same image from any position
  const auto agreement = [&](auto change) {
    SyntheticScene place = makeScene(options);
    for (std::size_t i = 0; i < place.photographs.size(); ++i)
      for (std::size_t v = 0; v < place.photographs[i].values.size(); ++v)
        place.photographs[i].values[v] = change(i, v, place.photographs[i].values[v]);
    return Stage(testDevice(), std::move(place)).render(cameraAt({0.3, 0.3, 0}, 0.02), with(Overlay::agreement));
  };
  const auto share = [](const Image8& picture, auto wanted) {
    std::size_t drawn = 0, right = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        if (picture.pixel(x, y)[3] == 0) continue;
        ++drawn;
        right += wanted(picture.pixel(x, y));
      }
    CHECK(drawn > 30000);
    return double(right) / double(drawn);
  };
  const auto agrees = [](auto pixel) { return distance(pixel, shader::rampColour(1)) <= 3; };
  const auto unknown = [](auto pixel) { return is(pixel, shader::unknownColour()); };
  const auto nearly = [](auto pixel) {
    return lightness(shader::vec3(pixel[0], pixel[1], pixel[2]) / 255.0f) > lightness(shader::rampColour(0.9f));
  };
  const auto opposes = [](auto pixel) { return is(pixel, shader::rampColour(0)); };
  CHECK(share(agreement([](auto, auto, int value) { return std::uint8_t(value); }),
              [&](auto p) { return agrees(p) || unknown(p); }) == 1);
  // Differences of exposure do not change the agreement.
  CHECK(share(agreement([](auto i, auto, int value) { return std::uint8_t(i == 0 ? value : 40 + value / 2); }),
              nearly) > 0.95);
  CHECK(share(agreement([](auto i, auto, int) { return std::uint8_t(80 + 20 * i); }), unknown) == 1);
  // Three photographs, of which one pair agrees and two pairs oppose: correlations 1, −1, −1.
  CHECK(share(agreement([](auto i, auto, int value) { return std::uint8_t(i == 0 ? 255 - value : value); }), opposes) >
        0.95);
  // A flat photograph does not count for the mean.
  CHECK(share(agreement([](auto i, auto, int value) { return std::uint8_t(i == 2 ? 128 : value); }), agrees) > 0.95);
}

TEST_CASE("overlays colour content at infinity, panoramas and empty pixels") {
  SyntheticOptions options = place(2);
  options.atInfinity = true;
  const Stage far(testDevice(), makeScene(options));
  for (const Overlay overlay : {Overlay::depth, Overlay::confidence}) {
    const Image8 picture = far.render(cameraAt({0.4, 0, 0}), with(overlay));
    std::size_t drawn = 0, wrong = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        if (picture.pixel(x, y)[3] == 0) continue;
        ++drawn;
        wrong += !is(picture.pixel(x, y), shader::rampColour(0));
      }
    CHECK(drawn > 20000);
    CHECK(wrong == 0);
  }

  SyntheticOptions room;
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {1, 0, 0.1}, {0.4, 0.8, 0.2}})
    room.cameras.push_back({{CameraModel::equirectangular, 256, 128}, {at, {1, 0, 0, 0}}});
  room.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  room.surfaceStep = 0.5;
  const Stage panoramas(testDevice(), makeScene(room));
  // Exact content also agrees across the seams of all three panoramas.
  const Camera seam = cameraAt({0.4, 0.2, 0.1}, std::numbers::pi, 0, 160, 120);
  const Image8 exact = panoramas.render(seam, with(Overlay::agreement));
  std::size_t high = 0;
  for (int y = 0; y < exact.height; ++y)
    for (int x = 60; x < 100; ++x)
      high += lightness(shader::vec3(exact.pixel(x, y)[0], exact.pixel(x, y)[1], exact.pixel(x, y)[2]) / 255.0f) > 75;
  CHECK(high > 40 * 120 * 8 / 10);

  const Stage rich(testDevice(), richScene());
  const Camera away = cameraAt({0.6, 0.4, 0.2}, std::numbers::pi, 0, 64, 48);
  for (const Overlay overlay : kAll) {
    const Image8 nothing = rich.render(away, with(overlay));
    for (int y = 0; y < nothing.height; ++y)
      for (int x = 0; x < nothing.width; ++x)
        if (!is(nothing.pixel(x, y), overlay == Overlay::tiers ? shader::tierColour(3) : shader::vec3(0.0f)))
          FAIL("overlay " << int(overlay));
  }
}

TEST_CASE("each of two views has its overlay, and the previous draw order is cross-faded") {
  const Stage stage(testDevice(), richScene());
  const Camera left = richView();
  Camera right = left;
  right.pose.position.x += 0.06;
  const SceneBounds bounds = sceneBounds(stage.scene());
  for (const Overlay overlay : {Overlay::depth, Overlay::overlap}) {
    const FramePlan both = planFrame(stage.scene(), bounds, {{left, right}, with(overlay)});
    const std::vector<Image8> pictures = stage.renderViews(both);
    for (std::size_t v = 0; v < 2; ++v) {
      FramePlan one = both;
      one.views = {both.views[v]};
      for (PlannedCell& cell : one.cells) cell.view[0] = both.cells[std::size_t(&cell - one.cells.data())].view[v];
      CHECK(difference(stage.render(one), pictures[v], 2).shareAbove < (v == 0 ? 1e-9 : 0.02));
    }
  }
  FramePlan switching = stage.plan(left, with(Overlay::tiers));
  switching.previous = switching.cells;
  switching.previousWeight = 0.5;
  CHECK(difference(stage.render(switching), stage.render(left, with(Overlay::tiers)), 2).shareAbove < 0.3);
}

TEST_CASE("overlays of a gathered or hybrid image equal its buffers") {
  // No second photograph confirms the left part of each photograph.
  GatherOptions options = wallOptions();
  options.evidence = [](std::size_t, glm::dvec2 pixel) { return pixel.x < 60 ? Evidence{0, 0.1f} : Evidence{}; };
  GatherStage stage = gatherStage(options);
  addCell(stage, options);
  const OnDevice device(stage);
  const SceneBounds bounds = sceneBounds(stage.made.scene);
  const Camera view = cameraAt({0.22, 0.17, 0.06}, 0.02, -0.01, 144, 108);
  for (const Composition composition : {Composition::gathered, Composition::hybrid}) {
    RenderSettings settings = GatherStage::gatherSettings();
    settings.composition = composition;
    const auto planWith = [&](Overlay overlay) {
      return planFrame(stage.made.scene, bounds, {{view}, with(overlay, settings)});
    };
    const FramePlan plan = planWith(Overlay::none);
    const Image8 plain = device.image(plan);
    const FrameBuffers buffers = device.buffers(plan);
    for (const Overlay overlay : {Overlay::wireframe, Overlay::tiers, Overlay::weights, Overlay::confidence,
                                  Overlay::depth, Overlay::agreement}) {
      const Image8 picture = device.image(planWith(overlay));
      std::size_t cells = 0, wrong = 0, wrongTier = 0;
      std::array<std::size_t, 4> gathered{};  // by tier
      std::set<std::uint32_t> colours;
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          const auto surface = buffers.surface.pixel(x, y);
          const auto pixel = picture.pixel(x, y), beneath = plain.pixel(x, y);
          wrongTier += pixel[3] != beneath[3];
          if (beneath[3] == 0) continue;
          wrongTier += beneath[3] != 255 - 64 * int(surface[1]);
          const bool isCell = surface[2] >= 0;
          ++(isCell ? cells : gathered.at(std::size_t(surface[1])));
          if (isCell && overlay != Overlay::tiers && overlay != Overlay::weights && overlay != Overlay::depth) continue;
          const shader::vec3 colour = shader::vec3(beneath[0], beneath[1], beneath[2]) / 255.0f;
          wrong += distance(pixel, gatheredOverlay(overlay, colour, buffers, {x, y}, float(plan.nearDistance))) > 2;
          colours.insert(std::uint32_t(pixel[0]) << 16 | std::uint32_t(pixel[1]) << 8 | pixel[2]);
        }
      INFO("composition " << int(composition) << ", overlay " << int(overlay));
      CHECK(wrong == 0);
      CHECK(wrongTier == 0);
      CHECK((composition == Composition::hybrid ? cells > 1000 : cells == 0));
      CHECK(gathered[kTierConsistent] > 500);
      CHECK(gathered[kTierCompleted] > 500);
      CHECK(gathered[kTierFilled] > 20);
      CHECK(colours.size() >= (overlay == Overlay::agreement ? 1 : overlay == Overlay::confidence ? 2 : 20));
    }
  }
}

TEST_CASE("the confidence overlay requires uncertaintyScene") {
  const Stage stage(testDevice(), richScene());
  const Error error = errorOf([&] {
    Renderer(testDevice(), stage.gpuScene(), {.maxExtent = {8, 8}, .overlays = {Overlay::confidence}});
  });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains("confidence"));
}
