// SPDX-License-Identifier: Apache-2.0
#include "io/colour.h"

#include <lcms2.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "base/check.h"

namespace ibr::io {
namespace {

constexpr int kMaxProfileDifference = 2;  // 8-bit levels; profiles called sRGB differ as much among each other

struct Close {
  void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, Close>;

struct Delete {
  void operator()(void* transform) const { cmsDeleteTransform(transform); }
};
using Transform = std::unique_ptr<void, Delete>;

// An own context avoids the library's global context and its messages.
class Context {
 public:
  Context() : context_(cmsCreateContext(nullptr, nullptr)) {
    check(context_ != nullptr, ErrorCode::outOfMemory, "out of memory in lcms2");
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context() { cmsDeleteContext(context_); }

  cmsContext get() const { return context_; }

 private:
  cmsContext context_;
};

Transform transformFrom(const Context& context, const Profile& from, cmsUInt32Number kind) {
  const Profile srgb(cmsCreate_sRGBProfileTHR(context.get()));
  return Transform(cmsCreateTransformTHR(context.get(), from.get(), kind, srgb.get(), TYPE_RGB_8,
                                         INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOCACHE));
}

// Largest difference over all channels, on a grid of colours.
int difference(const Transform& transform) {
  constexpr int kStep = 51;
  std::vector<std::uint8_t> before, after;
  for (int r = 0; r <= 255; r += kStep)
    for (int g = 0; g <= 255; g += kStep)
      for (int b = 0; b <= 255; b += kStep)
        for (const int c : {r, g, b}) before.push_back(std::uint8_t(c));
  after.resize(before.size());
  cmsDoTransform(transform.get(), before.data(), after.data(), cmsUInt32Number(before.size() / 3));
  int most = 0;
  for (std::size_t i = 0; i < before.size(); ++i) most = std::max(most, std::abs(int(before[i]) - int(after[i])));
  return most;
}

void convert(Image8& picture, const Context& context, const Profile& from) {
  assert(picture.channels == 3);
  const Transform transform = transformFrom(context, from, TYPE_RGB_8);
  if (!transform || difference(transform) <= kMaxProfileDifference) return;
  const std::size_t row = std::size_t(picture.width) * 3;
  for (int y = 0; y < picture.height; ++y) {
    std::uint8_t* const at = picture.values.data() + std::size_t(y) * row;
    cmsDoTransform(transform.get(), at, at, cmsUInt32Number(picture.width));
  }
}

void convertGrey(Image8& picture, const Context& context, const Profile& from) {
  const Transform transform = transformFrom(context, from, TYPE_GRAY_8);
  if (!transform) return;
  std::array<std::uint8_t, 256> grey;
  for (std::size_t v = 0; v < 256; ++v) grey[v] = std::uint8_t(v);
  std::array<std::uint8_t, 768> table;
  cmsDoTransform(transform.get(), grey.data(), table.data(), 256);
  int most = 0;
  for (std::size_t v = 0; v < 256; ++v) most = std::max(most, std::abs(int(table[3 * v]) - int(v)));
  if (most <= kMaxProfileDifference) return;
  for (std::uint8_t& value : picture.values) value = table[3 * std::size_t(value)];
}

}  // namespace

void toSrgb(Image8& picture, std::span<const std::byte> profile) {
  if (profile.empty()) return;
  const Context context;
  const Profile from(cmsOpenProfileFromMemTHR(context.get(), profile.data(), cmsUInt32Number(profile.size())));
  if (!from) return;
  const cmsColorSpaceSignature space = cmsGetColorSpace(from.get());
  if (space == cmsSigRgbData) convert(picture, context, from);
  if (space == cmsSigGrayData) convertGrey(picture, context, from);
}

void adobeRgbToSrgb(Image8& picture) {
  // Adobe RGB (1998) Color Image Encoding, §4.3: D65, these primaries, and a gamma of 2 51/256.
  const Context context;
  const cmsCIExyY white{0.3127, 0.3290, 1};
  const cmsCIExyYTRIPLE primaries{{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}};
  cmsToneCurve* const curve = cmsBuildGamma(context.get(), 2.19921875);
  cmsToneCurve* const curves[3] = {curve, curve, curve};
  const Profile from(cmsCreateRGBProfileTHR(context.get(), &white, &primaries, curves));
  cmsFreeToneCurve(curve);
  check(from != nullptr, ErrorCode::outOfMemory, "out of memory in lcms2");
  convert(picture, context, from);
}

}  // namespace ibr::io
