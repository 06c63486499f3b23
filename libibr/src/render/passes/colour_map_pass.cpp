// SPDX-License-Identifier: Apache-2.0
#include "render/passes/colour_map_pass.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "render/plan/colour_plan.h"
#include "render/resident/gpu_scene_state.h"
#include "shaders/colour_apply_comp.h"
#include "shaders/colour_count_frag.h"
#include "shaders/colour_proxy_frag.h"
#include "shaders/colour_redraw_frag.h"
#include "shared/cell.h"

namespace ibr {
namespace {

struct FragmentConstants {  // push constants of colour_proxy.frag; colour_count.frag uses the first alone
  std::uint32_t originOrCell, originY;
  float detail;
};
struct ApplyConstants {
  std::uint32_t width, height, slot;
};

constexpr ImageUse kSampledByCompute{use::kSampled.layout, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                     VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
// The image is replaced as a whole, after all reads of it.
constexpr ImageUse kReplaced{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_NONE};

std::uint32_t shareOf(double share) {
  return std::uint32_t(std::lround(std::clamp(share, 0.0, 1.0) * shader::kWhole));
}

std::uint32_t methodOf(ColourTable table) {
  switch (table) {
    case ColourTable::naive:
      return shader::kMapNaive;
    case ColourTable::strict:
      return shader::kMapStrict;
    case ColourTable::preserving:
      break;
  }
  return shader::kMapPreserving;
}

// True if the proxy shows the item: a planned cell, not one that fades out, whose table is needed.
bool isCounted(const FramePlan& plan, const DrawItem& item) {
  return item.cell != kNoCell && plan.cells[item.cell].colourTableNeeded;
}

// True if the list draws the main cell, plan.cells[0], whose colours are the reference.
bool startsWithMainCell(const DrawList& list) {
  return list.count > 0 && list.items[0].cell == 0;
}

RenderPassHandle makeRenderPass(const Device& device) {
  const VkAttachmentDescription attachment{.format = Canvas::kColourFormat,
                                           .samples = VK_SAMPLE_COUNT_1_BIT,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                           .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                           .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                           .initialLayout = use::kColourAttachment.layout,
                                           .finalLayout = use::kColourAttachment.layout};
  const VkAttachmentReference colour{0, use::kColourAttachment.layout};
  const VkSubpassDescription subpass{
      .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1, .pColorAttachments = &colour};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .attachmentCount = 1,
                                    .pAttachments = &attachment,
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass};
  return make<RenderPassHandle>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

}  // namespace

ColourMapPass::ColourMapPass(Device& device, ColourTables& tables, const CellPass& cells, const Canvas& canvas,
                             const RendererOptions& options)
    : tables_(&tables), cells_(&cells), canvas_(&canvas) {
  assert(options.colour != ColourSupport::off);
  const bool sequence = options.colour == ColourSupport::all;
  const std::array<VkDescriptorSetLayout, 3> sets{cells.frameLayout(), cells.scene().sets.layout(), tables.setLayout()};
  const VkPushConstantRange constants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(FragmentConstants)};
  layout_ = makePipelineLayout(device, sets, {&constants, 1});
  proxySet_ = tables.makeSet(device, canvas.colourView(), VK_NULL_HANDLE);
  if (sequence) {
    copy_.emplace(device,
                  GpuImageInfo{.format = Canvas::kColourFormat,
                               .extent = canvas.largest(),
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                  "framebuffer copy");
    renderPass_ = makeRenderPass(device);
    const VkImageView view = canvas.colourView();
    const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                       .renderPass = renderPass_.get(),
                                       .attachmentCount = 1,
                                       .pAttachments = &view,
                                       .width = canvas.largest().width,
                                       .height = canvas.largest().height,
                                       .layers = 1};
    framebuffer_ = make<FramebufferHandle>(device, vkCreateFramebuffer, info, "vkCreateFramebuffer");
    sequenceSet_ = tables.makeSet(device, copy_->view(), canvas.colourView());
    const VkPushConstantRange which{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(ApplyConstants)};
    applyLayout_ = makePipelineLayout(device, {&sets[2], 1}, {&which, 1});
    apply_ = makeComputePipeline(
        device, {.name = "colour apply", .shader = shaders::colour_apply_comp, .layout = applyLayout_.get()});
  }

  const auto require = [&](Stage stage, const GpuScene::State::Mesh& mesh, bool mayDissolve) {
    const CellPipelineInfo infos[]{
        {"colour proxy", shaders::colour_proxy_frag, layout_.get(), canvas.renderPass(), true},
        {"colour count", shaders::colour_count_frag, layout_.get(), renderPass_.get()},
        {"colour redraw", shaders::colour_redraw_frag, layout_.get(), renderPass_.get()}};
    for (const CellVariant& variant : variantsOf(mesh, mayDissolve, options.blends))
      if (const Key key{stage, variant}; !pipelines_.contains(key))
        pipelines_.emplace(key, makeCellPipeline(device, variant, infos[std::size_t(stage)]));
  };
  for (const GpuScene::State::Mesh& cell : cells.scene().cells) {
    require(Stage::proxy, cell, options.dissolve);
    if (!sequence) continue;
    require(Stage::count, cell, options.dissolve);
    require(Stage::redraw, cell, options.dissolve);
  }
}

shader::ColourFrame ColourMapPass::frameOf(const FramePlan& plan, VkExtent2D extent, VkExtent2D canvas) noexcept {
  const RenderSettings& settings = plan.settings;
  shader::ColourFrame frame{};
  frame.count = std::uint32_t(plan.cells.size());
  frame.joint = settings.colourMapping == ColourMapping::ours;
  frame.method = methodOf(settings.colourTable);
  frame.least = std::min(settings.colourMinSamples, 1u << 22);
  frame.kept = std::uint32_t(
      std::lround(std::clamp(settings.colourSamples, 0.0, 1.0) * shader::kNoiseSize * shader::kNoiseSize));
  frame.measured = !frame.joint;
  frame.mainShare = shareOf(plan.colour.mainShare);
  frame.share = shareOf(plan.colour.share);
  frame.maxStep = std::uint32_t(std::lround(std::clamp(plan.colour.maxStep, 0.0, 255.0) * shader::kFine));
  for (std::uint32_t k = 0; k < frame.count; ++k) {
    frame.slot[k] = plan.cells[k].colourSlot;
    frame.owner[k] = plan.cells[k].cell + 1;
    const bool fresh = plan.cells[k].colourTableIsNew || !eyesShare(plan);
    frame.fresh[k] = (fresh ? shader::kColourFresh : 0) | (plan.cells[k].colourTableNeeded ? 0 : shader::kColourUnseen);
  }
  // A proxy of a small image would have too few pixels for reliable tables, so its pixels are closer together.
  constexpr double kEnoughPixels = 20'000;
  const double pixels = double(extent.width) * double(extent.height);
  const int most = std::max(1, int(std::sqrt(pixels / kEnoughPixels)));
  const auto maxDivisor = int(std::min(extent.width, extent.height));
  for (int divisor = std::clamp(settings.colourProxy, 1, most);
       plan.colour.countHistograms && divisor <= maxDivisor && !frame.measured; ++divisor) {
    frame.tileWidth = extent.width / std::uint32_t(divisor);
    frame.tileHeight = extent.height / std::uint32_t(divisor);
    frame.tileColumns = canvas.width / frame.tileWidth;
    frame.measured = frame.tileColumns * (canvas.height / frame.tileHeight) >= frame.count;
  }
  return frame;
}

void ColourMapPass::count(const PlanDraws& draws, VkExtent2D extent, Renderer::Counters& counters) const noexcept {
  const FramePlan& plan = draws.plan;
  const ColourMapping mapping = plan.settings.colourMapping;
  if (mapping == ColourMapping::off) return;
  const shader::ColourFrame frame = frameOf(plan, extent, canvas_->largest());
  const DrawList& list = draws.list(Order::current, 0);
  const auto again = [&](const DrawItem& item) {
    ++counters.draws;
    counters.triangles += item.mesh->place.indices.count / 3;
  };
  if (mapping == ColourMapping::ours) {
    for (std::size_t view = 0; view < (eyesShare(plan) ? 1 : plan.views.size()); ++view) {
      if (frame.count > 0) ++counters.dispatches;
      if (!frame.measured || frame.count < 2) continue;
      ++counters.passes;
      ++counters.dispatches;
      for (const DrawItem& item : list.all())
        if (isCounted(plan, item)) again(item);
    }
    return;
  }
  std::uint32_t made = std::min(frame.count, 1u);
  counters.dispatches += made;
  for (std::uint32_t s = startsWithMainCell(list) ? 1 : 0; s < list.count; ++s) {
    const DrawItem& item = list.items[s];
    ++counters.passes;
    const std::uint32_t upTo = item.cell + 1;
    counters.dispatches += made < upTo;
    made = std::max(made, upTo);
    if (mapping == ColourMapping::paper) {
      ++counters.dispatches;
    } else {
      ++counters.passes;
      again(item);
    }
  }
}

void ColourMapPass::draw(VkCommandBuffer commands, Stage stage, const DrawItem& item, BlendMode blend,
                         std::uint32_t parameter, VkExtent2D extent) const noexcept {
  const VkRenderPassBeginInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = renderPass_.get(),
                                   .framebuffer = framebuffer_.get(),
                                   .renderArea = {{0, 0}, extent}};
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  setViewport(commands, extent);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.at({stage, variantOf(item, blend)}).get());
  cells_->bind(commands, layout_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetColour, 1,
                          &sequenceSet_, 0, nullptr);
  const FragmentConstants constants{item.cell, 0, 1};
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof constants, &constants);
  cells_->drawItem(commands, layout_.get(), item, parameter);
  vkCmdEndRenderPass(commands);
}

void ColourMapPass::makeTables(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view,
                               VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  const shader::ColourFrame frame = frameOf(plan, extent, canvas_->largest());
  tables_->begin(commands, frame);
  if (frame.measured && frame.count > 1) {
    const DrawList& list = draws.list(Order::current, view);
    const std::uint32_t rows = (frame.count + frame.tileColumns - 1) / frame.tileColumns;
    canvas_->begin(commands, {std::min(frame.count, frame.tileColumns) * frame.tileWidth, rows * frame.tileHeight},
                   {0, 0, 0, 0});
    cells_->bind(commands, layout_.get());
    for (std::uint32_t s = 0; s < list.count; ++s) {
      const DrawItem& item = list.items[s];
      if (!isCounted(plan, item)) continue;
      const VkOffset2D origin{std::int32_t(item.cell % frame.tileColumns * frame.tileWidth),
                              std::int32_t(item.cell / frame.tileColumns * frame.tileHeight)};
      const VkViewport viewport{float(origin.x), float(origin.y), float(frame.tileWidth), float(frame.tileHeight), 0,
                                kStepDepth};
      const VkRect2D scissor{origin, {frame.tileWidth, frame.tileHeight}};
      const FragmentConstants tile{std::uint32_t(origin.x), std::uint32_t(origin.y),
                                   float(frame.tileHeight) / float(extent.height)};
      vkCmdSetViewport(commands, 0, 1, &viewport);
      vkCmdSetScissor(commands, 0, 1, &scissor);
      vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                        pipelines_.at({Stage::proxy, variantOf(item, plan.settings.blend)}).get());
      vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof tile, &tile);
      cells_->drawItem(commands, layout_.get(), item, cells_->firstParameter(Order::current, view) + s);
    }
    canvas_->end(commands);
    transition(commands, canvas_->colour(), use::kSampled, kSampledByCompute);
    tables_->count(commands, proxySet_, frame);
  }
  if (frame.count > 0) tables_->chain(commands, proxySet_, 0, frame.count);
}

void ColourMapPass::drawSequence(VkCommandBuffer commands, const PlanDraws& draws, VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  assert(copy_);
  const bool byCompute = plan.settings.colourMapping == ColourMapping::paper;
  const shader::ColourFrame frame = frameOf(plan, extent, canvas_->largest());
  const DrawList& list = draws.list(Order::current, 0);
  const std::uint32_t parameter = cells_->firstParameter(Order::current, 0);
  tables_->begin(commands, frame);
  std::uint32_t made = 0;
  const auto makeUpTo = [&](std::uint32_t end) {
    if (made < end) tables_->chain(commands, sequenceSet_, made, end);
    made = std::max(made, end);
  };
  makeUpTo(std::min(frame.count, 1u));

  // The main cell is not mapped: it is the reference.
  canvas_->begin(commands, extent, {0, 0, 0, 0});
  if (startsWithMainCell(list)) {
    setViewport(commands, extent);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, cells_->pipeline(plan, list.items[0]));
    cells_->bind(commands, cells_->layout());
    cells_->drawItem(commands, cells_->layout(), list.items[0], parameter);
  }
  canvas_->end(commands);
  transition(commands, canvas_->colour(), use::kSampled, use::kTransferSource);

  for (std::uint32_t s = startsWithMainCell(list) ? 1 : 0; s < list.count; ++s) {
    const DrawItem& item = list.items[s];
    transition(commands, copy_->get(), kReplaced, use::kTransferDestination);
    const VkImageSubresourceLayers whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkImageCopy region{whole, {}, whole, {}, {extent.width, extent.height, 1}};
    vkCmdCopyImage(commands, canvas_->colour(), use::kTransferSource.layout, copy_->get(),
                   use::kTransferDestination.layout, 1, &region);
    transition(commands, copy_->get(), use::kTransferDestination, use::kSampled);
    transition(commands, canvas_->colour(), use::kTransferSource, use::kColourAttachment);
    draw(commands, Stage::count, item, plan.settings.blend, parameter + s, extent);
    makeUpTo(item.cell + 1);
    if (byCompute) {
      transition(commands, canvas_->colour(), use::kColourAttachment, use::kStorage);
      const ApplyConstants which{extent.width, extent.height, item.table};
      vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, apply_.get());
      vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, applyLayout_.get(), 0, 1, &sequenceSet_, 0,
                              nullptr);
      vkCmdPushConstants(commands, applyLayout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof which, &which);
      vkCmdDispatch(commands, (extent.width + 7) / 8, (extent.height + 7) / 8, 1);
      transition(commands, canvas_->colour(), use::kStorage, use::kTransferSource);
    } else {
      transition(commands, canvas_->colour(), use::kColourAttachment, use::kColourAttachment);
      draw(commands, Stage::redraw, item, plan.settings.blend, parameter + s, extent);
      transition(commands, canvas_->colour(), use::kColourAttachment, use::kTransferSource);
    }
  }
  transition(commands, canvas_->colour(), use::kTransferSource, use::kSampled);
}

}  // namespace ibr
