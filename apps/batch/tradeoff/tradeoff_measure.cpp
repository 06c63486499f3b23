// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_measure.h"
#include "batch/files/sha256.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/check.h"
#include "base/hash.h"
#include "base/random.h"
#include "ibr/view_scores.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

TradeoffBytes bytesOf(const auto& memory) {
  return {memory.positions, memory.indices, memory.textures};
}

// Times of one setting in one round, ms.
struct Timed {
  std::vector<double> device, plan;      // by view
  std::map<std::string, double> passes;  // mean over the views
};

Json timedJson(const Timed& timed) {
  return {{"device", timed.device}, {"plan", timed.plan}, {"passes", timed.passes}};
}

Timed timedOf(const Json& json) {
  return {json.at("device"), json.at("plan"), json.at("passes").get<std::map<std::string, double>>()};
}

void append(TradeoffRow& row, const Timed& timed) {
  row.deviceMs.push_back(timed.device);
  row.planMs.push_back(timed.plan);
  for (const auto& [pass, milliseconds] : timed.passes) row.passMs[pass].push_back(milliseconds);
}

// Each round has another order, so that no setting always follows the same one.
std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t(0));
  Random random(seed);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[std::min(i - 1, std::size_t(random.uniform(0, double(i))))]);
  return order;
}

}  // namespace

TradeoffMeasure::TradeoffMeasure(TradeoffRenderer& stage, const std::vector<TradeoffSubject>& subjects,
                                 const TradeoffPlan& plan, MeasurementCache& cache)
    : stage_(stage), subjects_(subjects), plan_(plan), cache_(cache) {}

std::uint64_t TradeoffMeasure::keyOf(const std::string& what) const {
  Hash hash;
  hash.add(plan_.key);
  hash.add(what);
  return hash.value();
}

const std::vector<Image8>& TradeoffMeasure::references() {
  if (references_.empty()) {
    const TradeoffVariant reference{.settings = preset(Preset::reference, stage_.device().kind())};
    for (const TradeoffSubject& subject : subjects_)
      references_.push_back(stage_.picture(reference, subject.view.camera));
  }
  return references_;
}

void TradeoffMeasure::renderViews(TradeoffRow& row) {
  const TradeoffVariant& variant = row.setting.variant;
  const std::uint64_t key = keyOf("pictures " + jsonLine(variantJson(variant)));
  if (const std::optional<Json> json = cache_.find(key)) try {
      readPicture(*json, row);
      ++found_;
      return;
    } catch (const Json::exception&) {  // damaged line: measured again
    }
  for (std::size_t v = 0; v < subjects_.size(); ++v) {
    const auto& [view, truth] = subjects_[v];
    const FramePlan plan = stage_.plan(variant, view.camera);
    const Image8 picture = stage_.picture(variant, plan), cover = coverOf(picture);
    const Renderer::Counters counters = stage_.count(variant, plan);
    TradeoffView figures;
    figures.name = view.name;
    if (!truth.empty()) figures.truth = similarity(picture, truth, cover);
    figures.reference = similarity(picture, references()[v], cover);
    figures.holes = double(std::ranges::count(cover.values, std::uint8_t(0))) / double(cover.values.size());
    figures.prediction = sha256(std::as_bytes(std::span(picture.values)));
    figures.passes = counters.passes;
    figures.draws = counters.draws;
    figures.dispatches = counters.dispatches;
    figures.triangles = counters.triangles;
    figures.cells = plan.cells.size();
    figures.photographs = plan.photographs.size();
    if (variant.views == 2) figures.eyes = stage_.eyes(variant, view.camera);
    row.views.push_back(std::move(figures));
    row.pipelines = counters.pipelines;
    row.workingBytes = counters.workingBytes;
  }
  row.measured = bytesOf(stage_.memory(variant));
  row.predicted = bytesOf(stage_.predicted(variant));
  cache_.add(key, pictureJson(row));
}

void TradeoffMeasure::timeRound(std::vector<TradeoffRow>& rows, int round) {
  std::string variants;
  for (const TradeoffRow& row : rows) variants += jsonLine(variantJson(row.setting.variant));
  const std::uint64_t key = keyOf(fmt::format("round {} seed {} of {}", round, plan_.seed, variants));
  if (const std::optional<Json> json = cache_.find(key)) try {
      std::vector<Timed> timed;
      for (const Json& each : json->at("times")) timed.push_back(timedOf(each));
      if (timed.size() == rows.size()) {
        for (std::size_t s = 0; s < rows.size(); ++s)
          if (rows[s].failure.empty()) append(rows[s], timed[s]);
        ++found_;
        return;
      }
    } catch (const Json::exception&) {  // damaged line: measured again
    }
  const auto timeOf = [&](const TradeoffRow& row) {
    Timed timed;
    for (const TradeoffSubject& subject : subjects_) {
      const TradeoffTimes times = stage_.time(row.setting.variant, subject.view.camera);
      timed.device.push_back(times.device);
      timed.plan.push_back(times.plan);
      for (const auto& [pass, milliseconds] : times.passes)
        timed.passes[pass] += milliseconds / double(subjects_.size());
    }
    return timed;
  };
  if (!std::exchange(warm_, true))  // an uncounted round first, since drivers compile on first use
    for (const TradeoffRow& row : rows)
      if (row.failure.empty()) timeOf(row);
  std::vector<Timed> timed(rows.size());
  for (const std::size_t s : shuffled(rows.size(), plan_.seed + std::uint64_t(round)))
    if (rows[s].failure.empty()) timed[s] = timeOf(rows[s]);
  Json json = Json::array();
  for (const Timed& each : timed) json.push_back(timedJson(each));
  cache_.add(key, {{"times", json}});
  for (std::size_t s = 0; s < rows.size(); ++s)
    if (rows[s].failure.empty()) append(rows[s], timed[s]);
}

std::vector<TradeoffRow> TradeoffMeasure::measure(const std::vector<TradeoffSetting>& settings,
                                                  const std::function<void(std::size_t, std::size_t)>& step) {
  std::vector<TradeoffRow> rows;
  const std::size_t rounds = std::size_t(plan_.repeat), all = settings.size() * (1 + rounds);
  for (const TradeoffSetting& setting : settings) {
    step(rows.size(), all);
    TradeoffRow& row = rows.emplace_back();
    row.setting = setting;
    try {
      stage_.prepare(setting.variant);
      renderViews(row);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::outOfMemory && error.code() != ErrorCode::unsupported) throw;
      row = {};
      row.setting = setting;
      row.failure = error.what();
    }
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    step(settings.size() * (1 + round), all);
    timeRound(rows, int(round));
  }
  step(all, all);
  return rows;
}

}  // namespace ibr::app
