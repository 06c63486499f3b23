// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/hands.h"

#include <cstring>
#include <utility>
#include <vector>

namespace ibr::app {
namespace {

constexpr std::array kHands{"/user/hand/left", "/user/hand/right"};

// Suggested bindings of a controller, as paths below the hand's path; nullptr: none.
struct Profile {
  const char* name;
  std::array<const char*, 2> menu;  // left, right
  const char* select = "/input/trigger/value";
  const char* stick = "/input/thumbstick";
  const char* pressed = nullptr;  // for a trackpad: the stick counts only while the pad is pressed, not merely touched
};

constexpr Profile kProfiles[]{
    {.name = "/interaction_profiles/khr/simple_controller",
     .menu = {"/input/menu/click", "/input/menu/click"},
     .select = "/input/select/click",
     .stick = nullptr},
    {.name = "/interaction_profiles/oculus/touch_controller", .menu = {"/input/y/click", "/input/b/click"}},
    {.name = "/interaction_profiles/valve/index_controller", .menu = {"/input/b/click", "/input/b/click"}},
    {.name = "/interaction_profiles/htc/vive_controller",
     .menu = {"/input/menu/click", "/input/menu/click"},
     .stick = "/input/trackpad",
     .pressed = "/input/trackpad/click"},
    {.name = "/interaction_profiles/microsoft/motion_controller", .menu = {"/input/menu/click", "/input/menu/click"}},
};

XrPath pathOf(XrInstance instance, const std::string& text) {
  XrPath path = XR_NULL_PATH;
  xr(xrStringToPath(instance, text.c_str(), &path), "xrStringToPath");
  return path;
}

}  // namespace

Hands::Hands(const Headset& headset, const Session& session) {
  makeActions(headset.instance());
  suggestAll(headset.instance());
  const XrActionSet set = set_.get();
  const XrSessionActionSetsAttachInfo info{
      .type = XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, .next = nullptr, .countActionSets = 1, .actionSets = &set};
  xr(xrAttachSessionActionSets(session.get(), &info), "xrAttachSessionActionSets");
  for (std::size_t hand = 0; hand < 2; ++hand) {
    const XrActionSpaceCreateInfo spaceInfo{.type = XR_TYPE_ACTION_SPACE_CREATE_INFO,
                                            .next = nullptr,
                                            .action = aim_,
                                            .subactionPath = paths_[hand],
                                            .poseInActionSpace = kXrIdentity};
    aims_[hand] = xrMake<XrSpaceOwner>(xrCreateActionSpace, session.get(), spaceInfo, "xrCreateActionSpace");
  }
}

XrAction Hands::makeAction(XrActionType type, const char* name, const char* localised) const {
  XrActionCreateInfo info{.type = XR_TYPE_ACTION_CREATE_INFO};
  std::strcpy(info.actionName, name);
  std::strcpy(info.localizedActionName, localised);
  info.actionType = type;
  info.countSubactionPaths = 2;
  info.subactionPaths = paths_.data();
  XrAction action = XR_NULL_HANDLE;
  xr(xrCreateAction(set_.get(), &info, &action), "xrCreateAction");
  return action;
}

void Hands::makeActions(XrInstance instance) {
  XrActionSetCreateInfo info{.type = XR_TYPE_ACTION_SET_CREATE_INFO};
  std::strcpy(info.actionSetName, "walk");
  std::strcpy(info.localizedActionSetName, "Walking");
  set_ = xrMake<XrActionSetOwner>(xrCreateActionSet, instance, info, "xrCreateActionSet");
  for (std::size_t hand = 0; hand < 2; ++hand) paths_[hand] = pathOf(instance, kHands[hand]);
  aim_ = makeAction(XR_ACTION_TYPE_POSE_INPUT, "aim", "Point");
  select_ = makeAction(XR_ACTION_TYPE_BOOLEAN_INPUT, "select", "Select, teleport");
  menu_ = makeAction(XR_ACTION_TYPE_BOOLEAN_INPUT, "menu", "Map and settings");
  stick_ = makeAction(XR_ACTION_TYPE_VECTOR2F_INPUT, "stick", "Turn, move");
  pressed_ = makeAction(XR_ACTION_TYPE_BOOLEAN_INPUT, "pressed", "Turn, move: press the pad");
  buzz_ = makeAction(XR_ACTION_TYPE_VIBRATION_OUTPUT, "buzz", "Buzz");
}

void Hands::suggestAll(XrInstance instance) const {
  for (const Profile& profile : kProfiles) {
    std::vector<XrActionSuggestedBinding> bindings;
    const auto bind = [&](XrAction action, std::size_t hand, const char* where) {
      if (where) bindings.push_back({action, pathOf(instance, std::string(kHands[hand]) + where)});
    };
    for (std::size_t hand = 0; hand < 2; ++hand) {
      bind(aim_, hand, "/input/aim/pose");
      bind(select_, hand, profile.select);
      bind(menu_, hand, profile.menu[hand]);
      bind(stick_, hand, profile.stick);
      bind(pressed_, hand, profile.pressed);
      bind(buzz_, hand, "/output/haptic");
    }
    const XrInteractionProfileSuggestedBinding info{.type = XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING,
                                                    .next = nullptr,
                                                    .interactionProfile = pathOf(instance, profile.name),
                                                    .countSuggestedBindings = std::uint32_t(bindings.size()),
                                                    .suggestedBindings = bindings.data()};
    const XrResult result = xrSuggestInteractionProfileBindings(instance, &info);
    // Runtimes may reject controllers that they do not support.
    if (result != XR_ERROR_PATH_UNSUPPORTED) xr(result, "xrSuggestInteractionProfileBindings");
  }
}

bool Hands::isOn(const Session& session, XrAction action, XrPath hand, bool otherwise) const {
  const XrActionStateGetInfo info{
      .type = XR_TYPE_ACTION_STATE_GET_INFO, .next = nullptr, .action = action, .subactionPath = hand};
  XrActionStateBoolean state{.type = XR_TYPE_ACTION_STATE_BOOLEAN};
  xr(xrGetActionStateBoolean(session.get(), &info, &state), "xrGetActionStateBoolean");
  return state.isActive ? state.currentState == XR_TRUE : otherwise;
}

std::array<HandInput, 2> Hands::read(const Session& session, XrTime time) {
  const XrActiveActionSet active{set_.get(), XR_NULL_PATH};
  const XrActionsSyncInfo syncInfo{
      .type = XR_TYPE_ACTIONS_SYNC_INFO, .next = nullptr, .countActiveActionSets = 1, .activeActionSets = &active};
  std::array<HandInput, 2> hands;
  if (xr(xrSyncActions(session.get(), &syncInfo), "xrSyncActions") == XR_SESSION_NOT_FOCUSED) return hands;
  for (std::size_t i = 0; i < 2; ++i) {
    HandInput& hand = hands[i];
    const std::optional<Pose> aim = session.locate(aims_[i].get(), time);
    hand.active = aim.has_value();
    if (!aim) continue;
    hand.aim = *aim;
    hand.select = isOn(session, select_, paths_[i], false);
    hand.menu = isOn(session, menu_, paths_[i], false);
    const XrActionStateGetInfo info{
        .type = XR_TYPE_ACTION_STATE_GET_INFO, .next = nullptr, .action = stick_, .subactionPath = paths_[i]};
    XrActionStateVector2f stick{.type = XR_TYPE_ACTION_STATE_VECTOR2F};
    xr(xrGetActionStateVector2f(session.get(), &info, &stick), "xrGetActionStateVector2f");
    if (stick.isActive && isOn(session, pressed_, paths_[i], true))
      hand.stick = {double(stick.currentState.x), double(stick.currentState.y)};
  }
  return hands;
}

void Hands::buzz(const Session& session, Hand hand) const noexcept {
  const XrHapticVibration vibration{.type = XR_TYPE_HAPTIC_VIBRATION,
                                    .next = nullptr,
                                    .duration = 20'000'000,  // ns
                                    .frequency = XR_FREQUENCY_UNSPECIFIED,
                                    .amplitude = 0.4f};
  const XrHapticActionInfo info{
      .type = XR_TYPE_HAPTIC_ACTION_INFO, .next = nullptr, .action = buzz_, .subactionPath = paths_[hand]};
  // Controllers without haptics return an error, which is ignored.
  static_cast<void>(
      xrApplyHapticFeedback(session.get(), &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration)));
}

std::array<std::string, 2> Hands::profiles(const Headset& headset, const Session& session) const {
  std::array<std::string, 2> names;
  for (std::size_t i = 0; i < 2; ++i) {
    XrInteractionProfileState state{.type = XR_TYPE_INTERACTION_PROFILE_STATE};
    xr(xrGetCurrentInteractionProfile(session.get(), paths_[i], &state), "xrGetCurrentInteractionProfile");
    if (state.interactionProfile == XR_NULL_PATH) continue;
    char text[XR_MAX_PATH_LENGTH];
    std::uint32_t length = 0;
    xr(xrPathToString(headset.instance(), state.interactionProfile, sizeof text, &length, text), "xrPathToString");
    names[i] = text;
  }
  return names;
}

}  // namespace ibr::app
