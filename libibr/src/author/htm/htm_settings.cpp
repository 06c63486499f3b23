// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/htm.h"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "base/check.h"

namespace ibr {
namespace {

using Json = nlohmann::ordered_json;

// Calls visit(name, value) for every setting that changes harmonise()'s result. `Options` may be const.
template <class Options, class Visit>
void forSettings(Options& o, Visit&& visit) {
  visit("adjustRounds", o.adjustRounds);
  visit("adjustSmoothness", o.adjustSmoothness);
  visit("reshape", o.reshape);
  visit("shapeSmoothness", o.shapeSmoothness);
  visit("faces", o.faces);
  visit("inconsistentSize", o.inconsistentSize);
  visit("inconsistentDifference", o.inconsistentDifference);
  visit("inconsistentShare", o.inconsistentShare);
  visit("radius", o.radius);
  visit("laterRadius", o.laterRadius);
  visit("minTexture", o.minTexture);
  visit("smoothness", o.smoothness);
  visit("complementPx", o.complementPx);
  visit("outlierPx", o.outlierPx);
  visit("alpha", o.alpha);
  visit("gamma1", o.gamma1);
  visit("rounds", o.rounds);
  visit("meanDifference", o.meanDifference);
  visit("faceDifference", o.faceDifference);
  visit("selfOccluded", o.selfOccluded);
  visit("minFacePx", o.minFacePx);
  visit("maxFaces", o.maxFaces);
  visit("reject", o.reject);
  visit("rejectDifference", o.rejectDifference);
  visit("rejectCorrelation", o.rejectCorrelation);
  visit("softPx", o.softPx);
}

constexpr const char* kMasks = "masks";
constexpr const char* kMeasure = "measure";
constexpr const char* kCorrelation = "ncc";
constexpr const char* kDifferences = "sad";

template <class T>
bool fits(const Json& json) {
  if constexpr (std::is_same_v<T, bool>)
    return json.is_boolean();
  else if constexpr (std::is_unsigned_v<T>)
    return json.is_number_unsigned();
  else if constexpr (std::is_integral_v<T>)
    return json.is_number_integer() && json == Json(json.get<T>());
  else
    return json.is_number();
}

}  // namespace

std::string htmOptionsToJson(const HtmBuildOptions& options) {
  Json json{{"maxSize", options.maxSize},
            {kMasks, !options.masks.empty()},
            {kMeasure, options.optimise.measure == TemplateMeasure::correlation ? kCorrelation : kDifferences}};
  forSettings(options.optimise, [&](const char* name, const auto& value) { json[name] = value; });
  return json.dump();
}

bool htmHasMasks(const std::string& settings) {
  const Json json = Json::parse(settings, nullptr, false);
  return !json.is_object() || json.value(kMasks, Json(true)) != Json(false);
}

HtmOptions htmOptionsFromJson(const std::string& settings) {
  HtmOptions options;
  if (settings.empty()) return options;
  const Json json = Json::parse(settings, nullptr, false);
  check(json.is_object(), ErrorCode::invalidInput, "the model's settings are not a JSON object");
  const auto take = [&](const char* name, auto& value) {
    const auto found = json.find(name);
    if (found == json.end()) return;
    using Value = std::remove_reference_t<decltype(value)>;
    check(fits<Value>(*found), ErrorCode::invalidInput, "the model's settings: {} has the invalid value {}", name,
          found->dump());
    value = found->get<Value>();
  };
  forSettings(options, take);
  if (const auto measure = json.find(kMeasure); measure != json.end()) {
    check(*measure == kCorrelation || *measure == kDifferences, ErrorCode::invalidInput,
          "the model's settings: {} has the invalid value {}", kMeasure, measure->dump());
    if (*measure == kCorrelation) options.measure = TemplateMeasure::correlation;
  }
  return options;
}

}  // namespace ibr
