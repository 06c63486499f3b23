// SPDX-License-Identifier: Apache-2.0
#include "window/window.h"

#define GLFW_INCLUDE_NONE
#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

#include <mutex>
#include <utility>

#include "base/check.h"
#include "base/vulkan/vulkan.h"

namespace ibr::app {
namespace {

std::string lastError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "GLFW gives no reason";
}

std::mutex wakeMutex;
bool canWake = false;  // GLFW is initialised

Window& of(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

}  // namespace

Window::Window(const std::string& title, int width, int height) {
  const bool begun = glfwInit() == GLFW_TRUE;  // first: the evaluation order of arguments is unspecified
  check(begun, ErrorCode::unsupported, "cannot open a window: {}", lastError());
  try {
    check(glfwVulkanSupported() == GLFW_TRUE, ErrorCode::unsupported, "Vulkan cannot draw to windows on this display");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    check(window_, ErrorCode::unsupported, "cannot open a window: {}", lastError());
  } catch (...) {
    glfwTerminate();
    throw;
  }
  glfwSetWindowUserPointer(window_, this);
  // Any event requests a redraw. ImGui's backend chains its callbacks to these.
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    of(w).dropped_.insert(of(w).dropped_.end(), paths, paths + count);
    of(w).touched_ = true;
  });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { of(w).touched_ = true; });
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* w, float, float) { of(w).touched_ = true; });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).touched_ = true; });
  glfwSetWindowIconifyCallback(window_, [](GLFWwindow* w, int) { of(w).touched_ = true; });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int) { of(w).touched_ = true; });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double, double) { of(w).touched_ = true; });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int) { of(w).touched_ = true; });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int, int, int) { of(w).touched_ = true; });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double) { of(w).touched_ = true; });
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
    of(w).touched_ = true;
    if (action != GLFW_REPEAT) of(w).keyChanges_.push_back({key, action == GLFW_PRESS});
    if (action != GLFW_PRESS) return;
    of(w).keys_.push_back({key, key, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0});
    // Shortcuts follow the letter printed on the key, not the key's position.
    const char* name = glfwGetKeyName(key, scancode);
    if (!name || name[1] != 0) return;
    int& meant = of(w).keys_.back().key;
    if (name[0] >= 'a' && name[0] <= 'z') meant = GLFW_KEY_A + (name[0] - 'a');
    if ((mods & GLFW_MOD_CONTROL) && name[0] == '+') meant = GLFW_KEY_EQUAL;
    if ((mods & GLFW_MOD_CONTROL) && name[0] == '-') meant = GLFW_KEY_MINUS;
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned) { of(w).touched_ = true; });
  const std::lock_guard lock(wakeMutex);
  canWake = true;
}

Window::~Window() {
  {
    const std::lock_guard lock(wakeMutex);
    canWake = false;
  }
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::vector<std::string> Window::instanceExtensions() {
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  check(names, ErrorCode::unsupported, "Vulkan cannot draw to windows on this display: {}", lastError());
  return {names, names + count};
}

VkSurfaceKHR Window::makeSurface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  vk(glfwCreateWindowSurface(instance, window_, nullptr, &surface), "glfwCreateWindowSurface");
  return surface;
}

VkExtent2D Window::pixels() const noexcept {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  if (width <= 0 || height <= 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return {0, 0};
  return {std::uint32_t(width), std::uint32_t(height)};
}

float Window::scale() const noexcept {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return x > 0 ? x : 1;
}

float Window::pixelsPerUnit() const noexcept {
  int units = 0, pixels = 0;
  glfwGetWindowSize(window_, &units, nullptr);
  glfwGetFramebufferSize(window_, &pixels, nullptr);
  return units > 0 && pixels > 0 ? float(pixels) / float(units) : 1;
}

bool Window::closing() const noexcept {
  return glfwWindowShouldClose(window_);
}
void Window::close() noexcept {
  glfwSetWindowShouldClose(window_, GLFW_TRUE);
}
void Window::setTitle(const std::string& title) {
  if (std::exchange(title_, title) != title) glfwSetWindowTitle(window_, title.c_str());
}

bool Window::handleEvents(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
  return std::exchange(touched_, false);
}

std::vector<std::filesystem::path> Window::takeDropped() {
  return std::exchange(dropped_, {});
}

std::vector<KeyPress> Window::takeKeys() {
  return std::exchange(keys_, {});
}

std::vector<KeyChange> Window::takeKeyChanges() {
  return std::exchange(keyChanges_, {});
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(window_);
  return text ? text : "";
}

void Window::setClipboard(const std::string& text) {
  glfwSetClipboardString(window_, text.c_str());
}

void wakeWindow() noexcept {
  const std::lock_guard lock(wakeMutex);
  if (canWake) glfwPostEmptyEvent();
}

}  // namespace ibr::app
