// SPDX-License-Identifier: Apache-2.0
// Relations that hold for images of any harmonised model, whatever the content.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "ibr/error.h"
#include "reference/htm/htm_stage.h"
#include "reference/stored_colours.h"
#include "support/error_of.h"

namespace ibr::test {
namespace {

int largestDifference(const Image8& a, const Image8& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    largest = std::max(largest, std::abs(int(a.values[i]) - int(b.values[i])));
  return largest;
}

double coveredShare(const Image8& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.values.size(); i += 4) {
    REQUIRE((picture.values[i] == 0 || picture.values[i] == 255));
    covered += picture.values[i] == 255;
  }
  return double(covered) * 4 / double(picture.values.size());
}

// Largest error over the pixels for which camera `camera` counts at each corner of the triangle.
double errorAgainstPhotograph(const HtmStage& stage, std::size_t camera, const Image8& picture) {
  const std::vector<SurfaceHit> hits = surfaceHits(stage.model().surface.mesh, stage.model().cameras[camera].camera);
  double largest = 0;
  std::size_t compared = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const SurfaceHit& hit = hits[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
      if (hit.triangle < 0 || stage.pictures()[camera].visibility.pixel(x, y)[0] < 255) continue;
      if (std::min({hit.share.x, hit.share.y, hit.share.z}) < 1e-3) continue;
      bool trusted = true;
      for (int c = 0; c < 3; ++c)
        trusted = trusted &&
                  (stage.model().surface.members[stage.model().surface.mesh.triangles[std::size_t(hit.triangle)][c]] >>
                       camera &
                   1);
      if (!trusted) continue;
      ++compared;
      for (std::size_t c = 0; c < 3; ++c)
        largest = std::max(
            largest, std::abs(double(picture.pixel(x, y)[c]) - stage.pictures()[camera].photograph.pixel(x, y)[c]));
    }
  CHECK(compared > 500);
  return largest;
}

}  // namespace

TEST_CASE("at a camera's pose the image equals its photograph", "[htm]") {
  const HtmStage stage(bumpyModel({.disagreement = 0.03}));
  for (std::size_t k = 0; k < stage.model().cameras.size(); ++k) {
    INFO("camera " << k);
    CHECK(errorAgainstPhotograph(stage, k, stage.render(stage.model().cameras[k].camera, {.gamma = 200})) <= 1.0);
    // Without the camera, the image differs from the photograph.
    const HtmSettings excluded{.gamma = 200, .exclude = CameraSet(1) << k};
    CHECK(errorAgainstPhotograph(stage, k, stage.render(stage.model().cameras[k].camera, excluded)) > 10);
  }
}

TEST_CASE("harmonised photographs agree better than blended photographs", "[htm]") {
  const BumpyModel bumpy =
      bumpyModel({.cameras = 12, .width = 320, .height = 240, .longitudes = 48, .latitudes = 28, .disagreement = 0.02});
  const HtmStage stage(bumpy);
  const double angle = 2 * std::acos(-1.0) * 2.5 / 12;
  const Camera view = ringCamera(bumpy.options, angle, 0.1);
  const HtmFramePlan plan = stage.plan(view);
  // Offset to which a vertex's colour is blended, by the cameras that count there.
  const auto offsetAt = [&](std::uint32_t v) {
    glm::dvec4 sum(0);
    for (const PlannedHtmCamera& camera : plan.cameras)
      if (stage.model().surface.members[v] >> camera.camera & 1)
        sum += std::exp(camera.logWeight) * glm::dvec4(bumpy.offsets[camera.camera], 1);
    return sum.w > 0 ? glm::dvec3(sum) / sum.w : glm::dvec3(0);
  };
  const std::vector<SurfaceHit> hits = surfaceHits(stage.model().surface.mesh, view);
  const auto meanError = [&](HtmMethod method) {
    const Image8 picture = stage.render(view, {.method = method});
    double error = 0, count = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const SurfaceHit& hit = hits[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
        if (hit.triangle < 0 || picture.pixel(x, y)[3] == 0) continue;
        const glm::uvec3 corner = stage.model().surface.mesh.triangles[std::size_t(hit.triangle)];
        glm::dvec3 at = pointOf(stage.model().surface.mesh, hit);
        // Offsets leave the surface, which shifts surfaces seen at a grazing angle. These are skipped.
        const std::vector<glm::dvec3>& p = stage.model().surface.mesh.positions;
        const glm::dvec3 normal = glm::normalize(glm::cross(p[corner.y] - p[corner.x], p[corner.z] - p[corner.x]));
        if (glm::dot(normal, glm::normalize(view.pose.position - at)) < 0.85) continue;
        for (int c = 0; c < 3; ++c) at += hit.share[c] * offsetAt(corner[c]);
        const glm::dvec3 truth = solidColour(at);
        for (std::size_t c = 0; c < 3; ++c) error += std::abs(picture.pixel(x, y)[c] - 255 * truth[int(c)]);
        count += 3;
      }
    REQUIRE(count > 1500);
    return error / count;
  };
  const double harmonised = meanError(HtmMethod::harmonised), blended = meanError(HtmMethod::blended),
               colours = meanError(HtmMethod::vertexColours);
  INFO("harmonised " << harmonised << ", blended " << blended << ", vertex colours " << colours);
  CHECK(harmonised < 0.5 * blended);
  CHECK(harmonised < 0.5 * colours);
}

TEST_CASE("the world's origin does not change the image", "[htm][P6]") {
  const glm::dvec3 far(1e5, -2e5, 3e5);
  const HtmStage here(bumpyModel()), there(bumpyModel({.middle = far}));
  for (const double angle : {0.2, 2.5}) {
    const Image8 a = here.render(ringCamera({}, angle)), b = there.render(ringCamera({.middle = far}, angle));
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) different += std::abs(int(a.values[i]) - int(b.values[i])) > 1;
    CHECK(double(different) < 0.002 * double(a.values.size()));  // pixels on triangle edges
  }
}

TEST_CASE("the order of cameras does not change the image", "[htm]") {
  const BumpyModel bumpy = bumpyModel();
  const std::vector<std::size_t> from{3, 0, 5, 1, 4, 2};  // new camera → old
  BumpyModel turned = bumpy;
  const std::size_t n = from.size();
  for (std::size_t v = 0; v < bumpy.model.vertexCount(); ++v) {
    turned.model.surface.members[v] = 0;
    for (std::size_t i = 0; i < n; ++i) {
      turned.model.surface.members[v] |= (bumpy.model.surface.members[v] >> from[i] & 1) << i;
      for (std::size_t j = 0; j < n; ++j)
        turned.model.complements[turned.model.complementIndex(i, j, v)] =
            bumpy.model.complements[bumpy.model.complementIndex(from[i], from[j], v)];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    turned.model.cameras[i] = bumpy.model.cameras[from[i]];
    turned.pictures[i] = bumpy.pictures[from[i]];
  }
  const HtmStage a(bumpy), b(turned);
  for (const HtmMethod method : {HtmMethod::harmonised, HtmMethod::vertexColours})
    CHECK(largestDifference(a.render(ringCamera({}, 0.8), {.method = method}),
                            b.render(ringCamera({}, 0.8), {.method = method})) <= 1);
}

TEST_CASE("surfaces that only cameras of tiny weight see are drawn", "[htm][N11]") {
  const BumpyModel bumpy = bumpyModel({.cameras = 8, .disagreement = 0});
  const HtmStage stage(bumpy);
  const Camera view = ringCamera(bumpy.options, 0.1);
  // Only cameras behind the body remain, with weights of e^−300 and less.
  HtmSettings settings{.gamma = 1000, .exclude = 0b11100111};
  const HtmFramePlan plan = stage.plan(view, settings);
  REQUIRE(plan.cameras.size() == 2);
  const Image8 behind = stage.render(plan);
  const double all = coveredShare(stage.render(view));
  CHECK(all > 0.15);
  const double share = coveredShare(behind);
  CHECK(share > 0.001);  // a narrow region beside the silhouette
  CHECK(share < 0.6 * all);
  // With all cameras, the weight cut loses no coverage, although some cameras are behind the body.
  settings.exclude = 0;
  CHECK(coveredShare(stage.render(view, settings)) == Approx(all).margin(1e-3));
  // Without a camera, only the background is drawn.
  settings.exclude = ~CameraSet(0);
  settings.background = {1, 0, 0};
  const Image8 none = stage.render(view, settings);
  CHECK(coveredShare(none) == 0);
  CHECK(none.pixel(80, 60)[0] == 255);
}

TEST_CASE("a point that no camera sees is coloured by its member cameras", "[htm][N11][T23]") {
  BumpyModel bumpy = bumpyModel();
  for (HtmImage& picture : bumpy.pictures) std::ranges::fill(picture.visibility.values, std::uint8_t(0));
  const HtmStage blind(bumpy);
  for (HtmImage& picture : bumpy.pictures) picture.visibility = {};
  const HtmStage all(bumpy);
  const Camera view = ringCamera({}, 0.4);
  for (const HtmMethod method : {HtmMethod::harmonised, HtmMethod::vertexColours}) {
    const HtmSettings deep{.method = method, .depthTolerance = 100};
    CHECK(largestDifference(blind.render(view, {.method = method}), all.render(view, deep)) <= 1);
    CHECK(coveredShare(blind.render(view, {.method = method})) > 0.15);
  }
}

TEST_CASE("models of extreme sizes and values are drawn", "[htm][T23]") {
  const auto drawAll = [](const HtmStage& stage) {
    double covered = 0;
    for (const HtmMethod method : {HtmMethod::harmonised, HtmMethod::blended, HtmMethod::vertexColours}) {
      const HtmSettings settings{.gamma = 1000, .method = method};
      covered = std::max(covered, coveredShare(stage.render(ringCamera({}, 0.3), settings)));
    }
    return covered;
  };
  SECTION("one camera") {
    CHECK(drawAll(HtmStage(bumpyModel({.cameras = 1}))) > 0.1);
  }
  SECTION("64 cameras") {
    CHECK(drawAll(HtmStage(bumpyModel({.cameras = 64, .width = 64, .height = 48}))) > 0.15);
  }
  SECTION("no triangles") {
    BumpyModel bumpy = bumpyModel();
    bumpy.model.surface.mesh.triangles.clear();
    CHECK(drawAll(HtmStage(bumpy)) == 0);
  }
  SECTION("no vertices") {
    BumpyModel bumpy = bumpyModel();
    bumpy.model.surface = {};
    bumpy.model.complements.clear();
    CHECK(drawAll(HtmStage(bumpy)) == 0);
  }
  SECTION("no members") {
    BumpyModel bumpy = bumpyModel();
    std::ranges::fill(bumpy.model.surface.members, CameraSet(0));
    CHECK(drawAll(HtmStage(bumpy)) == 0);
  }
  SECTION("a triangle without area, and complements far outside the photographs") {
    BumpyModel bumpy = bumpyModel();
    bumpy.model.surface.mesh.triangles.emplace_back(3, 3, 5);
    for (glm::vec2& complement : bumpy.model.complements) complement *= 1e30f;
    CHECK(drawAll(HtmStage(bumpy)) > 0.1);
  }
  SECTION("a camera inside the mesh, and a view from its position") {
    BumpyModel bumpy = bumpyModel();
    bumpy.model.cameras[2].camera.pose.position = glm::dvec3(0);
    const HtmStage stage(bumpy);
    CHECK(drawAll(stage) > 0.1);
    Camera view = ringCamera({}, 0.3);
    view.pose.position = glm::dvec3(0);
    coveredShare(stage.render(view));
  }
}

TEST_CASE("every target format shows the same image", "[htm]") {
  const HtmStage stage(bumpyModel());
  const HtmFramePlan plan = stage.plan(ringCamera({}, 1.1), {.background = {0.2f, 0.01f, 0.9f}});
  const Image8 first = stage.render(plan);
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_B8G8R8A8_SRGB})
    CHECK(largestDifference(first, stage.render(plan, format)) <= 1);
  for (const TargetFormat& format : kWideFormats)
    CHECK(wrongChannels(stage.renderFloat(plan, format), first, format, kRoundedSteps) == 0);
  for (const TargetFormat& format :
       {TargetFormat(VK_FORMAT_R32G32B32A32_SFLOAT), TargetFormat(VK_FORMAT_R8G8B8A8_SRGB, Encoding::linear)}) {
    const HtmRendererOptions options{.maxExtent = {8, 8}, .formats = {format}};
    CHECK(errorOf([&] { HtmRenderer(testDevice(), stage.gpuModel(), options); }).code() == ErrorCode::unsupported);
  }
}

TEST_CASE("photographs that do not fit their cameras are refused", "[htm]") {
  const auto made = [](const BumpyModel& bumpy) { GpuHtmModel(testDevice(), bumpy.model, bumpy.source()); };
  BumpyModel bumpy = bumpyModel();
  bumpy.pictures[3].photograph = Image8(10, 10, 3);
  CHECK(errorOf([&] { made(bumpy); }).code() == ErrorCode::invalidInput);
  bumpy = bumpyModel();
  bumpy.pictures[3].visibility = Image8(10, 10, 1);
  CHECK(errorOf([&] { made(bumpy); }).code() == ErrorCode::invalidInput);
  bumpy = bumpyModel();
  bumpy.model.surface.mesh.triangles[0].x = 1'000'000;
  CHECK(errorOf([&] { made(bumpy); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("a replaced model is drawn like a newly created model", "[htm]") {
  const auto view = [](const BumpyOptions& options) {
    BumpyOptions sized = options;
    sized.width = 160, sized.height = 120;
    return ringCamera(sized, 0.4, 0.1);
  };
  BumpyModel bare = bumpyModel({.cameras = 4, .longitudes = 30, .latitudes = 20});
  bare.model.complements.clear();
  const std::vector<BumpyModel> models{
      bumpyModel({.disagreement = 0.02}), bumpyModel({.disagreement = 0.04}),                      // equal sizes
      bumpyModel({.cameras = 9, .width = 200, .height = 150, .longitudes = 40, .latitudes = 24}),  // larger sizes
      bumpyModel({.cameras = 3, .width = 64, .height = 96, .longitudes = 8, .latitudes = 6}),      // smaller sizes
      bare};
  constexpr GpuHtmModelOptions kOptions{.trilinear = true};
  GpuHtmModel gpuModel(testDevice(), models[0].model, models[0].source(), kOptions);
  HtmRenderer renderer(testDevice(), gpuModel, {.maxExtent = {160, 120}});
  Offscreen offscreen(testDevice(), {160, 120});
  for (const std::size_t m : {0u, 1u, 2u, 3u, 4u, 2u, 0u}) {
    const BumpyModel& bumpy = models[m];
    gpuModel.replace(bumpy.model, bumpy.source());
    renderer.setModel(gpuModel);
    const HtmStage alone(bumpy);
    for (const HtmMethod method : {HtmMethod::harmonised, HtmMethod::blended, HtmMethod::vertexColours}) {
      const HtmFramePlan plan = alone.plan(view(bumpy.options), {.method = method});
      const Image8 picture =
          offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
      INFO("model " << m << " method " << int(method));
      CHECK(coveredShare(picture) > 0.05);
      CHECK(picture == alone.render(plan));
    }
  }

  // A failed replace leaves the model intact and replaceable.
  HtmModel invalid = models[1].model;
  invalid.surface.members[0] = ~CameraSet(0);
  CHECK(errorOf([&] { gpuModel.replace(invalid, models[1].source()); }).code() == ErrorCode::invalidInput);
  CHECK(errorOf([&] { gpuModel.replace(models[1].model, models[3].source()); }).code() == ErrorCode::invalidInput);
  gpuModel.replace(models[1].model, models[1].source());
  renderer.setModel(gpuModel);
  const HtmStage alone(models[1]);
  const HtmFramePlan plan = alone.plan(view(models[1].options));
  CHECK(offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); }) ==
        alone.render(plan));
}

TEST_CASE("copies of a prepared photograph share its mip levels", "[htm]") {
  const BumpyModel bumpy = bumpyModel();
  std::vector<HtmImage> prepared;
  for (std::size_t i = 0; i < bumpy.pictures.size(); ++i)
    prepared.push_back(prepareHtmImage(bumpy.model, i, bumpy.pictures[i]));
  const std::vector<HtmImage> copies = prepared;
  CHECK(copies[2].levels == prepared[2].levels);
  const HtmStage stage(bumpy), other(bumpy.model, copies);
  const Camera view = ringCamera(bumpy.options, 0.4);
  CHECK(stage.render(view) == other.render(view));
}

}  // namespace ibr::test
