// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/view_text.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "ibr/error.h"

using namespace ibr;
using namespace ibr::app;

TEST_CASE("a view's text is one line and round trips bit for bit") {
  TextView view{{{1e6 + 0.1, -1.0 / 3, 1e-12}, glm::normalize(glm::dquat(0.3, -0.5, 0.2, 0.7))}, 0.9, {}};
  for (const bool up : {false, true}) {
    if (up) view.up = glm::normalize(glm::dvec3(0.1, -0.2, 0.97));
    const std::string text = viewText(view);
    CHECK(text.find('\n') == std::string::npos);
    const TextView again = viewOf("  " + text + "\n");
    CHECK(again.pose.position == view.pose.position);
    CHECK(again.pose.rotation == view.pose.rotation);
    CHECK(again.fovY == view.fovY);
    CHECK(again.up == view.up);
    CHECK(viewText(again) == text);
  }
  CHECK(viewText({{{-0.0, 0, 0}, {1, -0.0, 0, 0}}, 1, {}}) == viewText({{{0, 0, 0}, {1, 0, 0, 0}}, 1, {}}));
}

TEST_CASE("a camera path's key is read as a view, and its rotation is normalised") {
  const TextView view =
      viewOf(R"({"time":2.5,"position":[1,2,3],"rotation":[0,0,0,1.0005],"fovY":0.8,"up":[0,0,0.9995]})");
  CHECK(view.pose.position == glm::dvec3(1, 2, 3));
  CHECK(view.pose.rotation == glm::dquat(1, 0, 0, 0));
  REQUIRE(view.up);
  CHECK(glm::distance(*view.up, glm::dvec3(0, 0, 1)) < 1e-15);
}

TEST_CASE("errors in a view's text name the field") {
  const std::string whole = R"({"position":[0,0,0],"rotation":[0,0,0,1],"fovY":1,"up":[0,1,0]})";
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = whole;
    text.replace(text.find(what), what.size(), by);
    return text;
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "JSON"},
      {"hello", "JSON"},
      {whole + whole, "JSON"},
      {"[]", "\"position\""},
      {"7", "\"position\""},
      {with("[0,0,0]", "[0,0]"), "/position"},
      {with("[0,0,0]", "[0,0,null]"), "/position/2"},
      {with("[0,0,0]", "[0,0,NaN]"), "JSON"},
      {with("[0,0,0]", "[0,0,1e16]"), "/position/2"},
      {with("[0,0,0,1]", "[0,0,0,1.002]"), "/rotation/3"},
      {with("[0,0,0,1]", "[0,0,0,0.99]"), "/rotation"},
      {with("[0,0,0,1]", "[0,0,0,0]"), "/rotation"},
      {with("\"fovY\":1", "\"fovY\":0"), "/fovY"},
      {with("\"fovY\":1", "\"fovY\":-1"), "/fovY"},
      {with("\"fovY\":1", "\"fovY\":3.1416"), "/fovY"},
      {with("\"fovY\":1", "\"fovY\":\"1\""), "/fovY"},
      {with("\"fovY\":1,", ""), "\"fovY\""},
      {with("[0,1,0]", "[0,0,0]"), "/up"},
      {with("\"up\"", "\"Up\""), "/Up"},
      {with("\"up\":[0,1,0]", "\"time\":true"), "/time"},
      {with("\"up\"", "\"fovY\""), "\"fovY\""},
      {std::string(5000, ' ') + whole, "4096"},
      {std::string(4000, '['), "nested"},
  };
  for (const auto& [text, place] : cases) {
    INFO(text.substr(0, 200));
    try {
      viewOf(text);
      FAIL_CHECK("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
      CHECK_THAT(e.what(), Catch::Contains("view") && Catch::Contains(place));
    }
  }
}
