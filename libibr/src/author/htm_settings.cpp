// SPDX-License-Identifier: Apache-2.0
#include "author/htm_settings.h"

#include <nlohmann/json.hpp>

#include "base/check.h"

namespace ibr {
namespace {

using Json = nlohmann::ordered_json;

// visit(name, value) for all that decides what harmonise() makes. `Options` is const or not.
template <class Options, class Visit>
void forSettings(Options& o, Visit&& visit) {
  visit("adjustRounds", o.adjustRounds);
  visit("adjustSmoothness", o.adjustSmoothness);
  visit("faces", o.faces);
  visit("inconsistentSize", o.inconsistentSize);
  visit("inconsistentDifference", o.inconsistentDifference);
  visit("inconsistentShare", o.inconsistentShare);
  visit("radius", o.radius);
  visit("laterRadius", o.laterRadius);
  visit("leastTexture", o.leastTexture);
  visit("smoothness", o.smoothness);
  visit("outlierPx", o.outlierPx);
  visit("alpha", o.alpha);
  visit("gamma1", o.gamma1);
  visit("rounds", o.rounds);
  visit("meanDifference", o.meanDifference);
  visit("faceDifference", o.faceDifference);
  visit("selfOccluded", o.selfOccluded);
  visit("leastFacePx", o.leastFacePx);
  visit("mostFaces", o.mostFaces);
  visit("reject", o.reject);
  visit("rejectDifference", o.rejectDifference);
  visit("rejectCorrelation", o.rejectCorrelation);
  visit("softPx", o.softPx);
}

constexpr const char* kMeasure = "measure";
constexpr const char* kCorrelation = "ncc";

}  // namespace

std::string htmSettingsText(const HtmBuildOptions& options) {
  Json json{{"maxSize", options.maxSize},
            {kMeasure, options.optimise.measure == TemplateMeasure::correlation ? kCorrelation : "sad"}};
  forSettings(options.optimise, [&](const char* name, const auto& value) { json[name] = value; });
  return json.dump();
}

HtmOptions htmOptionsOf(const std::string& settings) {
  HtmOptions options;
  if (settings.empty()) return options;
  const Json json = Json::parse(settings, nullptr, false);
  check(json.is_object(), ErrorCode::invalidInput, "the model's settings are no JSON object");
  const auto take = [&](const char* name, auto& value) {
    const auto found = json.find(name);
    if (found == json.end()) return;
    const bool fits = std::is_same_v<decltype(value), bool&> ? found->is_boolean() : found->is_number();
    check(fits, ErrorCode::invalidInput, "the model's settings: {} is {}", name, found->dump());
    value = found->get<std::remove_reference_t<decltype(value)>>();
  };
  forSettings(options, take);
  if (json.value(kMeasure, "") == std::string(kCorrelation)) options.measure = TemplateMeasure::correlation;
  return options;
}

}  // namespace ibr
