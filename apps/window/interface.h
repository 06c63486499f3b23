// SPDX-License-Identifier: Apache-2.0
// Dear ImGui in a window: its context and input (Interface), and its drawing by a device (InterfaceDrawer), which may
// be lost and made anew while the context stays.
#pragma once

#include <filesystem>
#include <string>

#include "gpu/handle.h"
#include "window/swapchain.h"
#include "window/window.h"

namespace ibr::app {

class Interface {
 public:
  /// `layout`: where panels' places are kept from one run to the next; empty: nowhere.
  Interface(const Window& window, const std::filesystem::path& layout);
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  ~Interface();

  /// Everything is drawn so much larger than at 96 dpi, letters from their outlines. Between frames of ImGui. Says
  /// whether that is new: then a drawer that is there has the wrong letters.
  bool setScale(float scale);

 private:
  std::string layout_;
  const Window& window_;
  float scale_ = 0;
};

class InterfaceDrawer {
 public:
  InterfaceDrawer(const Device& device, const Swapchain& swapchain);
  InterfaceDrawer(const InterfaceDrawer&) = delete;
  InterfaceDrawer& operator=(const InterfaceDrawer&) = delete;
  ~InterfaceDrawer();  // the device is idle

  void beginFrame();
  /// Records what was shown since beginFrame (ImGui::Render has been called) over what the frame's image holds. It is a
  /// transfer's destination before and as Swapchain::kAfter says after.
  void record(const Swapchain& swapchain, const Swapchain::Frame& frame);

 private:
  void makeFramebuffer(const Swapchain& swapchain, const Swapchain::Frame& frame);

  const Device& device_;
  DescriptorPoolHandle pool_;
  RenderPassHandle renderPass_;
  std::uint64_t generation_ = 0;
  FramebufferHandle framebuffer_;
};

}  // namespace ibr::app
