// SPDX-License-Identifier: Apache-2.0
// Depth of a panorama from its six cube faces, which are pinholes. Their maps are resampled to the sphere.
#pragma once

#include <span>
#include <vector>

#include "author/depth/depth_consistency.h"
#include "ibr/image.h"

namespace ibr {

/// Depth of one image with its evidence.
struct MatchedDepth {
  ConsistentDepth matched;
  Image8 sky;  // 255 for sky, else 0; empty: unknown
  DepthEvidence evidence;
};

/// Faces in the order of cubeFaces(), with about the angular resolution of `panorama`.
std::vector<Camera> depthFaces(const Camera& panorama);

/// Width and height of the faces, px, for a panorama of this width.
int depthFaceSize(int panoramaWidth);

/// Map of `panorama`: a pixel takes the nearest pixel of the face that contains its direction. Inverse depth along a
/// face's axis is converted to inverse distance along the ray. `faces`: of depthFaces(), at any sizes.
MatchedDepth onSphere(const Camera& panorama, std::span<const MatchedDepth> faces);

}  // namespace ibr
