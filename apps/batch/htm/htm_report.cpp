// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_report.h"

#include <nlohmann/json.hpp>

namespace ibr::app {

using Json = nlohmann::ordered_json;

Json htmReportJson(const HtmReport& report) {
  Json json{{"sourceFaces", report.sourceFaces},
            {"reducedFaces", report.reducedFaces},
            {"toReduced", {{"mean", report.reducedMean}, {"max", report.reducedMax}}},
            {"toSource", {{"mean", report.restoredMean}, {"max", report.restoredMax}}},
            {"adjustments", Json::array()},
            {"collapses", report.collapses},
            {"differenceReduced", report.reducedDifference},
            {"differenceCollapsed", report.collapsedDifference},
            {"rounds", Json::array()},
            {"camerasPerVertex", report.camerasPerVertex},
            {"rejected", report.rejected},
            {"complementBytes", report.complementBytes},
            {"stages", Json::array()}};
  for (const HtmReport::Adjustment& line : report.adjustments)
    json["adjustments"].push_back(
        {{"beforePx", line.beforePx}, {"afterPx", line.afterPx}, {"moved", line.meanDisplacement}});
  for (const HtmReport::Round& round : report.rounds)
    json["rounds"].push_back({{"vertices", round.vertices},
                              {"faces", round.faces},
                              {"before", round.unharmonisedDifference},
                              {"after", round.harmonisedDifference},
                              {"measured", round.matchedShare},
                              {"divided", round.divided},
                              {"divideHidden", round.dividedAsHidden}});
  for (const HtmReport::Stage& stage : report.stages)
    json["stages"].push_back({{"stage", stage.name}, {"seconds", stage.seconds}});
  return json;
}

}  // namespace ibr::app
