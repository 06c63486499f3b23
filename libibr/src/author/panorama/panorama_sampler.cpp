// SPDX-License-Identifier: Apache-2.0
// Backward mapping of a panorama to a pinhole ([T] §4.2): each pixel's direction gives a position in the panorama,
// sampled bilinearly. Departure: pixels that cover several panorama pixels are averaged.
//
// Pixels are processed in runs: directions and angles in float, in loops that the compiler vectorises; then positions
// rounded to 1/256 px, and colours in integers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "base/check.h"
#include "base/wide_math.h"
#include "ibr/author/panorama.h"

namespace ibr {
namespace {

constexpr int kRun = 32;                // px
constexpr int kTile = 64;               // rows of a tile of one run's width: neighbouring rows read the same memory
constexpr int kMaxSamplesPerAxis = 16;  // samples of a pixel, in each direction
constexpr float kMaxSamplesPerParallel = 64;  // along a parallel
constexpr std::size_t kBehind = 16;           // bytes that may be read behind the last pixel
constexpr float kPi = std::numbers::pi_v<float>;

// As std::atan2. x = y = 0 gives 0.
inline float angle(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  // Lesser over greater without a comparison: a second comparison of the same values would become a branch.
  const float apart = std::abs(ax - ay);
  float r = arctangent((ax + ay - apart) / (ax + ay + apart + 1e-30F));
  r = ay > ax ? 0.5F * kPi - r : r;
  r = x < 0 ? kPi - r : r;
  return std::copysign(r, y);
}

// Weights of the left and the right pixel, times 65536, by 256ths of a pixel. Their sum is 65535, so that products fit
// 16 bits; rounding compensates.
struct Weights {
  alignas(16) std::array<std::array<std::uint16_t, 8>, 256> lanes;  // of RGBRGB, and two unused ones
};
constexpr Weights makeWeights() {
  Weights w{};
  for (unsigned f = 0; f < 256; ++f) {
    const auto right = std::uint16_t((f * 65535 + 128) / 256);
    for (unsigned c = 0; c < 6; ++c) w.lanes[f][c] = c < 3 ? std::uint16_t(65535 - right) : right;
  }
  return w;
}
constexpr Weights kWeights = makeWeights();

// Bilinear colour times 256, at `fx`, `fy` 256ths from the upper left pixel.
template <int C>
struct Blended {
  std::array<std::uint16_t, C> value;

  Blended(const std::uint8_t* upper, const std::uint8_t* lower, unsigned fx, unsigned fy) {
    const unsigned left = kWeights.lanes[fx][0], right = kWeights.lanes[fx][3];
    for (int c = 0; c < C; ++c) {
      const unsigned l = upper[c] * (256 - fy) + lower[c] * fy, r = upper[c + C] * (256 - fy) + lower[c + C] * fy;
      value[std::size_t(c)] = std::uint16_t((l * left >> 16) + (r * right >> 16));
    }
  }
  void addTo(std::uint32_t* sum) const {
    for (int c = 0; c < C; ++c) sum[c] += value[std::size_t(c)];
  }
  void store(std::uint8_t* to) const {
    for (int c = 0; c < C; ++c) to[c] = std::uint8_t((value[std::size_t(c)] + 128U) >> 8);
  }
};

#if defined(__SSE2__)
// The same for RGB with SSE2: both pixels of a row at once.
template <>
struct Blended<3> {
  __m128i value;  // 16 bits each: R, G, B

  Blended(const std::uint8_t* upper, const std::uint8_t* lower, unsigned fx, unsigned fy) {
    const __m128i zero = _mm_setzero_si128(), down = _mm_set1_epi16(short(fy));
    const auto two = [&](const std::uint8_t* at) {
      return _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(at)), zero);
    };
    const __m128i column = _mm_add_epi16(_mm_mullo_epi16(two(upper), _mm_sub_epi16(_mm_set1_epi16(256), down)),
                                         _mm_mullo_epi16(two(lower), down));
    const __m128i both =
        _mm_mulhi_epu16(column, _mm_load_si128(reinterpret_cast<const __m128i*>(kWeights.lanes[fx].data())));
    value = _mm_add_epi16(both, _mm_srli_si128(both, 6));
  }
  void addTo(std::uint32_t* sum) const {
    __m128i* to = reinterpret_cast<__m128i*>(sum);
    _mm_storeu_si128(to, _mm_add_epi32(_mm_loadu_si128(to), _mm_unpacklo_epi16(value, _mm_setzero_si128())));
  }
  void store(std::uint8_t* to) const {  // writes one byte more, which the next pixel overwrites
    const __m128i rounded = _mm_srli_epi16(_mm_add_epi16(value, _mm_set1_epi16(128)), 8);
    const int bytes = _mm_cvtsi128_si32(_mm_packus_epi16(rounded, rounded));
    std::memcpy(to, &bytes, 4);
  }
};
#endif

struct Source {
  const std::uint8_t* bordered;
  std::size_t stride;
  float width, height;
};

struct Places {
  alignas(16) std::array<float, kRun> x, y, across;  // px of the panorama; across: horizontal part of the direction
};

// Maps a run of directions, `first` and on in steps of `step`, to positions in the panorama.
void place(const Source& from, glm::vec3 first, glm::vec3 step, Places& places) {
  const float turn = from.width / (2 * kPi), halfTurn = from.height / kPi;
  alignas(16) std::array<float, kRun> dx, dy, dz;
  for (int i = 0; i < kRun; ++i) {
    const float t = float(i);
    dx[i] = first.x + t * step.x;
    dy[i] = first.y + t * step.y;
    dz[i] = first.z + t * step.z;
    places.across[i] = std::sqrt(dx[i] * dx[i] + dz[i] * dz[i]);
  }
  for (int i = 0; i < kRun; ++i)
    places.x[i] = larger(smaller(angle(dx[i], -dz[i]) * turn + 0.5F * from.width, from.width), 0);
  for (int i = 0; i < kRun; ++i)
    places.y[i] = larger(smaller(0.5F * from.height - angle(dy[i], places.across[i]) * halfTurn, from.height), 0);
}

// Calls put(i, colour) for `count` positions, moved along the parallel by `shift` × the width of a pixel there.
template <int C, class Put>
void sample(const Source& from, const Places& places, int count, float widthTimesAcross, float shift, const Put& put) {
  alignas(16) std::array<std::int32_t, kRun> x, y;
  for (int i = 0; i < kRun; ++i) {
    const float wide = smaller(widthTimesAcross / larger(places.across[i], 1e-30F), from.width);
    float at = places.x[i] + shift * wide;
    at = at < 0 ? at + from.width : at;
    at = at > from.width ? at - from.width : at;
    // −0.5 to the centre of the previous pixel, +1 for the border.
    x[i] = std::int32_t((at + 0.5F) * 256 + 0.5F);
    y[i] = std::int32_t((places.y[i] + 0.5F) * 256 + 0.5F);
  }
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* upper = from.bordered + std::size_t(y[i] >> 8) * from.stride + std::size_t(x[i] >> 8) * C;
    put(i, Blended<C>(upper, upper + from.stride, unsigned(x[i] & 255), unsigned(y[i] & 255)));
  }
}

template <int C>
Image8 viewOf(const Source& from, const Intrinsics& k, glm::dquat rotation) {
  Image8 picture(k.width, k.height, C);
  const glm::dvec3 right = rotation * glm::dvec3(1 / k.fx, 0, 0), down = rotation * glm::dvec3(0, -1 / k.fy, 0);
  const glm::dvec3 corner = rotation * glm::dvec3(-k.cx / k.fx, k.cy / k.fy, -1);
  // Panorama pixels per view pixel at the view's centre, where neither image is stretched.
  const double wideX = double(from.width) / (2 * std::numbers::pi * k.fx),
               wideY = double(from.height) / (std::numbers::pi * k.fy);
  const int parts = std::clamp(int(std::lround(std::max(wideX, wideY))), 1, kMaxSamplesPerAxis);
  const float wide = float(std::max(wideX, double(from.width) / (2 * std::numbers::pi * k.fy)) / parts);
  std::array<std::uint8_t, kRun * C + 4> row{};
  std::array<std::uint32_t, kRun * 4> sum{};
  Places places;
  for (int top = 0; top < k.height; top += kTile)
    for (int begin = 0; begin < k.width; begin += kRun)
      for (int y = top; y < std::min(top + kTile, k.height); ++y) {
        const int count = std::min(kRun, k.width - begin);
        int samples = 0;  // of a pixel; equal for all pixels of a run
        sum.fill(0);
        for (int part = 0; part < parts * parts; ++part) {
          const double inX = (part % parts + 0.5) / parts, inY = (part / parts + 0.5) / parts;
          place(from, glm::vec3(corner + (begin + inX) * right + (y + inY) * down), glm::vec3(right), places);
          const float nearest = *std::min_element(places.across.begin(), places.across.begin() + count);
          const int along = int(std::clamp(wide / larger(nearest, 1e-30F) + 0.5F, 1.0F, kMaxSamplesPerParallel));
          if (parts == 1 && along == 1) {
            sample<C>(from, places, count, wide, 0,
                      [&](int i, const Blended<C>& colour) { colour.store(&row[i * C]); });
            continue;
          }
          samples += along;
          for (int a = 0; a < along; ++a)
            sample<C>(from, places, count, wide, (float(a) + 0.5F) / float(along) - 0.5F,
                      [&](int i, const Blended<C>& colour) { colour.addTo(&sum[i * 4]); });
        }
        if (samples > 0)
          for (int i = 0; i < count; ++i)
            for (int c = 0; c < C; ++c)
              row[i * C + c] = std::uint8_t((sum[i * 4 + c] + 128U * unsigned(samples)) / (256U * unsigned(samples)));
        std::memcpy(&picture.values[(std::size_t(y) * k.width + begin) * C], row.data(), std::size_t(count) * C);
      }
  return picture;
}

}  // namespace

PanoramaSampler::PanoramaSampler(const Image8& panorama)
    : width_(panorama.width),
      height_(panorama.height),
      channels_(panorama.channels),
      stride_(std::size_t(panorama.width + 2) * std::size_t(panorama.channels)) {
  check(width_ >= 1 && height_ >= 1 && channels_ >= 1 && channels_ <= 4, ErrorCode::invalidInput,
        "a panorama of {}x{} px with {} channels cannot be split", width_, height_, channels_);
  bordered_.resize(stride_ * std::size_t(height_ + 2) + kBehind);
  const std::size_t pixel = std::size_t(channels_), row = std::size_t(width_) * pixel;
  // Beyond the seam, copy the row's other end; beyond a pole, the same row turned by half a turn.
  const auto copy = [&](int from, int to, int turned) {
    const std::uint8_t* source = &panorama.values[std::size_t(from) * row];
    std::uint8_t* target = &bordered_[std::size_t(to) * stride_];
    const std::size_t head = std::size_t(turned) * pixel;
    std::memcpy(target + pixel, source + head, row - head);
    std::memcpy(target + pixel + row - head, source, head);
    std::memcpy(target, target + row, pixel);
    std::memcpy(target + pixel + row, target + pixel, pixel);
  };
  for (int y = 0; y < height_; ++y) copy(y, y + 1, 0);
  copy(0, 0, width_ / 2);
  copy(height_ - 1, height_ + 1, width_ / 2);
}

Image8 PanoramaSampler::view(const Intrinsics& pinhole, glm::dquat rotation) const {
  check(pinhole.model == CameraModel::pinhole && pinhole.width >= 1 && pinhole.height >= 1 && pinhole.fx > 0 &&
            pinhole.fy > 0 && std::isfinite(pinhole.fx + pinhole.fy + pinhole.cx + pinhole.cy),
        ErrorCode::invalidInput, "a panorama can only be split into pinhole images with positive focal lengths");
  const Source from{bordered_.data(), stride_, float(width_), float(height_)};
  switch (channels_) {
    case 1:
      return viewOf<1>(from, pinhole, rotation);
    case 2:
      return viewOf<2>(from, pinhole, rotation);
    case 3:
      return viewOf<3>(from, pinhole, rotation);
    default:
      return viewOf<4>(from, pinhole, rotation);
  }
}

}  // namespace ibr
