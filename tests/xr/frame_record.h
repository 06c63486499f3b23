// SPDX-License-Identifier: Apache-2.0
// What a program hands to an OpenXR runtime, written down line by line as JSON, because a runtime that shows nothing
// never looks at it: every frame with its layers, and what was made and told before.
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

/// Of what hangs on `next`, that of a type.
template <class T>
const T* chained(const void* next, XrStructureType type) {
  const auto* base = static_cast<const XrBaseInStructure*>(next);
  while (base && base->type != type) base = base->next;
  return reinterpret_cast<const T*>(base);
}

class FrameRecord {
 public:
  /// Appends to the file; an empty name writes nothing.
  explicit FrameRecord(const std::string& file);

  // What has to be known of things that a frame names.
  void session(XrSession session);
  void space(XrSpace space, XrSession session, std::string type) { spaces_[space] = {session, std::move(type)}; }
  void swapchain(XrSwapchain swapchain, XrSession session, const XrSwapchainCreateInfo& info);
  void acquired(XrSwapchain swapchain, std::uint32_t image) { swapchains_[swapchain].held.push_back(int(image)); }
  void released(XrSwapchain swapchain);
  struct Given {
    int image = -1;  // that was given back last
    std::int64_t format = 0;
  };
  Given given(XrSwapchain swapchain) const { return find(swapchains_, swapchain).given; }
  XrSession ownerOf(XrSwapchain swapchain) const { return find(swapchains_, swapchain).owner; }
  XrSession ownerOf(XrSpace space) const { return find(spaces_, space).owner; }

  // The frame as the runtime gave it.
  void waited(const XrFrameState& state) { waited_.push_back(state); }
  void begun();
  /// What is not known of the views is NaN, which is like nothing.
  void located(const XrViewLocateInfo& info, const XrView* views, std::uint32_t count);

  void event(const XrEventDataBuffer& event);
  /// A line {"frame": …}; `result` is what the runtime answered.
  void ended(int frame, const XrFrameEndInfo& info, XrResult result);

 private:
  struct Space {
    XrSession owner = XR_NULL_HANDLE;
    std::string type;
  };
  struct Swapchain {
    XrSession owner = XR_NULL_HANDLE;
    int number = -1;
    std::deque<int> held;  // images that the program has
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
