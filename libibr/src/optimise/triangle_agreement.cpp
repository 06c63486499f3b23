// SPDX-License-Identifier: Apache-2.0
#include "optimise/triangle_agreement.h"

#include <algorithm>
#include <cmath>

namespace ibr {
namespace {

constexpr double kReliableSamples = 1024;

}  // namespace

std::optional<TriangleAgreement> agreementOf(std::span<const Texels> pictures, const Positions& at,
                                             std::span<const glm::uvec3> triangles, double varianceFloor) {
  TriangleAgreement mean;
  const double members = double(pictures.size());
  for (std::size_t source = 0; source < pictures.size(); ++source) {
    const Judgement judgement = judgeTriangles(pictures, at, triangles, source);
    if (!judgement.whole) return std::nullopt;
    const double samples = double(judgement.pixels());
    mean.ecc += eccOf(judgement.score(EccDefinition::channels, varianceFloor)) / members;
    mean.samples += samples / (members * double(judgement.count));
    if (samples > 0)
      mean.variance += double(judgement.score(EccDefinition::channels, 0).varianceX) /
                       (members * samples * 3 * double(scoreUnits(1)));
  }
  return mean;
}

double surplusOf(const std::optional<TriangleAgreement>& before, const std::optional<TriangleAgreement>& after,
                 double gain) {
  if (!before || !after || before->samples == 0) return -1;
  return after->ecc - before->ecc - gain * std::max(1.0, std::sqrt(kReliableSamples / before->samples));
}

}  // namespace ibr
