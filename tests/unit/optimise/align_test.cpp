// SPDX-License-Identifier: Apache-2.0
// The loop around the methods: NUMERICS N3, T6.
#include <catch2/catch.hpp>

#include "support/planted.h"

using namespace ibr;

namespace {

AlignmentOptions patient(AlignmentMethod method = AlignmentMethod::cpu) {
  AlignmentOptions options;
  options.method = method;
  options.decay = 0.6;
  options.threshold = 1e-5;
  options.mostCycles = 14;
  return options;
}

}  // namespace

TEST_CASE("planted shifts are found to a tenth of a pixel") {
  const int members = GENERATE(2, 3, 4);
  auto planted = test::planted(members, 112, 4, 2.5, 7);
  const double before = test::matchError(planted).mean;
  const AlignmentSummary summary = align(planted.alignment, patient());
  const test::MatchError after = test::matchError(planted);
  CAPTURE(members, before, after.mean, after.largest, summary.initialEcc, summary.finalEcc, summary.cycles.size(),
          summary.seconds);
  CHECK(before > 1.0);
  CHECK(after.mean < 0.1);
  CHECK(summary.finalEcc > summary.initialEcc);
}
