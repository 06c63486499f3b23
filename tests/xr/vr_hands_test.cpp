// SPDX-License-Identifier: Apache-2.0
// Locomotion with the hands, checked with the world views stored in screenshots.
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "vr_harness.h"

using namespace ibr;
using namespace ibr::test;
using nlohmann::json;

namespace {

// A simulated person who walks, and the resulting head pose in the world.
class Walker {
 public:
  explicit Walker(std::vector<std::string> more = {}) : visitor_(setup_, arguments(std::move(more))) {
    for (std::size_t eye = 0; eye < 2; ++eye) state_.eyes[eye].pose.position = {eye == 0 ? -0.032 : 0.032, 0, 0};
    visitor_.move(state_);
    visitor_.waitForScene();
  }
  XrSetup& setup() { return setup_; }
  Visitor& visitor() { return visitor_; }
  RemoteState& state() { return state_; }

  // The head's pose in the world after all sent input.
  Pose head() {
    visitor_.move(state_);
    visitor_.pass(22);  // until fades are over and the next screenshot is taken
    const std::array<Camera, 2> views = viewsIn(lastPictures(pictures_.path()));
    return {0.5 * (views[0].pose.position + views[1].pose.position), views[0].pose.rotation};
  }
  // Presses a button from a released state, and releases the button.
  void press(const std::function<void(RemoteState&)>& hold) {
    const RemoteState before = state_;
    visitor_.move(state_);
    hold(state_);
    visitor_.move(state_);
    state_ = before;
    visitor_.move(state_);
  }

 private:
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    more.insert(more.end(), {"--no-governor", "--screenshots", pictures_.path(), "--screenshot-every", "4"});
    return more;
  }
  XrSetup setup_;
  TemporaryFolder pictures_;
  RemoteState state_ = lookingAhead();
  Visitor visitor_;
};

bool near(glm::dvec3 a, glm::dvec3 b) {
  return glm::distance(a, b) < 1e-4;
}

// A hand at rest that points at a position in the room.
RemoteHand pointing(glm::dvec3 from, glm::dvec3 at) {
  return {{from, glm::rotation(glm::dvec3(0, 0, -1), glm::normalize(at - from))}};
}

}  // namespace

TEST_CASE("the world stays in place while the head moves, and turns in steps of the stick") {
  Walker walker;
  walker.state().right.there = true;
  const Pose start = walker.head();
  CHECK(near(start.position, {0, 0, 0}));  // the position of the first photograph
  walker.state().head.position += glm::dvec3(0.3, -0.1, 0.2);
  const Pose moved = walker.head();
  CHECK(near(moved.position, {0.3, -0.1, 0.2}));
  CHECK(near(moved.rotation * glm::dvec3(0, 0, -1), {0, 0, -1}));
  walker.press([](RemoteState& s) { s.right.stick = {1, 0}; });
  const Pose turned = walker.head();
  CHECK(near(turned.position, moved.position));
  CHECK(near(turned.rotation * glm::dvec3(0, 0, -1), {0.5, 0, -std::sqrt(0.75)}));  // 30° to the right
  for (int i = 0; i < 2; ++i) walker.press([](RemoteState& s) { s.right.stick = {-1, 0}; });
  CHECK(near(walker.head().rotation * glm::dvec3(0, 0, -1), {-0.5, 0, -std::sqrt(0.75)}));
  walker.visitor().leave();
}

TEST_CASE("releasing the trigger teleports to the target, facing as before") {
  Walker walker;
  const Pose start = walker.head();
  CHECK(near(start.position, {0, 0, 0}));
  // The second photograph's position is half a metre to the right, with a mark on the floor.
  walker.state().right = pointing({0.4, 1.2, 0.3}, {0.5, 0, 0});
  walker.press([](RemoteState& s) { s.right.trigger = 1; });
  const Pose there = walker.head();
  CHECK(near(there.position, tinySet().cameras[1].camera.pose.position));
  CHECK(near(there.rotation * glm::dvec3(0, 0, -1), {0, 0, -1}));
  // Far from all photographs, pointing has no target.
  walker.state().right = pointing({0.4, 1.2, 0.3}, {0.4, 3, 4});
  walker.press([](RemoteState& s) { s.right.trigger = 1; });
  CHECK(near(walker.head().position, there.position));
  // The left stick moves the person only if smooth motion is enabled.
  walker.state().left.there = true;
  walker.press([](RemoteState& s) { s.left.stick = {0, 1}; });
  CHECK(near(walker.head().position, there.position));
  walker.visitor().leave();
}

TEST_CASE("hands and rays are drawn only while the hands are tracked") {
  XrSetup setup;
  setup.readPictures();
  Visitor visitor(setup, {"--no-governor"});
  RemoteState state = lookingAhead();
  visitor.move(state);
  visitor.waitForScene();
  visitor.pass(5);
  const auto bare = setup.pictures(visitor.program());
  state.right = pointing({0.2, 1.4, -0.5}, {0.2, 1.5, -4});
  visitor.move(state);
  const auto hand = setup.pictures(visitor.program());
  state.right.trigger = 1;
  visitor.move(state);
  const auto ray = setup.pictures(visitor.program());
  state.right = {.there = false};
  visitor.move(state);
  visitor.pass(12);
  const auto gone = setup.pictures(visitor.program());
  visitor.leave();
  for (const auto* pair : {&bare, &hand, &ray, &gone}) REQUIRE(pair->size() == 2);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    CHECK((hand[eye].values != bare[eye].values));
    CHECK((ray[eye].values != hand[eye].values));
    CHECK((gone[eye].values == bare[eye].values));
  }
}

TEST_CASE("one button opens and closes the menu's quad layer") {
  Walker walker;
  walker.state().right.there = true;
  const auto layers = [&] {
    walker.visitor().pass(2);
    std::vector<std::string> types;
    const json frame = shownFrames(walker.setup()).back();
    for (const json& layer : frame["layers"]) types.push_back(layer["type"]);
    return types;
  };
  CHECK(layers() == std::vector<std::string>{"projection"});
  walker.press([](RemoteState& s) { s.right.b = true; });
  CHECK(layers() == std::vector<std::string>{"projection", "quad"});
  walker.press([](RemoteState& s) { s.right.b = true; });
  CHECK(layers() == std::vector<std::string>{"projection"});
  walker.visitor().leave();
}
