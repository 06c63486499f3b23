// SPDX-License-Identifier: Apache-2.0
// A GLFW window and its events. Threading: only the thread that runs main().
#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "window/frame_keys.h"

struct GLFWwindow;

namespace ibr::app {

/// A key press, also one shorter than a frame; GLFW key codes. Letters follow the user's keyboard layout.
struct KeyPress {
  int key = 0;
  int physicalKey = 0;  // key code of this position on a US keyboard
  bool control = false, shift = false;
};

class Window {
 public:
  /// Throws Error{unsupported} without a display, or if Vulkan cannot present to windows.
  Window(const std::string& title, int width, int height);
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window();

  GLFWwindow* handle() const noexcept { return window_; }

  /// Instance extensions that the surface of a window needs.
  static std::vector<std::string> instanceExtensions();
  /// The caller must destroy the surface before the instance. Throws Error.
  VkSurfaceKHR makeSurface(VkInstance instance) const;

  VkExtent2D pixels() const noexcept;    // 0 × 0 while the window is minimised
  float scale() const noexcept;          // recommended scale of the interface, 1 at 96 dpi; of the monitor
  float pixelsPerUnit() const noexcept;  // 1 unless the system scales windows

  bool closing() const noexcept;
  void close() noexcept;
  void setTitle(const std::string& title);

  /// Handles pending events. If `seconds` is positive, waits for an event first, for at most this time. Returns true if
  /// an event occurred.
  bool handleEvents(double seconds);
  /// Files and folders dropped onto the window since the last call.
  std::vector<std::filesystem::path> takeDropped();

  /// Keys pressed since the last call, in order.
  std::vector<KeyPress> takeKeys();
  /// Keys that went down or up since the last call, in order.
  std::vector<KeyChange> takeKeyChanges();

  std::string clipboard() const;
  void setClipboard(const std::string& text);

 private:
  GLFWwindow* window_ = nullptr;
  std::string title_;
  bool touched_ = false;
  std::vector<std::filesystem::path> dropped_;
  std::vector<KeyPress> keys_;
  std::vector<KeyChange> keyChanges_;
};

/// Wakes handleEvents from a wait; without a window, does nothing. May be called from any thread.
void wakeWindow() noexcept;

}  // namespace ibr::app
