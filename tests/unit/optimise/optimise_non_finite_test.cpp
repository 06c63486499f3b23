// SPDX-License-Identifier: Apache-2.0
// Non-finite and extreme numbers in the optimiser's options.
#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/optimiser.h"
#include "support/error_of.h"
#include "support/extremes.h"
#include "support/planted.h"

using namespace ibr;

TEST_CASE("extreme option values are refused or give finite ECCs", "[N16]") {
  int refused = 0, ran = 0;
  for (double AlignmentOptions::*field :
       {&AlignmentOptions::radiusPx, &AlignmentOptions::decay, &AlignmentOptions::threshold,
        &AlignmentOptions::varianceFloor, &AlignmentOptions::rigidity, &AlignmentOptions::epipolarWeight,
        &AlignmentOptions::flipGain, &AlignmentOptions::insertBelow, &AlignmentOptions::insertGain,
        &AlignmentOptions::insertShare})
    for (const double value : test::kExtremes)
      for (const AlignmentMethod method : {AlignmentMethod::cpu, AlignmentMethod::gradient}) {
        auto planted = test::planted(2, 48, 2, 1.0, 5);
        AlignmentOptions options;
        options.method = method;
        options.maxCycles = 2;
        options.instances = 8;
        options.flipEdges = options.insertPoints = true;
        options.*field = value;
        INFO(value);
        if (!firstInvalidOption(options).empty()) {
          CHECK(test::errorOf([&] { align(planted.alignment, options); }).code() == ErrorCode::invalidInput);
          ++refused;
          continue;
        }
        const AlignmentSummary summary = align(planted.alignment, options);
        CHECK(std::isfinite(summary.finalEcc));
        CHECK(summary.finalEcc >= summary.initialEcc - 1e-12);
        ++ran;
      }
  CHECK(refused > 60);
  CHECK(ran > 20);
}
