// SPDX-License-Identifier: Apache-2.0
// Operations on images before they are written. All take and return 8-bit display-encoded values.
#pragma once

#include <vector>

#include "ibr/image.h"
#include "ibr/offscreen.h"
#include "io/exr.h"

namespace ibr::app {

/// Returns the image without its alpha channel.
Image8 rgb(const Image8& image);

/// Sets alpha to 255 in an RGBA image.
void makeOpaque(Image8& image);

/// Returns all data of an image's pixels, for an OpenEXR file: R, G, B, linear; Z, depth; tier; rank;
/// weight.0 … weight.3; confidence.spread, .uncertainty, .extrapolation (BufferTargets). Precondition: equal sizes.
std::vector<ExrChannel> exrChannels(const Image8& image, const FrameBuffers& buffers);

/// |a − b| by channel, times `gain`, for R, G, B. Precondition: equal sizes, at least 3 channels.
Image8 absoluteDifference(const Image8& a, const Image8& b, int gain);

/// Joins images of equal height from left to right; 3 channels each.
Image8 sideBySide(const std::vector<Image8>& images);

}  // namespace ibr::app
