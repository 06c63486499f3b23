// SPDX-License-Identifier: Apache-2.0
// Draws harmonised models and 3D video.
#include <algorithm>
#include <optional>

#include "base/vulkan/submit.h"
#include "ibr/offscreen.h"
#include "shared/camera/mesh_pick.h"
#include "shared/draw/graph_lines.h"
#include "shared/draw/htm_model_renderer.h"
#include "shared/draw/image_operations.h"
#include "viewer/open/item_on_device.h"

namespace ibr::app {
namespace {

class ModelOnDevice final : public ItemOnDevice {
 public:
  ModelOnDevice(Device& device, std::shared_ptr<OpenItem> item) : device_(device), owned_(std::move(item)) { choose(); }

  void record(const FrameContext& context, const Target& target, ScopeTimer* timer) override {
    choose();
    prepare(target);
    const Camera view = cameraOf(item_, target.extent);
    quiet_ = sameView(view, plan_.view) ? quiet_ + context.seconds : 0;
    planHtmFrame(*model_, bounds_, {view, item_.htmSettings, context.seconds}, plan_.next, plan_);
    renderer_->record(context.commands, plan_, target, timer);
    if (item_.showGraph) {
      const GpuScope scope(context.commands, timer, "graph");
      recordGraph(context.commands, graph(), view, target);
    }
  }

  bool needsRedraw() const override {
    return item_.playing || waiting_ || quiet_ < 5 * item_.htmSettings.smoothingSeconds;
  }

  Image8 picture(VkExtent2D extent, std::uint64_t& frame) override {
    choose(true);  // waits, so that the image shows the frame that its metadata names
    Offscreen offscreen(device_, extent);
    const HtmRenderer renderer(device_, *gpuModel_, {.maxExtent = extent});
    const HtmFramePlan plan = planHtmFrame(*model_, bounds_, {cameraOf(item_, extent), item_.htmSettings, 0});
    ++frame;
    Image8 image = offscreen.render([&](VkCommandBuffer commands) {
      renderer.record(commands, plan, offscreen.target());
      if (item_.showGraph) recordGraph(commands, graph(), plan.view, offscreen.target());
    });
    if (item_.showGraph) makeOpaque(image);  // lines also lie outside the object, where alpha is 0
    return image;
  }

  std::optional<glm::dvec3> pointAt(VkExtent2D extent, glm::dvec2 pixel) override {
    const Camera view = cameraOf(item_, extent);
    return pickedPoint(model_->surface.mesh, view.pose.position,
                       view.pose.rotation * unproject(view.intrinsics, pixel));
  }

  void rebuildPipelines() override {
    waitIdle(device_);
    graph_.reset();
    if (!renderer_) return;
    HtmRenderer fresh(device_, *gpuModel_, {.maxExtent = largest_, .formats = {format_}});
    *renderer_ = std::move(fresh);
  }

  std::vector<MemoryClass> memory() const override {
    const GpuHtmModel::Memory m = gpuModel_->memory();
    return {{"photographs", m.photographs, false},
            {"mesh", m.mesh, false},
            {"complements", m.complements, false},
            {"depths", m.depths, false}};
  }

 private:
  // Selects the model of the current time. If the model is not loaded yet, waits for it, or keeps the last model until
  // a later call.
  void choose(bool waits = false) {
    std::shared_ptr<const HtmModel> model{std::shared_ptr<void>(), &*item_.model};
    HtmImageSource source = readHtmPicture;
    if (item_.video) {
      const std::size_t index = item_.video->frameAt(item_.time);
      const auto frame = model_ && !waits ? item_.video->tryFrame(index) : item_.video->frame(index);
      waiting_ = !frame;
      if (!frame) return;
      model = {frame, &frame->model};
      source = [frame](const HtmModel&, std::size_t camera) { return frame->pictures[camera]; };
    }
    if (model == model_) return;
    if (gpuModel_) {
      plan_.next = transferHtmState(*model, *model_, plan_.next);
      waitIdle(device_);
      gpuModel_->replace(*model, source);
      if (renderer_) renderer_->setModel(*gpuModel_);
    } else {
      gpuModel_.emplace(device_, *model, source);
    }
    model_ = std::move(model);
    bounds_ = htmBounds(*model_);
  }

  void prepare(const Target& target) {
    const VkExtent2D& e = target.extent;
    if (renderer_ && largest_.width >= e.width && largest_.height >= e.height) return;
    waitIdle(device_);
    largest_ = {std::max(largest_.width, e.width), std::max(largest_.height, e.height)};
    format_ = target.format;
    renderer_.emplace(device_, *gpuModel_, HtmRendererOptions{.maxExtent = largest_, .formats = {target.format}});
  }

  GraphOverlay& graph() {
    if (!graph_) graph_ = graphLines(device_, *item_.model, VK_FORMAT_R8G8B8A8_UNORM);  // of all intermediate images
    return *graph_;
  }

  Device& device_;
  std::shared_ptr<OpenItem> owned_;
  OpenItem& item_ = *owned_;
  std::shared_ptr<const HtmModel> model_;
  HtmBounds bounds_;
  std::optional<GpuHtmModel> gpuModel_;
  std::optional<HtmRenderer> renderer_;
  std::optional<GraphOverlay> graph_;
  VkExtent2D largest_{0, 0};
  VkFormat format_ = VK_FORMAT_UNDEFINED;
  HtmFramePlan plan_;  // of the last frame
  double quiet_ = 0;
  bool waiting_ = false;
};

}  // namespace

std::unique_ptr<ItemOnDevice> modelOnDevice(Device& device, std::shared_ptr<OpenItem> item) {
  return std::make_unique<ModelOnDevice>(device, std::move(item));
}

}  // namespace ibr::app
