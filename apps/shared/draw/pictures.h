// SPDX-License-Identifier: Apache-2.0
// Small things that are done to pictures before they are written. All take and give 8-bit display-encoded values.
#pragma once

#include <array>
#include <vector>

#include "ibr/image.h"
#include "ibr/offscreen.h"
#include "io/exr.h"

namespace ibr::app {

/// Without the alpha channel.
Image8 rgb(const Image8& image);

/// All of an RGBA picture shows.
void makeOpaque(Image8& image);

/// Everything that is known of a picture's pixels, for an OpenEXR file: R, G, B, linear; Z, depth; tier; rank;
/// weight.0 … weight.3; confidence.spread, .uncertainty, .extrapolation (BufferTargets). Precondition: equal sizes.
std::vector<ExrChannel> exrChannels(const Image8& image, const FrameBuffers& buffers);

/// |a − b| channel by channel, times `gain`, over R, G, B. Precondition: equal sizes, 3 channels or more.
Image8 absoluteDifference(const Image8& a, const Image8& b, int gain);

/// Where a picture with alpha shows something: 255, else 0; one channel.
Image8 coverOf(const Image8& image);

/// Pictures of equal height, left to right; 3 channels each.
Image8 sideBySide(const std::vector<Image8>& images);

/// Shares of the pixels that tiers 0 to 3 show, in a picture with AlphaContent::tier.
std::array<double, 4> tierShares(const Image8& image);

}  // namespace ibr::app
