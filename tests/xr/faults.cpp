// SPDX-License-Identifier: Apache-2.0
#include "faults.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace ibr::test {
namespace {

constexpr std::array<std::string_view, 21> kNames{
    // Faults that happen once, at a frame.
    "session-loss",   // every later call of the session fails
    "loss-pending",   // the session state LOSS_PENDING
    "instance-loss",  // XrEventDataInstanceLossPending
    "stopping",       // the headset is taken off: STOPPING and IDLE, then READY again
    "exit",           // the runtime ends the program: STOPPING, IDLE, EXITING
    "recentre",       // XrEventDataReferenceSpaceChangePending; =stage: of STAGE instead of LOCAL
    "mask-changed",   // XrEventDataVisibilityMaskChangedKHR of view 0
    // Faults that persist for a range of frames.
    "frame-discarded",  // xrBeginFrame returns XR_FRAME_DISCARDED
    "not-rendered",     // shouldRender is false
    "no-view-pose",     // xrLocateViews returns neither position nor orientation; the poses are NaN
    "half-view-pose",   // xrLocateViews returns only the orientation
    "formats",          // =97:91: the swapchain formats, best first
    "no-array",         // swapchains of several layers are refused
    "no-stage",         // the reference space STAGE is missing
    "no-headset",       // xrGetSystem finds no headset; =2: twice, then finds one
    "odd-size",         // =333x217: the recommended size of a view
    "hide",             // =XR_KHR_composition_layer_depth: hides an extension
    "empty-mask",       // the visibility masks have no triangles
    "half-mask",        // the visibility masks hide the left half of the view
    "loss-at-exit",     // a session that the program asks to end is lost instead
    "no-swapchain",     // xrCreateSwapchain fails
};

int number(std::string_view text, const std::string& word) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw std::invalid_argument("not a frame in the fault \"" + word + "\"");
  return value;
}

Fault parse(const std::string& word) {
  Fault fault;
  std::string_view rest = word;
  if (const std::size_t at = rest.find('@'); at != rest.npos) {
    const std::string_view frames = rest.substr(at + 1);
    const std::size_t dash = frames.find('-');
    fault.first = number(frames.substr(0, dash), word);
    fault.last = dash == frames.npos ? fault.first : number(frames.substr(dash + 1), word);
    rest = rest.substr(0, at);
  }
  const std::size_t equals = rest.find('=');
  fault.name = rest.substr(0, equals);
  if (equals != rest.npos) fault.value = rest.substr(equals + 1);
  if (std::ranges::find(kNames, fault.name) == kNames.end())
    throw std::invalid_argument("there is no fault \"" + word + "\"");
  return fault;
}

}  // namespace

Faults::Faults(const std::string& words) {
  std::istringstream in(words);
  for (std::string word; std::getline(in, word, ',');) faults_.push_back(parse(word));
}

std::optional<std::string> Faults::active(const std::string& name) const {
  for (const Fault& fault : faults_)
    if (fault.name == name && fault.first <= frame_ && frame_ <= fault.last) return fault.value;
  return {};
}

std::optional<std::string> Faults::due(const std::string& name) {
  for (Fault& fault : faults_)
    if (fault.name == name && !fault.spent && fault.first <= frame_) {
      fault.spent = true;
      return fault.value;
    }
  return {};
}

}  // namespace ibr::test
