// SPDX-License-Identifier: Apache-2.0
// Quality bounds of the matching methods on photographs; a broken matcher fails them. Needs IBR_DATASETS.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>

#include "ibr/error.h"
#include "ibr/lab/matchers.h"

using namespace ibr;
namespace fs = std::filesystem;

namespace {

// Exits with 77 (skipped) if IBR_DATASETS is not set.
fs::path datasets() {
  const char* const folder = std::getenv("IBR_DATASETS");
  if (folder && fs::is_directory(fs::path(folder) / "pairs_opencv")) return folder;
  std::puts("skipped: IBR_DATASETS names no folder with pairs_opencv");
  std::exit(77);
}

MatchCase caseNamed(const std::string& name) {
  std::vector<MatchCase> cases = readMatchCases(IBR_MATCHER_CASES, datasets());
  const auto found = std::ranges::find(cases, name, &MatchCase::name);
  REQUIRE(found != cases.end());
  return *found;
}

}  // namespace

TEST_CASE("flow and homographies match aloe at a third of its size to the true disparities") {
  MatchCase aloe = caseNamed("aloe");
  aloe.maxSize = 427;
  const std::vector<MatchScore> scores = compareMatchMethods(aloe);
  REQUIRE(scores.size() == 3);  // the data has no poses, so there is no sweep
  for (const MatchScore& score : scores) {
    const bool flow = score.method == MatchMethod::flow;
    INFO(matchMethodName(score.method) << " " << int(score.filter));
    CHECK(score.vertices > 400);
    CHECK(score.medianPx < (flow ? 0.8 : 0.5));
    CHECK(score.within1Px > (flow ? 0.5 : 0.8));
    CHECK(score.beyond3Px < (flow ? 0.3 : 0.06));
    CHECK(score.coverage > (score.filter == TriangleFilter::homogeneous ? 0.2 : 0.4));
    CHECK(score.memberPsnr > 26);
    CHECK(score.ecc > 0.8);
  }
  const MatchScore &all = scores[1], &onPlanes = scores[2];
  CHECK(all.homogeneous > 0.5);
  CHECK(all.homogeneous < 1);
  CHECK(onPlanes.homogeneous == 1);
  CHECK(onPlanes.coverage < all.coverage);
}

TEST_CASE("each method matches a cell of the street at half its size to exact depth") {
  MatchCase street = caseNamed("street");
  street.maxSize = 384;
  const std::vector<MatchScore> scores = compareMatchMethods(street);
  REQUIRE(scores.size() == 4);
  CHECK(scores[0].method == MatchMethod::sweep);
  for (const MatchScore& score : scores) {
    const bool planes = score.method == MatchMethod::homographic;
    INFO(matchMethodName(score.method) << " " << int(score.filter));
    CHECK(score.vertices > 250);
    CHECK(score.medianPx < (planes ? 0.3 : 0.6));
    CHECK(score.within1Px > (planes ? 0.9 : 0.55));
    CHECK(score.completeness > (planes ? 0.3 : 0.4));
    CHECK(score.precision > 0.65);
    CHECK(score.memberPsnr > 24);
  }
  CHECK(scores[3].precision > scores[2].precision);
}
