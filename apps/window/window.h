// SPDX-License-Identifier: Apache-2.0
// A window by GLFW, and what happens to it. One thread, the one that runs main().
#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <string>
#include <vector>

struct GLFWwindow;

namespace ibr::app {

/// A key that was pressed, however briefly; GLFW's numbers. Letters are those of the user's keyboard layout.
struct KeyPress {
  int key = 0;
  int place = 0;  // on the keyboard: the key that has this place on an American one
  bool control = false, shift = false;
};

/// A key that went down or up; GLFW's number.
struct KeyChange {
  int key = 0;
  bool down = false;
};

class Window {
 public:
  /// Throws Error{unsupported} where there is no display or no Vulkan for it.
  Window(const std::string& title, int width, int height);
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window();

  GLFWwindow* handle() const noexcept { return window_; }

  /// Instance extensions that a surface of any window needs.
  static std::vector<std::string> instanceExtensions();
  /// The caller destroys it before the instance. Throws Error.
  VkSurfaceKHR makeSurface(VkInstance instance) const;

  VkExtent2D pixels() const noexcept;    // 0 × 0 while it is minimised
  float scale() const noexcept;          // of what is drawn for people, 1 at 96 dpi; the monitor's
  float pixelsPerUnit() const noexcept;  // 1 but where the system scales windows itself

  bool closing() const noexcept;
  void close() noexcept;
  void setTitle(const std::string& title);

  /// Handles what has happened; waits for something first, for at most so long, where `seconds` is not 0. Says whether
  /// something has.
  bool handleEvents(double seconds);
  /// Files and folders dropped on it since the last call.
  std::vector<std::filesystem::path> takeDropped();

  /// Keys pressed since the last call, in order.
  std::vector<KeyPress> takeKeys();
  /// What keys did since the last call, in order.
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

/// Ends a wait of handleEvents, from any thread.
void wakeWindow() noexcept;

}  // namespace ibr::app
