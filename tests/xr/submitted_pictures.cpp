// SPDX-License-Identifier: Apache-2.0
#include "submitted_pictures.h"

#include <fstream>

namespace fs = std::filesystem;

namespace ibr::test {

void SubmittedPictures::session(const XrSessionCreateInfo& info) {
  images_.clear();
  const auto* binding = chained<XrGraphicsBindingVulkanKHR>(info.next, XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR);
  if (active() && binding)
    tap_ = PictureTap(binding->physicalDevice, binding->device, binding->queueFamilyIndex, binding->queueIndex);
}

void SubmittedPictures::swapchain(XrSwapchain swapchain, PFN_xrEnumerateSwapchainImages enumerate) {
  std::uint32_t count = 0;
  if (!active() || XR_FAILED(enumerate(swapchain, 0, &count, nullptr))) return;
  std::vector<XrSwapchainImageVulkan2KHR> all(count, {XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR});
  if (XR_FAILED(enumerate(swapchain, count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(all.data())))) return;
  for (const auto& one : all) images_[swapchain].push_back(one.image);
}

void SubmittedPictures::frame(const XrFrameEndInfo& info, const FrameRecord& record) const {
  if (!active() || !fs::exists(folder_ / "wanted")) return;
  for (std::uint32_t i = 0; i < info.layerCount; ++i)
    if (info.layers[i]->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
      write(reinterpret_cast<const XrCompositionLayerProjection&>(*info.layers[i]), record);
      fs::remove(folder_ / "wanted");
      return;
    }
}

void SubmittedPictures::write(const XrCompositionLayerProjection& layer, const FrameRecord& record) const {
  for (std::uint32_t i = 0; i < layer.viewCount; ++i) {
    const auto& [swapchain, rect, index] = layer.views[i].subImage;
    const FrameRecord::Given given = record.given(swapchain);
    const auto images = images_.find(swapchain);
    if (images == images_.end() || given.image < 0) continue;
    const std::vector<std::uint8_t> pixels = tap_.read(
        images->second.at(std::size_t(given.image)), index,
        {{rect.offset.x, rect.offset.y}, {std::uint32_t(rect.extent.width), std::uint32_t(rect.extent.height)}});
    std::ofstream out(folder_ / ("eye" + std::to_string(i)), std::ios::binary);
    out << rect.extent.width << ' ' << rect.extent.height << ' ' << given.format << '\n';
    out.write(reinterpret_cast<const char*>(pixels.data()), std::streamsize(pixels.size()));
  }
}

}  // namespace ibr::test
