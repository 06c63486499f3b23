// SPDX-License-Identifier: Apache-2.0
// Block-compressed textures on the device, and the memory a scene takes there.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "gpu/transfer/readback.h"
#include "gpu/transfer/upload.h"
#include "ibr/memory_demand.h"
#include "ibr/metrics.h"
#include "reference/compare_pictures.h"
#include "reference/stage.h"
#include "render/resident/texture_arrays.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr TextureFormat kFormats[]{TextureFormat::rgba8, TextureFormat::bc1, TextureFormat::bc7};

// The photographs of a scene in a texture format, and the decoded images that a device should show.
struct Encoded {
  std::vector<Texture> textures;
  std::vector<std::vector<Image8>> decoded;

  Encoded(const SyntheticScene& place, TextureFormat format) {
    for (const Image8& photograph : place.photographs) {
      textures.push_back(encodeTexture(buildMips(photograph), format));
      decoded.push_back(decodeTexture(textures.back()));
    }
  }
  TextureSource source() const {
    return [this](const Scene&, std::size_t node, int first) { return withoutLargestLevels(textures[node], first); };
  }
  TextureSource decodedSource() const {
    return [this](const Scene&, std::size_t node, int first) { return withoutLargestLevels(decoded[node], first); };
  }
};

struct Messages {
  std::vector<std::pair<LogLevel, std::string>> all;
  LogCallback log() {
    return [this](LogLevel level, std::string_view text) { all.emplace_back(level, text); };
  }
};

// A level as the device decodes it, copied into an uncompressed image.
Image8 decodedOnDevice(const GpuImage& blocks, std::uint32_t level, int width, int height) {
  const VkExtent2D extent{std::uint32_t(width), std::uint32_t(height)};
  const GpuImage plain(testDevice(),
                       {.format = VK_FORMAT_R8G8B8A8_UNORM,
                        .extent = extent,
                        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                       "decoded");
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    transition(commands, plain.get(), use::kUndefined, use::kTransferDestination);
    const VkOffset3D end{width, height, 1};
    const VkImageBlit region{.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
                             .srcOffsets = {{}, end},
                             .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .dstOffsets = {{}, end}};
    vkCmdBlitImage(commands, blocks.get(), use::kTransferSource.layout, plain.get(), use::kTransferDestination.layout,
                   1, &region, VK_FILTER_NEAREST);
  });
  const std::vector<std::byte> bytes = readImage(testDevice(), plain.get(), extent, 4, use::kTransferDestination);
  Image8 image(width, height, 4);
  std::ranges::transform(bytes, image.values.begin(), [](std::byte b) { return std::uint8_t(b); });
  return image;
}

int largestDifference(const Image8& a, const Image8& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) largest = std::max(largest, std::abs(a.values[i] - b.values[i]));
  return largest;
}

bool copies(VkFormat format) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(testDevice().physicalDevice(), format, &properties);
  return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_SRC_BIT) != 0;
}

}  // namespace

// Property N14: BC7 decoding is exact, BC1 is loosely specified.
TEST_CASE("a device decodes blocks like decodeTexture, at any size and mip level", "[N14][bc]") {
  const Image8 photograph = makeScene(test::place(2)).photographs[0];
  for (const auto& [format, levelsOff] : {std::pair{TextureFormat::bc1, 1}, {TextureFormat::bc7, 0}})
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 7}, {4, 4}, {61, 38}, {128, 96}}) {
      if (!testDevice().supportsBlockCompression() || !copies(vulkanFormat(format))) continue;
      Image8 part(width, height, 4);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) std::ranges::copy(photograph.pixel(90 + x, 60 + y), part.pixel(x, y).begin());
      const Texture texture = encodeTexture(buildMips(part), format);
      const std::vector<Image8> expected = decodeTexture(texture);
      const GpuImage blocks(
          testDevice(),
          {.format = vulkanFormat(format),
           .extent = {std::uint32_t(width), std::uint32_t(height)},
           .mipLevels = std::uint32_t(texture.levels.size()),
           .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
          "blocks");
      Uploader uploader(testDevice());
      for (std::uint32_t l = 0; l < texture.levels.size(); ++l)
        uploader.image(blocks, 0, l,
                       {std::max(1u, std::uint32_t(width) >> l), std::max(1u, std::uint32_t(height) >> l)},
                       texture.levels[l]);
      uploader.flush();
      submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
        transition(commands, blocks.get(), use::kSampled, use::kTransferSource);
      });
      for (std::size_t l = 0; l < expected.size(); ++l) {
        const Image8 got = decodedOnDevice(blocks, std::uint32_t(l), expected[l].width, expected[l].height);
        CAPTURE(textureFormatName(format), width, height, l);
        CHECK(largestDifference(got, expected[l]) <= levelsOff);
      }
    }
}

TEST_CASE("compressed textures give the image of decoded textures, close to uncompressed ones", "[N14][bc]") {
  const SyntheticScene place = makeScene(test::place(3));
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03);
  const Stage plain(testDevice(), place);
  const Image8 expected = plain.render(view);
  struct Expected {
    TextureFormat format;
    int levels;    // max. difference from our decoder, 8-bit levels: filtering, and N14 for BC1
    double floor;  // min. PSNR, dB
  };
  for (const auto& [format, levels, floor] :
       {Expected{TextureFormat::bc1, 3, 34}, Expected{TextureFormat::bc7, 1, 42}}) {
    INFO(textureFormatName(format));
    const Encoded encoded(place, format);
    const Stage blocks(testDevice(), place, {.source = encoded.source(), .blocks = BlockTextureMode::keep});
    const Stage decoded(testDevice(), place, {.source = encoded.decodedSource()});
    const Image8 picture = blocks.render(view);
    CHECK(difference(picture, decoded.render(view), levels).shareAbove == 0);
    CHECK(psnr(picture, expected) > floor);
    CHECK(psnr(picture, expected) < 60);  // the image is not identical
  }
}

TEST_CASE("bilinear and trilinear filtering differ only slightly") {
  const SyntheticScene place = makeScene(test::place(3));
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03, 0, 160, 120);  // half the photographs' resolution
  const Stage trilinear(testDevice(), place, {.filter = TextureFilter::trilinear});
  const Stage bilinear(testDevice(), place, {.filter = TextureFilter::bilinear});
  const double between = psnr(bilinear.render(view), trilinear.render(view));
  CHECK(between > 25);
  CHECK(between < 60);
  // The device decides the meaning of TextureFilter::automatic.
  const bool software = testDevice().properties().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  const GpuScene automatic(testDevice(), place.scene, {.source = trilinear.source()});
  const Renderer renderer(testDevice(), automatic, {{160, 120}});
  Offscreen offscreen(testDevice(), {160, 120});
  const FramePlan plan = trilinear.plan(view);
  const Image8 picture =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  CHECK(picture == (software ? bilinear : trilinear).render(view));
}

TEST_CASE("bicubic filtering equals the reference at any size, and at a photograph's pose the photograph") {
  const Stage stage(testDevice(), makeScene(test::place(3)), {.filter = TextureFilter::bicubic});
  for (const int width : {640, 320, 240})  // magnified; between two levels; smaller
    compareWithReference(stage, stage.plan(cameraAt({0.4, 0.25, 0.1}, 0.03, 0, width, width * 3 / 4), withTiers()));
  SyntheticOptions room;
  for (const double x : {0.0, 1.0}) {
    Camera camera = cameraAt({x, 0, 0}, 3);  // the seam is ahead
    camera.intrinsics = {CameraModel::equirectangular, 256, 128};
    room.cameras.push_back(camera);
  }
  room.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  room.surfaceStep = 1;
  const Stage panoramas(testDevice(), makeScene(room), {.filter = TextureFilter::bicubic});
  compareWithReference(panoramas, panoramas.plan(cameraAt({0.4, 0.1, 0}, 0, 0, 160, 121, 1.2), withTiers()));

  const Image8& photograph = stage.place().photographs[0];
  const Image8 own = stage.render(stage.scene().nodes[0].camera, withTiers());
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x)
      if (own.pixel(x, y)[3] == 255)  // tier 0
        for (std::size_t c = 0; c < 3; ++c) REQUIRE(std::abs(own.pixel(x, y)[c] - photograph.pixel(x, y)[c]) <= 1);
}

TEST_CASE("for a magnified photograph bicubic filtering is closer to the truth than trilinear") {
  SyntheticOptions options = test::place(3);
  for (TexturedPlane& plane : options.planes) plane.wavelength = 0.2;
  const SyntheticScene place = makeScene(options);
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03, 0, 640, 480);
  const Image8 truth = renderTruth(place, view);
  RenderSettings settings;
  settings.alpha = AlphaContent::tier;
  const auto score = [&](TextureFilter filter) {
    const Image8 picture = Stage(testDevice(), place, {.filter = filter}).render(view, settings);
    Image8 mask(picture.width, picture.height, 1);
    for (std::size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = picture.values[4 * i + 3] == 255;
    return psnr(picture, truth, mask);
  };
  CHECK(score(TextureFilter::bicubic) > score(TextureFilter::trilinear) + 1);
}

TEST_CASE("allocated memory equals the prediction up to alignment", "[P12][bc]") {
  // The second scene uses three photographs of four, one of them in two cells and in a backdrop. One of its triangles
  // is rejected and not on the device.
  SyntheticOptions options = test::place(4);
  options.cells = {{0, 1}, {0, 2}};
  SyntheticScene some = makeScene(options);
  addBackdrops(some, options);
  some.scene.backdrops.resize(1);
  some.scene.cells[1].mesh.tier.back() = kTierRejected;
  SyntheticScene large = makeScene(test::place(2));
  for (Node& node : large.scene.nodes) node.camera.intrinsics = resized(node.camera.intrinsics, 1000, 750);
  for (const Scene& scene : {makeScene(test::place(4)).scene, some.scene, large.scene})
    for (const TextureFormat format : kFormats) {
      if (format != TextureFormat::rgba8 && !testDevice().supportsBlockCompression()) continue;
      // The content is irrelevant.
      const auto source = [&](const Scene& of, std::size_t node, int firstLevel) {
        const Intrinsics& k = of.nodes[node].camera.intrinsics;
        Texture texture;
        texture.format = format;
        texture.width = std::max(1, k.width >> firstLevel);
        texture.height = std::max(1, k.height >> firstLevel);
        for (int w = texture.width, h = texture.height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
          texture.levels.emplace_back(textureBytes(format, w, h));
          if (w == 1 && h == 1) return texture;
        }
      };
      const std::vector<TextureFormat> formats(scene.nodes.size(), format);
      const MemoryDemand demand = memoryDemand(scene, formats);
      const GpuScene gpuScene(testDevice(), scene, {.source = source, .blocks = BlockTextureMode::keep});
      const GpuScene::Memory memory = gpuScene.memory();
      CAPTURE(textureFormatName(format), scene.cells.size(), demand.textures, memory.textures);
      CHECK(memory.positions >= demand.positions);
      CHECK(memory.positions < demand.positions + 256);
      CHECK(memory.indices >= demand.indices);
      CHECK(memory.indices < demand.indices + 256);
      // Rows of large levels, and small levels, may be aligned: lavapipe adds 1.6 % to 1000×750 RGBA8.
      const std::uint64_t most = demand.textures / 32 + scene.nodes.size() * 10 * 1024;
      CHECK(memory.textures >= demand.textures);
      CHECK(memory.textures <= demand.textures + most);
    }
}

TEST_CASE("memory demand follows the corrected equation 21 of [T] in an example", "[T25]") {
  Scene scene;
  for (int n = 0; n < 4; ++n) {
    Node& node = scene.nodes.emplace_back();
    node.camera.intrinsics = pinholeFromFov(8, 4, 1);
  }
  Cell cell;
  cell.members = {0, 1, 2};
  cell.mesh.inverseDistance.resize(5);
  cell.mesh.triangles.resize(7);
  cell.mesh.tier = {0, 0, 0, 0, 0, 0, kTierRejected};
  scene.cells = {cell, cell};
  Cell backdrop;
  backdrop.members = {2};
  backdrop.mesh.inverseDistance.resize(3);
  backdrop.mesh.triangles.resize(1);
  backdrop.mesh.tier = {kTierConsistent};
  scene.backdrops = {backdrop};
  using enum TextureFormat;
  const MemoryDemand demand = memoryDemand(scene, std::vector{rgba8, bc1, bc7, rgba8});
  CHECK(demand.positions == 2 * 5 * (3 * 3 + 1) * 4 + 3 * (3 + 1) * 4);
  CHECK(demand.indices == (2 * 6 + 1) * 3 * 4);
  // 8×4, 4×2, 2×1, 1×1: 43 pixels, or 2 + 1 + 1 + 1 blocks. The fourth photograph is in no cell.
  CHECK(demand.textures == 43 * 4 + 5 * 8 + 5 * 16);
}

TEST_CASE("blocks are decoded if requested, faster, or not supported by the device", "[bc]") {
  const SyntheticScene place = makeScene(test::place(2));
  const Encoded encoded(place, TextureFormat::bc1);
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03);
  const Stage decoded(testDevice(), place, {.source = encoded.decodedSource()});
  const Image8 expected = decoded.render(view);
  const auto memory = [&](BlockTextureMode blocks, std::uint64_t budget) {
    const GpuScene gpuScene(testDevice(), place.scene,
                            {.source = encoded.source(), .budgetBytes = budget, .blocks = blocks});
    return gpuScene.memory();
  };
  if (!testDevice().supportsBlockCompression()) {  // a device without BC, or with IBR_DISABLE_FEATURES
    Messages messages;
    const Stage stage(testDevice(), place,
                      {.source = encoded.source(), .blocks = BlockTextureMode::keep, .log = messages.log()});
    CHECK(stage.render(view) == expected);
    REQUIRE(messages.all.size() == 1);
    CHECK_THAT(messages.all[0].second, Catch::Contains("RGBA8"));
    return;
  }
  const GpuScene::Memory kept = memory(BlockTextureMode::keep, 0);
  {
    Messages messages;
    const Stage stage(testDevice(), place,
                      {.source = encoded.source(), .blocks = BlockTextureMode::decode, .log = messages.log()});
    CHECK(stage.render(view) == expected);
    REQUIRE(messages.all.size() == 1);
    CHECK(messages.all[0].first == LogLevel::info);
    CHECK_THAT(messages.all[0].second, Catch::Contains("RGBA8"));
  }
  if (testDevice().properties().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) {
    CHECK(memory(BlockTextureMode::automatic, 0).textures > 5 * kept.textures);
    const std::uint64_t budget = kept.sum() + kept.textures;  // too small for decoded textures
    CHECK(memory(BlockTextureMode::automatic, budget).textures == kept.textures);
    // A software device samples BC7 so slowly that decoded textures are streamed instead.
    const Encoded bc7(place, TextureFormat::bc7);
    const std::uint64_t bc7Bytes =
        GpuScene(testDevice(), place.scene, {.source = bc7.source(), .blocks = BlockTextureMode::keep}).memory().sum();
    for (const BlockTextureMode blocks : {BlockTextureMode::automatic, BlockTextureMode::keep}) {
      const GpuScene gpuScene(testDevice(), place.scene,
                              {.source = bc7.source(), .budgetBytes = bc7Bytes, .blocks = blocks});
      CHECK(gpuScene.needsStreaming() == (blocks == BlockTextureMode::automatic));
      CHECK(gpuScene.memory().sum() <= bc7Bytes);
    }
  } else {
    CHECK(memory(BlockTextureMode::automatic, 0).textures == kept.textures);
  }
  // An adopted device without feature information: optional features count as disabled.
  Device adopted = Device::adopt({.instance = testDevice().instance(),
                                  .physicalDevice = testDevice().physicalDevice(),
                                  .device = testDevice().handle(),
                                  .queue = testDevice().queue(),
                                  .queueFamily = testDevice().queueFamily()});
  CHECK_FALSE(adopted.supportsBlockCompression());
  Messages messages;
  const Stage stage(adopted, place,
                    {.source = encoded.source(), .blocks = BlockTextureMode::keep, .log = messages.log()});
  CHECK(stage.render(view) == expected);
  REQUIRE(messages.all.size() == 1);
  CHECK(messages.all[0].first == LogLevel::warning);
  CHECK_THAT(messages.all[0].second, Catch::Contains("RGBA8"));
}
