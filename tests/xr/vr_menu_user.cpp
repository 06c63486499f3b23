// SPDX-License-Identifier: Apache-2.0
#include "vr_menu_user.h"

#include <nlohmann/json.hpp>

namespace ibr::test {

using nlohmann::json;

namespace {

constexpr int kPanelWidth = 960, kPanelHeight = 720;

// Position of an item, as shares of the panel's sides, on the page that contains the item.
glm::dvec2 placeOf(const std::string& name, glm::dvec2 part, std::size_t scenes) {
  for (const std::string page : {"", "scenes page", "settings page"}) {
    app::MenuPanel panel(kPanelWidth, kPanelHeight);
    app::MenuModel model{.scenes = std::vector<std::string>(scenes, "a"), .scene = 0, .eyeHeight = 1.6};
    model.governor = true;
    model.composition = "hybrid";
    std::optional<glm::dvec2> found;
    const auto find = [&](const std::string& what, glm::dvec2 in) {
      found.reset();
      for (const app::MenuItem& item : panel.items())
        if (item.name == what) found = (item.low + in * (item.high - item.low)) / glm::dvec2(kPanelWidth, kPanelHeight);
      return found.has_value();
    };
    const auto show = [&](bool held) { panel.show(model, {found, held}, 0.02); };
    show(false);
    if (!page.empty() && find(page, {0.5, 0.5}))
      for (const bool held : {false, false, true, true, false, false}) show(held);
    if (find(name, part)) return *found;
  }
  FAIL("the menu has no " << name);
  return {};
}

std::vector<std::string> withPictures(std::vector<std::string> more, const TemporaryFolder& folder) {
  if (std::ranges::find(more, "--screenshots") != more.end()) return more;
  more.insert(more.end(), {"--screenshots", folder.path(), "--screenshot-every", "4"});
  return more;
}

}  // namespace

Pose recordedPose(const json& p) {
  return {{p[0].get<double>(), p[1].get<double>(), p[2].get<double>()},
          {p[6].get<double>(), p[3].get<double>(), p[4].get<double>(), p[5].get<double>()}};
}

MenuUser::MenuUser(const std::string& faults, std::vector<std::string> more, std::size_t others)
    : setup_(faults), scenes_(1 + others), visitor_(setup_, withPictures(std::move(more), pictures_)) {
  for (std::size_t eye = 0; eye < 2; ++eye) state_.eyes[eye].pose.position = {eye == 0 ? -0.032 : 0.032, 0, 0};
  state_.right.there = true;
  send();
}

void MenuUser::waitUntil(const std::function<bool()>& come) {
  const bool came = visitor_.program().runsUntil(come);
  INFO(visitor_.program().err());
  REQUIRE(came);
}

void MenuUser::pressMenuButton() {
  for (const bool held : {false, true, false}) {
    state_.right.b = held;
    send();
  }
}

json MenuUser::panel() const {
  const std::vector<json> frames = shownFrames(setup_);
  if (frames.empty()) return nullptr;
  for (const json& layer : frames.back()["layers"])
    if (layer["type"] == "quad") return layer;
  return nullptr;
}

void MenuUser::pointAt(const std::string& name, glm::dvec2 part) {
  const json layer = panel();
  INFO(name);
  INFO(visitor_.program().err());
  REQUIRE(!layer.is_null());
  const Pose pose = recordedPose(layer["pose"]);
  const glm::dvec2 size{layer["size"][0].get<double>(), layer["size"][1].get<double>()};
  const glm::dvec2 at = placeOf(name, part, scenes_);
  // The panel faces +z, a hand points along −z.
  const glm::dvec3 from{(at.x - 0.5) * size.x, (0.5 - at.y) * size.y, 0.3};
  state_.right.pose = {pose.position + pose.rotation * from, pose.rotation};
}

void MenuUser::press(const std::string& name, glm::dvec2 part) {
  pointAt(name, part);
  for (const double trigger : {0.0, 1.0, 0.0}) {
    state_.right.trigger = trigger;
    send();
  }
}

Outcome MenuUser::exit() {
  press("exit");
  visitor_.pass(5);  // the program waits for confirmation
  state_.right.trigger = 1;
  send();
  state_.right.trigger = 0;
  setup_.move(visitor_.program(), state_);  // the program may end at once
  return visitor_.finish();
}

std::array<Camera, 2> MenuUser::eyes() {
  const auto count = [&] { return std::distance(std::filesystem::directory_iterator(pictures_.path()), {}); };
  const auto before = count();
  waitUntil([&] { return count() >= before + 24; });  // two views of two files each, until fades are over
  return viewsIn(lastPictures(pictures_.path()));
}

glm::dvec3 MenuUser::head() {
  const std::array<Camera, 2> views = eyes();
  return 0.5 * (views[0].pose.position + views[1].pose.position);
}

}  // namespace ibr::test
