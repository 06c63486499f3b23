// SPDX-License-Identifier: Apache-2.0
// Records the calls of a program to an OpenXR runtime as JSON lines, because a null compositor does not check them:
// every frame with its layers, and the objects and events before the frame.
#pragma once

#include <openxr/openxr.h>

#include <cstdint>
#include <deque>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ibr::test {

/// Returns the structure of a type in the `next` chain, or nullptr.
template <class T>
const T* chained(const void* next, XrStructureType type) {
  const auto* base = static_cast<const XrBaseInStructure*>(next);
  while (base && base->type != type) base = base->next;
  return reinterpret_cast<const T*>(base);
}

class FrameRecord {
 public:
  /// Appends to the file. An empty name disables the record.
  explicit FrameRecord(const std::string& file);

  // Objects that frames refer to.
  void session(XrSession session);
  void space(XrSpace space, XrSession session, std::string type) { spaces_[space] = {session, std::move(type)}; }
  void swapchain(XrSwapchain swapchain, XrSession session, const XrSwapchainCreateInfo& info);
  void acquired(XrSwapchain swapchain, std::uint32_t image) { swapchains_[swapchain].held.push_back(int(image)); }
  void released(XrSwapchain swapchain);
  struct Given {
    int image = -1;  // the image released last
    std::int64_t format = 0;
  };
  Given given(XrSwapchain swapchain) const { return find(swapchains_, swapchain).given; }
  XrSession ownerOf(XrSwapchain swapchain) const { return find(swapchains_, swapchain).owner; }
  XrSession ownerOf(XrSpace space) const { return find(spaces_, space).owner; }

  // A frame as the runtime reported it.
  void waited(const XrFrameState& state) { waited_.push_back(state); }
  void begun();
  /// Unknown parts of the views are recorded as NaN, which equals nothing.
  void located(const XrViewLocateInfo& info, const XrView* views, std::uint32_t count);

  void event(const XrEventDataBuffer& event);
  /// Writes a line {"frame": …}. `result`: returned by the runtime.
  void ended(int frame, const XrFrameEndInfo& info, XrResult result);

 private:
  struct Space {
    XrSession owner = XR_NULL_HANDLE;
    std::string type;
  };
  struct Swapchain {
    XrSession owner = XR_NULL_HANDLE;
    int number = -1;
    std::deque<int> held;  // images acquired by the program
    Given given;
  };
  struct Located {
    XrTime time;
    XrSpace space;
    std::vector<XrView> views;
  };

  template <class Key, class Value>
  static Value find(const std::map<Key, Value>& map, Key key) {
    const auto found = map.find(key);
    return found == map.end() ? Value{} : found->second;
  }
  nlohmann::json subImage(const XrSwapchainSubImage& image) const;
  nlohmann::json view(const XrCompositionLayerProjectionView& view, std::uint32_t index, XrTime time,
                      XrSpace space) const;
  nlohmann::json layer(const XrCompositionLayerBaseHeader& layer, XrTime time) const;
  bool isAsLocated(const XrCompositionLayerProjectionView& view, std::uint32_t index, XrTime time, XrSpace space) const;
  void write(const nlohmann::json& line);

  std::ofstream out_;
  std::map<XrSpace, Space> spaces_;
  std::map<XrSwapchain, Swapchain> swapchains_;
  std::deque<XrFrameState> waited_;
  std::deque<Located> located_;
  XrFrameState begun_{XR_TYPE_FRAME_STATE};
  int sessions_ = 0, swapchainsMade_ = 0;
};

}  // namespace ibr::test
