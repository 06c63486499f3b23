// SPDX-License-Identifier: Apache-2.0
// Construction without the queue: uploads that the caller records (ibr/uploads.h).
#include "ibr/uploads.h"

#include <catch2/catch.hpp>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "base/vulkan/submit.h"
#include "engine/adopted_test_device.h"
#include "faults/small_place.h"
#include "gpu/draw/multiview.h"
#include "ibr/ecc_pass.h"
#include "ibr/graph_overlay.h"
#include "ibr/htm.h"
#include "ibr/template_search_pass.h"
#include "support/bumpy_model.h"
#include "support/error_of.h"
#include "support/handmade_device.h"
#include "support/planted.h"
#include "support/vulkan_calls.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr VkExtent2D kExtent{48, 36};

struct Look {
  const char* name;
  RenderSettings settings = {};
  TextureFormat format = TextureFormat::rgba8;
  bool streams = false;
};

std::vector<Look> looks() {
  std::vector<Look> all{{.name = "cells with colour tables"},
                        {.name = "gathered with depth textures"},
                        {.name = "overlay and hidden area"},
                        {.name = "BC1", .format = TextureFormat::bc1},
                        {.name = "BC7", .format = TextureFormat::bc7},
                        {.name = "streamed", .streams = true},
                        {.name = "streamed BC7, gathered", .format = TextureFormat::bc7, .streams = true}};
  all[0].settings.colourMapping = ColourMapping::ours;
  all[0].settings.maxTier = kTierFilled;
  all[1].settings.composition = Composition::hybrid;
  all[2].settings.overlay = Overlay::confidence;
  all[6].settings.composition = Composition::gathered;
  return all;
}

/// The photographs of a scene as textures of one format.
class Textures {
 public:
  Textures(const SmallScene& place, TextureFormat format) {
    for (std::size_t node = 0; node < place.scene().nodes.size(); ++node) {
      const Texture plain = place.source()(place.scene(), node, 0);
      textures_.push_back(format == TextureFormat::rgba8 ? plain : encodeTexture(decodeTexture(plain), format));
    }
  }
  TextureSource source() const {
    return [this](const Scene&, std::size_t node, int firstLevel) {
      return withoutLargestLevels(textures_[node], firstLevel);
    };
  }

 private:
  std::vector<Texture> textures_;
};

RendererOptions rendererOptions(const SmallScene& place, const RenderSettings& settings, Uploads* uploads) {
  RendererOptions options = optionsFor(settings, kExtent);
  options.uncertaintyScene = &place.scene();
  if (settings.overlay != Overlay::none) options.hiddenArea[0] = {{-1, -1}, {-0.5, -1}, {-1, -0.5}};
  options.uploads = uploads;
  return options;
}

/// First and second frame of a new scene. With `uploads`, they are recorded `records` times before the first frame.
std::vector<Image8> frames(Device& device, const SmallScene& place, const Look& look, const GpuSceneOptions& options,
                           Uploads* uploads, int records = 1) {
  const VulkanCalls before = vulkanCalls();
  GpuScene scene(device, place.scene(), options);
  const Renderer renderer(device, scene, rendererOptions(place, look.settings, uploads));
  Offscreen offscreen(device, kExtent);
  if (uploads) {
    CHECK((vulkanCalls() - before).queueUses() == 0);
    CHECK_FALSE(uploads->empty());
    CHECK(uploads->bytes() > 0);
  } else {
    CHECK((vulkanCalls() - before).queueUses() >= 4);  // otherwise the calls are not counted
  }
  const FramePlan plan = place.plan(look.settings);
  std::vector<Image8> images;
  for (std::uint64_t frame = 1; frame <= 2; ++frame) {
    images.push_back(offscreen.render([&](VkCommandBuffer commands) {
      for (int i = 0; uploads && frame == 1 && i < records; ++i) uploads->record(commands);
      if (scene.needsStreaming()) scene.stream(commands, plan, frame, frame - 1);
      renderer.record(commands, plan, offscreen.target());
    }));
    if (uploads) uploads->clear();
  }
  CHECK((scene.needsStreaming() || !look.streams));
  return images;
}

GpuSceneOptions sceneOptions(const Textures& textures, std::uint64_t budget, Uploads* uploads) {
  GpuSceneOptions options;
  options.source = textures.source();
  options.budgetBytes = budget;
  options.depthSource = farDepths;
  options.blocks = BlockTextureMode::keep;
  options.uploads = uploads;
  options.readerThreads = 0;
  return options;
}

}  // namespace

TEST_CASE("scenes and renderers made with uploads use no queue, and the first frame is the same") {
  const SmallScene place;
  const Look look = GENERATE(from_range(looks()));
  CAPTURE(look.name);
  Device device = Device::adopt(testDeviceHandles());
  if (look.format != TextureFormat::rgba8 && !device.supportsBlockCompression()) return;
  const Textures textures(place, look.format);
  std::uint64_t budget = 0;
  if (look.streams) budget = GpuScene(device, place.scene(), sceneOptions(textures, 0, nullptr)).memory().sum() - 1;
  const std::vector<Image8> expected = frames(device, place, look, sceneOptions(textures, budget, nullptr), nullptr);
  Uploads uploads(device);
  for (const int records : {1, 2}) {
    CAPTURE(records);
    CHECK((frames(device, place, look, sceneOptions(textures, budget, &uploads), &uploads, records) == expected));
    CHECK(uploads.empty());
    CHECK(uploads.bytes() == 0);
  }
}

TEST_CASE("uploads of an adopted device whose queue nobody else uses are visible to later submissions") {
  const SmallScene place;
  const HandmadeDevice handmade;
  Device device = Device::adopt(handmade.handles());
  const std::vector<Image8> expected = place.pictures(device, place.open(device), place.plan({}));
  const VulkanCalls before = vulkanCalls();
  Uploads uploads(device);
  const GpuScene scene = place.open(device, {.uploads = &uploads});
  const Renderer renderer(device, scene, rendererOptions(place, {}, &uploads));
  const GraphOverlay overlay(device, imageGraph(place.scene()), {.uploads = &uploads});
  CHECK((vulkanCalls() - before).queueUses() == 0);
  submitAndWait(device, [&](VkCommandBuffer commands) { uploads.record(commands); });
  uploads.clear();
  Offscreen offscreen(device, kExtent);
  const FramePlan plan = place.plan({});
  CHECK((offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); }) ==
         expected[0]));
  CHECK(device.validationMessages() == 0);
}

TEST_CASE("uploads that are dropped leave objects that can be destroyed") {
  const SmallScene place;
  Device device = Device::adopt(testDeviceHandles());
  const VulkanCalls before = vulkanCalls();
  Uploads uploads(device);
  {
    const GpuScene scene = place.open(device, {.uploads = &uploads});
    const Renderer renderer(device, scene, rendererOptions(place, {}, &uploads));
    CHECK_FALSE(uploads.empty());
    uploads.clear();
    CHECK(uploads.empty());
    CHECK(uploads.bytes() == 0);
  }
  const VulkanCalls calls = vulkanCalls() - before;
  CHECK(calls.queueUses() == 0);
  CHECK(calls.allocations == calls.frees);
}

TEST_CASE("a constructor that throws adds no uploads") {
  const SmallScene place;
  Device device = Device::adopt(testDeviceHandles());
  Uploads uploads(device);
  const auto broken = [&](const Scene& scene, std::size_t node, int firstLevel) {
    if (node + 1 == scene.nodes.size() && firstLevel == 0) throw Error(ErrorCode::io, "the last photograph is gone");
    return place.source()(scene, node, firstLevel);
  };
  const auto fail = [&] {
    GpuSceneOptions options;
    options.source = broken;
    options.depthSource = farDepths;
    options.uploads = &uploads;
    CHECK(errorOf([&] { GpuScene(device, place.scene(), options); }).code() == ErrorCode::io);
  };
  fail();
  CHECK(uploads.empty());
  CHECK(uploads.bytes() == 0);
  // Uploads of other objects are kept.
  const GpuScene scene = place.open(device, {.uploads = &uploads});
  const std::uint64_t bytes = uploads.bytes();
  fail();
  CHECK(errorOf([&] {
          RendererOptions options = rendererOptions(place, {}, &uploads);
          options.formats = {VK_FORMAT_R32_SFLOAT};
          Renderer(device, scene, options);
        }).code() == ErrorCode::unsupported);
  CHECK(uploads.bytes() == bytes);
  const Renderer renderer(device, scene, rendererOptions(place, {}, &uploads));
  Offscreen offscreen(device, kExtent);
  const FramePlan plan = place.plan({});
  const Image8 image = offscreen.render([&](VkCommandBuffer commands) {
    uploads.record(commands);
    renderer.record(commands, plan, offscreen.target());
  });
  CHECK((image == place.pictures(device, place.open(device), plan)[0]));
}

TEST_CASE("a renderer made with uploads draws both views at once only after a probe of multiview", "[multiview]") {
  const SmallScene place;
  Device device = Device::adopt(testDeviceHandles());
  Uploads uploads(device);
  const GpuScene scene = place.open(device, {.uploads = &uploads});
  const FramePlan plan = place.plan({}, 2);
  const auto canvases = [&](bool multiview, Uploads* into) {
    RendererOptions options = rendererOptions(place, {}, into);
    options.maxViews = 2;
    options.multiview = multiview;
    return Renderer(device, scene, options).count(plan).bytes.canvases;
  };
  const VulkanCalls before = vulkanCalls();
  const std::uint64_t single = canvases(false, &uploads);
  CHECK(canvases(true, &uploads) == single);
  CHECK((vulkanCalls() - before).queueUses() == 0);

  const bool works = Renderer::probeMultiview(device);
  const VulkanCalls probed = vulkanCalls();
  CHECK(((probed - before).queueUses() > 0) == device.supportsMultiview());
  CHECK(Renderer::probeMultiview(device) == works);
  CHECK((canvases(true, &uploads) > single) == works);
  CHECK((vulkanCalls() - probed).queueUses() == 0);
  CHECK(works == runMultiviewProbe(testDevice()));
  uploads.clear();  // the renderers are destroyed
}

TEST_CASE("a harmonised model is opened and replaced without the queue, and its image is the same") {
  Device device = Device::adopt(testDeviceHandles());
  const BumpyModel bumpy = bumpyModel({.cameras = 3, .width = 40, .height = 30, .longitudes = 8, .latitudes = 6});
  const BumpyModel other = bumpyModel({.cameras = 4, .width = 50, .height = 30, .longitudes = 9, .latitudes = 7});
  const Camera view = ringCamera(bumpy.options, 0.3);
  const VkExtent2D extent{std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
  const auto planOf = [&](const BumpyModel& shown) {
    return planHtmFrame(shown.model, htmBounds(shown.model), {view, {}});
  };
  Uploads uploads(device);
  const auto images = [&](Uploads* into) {
    const VulkanCalls before = vulkanCalls();
    GpuHtmModel model(device, bumpy.model, bumpy.source(), {.uploads = into});
    HtmRenderer renderer(device, model, {.maxExtent = extent});
    Offscreen offscreen(device, extent);
    if (into) CHECK((vulkanCalls() - before).queueUses() == 0);
    const auto show = [&](const BumpyModel& shown) {
      const HtmFramePlan plan = planOf(shown);
      return offscreen.render([&](VkCommandBuffer commands) {
        if (into) into->record(commands);
        renderer.record(commands, plan, offscreen.target());
        if (into) into->record(commands);  // waits for the frame's reads
        Target again = offscreen.target();
        again.initialUse = again.finalUse;
        renderer.record(commands, plan, again);
      });
    };
    std::vector<Image8> made{show(bumpy)};
    if (into) into->clear();
    const VulkanCalls shown = vulkanCalls();
    model.replace(other.model, other.source(), into);
    if (into) CHECK((vulkanCalls() - shown).queueUses() == 0);
    renderer.setModel(model);
    made.push_back(show(other));
    if (into) into->clear();
    return made;
  };
  const std::vector<Image8> expected = images(nullptr);
  CHECK((expected[0] != expected[1]));
  CHECK((images(&uploads) == expected));
}

TEST_CASE("passes of alignment and of template search are made without the queue") {
  Device device = Device::adopt(testDeviceHandles());
  const Planted planted = test::planted(2, 40, 2, 2.0, 11);
  std::vector<const Image8*> pictures;
  for (const Image8& picture : planted.pictures) pictures.push_back(&picture);
  std::vector<TemplateSample> samples;
  for (int k = 0; k < 25; ++k) {
    const auto p = planted.pictures[0].pixel(12 + k % 5, 12 + k / 5);
    samples.push_back({std::int16_t(10 + k % 5), std::int16_t(13 + k / 5), p[0], p[1], p[2]});
  }
  const std::vector<TemplateTask> tasks{{0, 0, 25, {}}};
  const VulkanCalls before = vulkanCalls();
  Uploads uploads(device);
  TemplateSearchPass search(device, pictures, {.tasks = 1, .samples = 25}, &uploads);
  std::optional<EccPass> ecc;
  if (device.supportsInt64()) ecc.emplace(device, planted.alignment, AlignmentOptions{.instances = 8}, &uploads);
  CHECK((vulkanCalls() - before).queueUses() == 0);
  search.set(tasks, samples, 4, TemplateMeasure::absoluteDifferences);
  submitAndWait(device, [&](VkCommandBuffer commands) {
    uploads.record(commands);
    search.record(commands);
    if (ecc) {
      ecc->recordEvaluation(commands);
      ecc->recordReadback(commands);
    }
  });
  uploads.clear();
  CHECK((search.matches()[0].displacement == glm::ivec2(2, -1)));
  if (!ecc) return;
  const EccPass ordinary(device, planted.alignment, {.instances = 8});
  submitAndWait(device, [&](VkCommandBuffer commands) {
    ordinary.recordEvaluation(commands);
    ordinary.recordReadback(commands);
  });
  CHECK((ecc->positions() == planted.alignment.position));
  const std::vector<std::vector<EccStar>> stars = ecc->stars(), expected = ordinary.stars();
  REQUIRE(stars.size() == expected.size());
  for (std::size_t picture = 0; picture < stars.size(); ++picture)
    for (std::size_t p = 0; p < stars[picture].size(); ++p) {
      CHECK(stars[picture][p].pixels == expected[picture][p].pixels);
      CHECK(stars[picture][p].channels == expected[picture][p].channels);
      CHECK(stars[picture][p].concatenated == expected[picture][p].concatenated);
    }
}

TEST_CASE("a thread without a lock loads a scene while another one uses the queue") {
  const SmallScene place;
  const HandmadeDevice handmade;
  Device device = Device::adopt(handmade.handles()), loading = Device::adopt(handmade.handles());
  const FramePlan plan = place.plan({});
  const GpuScene shown = place.open(device);
  const Image8 expected = place.pictures(device, shown, plan)[0];
  Uploads uploads(loading);
  std::unique_ptr<GpuScene> scene;
  std::unique_ptr<Renderer> renderer;
  std::thread loader([&] {
    scene = std::make_unique<GpuScene>(place.open(loading, {.uploads = &uploads}));
    renderer = std::make_unique<Renderer>(loading, *scene, rendererOptions(place, {}, &uploads));
  });
  for (int i = 0; i < 3; ++i) CHECK((place.pictures(device, shown, plan)[0] == expected));
  loader.join();
  Offscreen offscreen(device, kExtent);
  const Image8 image = offscreen.render([&](VkCommandBuffer commands) {
    uploads.record(commands);
    renderer->record(commands, plan, offscreen.target());
  });
  uploads.clear();
  CHECK((image == expected));
  CHECK(device.validationMessages() == 0);
}
