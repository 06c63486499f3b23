// SPDX-License-Identifier: Apache-2.0
#include "optimise/row_sums.h"

#include "optimise/row_sums_avx2.h"

namespace ibr {
namespace {

glm::ivec3 sampleAt(const RunSource& s, std::int32_t x, std::int32_t y) {
  constexpr int kFraction = shader::kEccRunBits, kDropped = kFraction - shader::kEccWeightBits;
  constexpr int kMask = (1 << shader::kEccWeightBits) - 1;
  const std::uint32_t* upper = s.texel + std::ptrdiff_t(y >> kFraction) * s.stride + (x >> kFraction);
  const std::uint32_t* lower = upper + s.stride;
  return shader::eccSample(upper[0], upper[1], lower[0], lower[1], x >> kDropped & kMask, y >> kDropped & kMask);
}

std::int64_t dot(glm::ivec3 p, glm::ivec3 q) {
  return std::int64_t(p.x) * q.x + std::int64_t(p.y) * q.y + std::int64_t(p.z) * q.z;
}

void addPortable(const RunSource& source, const RunSource& target, int pixels, shader::EccTarget& sums, RunLanes&) {
  for (int i = 0; i < pixels; ++i) {
    const glm::ivec3 a = sampleAt(source, source.x + i * source.stepX, source.y + i * source.stepY);
    const glm::ivec3 b = sampleAt(target, target.x + i * target.stepX, target.y + i * target.stepY);
    sums.x0 += a.x, sums.x1 += a.y, sums.x2 += a.z;
    sums.y0 += b.x, sums.y1 += b.y, sums.y2 += b.z;
    sums.xx += dot(a, a), sums.yy += dot(b, b), sums.xy += dot(a, b);
  }
  sums.n += pixels;
}

}  // namespace

const RunAdder kPortableRunAdder{addPortable, [](shader::EccTarget&, RunLanes&) {}};

const RunAdder& fastestRunAdder() {
  const RunAdder* avx2 = avx2RunAdder();
  return avx2 ? *avx2 : kPortableRunAdder;
}

}  // namespace ibr
