// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "ibr/error.h"
#include "ibr/htm.h"
#include "support/bumpy_model.h"
#include "support/error_of.h"

namespace ibr::test {
namespace {

const BumpyModel& bumpy() {
  static const BumpyModel made = bumpyModel({.cameras = 12, .width = 32, .height = 24});
  return made;
}

HtmFramePlan planFor(const Camera& view, const HtmSettings& settings = {}, const HtmPlanState& state = {},
                     double dt = 0) {
  return planHtmFrame(bumpy().model, htmBounds(bumpy().model), {view, settings, dt}, state);
}

Camera viewAt(double angle) {
  return ringCamera(bumpy().options, angle);
}

}  // namespace

TEST_CASE("a plan has all cameras except excluded ones, best first", "[htm]") {
  const HtmFramePlan plan = planFor(viewAt(0.4), {.exclude = 0b100});
  REQUIRE(plan.cameras.size() == 11);
  CHECK(plan.cameras[0].camera == 1);
  CHECK(plan.cameras[0].logWeight == 0);
  for (std::size_t k = 0; k < plan.cameras.size(); ++k) {
    CHECK(plan.cameras[k].camera != 2);
    if (k > 0) CHECK(plan.cameras[k].logWeight <= plan.cameras[k - 1].logWeight);
    double rest = 0;
    for (std::size_t m = k + 1; m < plan.cameras.size(); ++m)
      rest += std::exp(plan.cameras[m].logWeight - plan.cameras[k].logWeight);
    if (k + 1 < plan.cameras.size())
      CHECK(plan.cameras[k].logRemainingWeight - plan.cameras[k].logWeight == Approx(std::log(rest)).margin(1e-9));
    else
      CHECK(plan.cameras[k].logRemainingWeight == -std::numeric_limits<double>::infinity());
  }
  // If the best camera is excluded, log weights are relative to the next best.
  CHECK(planFor(viewAt(0.4), {.exclude = 0b10}).cameras[0].logWeight == 0);
  CHECK(planFor(viewAt(0.4), {.exclude = ~CameraSet(0)}).cameras.empty());
}

TEST_CASE("turning the view about its centre changes only weights by axis", "[htm]") {
  const Camera view = viewAt(0.4);
  Camera turned = view;
  turned.pose.rotation = turned.pose.rotation * glm::angleAxis(0.3, glm::dvec3(0, 1, 0));
  const auto logs = [](const Camera& camera, HtmDirection direction) {
    return planFor(camera, {.direction = direction}).next.logWeights;
  };
  CHECK(logs(view, HtmDirection::middle) == logs(turned, HtmDirection::middle));
  CHECK(logs(view, HtmDirection::axis) != logs(turned, HtmDirection::axis));
  // If all cameras look at the middle, both directions give the weights of [H].
  const auto around = [&](HtmDirection direction) {
    return planHtmFrame(bumpy().model, {bumpy().options.middle, 0.5}, {view, {.direction = direction}}).next.logWeights;
  };
  const std::vector<double> a = around(HtmDirection::middle), b = around(HtmDirection::axis);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == Approx(b[i]).margin(1e-6));
}

TEST_CASE("a view in the middle of the mesh has finite weights", "[htm]") {
  Camera view = viewAt(0.4);
  view.pose.position = htmBounds(bumpy().model).middle;
  for (const double log : planFor(view).next.logWeights) CHECK(std::isfinite(log));
}

TEST_CASE("weights follow the view with a time constant", "[htm]") {
  const HtmSettings settings{.smoothingSeconds = 0.5};
  const std::vector<double> from = planFor(viewAt(0)).next.logWeights, to = planFor(viewAt(2)).next.logWeights;
  // Without a previous state the weights apply at once.
  CHECK(planFor(viewAt(2), settings).next.logWeights == to);
  HtmPlanState state{from};
  CHECK(planFor(viewAt(2), settings, state, 0).next.logWeights == from);
  double distance = 1e9;
  for (int frame = 0; frame < 40; ++frame) {
    state = planFor(viewAt(2), settings, state, 0.1).next;
    CHECK(*std::ranges::max_element(state.logWeights) == 0);
    double now = 0;
    for (std::size_t i = 0; i < to.size(); ++i) now = std::max(now, std::abs(state.logWeights[i] - to[i]));
    CHECK(now <= distance);
    distance = now;
  }
  CHECK(distance < 0.5);
  // A state of another model is ignored.
  CHECK(planFor(viewAt(2), settings, {{0, 0}}, 0.1).next.logWeights == to);
}

TEST_CASE("a plan over a previous plan equals a new one", "[htm]") {
  const HtmBounds bounds = htmBounds(bumpy().model);
  HtmFramePlan reused;
  HtmPlanState state;
  for (int frame = 0; frame < 6; ++frame) {
    HtmSettings settings{.smoothingSeconds = frame % 2 == 0 ? 0.5 : 0.0};
    settings.exclude = frame == 3 ? 5 : 0;
    if (frame == 4) state = reused.next = {};
    const HtmFramePlan fresh = planFor(viewAt(frame), settings, state, 0.1);
    planHtmFrame(bumpy().model, bounds, {viewAt(frame), settings, 0.1}, reused.next, reused);
    state = fresh.next;
    CHECK(reused.view == fresh.view);
    CHECK(reused.settings.exclude == settings.exclude);
    CHECK(reused.bounds.radius == fresh.bounds.radius);
    CHECK(reused.next.logWeights == fresh.next.logWeights);
    REQUIRE(reused.cameras.size() == fresh.cameras.size());
    for (std::size_t i = 0; i < fresh.cameras.size(); ++i) {
      CHECK(reused.cameras[i].camera == fresh.cameras[i].camera);
      CHECK(reused.cameras[i].logWeight == fresh.cameras[i].logWeight);
      CHECK(reused.cameras[i].logRemainingWeight == fresh.cameras[i].logRemainingWeight);
    }
  }
  // A refused input leaves the plan as it was.
  errorOf([&] { planHtmFrame(bumpy().model, bounds, {viewAt(1), {.gamma = 0}, 0.1}, reused.next, reused); });
  CHECK(reused.view == viewAt(5));
  CHECK(reused.next.logWeights == state.logWeights);
}

TEST_CASE("a plan refuses invalid input by field", "[htm]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const HtmSettings& settings) {
    return std::string(errorOf([&] { planFor(viewAt(0), settings); }).what());
  };
  for (const double gamma : {0.0, 0.99, 1001.0, -50.0, nan})
    CHECK_THAT(message({.gamma = gamma}), Catch::Contains("gamma"));
  for (const double cut : {-0.1, 1.0, nan}) CHECK_THAT(message({.weightCut = cut}), Catch::Contains("weightCut"));
  for (const double tolerance : {0.0, -1.0, nan, HUGE_VAL})
    CHECK_THAT(message({.depthTolerance = tolerance}), Catch::Contains("depthTolerance"));
  for (const double seconds : {-1.0, nan})
    CHECK_THAT(message({.smoothingSeconds = seconds}), Catch::Contains("smoothingSeconds"));
  for (int c = 0; c < 3; ++c)
    for (const float value : {float(nan), HUGE_VALF, -HUGE_VALF}) {
      HtmSettings settings;
      settings.background[c] = value;
      CHECK_THAT(message(settings), Catch::Contains("background"));
    }
  Camera view = viewAt(0);
  view.intrinsics.fx = nan;
  CHECK_THAT(errorOf([&] { planFor(view); }).what(), Catch::Contains("view"));
  view = viewAt(0);
  view.intrinsics = {CameraModel::equirectangular, 64, 32};
  CHECK_THAT(errorOf([&] { planFor(view); }).what(), Catch::Contains("pinhole"));
}

TEST_CASE("values that are not finite are kept out of a plan's state", "[htm][N16][P4]") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), most = std::numeric_limits<double>::max();
  const HtmPlanState state = planFor(viewAt(0)).next;
  for (const double smooth : {0.0, 0.5, HUGE_VAL})
    for (const double dt : {nan, HUGE_VAL, -HUGE_VAL})
      CHECK_THAT(errorOf([&] { planFor(viewAt(2), {.smoothingSeconds = smooth}, state, dt); }).what(),
                 Catch::Contains("dtSeconds"));
  for (const double wrong : {nan, HUGE_VAL, -HUGE_VAL, 1e-9}) {
    HtmPlanState broken = state;
    broken.logWeights[7] = wrong;
    CHECK_THAT(errorOf([&] { planFor(viewAt(2), {.smoothingSeconds = 0.5}, broken, 0.1); }).what(),
               Catch::Contains("state.logWeights[7]"));
  }
  const auto within = [&](const HtmBounds& bounds) { planHtmFrame(bumpy().model, bounds, {viewAt(2), {}}); };
  for (const double wrong : {nan, HUGE_VAL}) {
    CHECK_THAT(errorOf([&] { within({{0, wrong, 0}, 1}); }).what(), Catch::Contains("bounds.middle"));
    CHECK_THAT(errorOf([&] { within({{0, 0, 0}, wrong}); }).what(), Catch::Contains("bounds.radius"));
  }
  for (const double wrong : {0.0, -1.0})
    CHECK_THAT(errorOf([&] { within({{0, 0, 0}, wrong}); }).what(), Catch::Contains("bounds.radius"));

  const auto finiteAll = [](const HtmFramePlan& plan) {
    return std::ranges::all_of(plan.next.logWeights, [](double log) { return std::isfinite(log) && log <= 0; });
  };
  for (const double smooth : {0.0, std::numeric_limits<double>::denorm_min(), 0.5, most, HUGE_VAL})
    for (const double dt : {-most, -1.0, 0.0, 1.0, most})
      CHECK(finiteAll(planFor(viewAt(2), {.smoothingSeconds = smooth}, state, dt)));
  // An infinite time constant or a negative time step keeps the weights.
  CHECK(planFor(viewAt(2), {.smoothingSeconds = HUGE_VAL}, state, most).next.logWeights == state.logWeights);
  CHECK(planFor(viewAt(2), {.smoothingSeconds = 0.5}, state, -1).next.logWeights == state.logWeights);
  for (const double far : {1e12, 1e160, most}) {
    Camera view = viewAt(0);
    CHECK(finiteAll(planHtmFrame(bumpy().model, {{-far, far, -far}, 1}, {view, {}})));
    view.pose.position = {far, -far, far};
    if (far <= 1e12) {
      CHECK(finiteAll(planFor(view)));
      CHECK(finiteAll(planHtmFrame(bumpy().model, {{-far, far, -far}, 1}, {view, {}})));
    } else {
      CHECK_THAT(errorOf([&] { planFor(view); }).what(), Catch::Contains("view.pose.position"));
    }
  }
  HtmPlanState deep = state;
  deep.logWeights.assign(deep.logWeights.size(), -most);
  CHECK(finiteAll(planFor(viewAt(2), {.smoothingSeconds = 0.5}, deep, 0.1)));
}

TEST_CASE("bounds enclose the mesh", "[htm]") {
  const HtmBounds bounds = htmBounds(bumpy().model);
  for (const glm::dvec3& position : bumpy().model.surface.mesh.positions)
    CHECK(glm::length(position - bounds.middle) <= bounds.radius);
  HtmModel empty;
  CHECK(htmBounds(empty).radius > 0);
  empty.surface.mesh = {{{1, 2, 3}}, {{0, 0, 0}}};
  CHECK(htmBounds(empty).radius > 0);
  CHECK(htmBounds(empty).middle == glm::dvec3(1, 2, 3));
}

TEST_CASE("a baseline is the source mesh without complements", "[htm]") {
  HtmModel model = bumpy().model;
  CHECK(unoptimisedModel(model).surface.mesh == model.surface.mesh);
  model.source = HtmSurface{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {1, 1, 1}};
  const HtmModel baseline = unoptimisedModel(model);
  CHECK(baseline.surface.mesh == model.source->mesh);
  CHECK(baseline.complements.empty());
  CHECK(validate(baseline).empty());
}

TEST_CASE("weights carry over to a model with other cameras", "[htm]") {
  const auto named = [](const std::vector<std::string>& names) {
    HtmModel model;
    for (const std::string& name : names) model.cameras.push_back({name, {}, {}, {}});
    return model;
  };
  const HtmModel before = named({"a", "b", "c"});
  const HtmPlanState state{{-3, 0, -1}};
  const auto logs = [&](const std::vector<std::string>& names) {
    return transferHtmState(named(names), before, state).logWeights;
  };
  CHECK(logs({"a", "b", "c"}) == state.logWeights);
  CHECK(logs({"c", "a", "b"}) == std::vector<double>{-1, -3, 0});
  CHECK(logs({"c", "a"}) == std::vector<double>{0, -2});  // the largest is 0
  CHECK(logs({"c", "new", "b", "a"}) == std::vector<double>{-1, -3, 0, -3});
  CHECK(logs({"new", "c"}) == std::vector<double>{-2, 0});
  CHECK(logs({"new", "newer"}).empty());
  CHECK(logs({}).empty());
  // An invalid state of the previous model gives no state.
  CHECK(transferHtmState(before, before, {}).logWeights.empty());
  CHECK(transferHtmState(before, before, {{0, 0}}).logWeights.empty());
}

TEST_CASE("a prepared photograph has mip levels with visibility as alpha", "[htm]") {
  HtmModel model = bumpy().model;
  model.cameras[1].camera.intrinsics.width = 40;  // widest camera: sets the size of the texture array
  const HtmImage picture = bumpy().pictures[0], prepared = prepareHtmImage(model, 0, picture);
  CHECK(prepared.photograph.empty());
  CHECK(prepared.visibility.empty());
  REQUIRE(prepared.levels->size() == 6);
  const Image8& page = prepared.levels->front();
  REQUIRE((page.width == 40 && page.height == 24 && page.channels == 4));
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) {
      const int at = std::min(x, 31);
      CHECK(page.pixel(x, y)[1] == picture.photograph.pixel(at, y)[1]);
      CHECK(page.pixel(x, y)[3] == (picture.visibility.empty() ? 255 : picture.visibility.pixel(at, y)[0]));
    }
  CHECK(errorOf([&] { prepareHtmImage(model, 1, picture); }).code() == ErrorCode::invalidInput);
}

}  // namespace ibr::test
