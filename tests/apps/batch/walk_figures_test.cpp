// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/walk_figures.h"
#include "support/json.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace ibr::app;

TEST_CASE("a walk's pop is the largest FLIP step while cells are switched") {
  std::vector<WalkFrame> frames(6);
  const double steps[] = {NAN, 2, 9, 3, 4, 2}, flips[] = {NAN, 0.02, 0.09, 0.03, 0.04, 0.02};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].mainCell = i < 3 ? 5 : 7;
    frames[i].switching = i == 3 || i == 4;
    frames[i].step = steps[i];
    frames[i].flipStep = flips[i];
    frames[i].coverage = i == 2 ? 0.9 : 1;
    frames[i].coverageInside = i == 1 ? NAN : i == 2 ? 0.8 : 1;
  }
  frames[1].flicker = 0;
  frames[4].flicker = 3;
  frames[4].name = "frame_0004";
  frames[5].flicker = 3;  // the first of equally bad frames is reported
  frames[2].eyes = EyeAgreement{0.5, 1, 2, 4};
  frames[3].eyes = EyeAgreement{0.7, 0.5, 4, 8};
  frames[5].eyes = EyeAgreement{};  // no surface is visible to both eyes
  const WalkSummary summary = summaryOf(frames);
  CHECK(summary.switches == 1);
  CHECK(summary.medianStep == 3);
  CHECK(summary.maxStep == 9);
  CHECK(summary.maxStepAtSwitch == 4);
  CHECK(summary.pop == 0.04);
  CHECK(summary.medianFlipStep == 0.03);
  CHECK(summary.minCoverage == 0.9);
  CHECK(summary.minCoverageInside == 0.8);
  CHECK(summary.meanCoverageInside == Approx(4.8 / 5));
  CHECK(summary.flicker == 3);
  CHECK(summary.flickerFrame == 4);
  CHECK(summary.flickerAt == "frame_0004");
  CHECK(summaryJson(summary).at("flickerAt") == "frame_0004");
  CHECK(summaryJson(summary).at("flickerFrame") == 4);
  CHECK(summary.eyes.seenByBoth == Approx(0.4));
  CHECK(summary.eyes.sameCell == Approx(0.75));
  CHECK(summary.eyes.difference == Approx(3));
  CHECK(summary.eyes.difference95 == Approx(6));
  const std::string table = summaryTable(summary, frames.size()).text();
  CHECK_THAT(table, Catch::Contains("pop") && Catch::Contains("0.0400") && Catch::Contains("flicker") &&
                        Catch::Contains("eyes") && Catch::Contains("4 (frame_0004)"));
}

TEST_CASE("figures that a walk did not measure are null and have no table row") {
  const WalkSummary summary = summaryOf({WalkFrame{}});
  const auto json = summaryJson(summary);
  for (const char* name : {"pop", "medianStep", "medianFlipStep", "maxStepAtSwitch", "coverageInside"})
    if (json.contains(name)) CHECK(ibr::test::parseOrderedJson(ibr::test::jsonLine(json)).at(name).is_null());
  CHECK(json.at("flicker").is_null());
  CHECK(json.at("flickerAt").is_null());
  CHECK(json.at("flickerFrame").is_null());
  CHECK(json.at("eyes").is_null());
  CHECK_THAT(summaryTable(summary, 1).text(), !Catch::Contains("pop") && !Catch::Contains("nan") &&
                                                  !Catch::Contains("flicker") && !Catch::Contains("eyes"));
}
