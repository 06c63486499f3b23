// SPDX-License-Identifier: Apache-2.0
// Dear ImGui in a window: its context and input (Interface), and its drawing by a device (InterfaceDrawer), which may
// be lost and made anew while the context stays.
#pragma once

#include <filesystem>
#include <vector>

#include "gpu/handle.h"
#include "viewer/swapchain.h"
#include "viewer/window.h"

namespace ibr::app {

class Interface {
 public:
  /// `layout`: where panels' places are kept from one run to the next; empty: nowhere.
  Interface(const Window& window, const std::filesystem::path& layout);
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  ~Interface();

 private:
  std::string layout_;
};

class InterfaceDrawer {
 public:
  InterfaceDrawer(const Device& device, const Swapchain& swapchain);
  InterfaceDrawer(const InterfaceDrawer&) = delete;
  InterfaceDrawer& operator=(const InterfaceDrawer&) = delete;
  ~InterfaceDrawer();  // the device is idle

  void beginFrame();
  /// Records what was shown since beginFrame (ImGui::Render has been called) over what the image holds. The image is a
  /// transfer's destination before and in use::kPresent's layout after.
  void record(const Swapchain& swapchain, const Swapchain::Frame& frame);

 private:
  void makeFramebuffers(const Swapchain& swapchain, const Swapchain::Frame& frame);

  const Device& device_;
  DescriptorPoolHandle pool_;
  RenderPassHandle renderPass_;
  std::uint64_t generation_ = 0;
  std::vector<FramebufferHandle> framebuffers_;  // by image
};

/// The user's folders for what programs keep: libibr in $XDG_CONFIG_HOME or ~/.config, for what could be made again in
/// $XDG_CACHE_HOME or ~/.cache; made where they are missing. Empty where that cannot be.
std::filesystem::path settingsFolder();
std::filesystem::path cacheFolder();

}  // namespace ibr::app
