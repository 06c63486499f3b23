// SPDX-License-Identifier: Apache-2.0
#include <cassert>

#include "gpu/canvas.h"
#include "ibr/renderer.h"
#include "render/cell_pass.h"
#include "render/composite_pass.h"

namespace ibr {

struct Renderer::State {
  State(Device& device, const GpuScene& scene, VkExtent2D size)
      : largest(size), canvas(device, size), cells(device, scene, canvas.renderPass()), composite(device, canvas) {}

  VkExtent2D largest;
  Canvas canvas;
  CellPass cells;
  CompositePass composite;
};

Renderer::Renderer(Device& device, const GpuScene& scene, VkExtent2D largest)
    : state_(std::make_unique<State>(device, scene, largest)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

bool Renderer::supports(VkFormat format) noexcept {
  return CompositePass::supports(format);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan, const Target& target) const noexcept {
  const State& s = *state_;
  assert(target.extent.width <= s.largest.width && target.extent.height <= s.largest.height);
  assert(int(target.extent.width) == plan.view.intrinsics.width &&
         int(target.extent.height) == plan.view.intrinsics.height);
  s.cells.update(commandBuffer, plan);
  s.canvas.begin(commandBuffer, target.extent, {0, 0, 0, 0});
  s.cells.draw(commandBuffer, plan, target.extent);
  s.canvas.end(commandBuffer);
  s.composite.record(commandBuffer, plan.settings, target);
}

}  // namespace ibr
