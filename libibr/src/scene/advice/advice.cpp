// SPDX-License-Identifier: Apache-2.0
#include "ibr/advice.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/check.h"
#include "scene/advice/capture_facts.h"
#include "scene/advice/next_views.h"
#include "scene/advice/photograph_advice.h"
#include "scene/advice/sharpness_advice.h"
#include "scene/advice/site_advice.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {
namespace {

constexpr double kMinGain = 0.02;  // minimum gain of a further photograph, at one viewpoint

void append(std::vector<Advice>& list, std::vector<Advice> more) {
  std::ranges::move(more, std::back_inserter(list));
}

// Sorts each kind from the worst: the smallest share, or the most stops or pixels.
void sortBySeverity(std::vector<Advice>& list) {
  const auto worst = [](const Advice& a) {
    if (std::isnan(a.value)) return 0.0;
    return a.kind == AdviceKind::exposure || a.kind == AdviceKind::pose ? -std::abs(a.value) : a.value;
  };
  std::ranges::sort(list, [&](const Advice& a, const Advice& b) {
    if (a.severity != b.severity) return a.severity > b.severity;
    if (a.kind != b.kind) return a.kind < b.kind;
    return worst(a) != worst(b) ? worst(a) < worst(b) : a.problem < b.problem;
  });
}

// Precondition: validate(scene) is empty.
CaptureAdvice makeAdvice(const Scene& scene, const AdviceOptions& options) {
  const CaptureFacts facts = captureFacts(scene);
  CaptureAdvice result;
  std::vector<Advice>& list = result.advice;
  list = tooFewAdvice(facts);
  if (!list.empty()) {
    append(list, unusedAdvice(scene));
    return result;
  }
  WalkEstimate walk(scene, facts.depths, facts.siteGraph);
  append(list, apartAdvice(facts));
  const std::size_t firstLink = list.size();
  LinkAdvice links = linkAdvice(facts, walk);
  append(list, std::move(links.advice));
  append(list, directionAdvice(facts, walk));
  append(list, twiceAdvice(facts));
  append(list, exposureAdvice(facts));
  append(list, matchAdvice(facts));
  append(list, poseAdvice(scene));
  append(list, rowAdvice(facts));
  append(list, unusedAdvice(scene));
  if (options.readTextures) append(list, sharpnessAdvice(scene, facts.neighbours));
  result.coverage = walk.shown();
  result.views = nextViews(scene, facts.siteGraph, walk, options.views, kMinGain);
  result.coverageWithViews = walk.shown();
  for (const LinkRemedy& remedy : links.remedies)
    if (auto text = linkRemedyText(facts, remedy, result.views))
      list[firstLink + remedy.advice].remedy = std::move(*text);
  sortBySeverity(list);
  return result;
}

}  // namespace

const char* adviceKindName(AdviceKind kind) noexcept {
  constexpr const char* kNames[] = {"tooFew",  "turned",    "apart", "hole",   "wide",  "direction", "exposure",
                                    "blurred", "unmatched", "pose",  "unused", "twice", "row"};
  return kNames[std::size_t(kind)];
}

const char* severityName(Severity severity) noexcept {
  constexpr const char* kNames[] = {"hint", "warning", "serious"};
  return kNames[std::size_t(severity)];
}

CaptureAdvice adviseCapture(const Scene& scene, const AdviceOptions& options) {
  const std::vector<Fault> faults = validate(scene, 1);
  if (!faults.empty())
    fail(ErrorCode::invalidInput, "{}: {} {}", scene.folder.string(), faults[0].field, faults[0].message);
  return makeAdvice(scene, options);
}

}  // namespace ibr
