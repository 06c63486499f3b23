// SPDX-License-Identifier: Apache-2.0
// Rendering of photographs that have gains (Node::gain).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/exponential.hpp>

#include "base/srgb.h"
#include "reference/compare_pictures.h"

using namespace ibr;
using namespace ibr::test;

namespace {

const glm::dvec3 kGains[]{{0.5, 0.8, 1.1}, {1.7, 1, 0.6}, {1, 1.4, 1.9}, {0.3, 3, 1}};

SyntheticScene withGains(SyntheticScene made) {
  for (std::size_t n = 0; n < made.scene.nodes.size(); ++n) made.scene.nodes[n].gain = kGains[n % 4];
  return made;
}

// Changes a photograph as if a camera of another exposure had taken the photograph.
void develop(Image8& photograph, glm::dvec3 factor) {
  for (int y = 0; y < photograph.height; ++y)
    for (int x = 0; x < photograph.width; ++x)
      for (int c = 0; c < 3; ++c) {
        std::uint8_t& level = photograph.pixel(x, y)[std::size_t(c)];
        level = std::uint8_t(
            std::lround(255 * std::clamp(linearToSrgb(factor[c] * srgbToLinear(level / 255.0)), 0.0, 1.0)));
      }
}

double meanDifference(const Image8& a, const Image8& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a.pixel(x, y)[c] - b.pixel(x, y)[c]);
  return sum / double(3 * a.width * a.height);
}

}  // namespace

TEST_CASE("photographs with gains equal the reference implementation") {
  for (const std::size_t members : {2u, 3u, 4u}) {
    const Stage stage(testDevice(), withGains(makeScene(place(members))));
    for (const BlendMode blend : {BlendMode::blend, BlendMode::dither, BlendMode::mixed})
      for (const Exposure exposure : {Exposure::off, Exposure::scene, Exposure::adapted}) {
        RenderSettings settings = withTiers();
        settings.blend = blend;
        settings.exposure = exposure;
        INFO(members << " members, blend " << int(blend) << ", exposure " << int(exposure));
        compareWithReference(stage, stage.plan(cameraAt({0.4, 0.25, 0.1}, 0.03), settings));
      }
  }
}

TEST_CASE("photographs with gains in several cells equal the reference implementation") {
  SyntheticScene made = withGains(twoCells());
  for (Cell& cell : made.scene.cells) {  // holes that show the second cell
    MorphMesh& mesh = cell.mesh;
    for (std::size_t t = mesh.triangles.size() * 2 / 3; t < mesh.triangles.size(); ++t) mesh.tier[t] = kTierRejected;
  }
  const Stage stage(testDevice(), made);
  RenderSettings settings = withTiers();
  settings.exposure = Exposure::scene;
  compareWithReference(stage, stage.plan(cameraAt({0.45, 0.3, 0.2}, 0.02), settings));
}

TEST_CASE("gains of 1 and disabled gains do not change the image") {
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03);
  const Stage plain(testDevice(), makeScene(place(3))), gained(testDevice(), withGains(makeScene(place(3))));
  RenderSettings off = withTiers();
  off.exposure = Exposure::off;
  const Image8 picture = plain.render(view, off);
  for (const Exposure exposure : {Exposure::scene, Exposure::adapted}) {
    RenderSettings settings = withTiers();
    settings.exposure = exposure;
    CHECK(plain.render(view, settings) == picture);
    CHECK(gained.render(view, settings) != picture);
  }
  CHECK(gained.render(view, off) == picture);  // rendered by the shader variant that applies gains
}

TEST_CASE("at a photograph's pose the adapted image equals the photograph for any gain") {
  const Stage plain(testDevice(), makeScene(place(3))), gained(testDevice(), withGains(makeScene(place(3))));
  RenderSettings settings = withTiers();
  settings.exposure = Exposure::adapted;
  settings.maxCells = 1;
  for (std::size_t n = 0; n < 3; ++n)
    CHECK(gained.render(gained.scene().nodes[n].camera, settings) ==
          plain.render(plain.scene().nodes[n].camera, settings));
}

TEST_CASE("photographs of several exposures with gains look like photographs of one exposure") {
  SyntheticScene one = makeScene(place(3));
  for (Image8& photograph : one.photographs) develop(photograph, glm::dvec3(0.4));  // leaves headroom for gains
  SyntheticScene several = one;
  for (std::size_t n = 0; n < 3; ++n) {
    develop(several.photographs[n], 1.0 / kGains[n]);
    several.scene.nodes[n].gain = kGains[n];
  }
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03);
  RenderSettings off = withTiers(), scene = withTiers();
  off.exposure = Exposure::off;
  scene.exposure = Exposure::scene;
  const Stage stageOfOne(testDevice(), one), stageOfSeveral(testDevice(), several);
  const Image8 right = stageOfOne.render(view, off);
  CHECK(meanDifference(stageOfSeveral.render(view, scene), right) < 0.6);  // 8-bit levels, rounded twice
  CHECK(meanDifference(stageOfSeveral.render(view, off), right) > 2);
}

TEST_CASE("at a photograph's pose the scene's exposure is the photographs' mean, without a colour cast") {
  // Exposures of the photographs. The solver's gains are their inverse, with a mean logarithm of 0.
  const glm::dvec3 taken[]{{0.4, 0.3, 0.5}, {0.2, 0.35, 0.3}, {0.3, 0.2, 0.25}};
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& e : taken) mean += glm::log(e) / 3.0;
  SyntheticScene several = makeScene(place(3)), one = several;
  for (std::size_t n = 0; n < 3; ++n) {
    develop(several.photographs[n], taken[n]);
    develop(one.photographs[n], glm::exp(mean));
    several.scene.nodes[n].gain = glm::exp(mean) / taken[n];
  }
  RenderSettings settings = withTiers();
  settings.exposure = Exposure::scene;
  const Stage shown(testDevice(), several), right(testDevice(), one);
  const auto colourOf = [](const Image8& picture) {
    glm::dvec3 light(0.0);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (int c = 0; c < 3; ++c) light[c] += srgbToLinear(picture.pixel(x, y)[std::size_t(c)] / 255.0);
    return light;
  };
  for (std::size_t n = 0; n < 3; ++n) {
    const Camera& pose = shown.scene().nodes[n].camera;
    const glm::dvec3 cast = colourOf(shown.render(pose, settings)) / colourOf(right.render(pose, settings));
    for (int c = 0; c < 3; ++c) CHECK(cast[c] == Approx(1).epsilon(0.006));
  }
}
