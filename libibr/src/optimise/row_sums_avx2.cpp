// SPDX-License-Identifier: Apache-2.0
#include "optimise/row_sums_avx2.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

#include <algorithm>

#define IBR_AVX2 __attribute__((target("avx2"), always_inline)) inline

namespace ibr {
namespace {

constexpr int kPixels = 8;          // per step
constexpr int kMaxSteps = 1 << 13;  // until lanes are emptied: a lane of products gains less than 2¹⁸ per step

struct Colours {
  __m256i r, g, b;  // values of eight pixels in 2⁻⁸ levels, 32 bits each
};

// Moves byte `channel` of each word to byte `place`; the other bytes become 0.
IBR_AVX2 __m256i byteTo(__m256i words, int channel, int place) {
  const int first = int((0x80808080u & ~(0xffu << 8 * place)) | unsigned(channel) << 8 * place), next = 4 << 8 * place;
  const __m256i shuffle = _mm256_setr_epi32(first, first + next, first + 2 * next, first + 3 * next, first,
                                            first + next, first + 2 * next, first + 3 * next);
  return _mm256_shuffle_epi8(words, shuffle);
}

// 256 · (level − 128) of a texel (lower half of each word) and of its right neighbour (upper half).
IBR_AVX2 __m256i neighbours(__m256i left, __m256i right, int channel) {
  return _mm256_or_si256(byteTo(left, channel, 1), byteTo(right, channel, 3));
}

// Combines two 16-bit numbers per word.
IBR_AVX2 __m256i paired(__m256i low, __m256i high) {
  return _mm256_blend_epi16(low, _mm256_slli_epi32(high, 16), 0xAA);
}

// Weighted sums of two 16-bit numbers per word, rounded and divided by the sum of the weights.
IBR_AVX2 __m256i weighed(__m256i pairs, __m256i weights) {
  const __m256i half = _mm256_set1_epi32(1 << (shader::kEccWeightBits - 1));
  return _mm256_srai_epi32(_mm256_add_epi32(_mm256_madd_epi16(pairs, weights), half), shader::kEccWeightBits);
}

// Computes eccBilinear for one channel.
IBR_AVX2 __m256i mixed(__m256i t00, __m256i t10, __m256i t01, __m256i t11, __m256i acrossWeights, __m256i downWeights,
                       int channel) {
  const __m256i upper = weighed(neighbours(t00, t10, channel), acrossWeights);
  const __m256i lower = weighed(neighbours(t01, t11, channel), acrossWeights);
  const __m256i pairs = paired(upper, lower);
  return _mm256_max_epi32(weighed(pairs, downWeights), _mm256_set1_epi32(-32767));
}

// 2¹⁴ − w in the lower half of each word, w in the upper.
IBR_AVX2 __m256i weightPairs(__m256i coordinate) {
  constexpr int kDropped = shader::kEccRunBits - shader::kEccWeightBits;
  const __m256i weight =
      _mm256_and_si256(_mm256_srli_epi32(coordinate, kDropped), _mm256_set1_epi32((1 << shader::kEccWeightBits) - 1));
  return _mm256_or_si256(_mm256_sub_epi32(_mm256_set1_epi32(1 << shader::kEccWeightBits), weight),
                         _mm256_slli_epi32(weight, 16));
}

// Samples the pixels `index` of a run.
IBR_AVX2 Colours sampled(const RunSource& s, __m256i index) {
  const __m256i x = _mm256_add_epi32(_mm256_set1_epi32(s.x), _mm256_mullo_epi32(index, _mm256_set1_epi32(s.stepX)));
  const __m256i y = _mm256_add_epi32(_mm256_set1_epi32(s.y), _mm256_mullo_epi32(index, _mm256_set1_epi32(s.stepY)));
  const __m256i at =
      _mm256_add_epi32(_mm256_mullo_epi32(_mm256_srai_epi32(y, shader::kEccRunBits), _mm256_set1_epi32(s.stride)),
                       _mm256_srai_epi32(x, shader::kEccRunBits));
  const int* texel = reinterpret_cast<const int*>(s.texel);
  const __m256i t00 = _mm256_i32gather_epi32(texel, at, 4), t10 = _mm256_i32gather_epi32(texel + 1, at, 4);
  const __m256i t01 = _mm256_i32gather_epi32(texel + s.stride, at, 4),
                t11 = _mm256_i32gather_epi32(texel + s.stride + 1, at, 4);
  const __m256i across = weightPairs(x), down = weightPairs(y);
  return {mixed(t00, t10, t01, t11, across, down, 0), mixed(t00, t10, t01, t11, across, down, 1),
          mixed(t00, t10, t01, t11, across, down, 2)};
}

IBR_AVX2 void addTo(RunLanes& lanes, RunLanes::Sum sum, __m256i values) {
  auto* at = reinterpret_cast<__m256i*>(lanes.lanes[sum].data());
  _mm256_storeu_si256(at, _mm256_add_epi32(_mm256_loadu_si256(at), values));
}

// Adds products of two 16-bit numbers, of red with green and of blue, with low and high halves separate.
IBR_AVX2 void addProducts(RunLanes& lanes, RunLanes::Sum low, RunLanes::Sum high, __m256i redGreen, __m256i blue) {
  const __m256i mask = _mm256_set1_epi32(0xffff);
  addTo(lanes, low, _mm256_add_epi32(_mm256_and_si256(redGreen, mask), _mm256_and_si256(blue, mask)));
  addTo(lanes, high, _mm256_add_epi32(_mm256_srai_epi32(redGreen, 16), _mm256_srai_epi32(blue, 16)));
}

IBR_AVX2 void addStep(const Colours& a, const Colours& b, RunLanes& lanes) {
  addTo(lanes, RunLanes::x0, a.r);
  addTo(lanes, RunLanes::x1, a.g);
  addTo(lanes, RunLanes::x2, a.b);
  addTo(lanes, RunLanes::y0, b.r);
  addTo(lanes, RunLanes::y1, b.g);
  addTo(lanes, RunLanes::y2, b.b);
  const __m256i aRedGreen = paired(a.r, a.g), bRedGreen = paired(b.r, b.g), aBlue = paired(a.b, _mm256_setzero_si256()),
                bBlue = paired(b.b, _mm256_setzero_si256());
  addProducts(lanes, RunLanes::xxLow, RunLanes::xxHigh, _mm256_madd_epi16(aRedGreen, aRedGreen),
              _mm256_madd_epi16(aBlue, aBlue));
  addProducts(lanes, RunLanes::yyLow, RunLanes::yyHigh, _mm256_madd_epi16(bRedGreen, bRedGreen),
              _mm256_madd_epi16(bBlue, bBlue));
  addProducts(lanes, RunLanes::xyLow, RunLanes::xyHigh, _mm256_madd_epi16(aRedGreen, bRedGreen),
              _mm256_madd_epi16(aBlue, bBlue));
}

IBR_AVX2 Colours without(const Colours& c, __m256i mask) {
  return {_mm256_andnot_si256(mask, c.r), _mm256_andnot_si256(mask, c.g), _mm256_andnot_si256(mask, c.b)};
}

void empty(shader::EccTarget& sums, RunLanes& lanes) {
  const auto total = [&](RunLanes::Sum sum) {
    std::int64_t all = 0;
    for (const std::int32_t lane : lanes.lanes[sum]) all += lane;
    return all;
  };
  const auto products = [&](RunLanes::Sum low, RunLanes::Sum high) { return total(low) + total(high) * 65536; };
  sums.x0 += total(RunLanes::x0), sums.x1 += total(RunLanes::x1), sums.x2 += total(RunLanes::x2);
  sums.y0 += total(RunLanes::y0), sums.y1 += total(RunLanes::y1), sums.y2 += total(RunLanes::y2);
  sums.xx += products(RunLanes::xxLow, RunLanes::xxHigh);
  sums.yy += products(RunLanes::yyLow, RunLanes::yyHigh);
  sums.xy += products(RunLanes::xyLow, RunLanes::xyHigh);
  lanes = {};
}

__attribute__((target("avx2"))) void addRun(const RunSource& source, const RunSource& target, int pixels,
                                            shader::EccTarget& sums, RunLanes& lanes) {
  const __m256i ascending = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  for (int first = 0; first < pixels; first += kPixels) {
    const __m256i index = _mm256_add_epi32(_mm256_set1_epi32(first), ascending);
    const __m256i last = _mm256_set1_epi32(pixels - 1);  // lanes beyond the last pixel read it again and are masked
    const __m256i beyond = _mm256_cmpgt_epi32(index, last), at = _mm256_min_epi32(index, last);
    Colours a = sampled(source, at), b = sampled(target, at);
    if (first + kPixels > pixels) a = without(a, beyond), b = without(b, beyond);
    addStep(a, b, lanes);
    if (++lanes.steps == kMaxSteps) empty(sums, lanes);
  }
  sums.n += pixels;
}

constexpr RunAdder kAvx2RunAdder{addRun, empty};

}  // namespace

const RunAdder* avx2RunAdder() {
  return __builtin_cpu_supports("avx2") ? &kAvx2RunAdder : nullptr;
}

}  // namespace ibr

#else

namespace ibr {
const RunAdder* avx2RunAdder() {
  return nullptr;
}
}  // namespace ibr

#endif
