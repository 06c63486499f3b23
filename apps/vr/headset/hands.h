// SPDX-License-Identifier: Apache-2.0
// Input of the two controllers, as OpenXR actions with suggested bindings for common models. Threading: one thread.
#pragma once

#include <array>
#include <string>

#include "vr/headset/xr_session.h"
#include "vr/walk/locomotion.h"

namespace ibr::app {

class Hands {
 public:
  /// Attaches the actions to the session; OpenXR allows this once per session. Throws Error.
  Hands(const Headset& headset, const Session& session);
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// Returns the state of both hands, with poses predicted for `time`, in the session's space. Hands are inactive while
  /// the session is not focused.
  std::array<HandInput, 2> read(const Session& session, XrTime time);

  /// Vibrates a controller for 20 ms.
  void buzz(const Session& session, Hand hand) const noexcept;

  /// Interaction profiles, left and right, such as "/interaction_profiles/valve/index_controller"; empty: none.
  std::array<std::string, 2> profiles(const Headset& headset, const Session& session) const;

 private:
  void makeActions(XrInstance instance);
  XrAction makeAction(XrActionType type, const char* name, const char* localised) const;
  void suggestAll(XrInstance instance) const;
  bool isOn(const Session& session, XrAction action, XrPath hand, bool otherwise) const;

  XrActionSetOwner set_;
  // owned by the action set
  XrAction aim_ = XR_NULL_HANDLE, select_ = XR_NULL_HANDLE, menu_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE,
           pressed_ = XR_NULL_HANDLE, buzz_ = XR_NULL_HANDLE;
  std::array<XrPath, 2> paths_{};  // of the hands
  std::array<XrSpaceOwner, 2> aims_;
};

}  // namespace ibr::app
