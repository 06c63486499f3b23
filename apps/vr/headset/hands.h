// SPDX-License-Identifier: Apache-2.0
// The two controllers: what they do, as actions with suggested bindings for the common ones. One thread.
#pragma once

#include <array>
#include <string>

#include "vr/headset/xr_session.h"
#include "vr/walk/locomotion.h"

namespace ibr::app {

class Hands {
 public:
  /// Attaches its actions to the session: no others can follow. Throws Error.
  Hands(const Headset& headset, const Session& session);
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// What both hands do, and where they will be at that time, in the session's space. Hands are not active while the
  /// program is not focused.
  std::array<HandInput, 2> read(const Session& session, XrTime time);

  /// A short buzz.
  void buzz(const Session& session, Hand hand) const noexcept;

  /// Which controllers there are, left and right: "/interaction_profiles/valve/index_controller"; empty: none.
  std::array<std::string, 2> profiles(const Headset& headset, const Session& session) const;

 private:
  void makeActions(XrInstance instance);
  XrAction makeAction(XrActionType type, const char* name, const char* localised) const;
  void suggestAll(XrInstance instance) const;
  bool isOn(const Session& session, XrAction action, XrPath hand, bool otherwise) const;

  XrActionSetOwner set_;
  // They go with the set.
  XrAction aim_ = XR_NULL_HANDLE, select_ = XR_NULL_HANDLE, menu_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE,
           pressed_ = XR_NULL_HANDLE, buzz_ = XR_NULL_HANDLE;
  std::array<XrPath, 2> paths_{};  // of the hands
  std::array<XrSpaceOwner, 2> aims_;
};

}  // namespace ibr::app
