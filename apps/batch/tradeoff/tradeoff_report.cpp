// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

std::string frontText(const TradeoffReport& report) {
  std::string text;
  for (const std::size_t i : timeFront(report.rows))
    text += fmt::format("{}{}", text.empty() ? "" : ", ", report.rows[i].setting.name());
  return text;
}

std::string walkTable(const std::vector<TradeoffWalk>& walks) {
  Table table;
  table.row({"walk", "frames", "drawn", "switches", "median step", "step at a switch", "pop (FLIP)", "hole px"});
  for (const TradeoffWalk& walk : walks)
    table.row({walk.preset, std::to_string(walk.frames), std::to_string(walk.drawn), std::to_string(walk.switches),
               numberText(walk.medianStep, 3), numberText(walk.switchStep, 3), numberText(walk.pop, 4),
               std::to_string(walk.holePixels)});
  return table.text();
}

std::string referenceErrorTable(const std::vector<ImplementationError>& errors) {
  Table table;
  table.row({"device against reference", "compared %", "mean 8-bit levels", "largest", "beyond the bound %"});
  for (const ImplementationError& error : errors)
    table.row({error.name, numberText(100 * error.compared, 1), numberText(error.meanLevels, 3),
               numberText(error.largestLevels, 2), numberText(100 * error.beyondBound, 4)});
  return table.text();
}

}  // namespace

std::vector<TradeoffGate> TradeoffReport::gates() const {
  std::vector<TradeoffGate> all = presetGates(rows);
  for (TradeoffGate& gate : walkGates(walks, rows, sampledDetail)) all.push_back(std::move(gate));
  return all;
}

Json reportJson(const TradeoffReport& report) {
  Json json{{"version", 1}};
  json.update(report.about);
  Json knobs = Json::array(), front = Json::array(), walks = Json::array(), gates = Json::array();
  for (const TradeoffKnob& knob : report.knobs)
    knobs.push_back(
        {{"name", knob.name}, {"description", knob.about}, {"baseSetting", report.rows[knob.base].setting.name()}});
  for (const std::size_t i : timeFront(report.rows)) front.push_back(report.rows[i].setting.name());
  for (const TradeoffWalk& walk : report.walks) walks.push_back(walkJson(walk));
  for (const TradeoffGate& gate : report.gates())
    gates.push_back({{"gate", gate.name}, {"holds", gate.holds}, {"found", gate.found}, {"counted", gate.counted}});
  Json errors = Json::array(), implementation = Json::array();
  for (const ImplementationError& error : report.implementation)
    implementation.push_back({{"name", error.name},
                              {"compared", error.compared},
                              {"meanLevels", error.meanLevels},
                              {"largestLevels", error.largestLevels},
                              {"beyondBound", error.beyondBound}});
  json["implementation"] = std::move(implementation);
  for (const MapError& error : report.mapErrors)
    errors.push_back({{"samples", error.samples}, {"same", error.same}, {"apart", error.apart}});
  json["sampledDetail"] = report.sampledDetail;
  json["mapErrors"] = std::move(errors);
  json["knobs"] = std::move(knobs);
  json["missing"] = report.missing;
  json["front"] = std::move(front);
  json["gates"] = std::move(gates);
  json["walks"] = std::move(walks);
  json["settings"] = Json::array();
  for (const TradeoffRow& row : report.rows) json["settings"].push_back(rowJson(row));
  return json;
}

std::string reportText(const TradeoffReport& report) {
  std::string text = tradeoffTable(report.rows);
  text += fmt::format("\nPareto front of time and error: {}\n", frontText(report));
  if (!report.implementation.empty()) text += '\n' + referenceErrorTable(report.implementation);
  if (!report.walks.empty()) text += '\n' + walkTable(report.walks);
  text += '\n';
  for (const TradeoffGate& gate : report.gates())
    text += fmt::format("{} {}{}{}\n", gate.holds ? "holds " : "FAILS ", gate.name, gate.found.empty() ? "" : ": ",
                        gate.found);
  for (const std::string& missing : report.missing) text += fmt::format("not measured: {}\n", missing);
  return text;
}

}  // namespace ibr::app
