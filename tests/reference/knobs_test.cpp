// SPDX-License-Identifier: Apache-2.0
// Effects of the fields of RenderSettings on rendered images.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/error.h"
#include "ibr/metrics.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Mean absolute difference between neighbouring pixels, as a measure of detail.
double detailOf(const Image8& picture) {
  double sum = 0;
  for (int y = 20; y < picture.height - 20; ++y)
    for (int x = 20; x < picture.width - 20; ++x) sum += std::abs(picture.pixel(x, y)[1] - picture.pixel(x - 1, y)[1]);
  return sum / double((picture.width - 40) * (picture.height - 40));
}

SyntheticScene fine() {
  SyntheticOptions options = place(3);
  for (TexturedPlane& plane : options.planes) plane.wavelength = 0.12;
  return makeScene(options);
}

}  // namespace

TEST_CASE("texture scale reduces detail") {
  const Stage stage(testDevice(), fine());
  const Camera view = cameraAt({0.4, 0.25, 0.1});
  RenderSettings settings;
  const Image8 whole = stage.render(view, settings);
  for (const BlendMode blend : {BlendMode::blend, BlendMode::dither}) {
    settings.blend = blend;
    settings.textureScale = 1;
    double before = detailOf(stage.render(view, settings));
    for (const double scale : {0.5, 0.25}) {
      settings.textureScale = scale;
      const Image8 picture = stage.render(view, settings);
      CHECK(detailOf(picture) < 0.9 * before);
      CHECK(difference(picture, whole, 255).meanAbsolute < 40);
      before = detailOf(picture);
    }
  }
}

TEST_CASE("minified photographs keep the detail that the image can show") {
  // A view from farther back: one image pixel spans 2.4 px of a photograph. The truth is the mean over each pixel.
  SyntheticOptions options = place(3);
  for (TexturedPlane& plane : options.planes) plane.wavelength = 0.12;
  options.samplesPerAxis = 4;
  const SyntheticScene made = makeScene(options);
  const Stage stage(testDevice(), made);
  Camera view = cameraAt({0.4, 0.25, 0.1});
  view.intrinsics = resized(view.intrinsics, view.intrinsics.width * 5 / 12, view.intrinsics.height * 5 / 12);
  const Image8 truth = renderTruth(made, view);
  RenderSettings settings = withTiers();
  const Image8 usual = stage.render(view, settings);
  settings.textureScale = std::sqrt(0.5);  // the level that the footprint selects without the bias
  const Image8 coarser = stage.render(view, settings);
  Image8 cover(view.intrinsics.width, view.intrinsics.height, 1);
  for (int y = 0; y < cover.height; ++y)
    for (int x = 0; x < cover.width; ++x) cover.pixel(x, y)[0] = usual.pixel(x, y)[3];
  CHECK(psnr(usual, truth, cover) > psnr(coarser, truth, cover) + 1);
  CHECK(detail(usual, truth, cover).energy > detail(coarser, truth, cover).energy + 0.1);
}

TEST_CASE("render scale draws cells at another resolution and interpolates to the target's") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const Camera view = cameraAt({0.4, 0.25, 0.1});
  Camera half = view;
  half.intrinsics = resized(view.intrinsics, 160, 120);
  for (const int maxTier : {0, 3}) {
    RenderSettings settings;
    settings.maxTier = maxTier;
    settings.background = {0.3f, 0.3f, 0.3f};
    const Image8 small = stage.render(half, settings);
    settings.renderScale = 0.5;
    const Image8 picture = stage.render(view, settings);
    REQUIRE((picture.width == 320 && picture.height == 240));
    // Bilinear by hand, pixel centres at ½. Filled pixels are interpolated only once, in finer steps.
    int largest = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
          const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
          double sum = 0;
          for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i)
              sum += (i ? u - x0 : 1 - u + x0) * (j ? v - y0 : 1 - v + y0) *
                     small.pixel(std::clamp(x0 + i, 0, 159), std::clamp(y0 + j, 0, 119))[c];
          largest = std::max(largest, int(std::lround(std::abs(sum - picture.pixel(x, y)[c]))));
        }
    CHECK(largest <= (maxTier == 3 ? 12 : 1));
  }
}

TEST_CASE("a render scale above 1 averages several samples per pixel") {
  const Stage stage(testDevice(), fine());
  RenderSettings settings;
  settings.blend = BlendMode::dither;
  const Camera view = cameraAt({0.4, 0.25, 0.1}), large = [&] {
    Camera camera = view;
    camera.intrinsics = resized(view.intrinsics, 640, 480);
    return camera;
  }();
  settings.renderScale = 2;
  const Image8 twice = stage.render(view, settings);
  settings.renderScale = 1;
  const Image8 drawn = stage.render(large, settings);
  int largest = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += drawn.pixel(2 * x + k % 2, 2 * y + k / 2)[0];
      largest = std::max(largest, int(std::lround(std::abs(sum / 4 - twice.pixel(x, y)[0]))));
    }
  CHECK(largest <= 1);
}

TEST_CASE("scales that are not positive are refused by name") {
  const Stage stage(testDevice(), makeScene(place(2)));
  for (const double scale : {0.0, -1.0, std::nan("")}) {
    RenderSettings settings;
    settings.renderScale = scale;
    CHECK_THROWS_WITH(stage.plan(cameraAt({0.4, 0, 0}), settings), Catch::Contains("renderScale"));
    settings = {};
    settings.textureScale = scale;
    CHECK_THROWS_WITH(stage.plan(cameraAt({0.4, 0, 0}), settings), Catch::Contains("textureScale"));
  }
}

TEST_CASE("both eyes share colour tables, or each eye has its own") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  SyntheticScene place = makeScene(options);
  for (std::size_t node : {1u, 3u})
    for (std::uint8_t& value : place.photographs[node].values) value = std::uint8_t(value * 3 / 4);
  const Stage stage(testDevice(), std::move(place));
  const Camera left = cameraAt({0.35, 0.3, 0.2}), right = cameraAt({0.55, 0.3, 0.2});
  RenderSettings settings;
  settings.colourMapping = ColourMapping::ours;
  settings.colourProxy = 2;
  const auto pictures = [&](const std::vector<Camera>& views) {
    return stage.renderViews(planFrame(stage.scene(), sceneBounds(stage.scene()), {views, settings}));
  };
  const std::vector<Image8> shared = pictures({left, right});
  settings.shareEyeColours = false;
  const std::vector<Image8> own = pictures({left, right});
  CHECK(own[0] == shared[0]);
  CHECK(own[1] != shared[1]);
  // An eye's own tables equal the tables of the same view as the first eye.
  CHECK(own[1] == pictures({right, left})[0]);
}

TEST_CASE("presets increase from fast to accurate, and renderer options fit each preset", "[P11]") {
  for (const DeviceKind kind : {DeviceKind::software, DeviceKind::hardware}) {
    double pixels = 0, vote = 0;
    std::uint32_t cells = 0, photographs = 0, colours = 0;
    for (const Preset name : {Preset::fast, Preset::balanced, Preset::accurate, Preset::reference}) {
      const RenderSettings settings = preset(name, kind);
      CHECK(settings.composition == Composition::hybrid);
      CHECK(settings.voteScale >= vote);
      CHECK(settings.gatherCandidates >= photographs);
      CHECK(settings.gatherColours >= colours);
      vote = settings.voteScale;
      photographs = settings.gatherCandidates;
      colours = settings.gatherColours;
      CHECK(settings.maxCells > cells);
      CHECK(settings.renderScale >= pixels);
      cells = settings.maxCells;
      pixels = settings.renderScale;
      const RendererOptions options = optionsFor(settings, {64, 48});
      CHECK(options.compositions == std::vector{settings.composition});
      CHECK(options.blends == std::vector{settings.blend});
      CHECK((options.maxRenderScale == 0) == (settings.renderScale == 1));
      // The best combination of exposure and colour mapping for photographs of different exposure
      // (libibr/docs/limits.md).
      CHECK(settings.exposure == Exposure::adapted);
      CHECK(settings.colourMapping == ColourMapping::off);
      CHECK(options.colour == ColourSupport::off);
      CHECK(settings.maxTier == kTierFilled);
      CHECK(options.fill);
    }
    CHECK(preset(Preset::balanced, kind).maxCells == RenderSettings{}.maxCells);
  }
}
