// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "batch/evaluate/union_of_views.h"
#include "ibr/metrics.h"
#include "shared/cli/presets.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kStepSeconds = 1 / 60.0;
constexpr std::size_t kMaxWindows = 4, kBefore = 5, kAfter = 20;  // limit of drawn changes; frames before and after
constexpr double kMaxSwitchRatio = 1.5, kMinDetail = 0.9, kMaxDetail = 1.1;

// Changes of the main cell, and the frames around some of them, spread over the walk.
struct Windows {
  std::size_t switches = 0;
  std::set<std::size_t> frames;
};

Windows windowsOf(const TradeoffRenderer& stage, const TradeoffVariant& variant, const std::vector<View>& walk) {
  std::vector<std::size_t> changes;
  PlanState state;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const std::int64_t before = state.mainCell;
    state = stage.plan(variant, walk[i].camera, i > 0 ? kStepSeconds : 0, state).next;
    if (i > 0 && state.mainCell != before) changes.push_back(i);
  }
  Windows windows{changes.size(), {}};
  const std::size_t shown = std::min(kMaxWindows, changes.size());
  const auto add = [&](std::size_t middle) {
    for (std::size_t i = middle - std::min(middle, kBefore); i < std::min(walk.size(), middle + kAfter); ++i)
      windows.frames.insert(i);
  };
  for (std::size_t w = 0; w < shown; ++w) add(changes[w * changes.size() / shown]);
  if (changes.empty()) add(walk.size() / 2);
  return windows;
}

std::size_t holesSeen(const Image8& picture, const UnionOfViews& photographs, const Camera& camera) {
  std::size_t holes = 0;
  for (const glm::ivec2 pixel : photographs.pixelsSeen(camera)) holes += picture.pixel(pixel.x, pixel.y)[3] == 0;
  return holes;
}

}  // namespace

TradeoffWalk measureWalk(TradeoffRenderer& stage, const std::string& preset, const TradeoffVariant& variant,
                         const std::vector<View>& walk, const std::function<void()>& step) {
  const Windows windows = windowsOf(stage, variant, walk);
  const UnionOfViews photographs(stage.scene(variant));
  TradeoffWalk result{.preset = preset,
                      .frames = walk.size(),
                      .drawn = windows.frames.size(),
                      .switches = windows.switches,
                      .medianStep = NAN,
                      .switchStep = NAN};
  std::vector<double> steps;
  PlanState state;
  Image8 before;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const std::int64_t mainCell = state.mainCell;
    const FramePlan plan = stage.plan(variant, walk[i].camera, i > 0 ? kStepSeconds : 0, state);
    const bool switching = (i > 0 && plan.next.mainCell != mainCell) || !plan.next.previous.empty();
    state = plan.next;
    if (!windows.frames.contains(i)) {
      before = {};
      continue;
    }
    step();
    Image8 picture = stage.picture(variant, plan);
    result.holePixels = std::max(result.holePixels, holesSeen(picture, photographs, walk[i].camera));
    if (!before.empty()) {
      const double difference = ibr::difference(picture, before, 0).meanAbsolute;
      if (switching)
        result.switchStep = std::fmax(result.switchStep, difference);
      else
        steps.push_back(difference);
      result.pop = std::max(result.pop, flip(picture, before));
    }
    before = std::move(picture);
  }
  result.medianStep = quantile(steps, 0.5);
  return result;
}

std::vector<TradeoffGate> walkGates(const std::vector<TradeoffWalk>& walks, const std::vector<TradeoffRow>& rows,
                                    double sampledDetail) {
  std::vector<TradeoffGate> gates;
  for (const TradeoffWalk& walk : walks) {
    gates.push_back({walk.preset + ": no hole on the walk", walk.holePixels == 0,
                     fmt::format("at most {} px in a frame", walk.holePixels), true});
    if (std::isfinite(walk.switchStep) && std::isfinite(walk.medianStep))
      gates.push_back(
          {walk.preset + ": the step at a switch of the main cell is at most 1.5 times the median step",
           walk.switchStep <= kMaxSwitchRatio * walk.medianStep,
           fmt::format("{:.3f} levels, median {:.3f}, {} switches", walk.switchStep, walk.medianStep, walk.switches),
           true});
  }
  const double least = kMinDetail * sampledDetail;
  for (std::size_t p = 0; p < kPresets.size(); ++p)
    if (const double detail = rows[p].truth().detail; std::isfinite(detail))
      gates.push_back(
          {fmt::format("{}: gradient energy is at least 0.9 of that of the resampled truth, and at most 1.1 of "
                       "that of the truth",
                       kPresets[p].first),
           detail >= least && detail <= kMaxDetail,
           fmt::format("{:.3f}, allowed {:.3f} to {}", detail, least, kMaxDetail), true});
  return gates;
}

Json walkJson(const TradeoffWalk& walk) {
  return {{"preset", walk.preset},     {"frames", walk.frames},         {"drawn", walk.drawn},
          {"switches", walk.switches}, {"medianStep", walk.medianStep}, {"switchStep", walk.switchStep},
          {"pop", walk.pop},           {"holePixels", walk.holePixels}};
}

TradeoffWalk walkOf(const Json& json) {
  const auto number = [&](const char* name) { return json.at(name).is_null() ? NAN : json.at(name).get<double>(); };
  return {json.at("preset"),    json.at("frames"),    json.at("drawn"), json.at("switches"),
          number("medianStep"), number("switchStep"), number("pop"),    json.at("holePixels")};
}

}  // namespace ibr::app
