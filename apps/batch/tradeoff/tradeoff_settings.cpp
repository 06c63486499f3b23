// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "shared/cli/presets.h"
#include "shared/cli/settings.h"

namespace ibr::app {
namespace {

struct Value {
  std::string word;
  std::function<void(TradeoffVariant&)> set;
};

// Base of a knob: the default; gathered; cells; cells with colour mapping; these with two views.
enum class Around { defaults, gathered, cells, mapped, twoEyes };

struct Knob {
  const char* name;
  const char* about;
  Around around;
  std::vector<Value> values;
};

template <class T, class M>
std::vector<Value> numbers(M RenderSettings::*member, const std::vector<T>& values) {
  std::vector<Value> all;
  for (const T value : values)
    all.push_back({fmt::format("{}", value), [=](TradeoffVariant& variant) { variant.settings.*member = M(value); }});
  return all;
}

template <class M>
std::vector<Value> words(M RenderSettings::*member, const std::vector<std::pair<const char*, M>>& values) {
  std::vector<Value> all;
  for (const auto& [word, value] : values)
    all.push_back({word, [member, v = value](TradeoffVariant& variant) { variant.settings.*member = v; }});
  return all;
}

std::vector<Value> formats() {
  std::vector<Value> all;
  for (const TextureFormat format : {TextureFormat::rgba8, TextureFormat::bc7, TextureFormat::bc1})
    all.push_back({textureFormatName(format), [format](TradeoffVariant& variant) { variant.texture = format; }});
  return all;
}

std::vector<Value> filters() {
  std::vector<Value> all;
  for (const auto& [word, filter] : {std::pair{"bilinear", TextureFilter::bilinear},
                                     {"trilinear", TextureFilter::trilinear},
                                     {"bicubic", TextureFilter::bicubic}})
    all.push_back({word, [f = filter](TradeoffVariant& variant) { variant.filter = f; }});
  return all;
}

template <class M, std::size_t N>
std::vector<std::pair<const char*, M>> listOf(const std::array<std::pair<const char*, M>, N>& words) {
  return {words.begin(), words.end()};
}

const std::vector<Knob>& knobs() {
  using R = RenderSettings;
  static const std::vector<Knob> kKnobs{
      {"composition", "source of depth and colour", Around::defaults,
       words<Composition>(
           &R::composition,
           {{"cells", Composition::cells}, {"gathered", Composition::gathered}, {"hybrid", Composition::hybrid}})},
      {"photographs", "maximum number of photographs per frame to gather from", Around::gathered,
       numbers<int>(&R::gatherCandidates, {4, 8, 12, 16})},
      {"colours", "maximum number of photographs averaged in a pixel", Around::gathered,
       numbers<int>(&R::gatherColours, {1, 2, 4, 8})},
      {"layers", "maximum number of surfaces behind one another in a pixel", Around::gathered,
       numbers<int>(&R::gatherLayers, {1, 2})},
      {"voteScale", "size of the vote's image, as a factor on the drawn image's sides", Around::gathered,
       numbers<double>(&R::voteScale, {0.125, 0.25, 0.5, 1})},
      {"cells", "maximum number of drawn cells", Around::cells,
       numbers<int>(&R::maxCells, {1, 2, 4, 8, 12, 16, 24, 64})},
      {"extrapolation", "maximum distance of drawn cells, cell sizes", Around::cells,
       numbers<double>(&R::extrapolationLimit, {0, 0.5, 1, 2, 4})},
      {"tiers", "last tier that is drawn", Around::defaults, numbers<int>(&R::maxTier, {0, 2, 3})},
      {"renderScale", "size of the drawn image, as a factor on the result's sides", Around::defaults,
       numbers<double>(&R::renderScale, {0.5, 0.7, 1, 1.5, 2})},
      {"blend", "combination of the members' colours", Around::cells,
       words<BlendMode>(&R::blend,
                        {{"blend", BlendMode::blend}, {"dither", BlendMode::dither}, {"mixed", BlendMode::mixed}})},
      {"texture", "texture format", Around::defaults, formats()},
      {"textureScale", "share of the photographs' detail that is shown", Around::defaults,
       numbers<double>(&R::textureScale, {2, 1.41, 1, 0.5, 0.25})},
      {"filter", "texture filter", Around::defaults, filters()},
      {"morph", "position of morphed vertices", Around::cells,
       words<Morph>(&R::morph, {{"ours", Morph::ours}, {"paper", Morph::paper}})},
      {"order", "draw order of cells", Around::cells,
       words<DrawOrder>(&R::order, {{"ours", DrawOrder::ours}, {"paper", DrawOrder::paper}})},
      {"align", "shift of cells so that they agree", Around::cells,
       words<bool>(&R::alignCells, {{"off", false}, {"on", true}})},
      {"exposure", "exposure at which photographs are shown", Around::defaults,
       words<Exposure>(&R::exposure, listOf(kExposures))},
      {"colour", "mapping of cells' colours to those of the main cell", Around::cells,
       words<ColourMapping>(&R::colourMapping, listOf(kColourMappings))},
      {"colourTable", "extrapolation of colour tables beyond shared colours", Around::mapped,
       words<ColourTable>(
           &R::colourTable,
           {{"naive", ColourTable::naive}, {"strict", ColourTable::strict}, {"preserving", ColourTable::preserving}})},
      {"colourSamples", "share of an overlap's pixels that are counted", Around::mapped,
       numbers<double>(&R::colourSamples, {1, 0.5, 0.25, 0.1, 0.01})},
      {"colourProxy", "factor by which the counted image is smaller in width and height", Around::mapped,
       numbers<int>(&R::colourProxy, {2, 4, 8, 16})},
      {"colourPeriod", "number of frames after which pixels are counted again", Around::mapped,
       numbers<int>(&R::colourPeriod, {1, 4, 8, 16})},
      {"eyeColours", "one colour table for both eyes, or one for each", Around::twoEyes,
       words<bool>(&R::shareEyeColours, {{"shared", true}, {"own", false}})},
  };
  return kKnobs;
}

class Settings {
 public:
  explicit Settings(const TradeoffSelection& selection) : selection_(selection) {}

  TradeoffSettings all() {
    for (const auto& [word, preset] : kPresets)
      add({.settings = ibr::preset(preset, selection_.kind)}, {"preset", word});
    for (const Knob& knob : knobs())
      if (wanted(knob)) addKnob(knob);
    if (!selection_.builds.empty()) {
      made_.knobs.push_back({"build", "build of the scene", kDefaultSetting});
      label(kDefaultSetting, {"build", "SCENE"});
    }
    for (std::size_t b = 0; b < selection_.builds.size(); ++b) {
      TradeoffVariant variant = made_.all[kDefaultSetting].variant;
      variant.build = b + 1;
      add(variant, {"build", selection_.builds[b]});
    }
    if (selection_.grid) addGrid();
    return std::move(made_);
  }

 private:
  bool wanted(const Knob& knob) const {
    if (knob.name == std::string("texture") && !selection_.textures) return false;
    return selection_.knobs.empty() || std::ranges::find(selection_.knobs, knob.name) != selection_.knobs.end();
  }

  void label(std::size_t setting, const TradeoffLabel& label) { made_.all[setting].labels.push_back(label); }

  std::size_t add(const TradeoffVariant& variant, const TradeoffLabel& named) {
    const auto found = std::ranges::find(made_.all, variant, &TradeoffSetting::variant);
    if (found == made_.all.end()) {
      made_.all.push_back({variant, {named}});
      return made_.all.size() - 1;
    }
    found->labels.push_back(named);
    return std::size_t(found - made_.all.begin());
  }

  void addKnob(const Knob& knob) {
    TradeoffVariant base = made_.all[kDefaultSetting].variant;
    if (knob.around != Around::defaults)
      base.settings.composition = knob.around == Around::gathered ? Composition::gathered : Composition::cells;
    if (knob.around == Around::mapped || knob.around == Around::twoEyes)
      base.settings.colourMapping = ColourMapping::ours;
    if (knob.around == Around::twoEyes) base.views = 2;
    for (const Value& value : knob.values) {
      TradeoffVariant variant = base;
      value.set(variant);
      add(variant, {knob.name, value.word});
    }
    const auto at = std::ranges::find(made_.all, base, &TradeoffSetting::variant);
    // A knob without the base among its values (such as the device's choice of filter) refers to the default setting.
    made_.knobs.push_back(
        {knob.name, knob.about, at == made_.all.end() ? kDefaultSetting : std::size_t(at - made_.all.begin())});
  }

  void addCombination(const TradeoffVariant& variant, const std::string& name) {
    if (std::ranges::find(made_.all, variant, &TradeoffSetting::variant) == made_.all.end())
      add(variant, {"grid", name});
  }

  // Combinations of the settings that affect both time and accuracy most.
  void addGrid() {
    for (const int cells : {2, 4, 8})
      for (const double extrapolation : {1.0, 2.0, 4.0})
        for (const double scale : {0.5, 0.7, 0.85, 1.0, 1.5}) {
          TradeoffVariant variant = made_.all[kDefaultSetting].variant;
          variant.settings.composition = Composition::cells;
          variant.settings.maxCells = std::uint32_t(cells);
          variant.settings.extrapolationLimit = extrapolation;
          variant.settings.renderScale = scale;
          addCombination(variant, fmt::format("cells {} reach {:g} scale {:g}", cells, extrapolation, scale));
        }
    for (const Composition composition : {Composition::hybrid, Composition::gathered})
      for (const unsigned photographs : {4u, 8u, 12u})
        for (const double vote : {0.125, 0.25, 0.5})
          for (const double scale : {0.7, 1.0}) {
            TradeoffVariant variant = made_.all[kDefaultSetting].variant;
            variant.settings.composition = composition;
            variant.settings.gatherCandidates = photographs;
            variant.settings.voteScale = vote;
            variant.settings.renderScale = scale;
            addCombination(variant, fmt::format("{} photographs {} vote {:g} scale {:g}", optionValue(composition),
                                                photographs, vote, scale));
          }
  }

  const TradeoffSelection& selection_;
  TradeoffSettings made_;
};

}  // namespace

const std::string* TradeoffSetting::valueOf(const std::string& knob) const {
  const auto found = std::ranges::find(labels, knob, &TradeoffLabel::knob);
  return found == labels.end() ? nullptr : &found->value;
}

std::vector<std::string> tradeoffKnobNames() {
  std::vector<std::string> names;
  for (const Knob& knob : knobs()) names.emplace_back(knob.name);
  return names;
}

TradeoffSettings tradeoffSettings(const TradeoffSelection& selection) {
  return Settings(selection).all();
}

nlohmann::ordered_json variantJson(const TradeoffVariant& variant) {
  nlohmann::ordered_json json = settingsJson(variant.settings, {.filter = variant.filter}), texture;
  json.erase("preset");
  json.erase("vramBudget");
  json.erase("blocks");
  if (variant.texture) texture = textureFormatName(*variant.texture);
  json["texture"] = texture;
  json["views"] = variant.views;
  json["build"] = variant.build;
  return json;
}

}  // namespace ibr::app
