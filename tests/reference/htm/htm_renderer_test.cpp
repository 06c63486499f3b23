// SPDX-License-Identifier: Apache-2.0
// The harmonised model's shaders against the double-precision reference implementation.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/vulkan/submit.h"
#include "gpu/transfer/readback.h"
#include "htm/coordinates_pass.h"
#include "htm/frame_set.h"
#include "reference/htm/htm_reference.h"
#include "reference/htm/htm_stage.h"
#include "reference/shader_offsets.h"
#include "shaders/htm_frag.h"

namespace ibr::test {
namespace {

void compareWithReference(const HtmStage& stage, const Camera& view, const HtmSettings& settings) {
  const HtmFramePlan plan = stage.plan(view, settings);
  const Image8 picture = stage.render(plan);
  const reference::HtmReferenceImage ref = reference::render(stage.model(), stage.pictures(), plan);
  std::size_t drawn = 0, wrongAlpha = 0, wrongColour = 0;
  for (int y = 0; y < ref.height; ++y)
    for (int x = 0; x < ref.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(ref.width) + std::size_t(x);
      if (!ref.safe[at]) continue;
      drawn += ref.colour[at].w > 0;
      wrongAlpha += picture.pixel(x, y)[3] != (ref.colour[at].w > 0 ? 255 : 0);
      // Tolerance for rounding, and for the filter's precision of 1/256 texel.
      for (int c = 0; c < 3; ++c)
        wrongColour += std::abs(picture.pixel(x, y)[std::size_t(c)] - 255 * ref.colour[at][c]) > 2.5;
    }
  CHECK(double(drawn) > 0.1 * ref.width * ref.height);
  CHECK(wrongAlpha == 0);
  CHECK(wrongColour == 0);
}

}  // namespace

TEST_CASE("a harmonised model equals the reference implementation", "[htm][P9]") {
  const HtmStage stage(bumpyModel());
  const BumpyOptions options;
  for (const HtmMethod method : {HtmMethod::harmonised, HtmMethod::blended, HtmMethod::vertexColours}) {
    INFO("method " << int(method));
    HtmSettings settings{.method = method, .background = {0.2f, 0.4f, 0.6f}};
    compareWithReference(stage, ringCamera(options, 0.3), settings);
    settings.gamma = 3;
    compareWithReference(stage, ringCamera(options, 2.0, 0.9), settings);
    settings.gamma = 1000;
    compareWithReference(stage, ringCamera(options, 4.4, -0.7), settings);
    settings.gamma = 50;
    settings.exclude = 0b11;  // the near cameras: the others are far off and do not see much of the surface
    compareWithReference(stage, ringCamera(options, 0.5), settings);
  }
}

TEST_CASE("photographs of different sizes share a texture array", "[htm]") {
  BumpyModel bumpy = bumpyModel();
  BumpyOptions small;
  small.width = 90;
  small.height = 140;
  const BumpyModel other = bumpyModel(small);
  for (const std::size_t i : {1u, 4u}) {
    bumpy.model.cameras[i] = other.model.cameras[i];
    bumpy.pictures[i] = other.pictures[i];
  }
  const HtmStage stage(std::move(bumpy));
  compareWithReference(stage, ringCamera({}, 0.7), {});
  compareWithReference(stage, ringCamera({}, 0.7), {.gamma = 2, .weightCut = 0});
}

TEST_CASE("harmonised coordinates follow eq. 6", "[htm]") {
  BumpyModel bumpy = bumpyModel();
  bumpy.model.surface.members[7] = 0;
  const HtmStage stage(std::move(bumpy));
  // Work groups in a row: all in one, or several rows with an incomplete last one.
  const std::uint32_t most = GENERATE(0xffffffffu, 1u, 3u);
  const std::uint32_t groups = (std::uint32_t(stage.model().vertexCount()) + 63) / 64;
  REQUIRE(groups > 3);
  for (const double gamma : {1.0, 50.0, 1000.0})
    for (const double angle : {0.0, 0.5, 3.0}) {
      // weightCut is 0, because rounding decides which weights near the cut count.
      const HtmFramePlan plan = stage.plan(ringCamera({}, angle), {.gamma = gamma, .weightCut = 0});
      const HtmFrameSet set(testDevice(), stateOf(stage.gpuModel()));
      const HtmCoordinatesPass pass(testDevice(), set, most);
      submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
        set.update(commands, plan);
        pass.record(commands, set, plan);
      });
      const std::vector<std::byte> bytes = readBuffer(testDevice(), set.displacements());
      const auto* displaced = reinterpret_cast<const glm::vec2*>(bytes.data());
      const auto ref = reference::harmonise(stage.model(), plan);
      double largest = 0, error = 0;
      for (std::size_t i = 0; i < ref.size(); ++i)
        for (std::size_t v = 0; v < stage.model().vertexCount(); ++v) {
          const glm::dvec2 got(displaced[i * stage.model().vertexCount() + v]);
          largest = std::max(largest, glm::length(ref[i][v]));
          error = std::max(error, std::isfinite(got.x + got.y) ? glm::length(got - ref[i][v]) : 1e9);
        }
      INFO("gamma " << gamma << " angle " << angle << " of " << groups << " groups in a row at most " << most);
      CHECK(largest > 0.5);
      CHECK(error < 1e-3);  // px: exp2 of a value rounded to 24 bits
    }
}

TEST_CASE("groups of vertices are folded into rows that a device can dispatch", "[htm]") {
  for (const std::uint32_t most : {1u, 2u, 65535u, 0x7fffffffu, 0xffffffffu})
    for (const std::uint32_t groups : {1u, 2u, 3u, 65535u, 65536u, 65537u, 131071u, 1u << 26}) {
      const glm::uvec2 folded = htmDispatchGroups(groups, most);
      const std::uint64_t sum = std::uint64_t(folded.x) * folded.y;
      INFO(groups << " groups, " << most << " in a row");
      CHECK(folded.x <= most);
      CHECK(sum >= groups);
      CHECK(sum - groups < folded.y);
      CHECK(folded.y == (std::uint64_t(groups) + most - 1) / most);
    }
}

TEST_CASE("parameters of a harmonised model have the memory layout of the shaders", "[htm]") {
  using Offsets = std::map<std::string, std::uint32_t>;
  using shader::HtmCameraParameters;
  using shader::HtmFrame;
  CHECK(offsetsOf(shaders::htm_frag, "HtmCameraParameters") ==
        Offsets{{"column", offsetof(HtmCameraParameters, column)},
                {"row", offsetof(HtmCameraParameters, row)},
                {"depthOf", offsetof(HtmCameraParameters, depthOf)},
                {"size", offsetof(HtmCameraParameters, size)},
                {"log2Weight", offsetof(HtmCameraParameters, log2Weight)},
                {"log2Rest", offsetof(HtmCameraParameters, log2Rest)},
                {"detail", offsetof(HtmCameraParameters, detail)},
                {"texelWidth", offsetof(HtmCameraParameters, texelWidth)},
                {"nearDistance", offsetof(HtmCameraParameters, nearDistance)},
                {"camera", offsetof(HtmCameraParameters, camera)}});
  CHECK(sizeof(HtmCameraParameters) == 80);
  CHECK(offsetsOf(shaders::htm_frag, "HtmFrame") == Offsets{{"clip", offsetof(HtmFrame, clip)},
                                                            {"background", offsetof(HtmFrame, background)},
                                                            {"cut", offsetof(HtmFrame, cut)},
                                                            {"depthTolerance", offsetof(HtmFrame, depthTolerance)},
                                                            {"vertexCount", offsetof(HtmFrame, vertexCount)},
                                                            {"cameraCount", offsetof(HtmFrame, cameraCount)},
                                                            {"plannedCount", offsetof(HtmFrame, plannedCount)}});
}

}  // namespace ibr::test
