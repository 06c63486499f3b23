// SPDX-License-Identifier: Apache-2.0
// The optimiser on a device against the CPU method: equal meshes, sums and counts, bit for bit.
#include <catch2/catch.hpp>

#include "base/vulkan/submit.h"
#include "ibr/ecc_pass.h"
#include "ibr/optimiser.h"
#include "optimise/alignment_backend.h"
#include "support/error_of.h"
#include "support/gpu.h"
#include "support/planted.h"

using namespace ibr;
using namespace ibr::test;

namespace {

AlignmentSummary alignedBy(AlignmentMethod method, AlignmentOptions options, Alignment& alignment) {
  options.method = method;
  return align(alignment, options, &testDevice());
}

// Returns true on a device without the method's integer support. Checks that this is reported and nothing moves.
bool refuses(AlignmentMethod method) {
  const bool raster = method == AlignmentMethod::raster;
  if (raster ? testDevice().supportsInt64Atomics() : testDevice().supportsInt64()) return false;
  Planted planted = test::planted(2, 72, 3, 2.0, 11);
  const auto before = planted.alignment.position;
  const Error error = errorOf([&] { alignedBy(method, {}, planted.alignment); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains("Int64"));
  CHECK(planted.alignment.position == before);
  CHECK(alignedBy(AlignmentMethod::cpu, {}, planted.alignment).finalEcc > 0.9);
  return true;
}

void expectSame(const AlignmentSummary& a, const AlignmentSummary& b) {
  CHECK(a.initialEcc == b.initialEcc);
  CHECK(a.finalEcc == b.finalEcc);
  CHECK(a.initialEccPaper == b.initialEccPaper);
  CHECK(a.finalEccPaper == b.finalEccPaper);
  CHECK(a.bestCycle == b.bestCycle);
  REQUIRE(a.cycles.size() == b.cycles.size());
  for (std::size_t c = 0; c < a.cycles.size(); ++c) {
    CAPTURE(c);
    CHECK(a.cycles[c].ecc == b.cycles[c].ecc);
    CHECK(a.cycles[c].mutations == b.cycles[c].mutations);
    CHECK(a.cycles[c].pixels == b.cycles[c].pixels);
    CHECK(a.cycles[c].moved == b.cycles[c].moved);
    CHECK(a.cycles[c].refused == b.cycles[c].refused);
  }
}

}  // namespace

TEST_CASE("methods compute and cpu give the same mesh", "[N3][T7][int64]") {
  if (refuses(AlignmentMethod::compute)) return;
  AlignmentOptions options;
  options.instances = GENERATE(16, 100);
  options.prune = GENERATE(false, true);
  options.definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  options.maxCycles = 2;
  options.rigidity = options.instances == 16 ? 30 : 0;
  const int members = options.instances == 16 ? 3 : 2;
  Planted onCpu = planted(members, 72, 3, 2.0, 11), onDevice = planted(members, 72, 3, 2.0, 11);
  const AlignmentSummary cpu = alignedBy(AlignmentMethod::cpu, options, onCpu.alignment);
  const AlignmentSummary compute = alignedBy(AlignmentMethod::compute, options, onDevice.alignment);
  expectSame(cpu, compute);
  CHECK(cpu.cycles[0].moved > 3);
  CHECK(onCpu.alignment.position == onDevice.alignment.position);
}

TEST_CASE("methods compute and cpu call the guard alike and undo refused moves", "[int64]") {
  if (refuses(AlignmentMethod::compute)) return;
  AlignmentOptions options;
  options.instances = 24;
  options.maxCycles = 2;
  options.guard = [](std::uint32_t point, std::span<const glm::ivec2> match) {
    return point % 2 == 0 && (match[0].x & 3) != 1;
  };
  Planted onCpu = planted(2, 72, 3, 2.0, 12), onDevice = planted(2, 72, 3, 2.0, 12);
  const auto before = onCpu.alignment.position;
  const AlignmentSummary cpu = alignedBy(AlignmentMethod::cpu, options, onCpu.alignment);
  const AlignmentSummary compute = alignedBy(AlignmentMethod::compute, options, onDevice.alignment);
  expectSame(cpu, compute);
  CHECK(cpu.cycles[0].refused > 0);
  CHECK(cpu.cycles[0].moved > 0);
  CHECK(onCpu.alignment.position == onDevice.alignment.position);
  for (std::size_t p = 1; p < before[0].size(); p += 2) CHECK(onDevice.alignment.position[1][p] == before[1][p]);
}

TEST_CASE("the raster method covers the same pixels as the other methods", "[N1][int64]") {
  if (refuses(AlignmentMethod::raster)) return;
  AlignmentOptions options;
  options.instances = 12;
  options.maxCycles = 1;
  options.definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  options.guard = [](std::uint32_t, std::span<const glm::ivec2>) { return false; };  // refuses all moves
  Planted planted = test::planted(3, 72, 3, 2.0, 13);
  const AlignmentSummary cpu = alignedBy(AlignmentMethod::cpu, options, planted.alignment);
  const AlignmentSummary raster = alignedBy(AlignmentMethod::raster, options, planted.alignment);
  CHECK(raster.cycles[0].mutations == cpu.cycles[0].mutations);
  CHECK(raster.cycles[0].pixels == cpu.cycles[0].pixels);
  // Samplers have 8-bit weights, so another candidate is sometimes minimally better.
  CHECK(double(raster.cycles[0].refused) == Approx(double(cpu.cycles[0].refused)).margin(3));
}

TEST_CASE("the raster method finds planted shifts with both definitions", "[N3][int64]") {
  if (refuses(AlignmentMethod::raster)) return;
  AlignmentOptions options;
  options.decay = 0.6;
  options.threshold = 1e-5;
  options.maxCycles = 9;
  options.instances = 32;
  options.definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  Planted planted = test::planted(2, 72, 3, 2.0, 14);
  REQUIRE(matchError(planted).mean > 1);
  alignedBy(AlignmentMethod::raster, options, planted.alignment);
  CHECK(matchError(planted).mean < 0.1);
}

TEST_CASE("a caller's command buffer moves points like the optimiser", "[int64]") {
  if (refuses(AlignmentMethod::compute)) return;
  AlignmentOptions options;
  options.instances = 16;
  Planted planted = test::planted(2, 72, 3, 2.0, 15);
  const EccPass pass(testDevice(), planted.alignment, options);
  REQUIRE(pass.classCount() > 1);
  const auto run = [&](bool move) {
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      for (std::uint32_t picture = 0; move && picture < 2; ++picture)
        for (std::uint32_t k = 0; k < pass.classCount(); ++k) pass.recordMove(commands, {picture, k, 3.0, 77});
      pass.recordEvaluation(commands);
      pass.recordReadback(commands);
    });
  };
  run(false);
  CHECK(pass.positions() == planted.alignment.position);
  const std::vector<std::vector<EccStar>> before = pass.stars();
  run(true);
  const std::vector<std::vector<EccStar>> after = pass.stars();
  double rise = 0;
  for (std::size_t picture = 0; picture < 2; ++picture)
    for (std::size_t p = 0; p < 16; ++p) {
      CHECK(before[picture][p].pixels > 0);
      rise += after[picture][p].channels - before[picture][p].channels;
    }
  CHECK(rise > 0.1);

  // The same moves on the CPU.
  const StarMesh mesh = starMeshOf(planted.alignment);
  std::vector<Texels> pictures;
  for (const Image8& picture : planted.pictures) pictures.push_back(texelsOf(picture));
  Positions at = planted.alignment.position;
  makeCpuBackend({mesh, pictures, options, planted.alignment})->cycle({3 * kAlignmentUnitsPerPixel, 77}, at, [] {});
  CHECK(pass.positions() == at);
}
