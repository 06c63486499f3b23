// SPDX-License-Identifier: Apache-2.0
// Images of the eyes: the runtime's swapchain images, screenshots, and the output of `ibr render --stereo` for the same
// poses are equal.
#include <fmt/format.h>

#include <iterator>

#include "io/image_file.h"

#include <nlohmann/json.hpp>

#include "vr_harness.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using nlohmann::json;

namespace {

bool isEmpty(const Image8& image) {
  return std::ranges::all_of(image.values, [&](std::uint8_t v) { return v == image.values[0]; });
}

struct Asked {
  std::vector<std::string> headset = {}, renderer = {};  // options of ibr-vr alone, and of both ibr-vr and ibr render
  std::string faults = "";
  bool stockDevice = false;
  double unitsPerMetre = 1;
  // Filled pixels have fractional values. If a format encodes sRGB, their rounding
  // differs.
  int tolerance = 1;
};

bool same(const Image8& a, const Image8& b, int tolerance) {
  return a.width == b.width &&
         std::ranges::equal(a.values, b.values, [&](int p, int q) { return std::abs(p - q) <= tolerance; });
}

// Checks that the views stored in the images are those of the headset's eyes.
void checkViews(const std::array<Camera, 2>& views, const RemoteState& state, double unitsPerMetre) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Intrinsics& k = views[eye].intrinsics;
    const RemoteFov& fov = state.eyes[eye].fov;
    CHECK(-k.cx / k.fx == Approx(std::tan(fov.left)));
    CHECK((k.width - k.cx) / k.fx == Approx(std::tan(fov.right)));
    CHECK(k.cy / k.fy == Approx(std::tan(fov.up)));
    CHECK((k.cy - k.height) / k.fy == Approx(std::tan(fov.down)));
  }
  const glm::dvec3 apart = unitsPerMetre * (state.eyes[1].pose.position - state.eyes[0].pose.position);
  CHECK(glm::distance(views[1].pose.position - views[0].pose.position, views[0].pose.rotation * apart) < 1e-6);
}

void checkPictures(const RemoteState& state, const Asked& asked) {
  XrSetup setup(asked.faults);
  setup.readPictures();
  if (asked.stockDevice) setup.useStockDevice();
  std::vector<std::string> words{"--no-governor", "--frames", "60", "--screenshot", setup.folder() / "shot.png"};
  for (const auto* more : {&asked.headset, &asked.renderer}) words.insert(words.end(), more->begin(), more->end());
  Visitor visitor(setup, words);
  visitor.move(state);
  visitor.waitForScene();
  visitor.pass(15);
  const std::vector<Image8> shown = setup.pictures(visitor.program());
  REQUIRE(shown.size() == 2);
  REQUIRE(visitor.finish().code == 0);
  const fs::path left = setup.folder() / "shot_l.png", right = setup.folder() / "shot_r.png";
  checkViews(viewsIn({left, right}), state, asked.unitsPerMetre);
  const std::array kept{readImage(left), readImage(right)};
  const std::array again = drawnAgain(setup, left, setup.folder() / "again", asked.renderer);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    INFO("eye " << eye);
    CHECK(!isEmpty(kept[eye]));
    CHECK((kept[eye].values == shown[eye].values));
    CHECK(same(kept[eye], again[eye], asked.tolerance));
  }
  CHECK((kept[0].values != kept[1].values));
}

}  // namespace

TEST_CASE("ibr render reproduces both eyes' images from their poses") {
  RemoteState state = lookingAhead({0.1, 1.65, 0.05});
  state.head.rotation = glm::angleAxis(0.2, glm::normalize(glm::dvec3(0.3, 1, 0.2)));
  checkPictures(state, {.headset = {"--no-floor"}});
}

TEST_CASE("ibr render reproduces both eyes' images without optional features of the runtime") {
  checkPictures(lookingAhead(), {.headset = {"--no-floor"},
                                 .faults = "no-array,odd-size=333x217,no-stage,formats=50,hide=XR_KHR_composition_"
                                           "layer_depth:XR_KHR_visibility_mask"});
}

TEST_CASE("ibr render reproduces both eyes' images on the installed software device") {
  checkPictures(lookingAhead(), {.headset = {"--no-floor"}, .stockDevice = true});
}

TEST_CASE("a scale increases the distance of the eyes, and other settings are kept") {
  checkPictures(lookingAhead(),
                {.headset = {"--scale", "2", "--no-floor"}, .renderer = {"--blend", "dither"}, .unitsPerMetre = 2});
}

TEST_CASE("the floor equals that of ibr render") {
  RemoteState state = lookingAhead();
  state.head.rotation = glm::angleAxis(-0.5, glm::dvec3(1, 0, 0));
  checkPictures(state, {});
}

TEST_CASE("hidden areas of the lenses are not drawn, but screenshots are complete") {
  XrSetup setup("half-mask");
  setup.readPictures();
  Visitor visitor(setup, {"--no-governor", "--no-floor", "--frames", "60", "--tiers", "2", "--screenshot",
                          setup.folder() / "shot.png"});  // filled colours depend on hidden neighbours
  const RemoteState state = lookingAhead();
  visitor.move(state);
  visitor.waitForScene();
  visitor.pass(15);
  const std::vector<Image8> shown = setup.pictures(visitor.program());
  REQUIRE(visitor.finish().code == 0);
  REQUIRE(shown.size() == 2);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    INFO("eye " << eye);
    const fs::path file = setup.folder() / (eye == 0 ? "shot_l.png" : "shot_r.png");
    const Image8 kept = readImage(file);
    const double middle = viewsIn({file, file})[0].intrinsics.cx;  // columns left of `middle` are hidden
    std::size_t hidden = 0, left = 0, wrong = 0;
    for (int y = 0; y < kept.height; ++y)
      for (int x = 0; x < kept.width; ++x) {
        const bool black = std::ranges::all_of(shown[eye].pixel(x, y), [](int v) { return v == 0; });
        if (x + 1 < middle) ++left, hidden += black;
        if (x > middle) wrong += !std::ranges::equal(shown[eye].pixel(x, y), kept.pixel(x, y));
      }
    CHECK(left > 0);
    CHECK(hidden == left);
    CHECK(wrong == 0);
    CHECK(!isEmpty(kept));
  }
}

TEST_CASE("after Ctrl-C the screenshots of all frames are complete") {
  XrSetup setup;
  TemporaryFolder folder;
  Visitor visitor(setup, {"--no-governor", "--screenshots", folder.path(), "--screenshot-every", "1"});
  visitor.move(lookingAhead());
  visitor.waitForScene();
  visitor.pass(10);
  const json report = visitor.leave();
  const json& files = report["pictures"];
  CHECK(files.size() >= 2 * report["frames"]["frames"].get<std::size_t>());
  CHECK(files.size() == std::size_t(std::distance(fs::directory_iterator(folder.path()), {})));
  for (std::size_t i = 0; i < files.size(); i += 2) {
    const std::string left = files[i], right = files[i + 1];
    CHECK(left == (folder / (fmt::format("view_{:04d}_l.png", i / 2 + 1))).string());
    CHECK(!isEmpty(readImage(left)));
    CHECK(!isEmpty(readImage(right)));
  }
}
