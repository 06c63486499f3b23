// SPDX-License-Identifier: Apache-2.0
// The optimiser's loop around the alignment methods.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "optimise/judge.h"
#include "support/error_of.h"
#include "support/planted.h"

using namespace ibr;

namespace {

AlignmentOptions patient(AlignmentMethod method = AlignmentMethod::cpu) {
  AlignmentOptions options;
  options.method = method;
  options.decay = 0.6;
  options.threshold = 1e-5;
  options.maxCycles = 14;
  return options;
}

}  // namespace

TEST_CASE("planted shifts are found to a tenth of a pixel", "[N3]") {
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

TEST_CASE("a move never lowers the ECC of its own star", "[N3]") {
  auto planted = test::planted(3, 96, 4, 2.5, 8);
  const StarMesh mesh = starMeshOf(planted.alignment);
  std::vector<Texels> pictures;
  for (const Image8& picture : planted.pictures) pictures.push_back(texelsOf(picture));
  Positions at = planted.alignment.position;
  int moves = 0, lowered = 0;
  AlignmentOptions options = patient();
  options.maxCycles = 3;
  options.guard = [&](std::uint32_t point, std::span<const glm::ivec2> match) {
    for (std::size_t member = 0; member < at.size(); ++member) {
      if (match[member] == at[member][point]) continue;
      const glm::ivec2 offset = match[member] - at[member][point];
      const auto score = [&](glm::ivec2 by) {
        return judge({mesh, pictures}, at, point, member, by).score(options.definition, options.varianceFloor);
      };
      lowered += !shader::eccGreater(score(offset), score(glm::ivec2(0)));
      at[member][point] = match[member];
      ++moves;
    }
    return true;
  };
  align(planted.alignment, options);
  CHECK(moves > 50);
  CHECK(lowered == 0);
}

TEST_CASE("the same seed gives the same mesh on any number of threads, other seeds an equal ECC", "[N3][P3]") {
  std::vector<double> ecc;
  Positions first;
  for (const std::uint64_t seed : {1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20}) {
    auto planted = test::planted(2, 96, 4, 2.5, 9);
    AlignmentOptions options = patient();
    options.prune = true;
    options.seed = seed;
    options.threads = ecc.empty() ? 1 : 3;
    ecc.push_back(align(planted.alignment, options).finalEcc);
    if (ecc.size() == 1) first = planted.alignment.position;
    if (ecc.size() == 2) CHECK(planted.alignment.position == first);
    if (ecc.size() == 3) CHECK(planted.alignment.position != first);
  }
  const auto [least, most] = std::ranges::minmax(ecc);
  CHECK(most - least <= 0.002);
}

TEST_CASE("alignment of noise, negatives and constant images ends", "[N3][T6]") {
  auto planted = test::planted(2, 64, 3, 0.0, 10);
  std::mt19937 random(1);
  SECTION("noise") {
    for (Image8& picture : planted.pictures)
      for (auto& v : picture.values) v = std::uint8_t(random());
  }
  SECTION("a negative: ECC at most 0 from the start") {
    for (std::size_t i = 0; i < planted.pictures[0].values.size(); ++i)
      planted.pictures[1].values[i] = std::uint8_t(255 - planted.pictures[0].values[i]);
  }
  SECTION("constant images") {
    for (Image8& picture : planted.pictures) picture = Image8(64, 64, 3, 90);
  }
  AlignmentOptions options;
  options.method = AlignmentMethod::cpu;
  options.threshold = GENERATE(0.0, 0.005);
  options.varianceFloor = GENERATE(0.0, 25.0);
  options.decay = 0.8;
  const AlignmentSummary summary = align(planted.alignment, options);
  CHECK(summary.cycles.size() < 50);
  CHECK(summary.finalEcc >= summary.initialEcc);
}

TEST_CASE("the loop continues after its first cycle, and the best cycle's mesh is kept", "[N3][T6]") {
  auto planted = test::planted(2, 96, 4, 2.5, 11);
  AlignmentOptions options;
  options.method = AlignmentMethod::cpu;
  const AlignmentSummary summary = align(planted.alignment, options);
  CHECK(summary.cycles.size() > 1);
  REQUIRE(summary.bestCycle > 0);
  CHECK(summary.finalEcc == summary.cycles[summary.bestCycle - 1].ecc);
  for (const AlignmentCycle& cycle : summary.cycles) CHECK(cycle.ecc <= summary.finalEcc);
  options.maxCycles = 1;
  options.guard = [](std::uint32_t, std::span<const glm::ivec2>) { return false; };
  const AlignmentSummary again = align(planted.alignment, options);
  CHECK(again.initialEcc == summary.finalEcc);
  CHECK(again.bestCycle == 0);
}

TEST_CASE("the first cycle never ends the loop at any threshold", "[N3][T6]") {
  auto planted = test::planted(2, 64, 3, 2.0, 13);
  AlignmentOptions options;
  options.method = AlignmentMethod::cpu;
  options.threshold = 100;  // no gain reaches it
  CHECK(align(planted.alignment, options).cycles.size() == 2);
}

TEST_CASE("options out of range and cancelling throw and do not change the alignment") {
  auto planted = test::planted(2, 64, 3, 1.0, 12);
  const auto before = planted.alignment.position;
  const auto faultOf = [&](auto&& spoil) {
    AlignmentOptions options;
    options.method = AlignmentMethod::cpu;
    spoil(options);
    return std::string(test::errorOf([&] { align(planted.alignment, options); }).what());
  };
  CHECK_THAT(faultOf([](auto& o) { o.instances = 1; }), Catch::Contains("instances") && Catch::Contains("256"));
  CHECK_THAT(faultOf([](auto& o) { o.radiusPx = 65; }),
             Catch::Contains("radiusPx") && Catch::Contains("65") && Catch::Contains("64"));
  CHECK_THAT(faultOf([](auto& o) { o.decay = 0; }),
             Catch::Contains("decay") && Catch::Contains("0") && Catch::Contains("1"));
  CHECK_THAT(faultOf([](auto& o) { o.threshold = -1; }), Catch::Contains("threshold") && Catch::Contains("-1"));
  CHECK_THAT(faultOf([](auto& o) { o.maxCycles = 0; }),
             Catch::Contains("maxCycles") && Catch::Contains("0") && Catch::Contains("1"));
  CHECK_THAT(faultOf([](auto& o) { o.varianceFloor = -1; }),
             Catch::Contains("varianceFloor") && Catch::Contains("-1") && Catch::Contains("1000"));
  CHECK_THAT(faultOf([](auto& o) { o.method = AlignmentMethod::compute; }),
             Catch::Contains("compute") && Catch::Contains("device"));
  int asked = 0;
  const Error stopped = test::errorOf(
      [&] { align(planted.alignment, patient(), nullptr, [&](const Progress&) { return ++asked < 3; }); });
  CHECK(stopped.code() == ErrorCode::cancelled);
  CHECK(planted.alignment.position == before);
}
