// SPDX-License-Identifier: Apache-2.0
// A panorama's depth by its faces: six pinholes of a cube, whose maps are read back over the sphere.
#pragma once

#include <span>
#include <vector>

#include "author/depth/depth_consistency.h"
#include "ibr/image.h"

namespace ibr {

/// Depth of one picture with its evidence.
struct MatchedDepth {
  ConsistentDepth matched;
  Image8 sky;  // 255 where the picture shows it, else 0; empty: not known
  DepthEvidence evidence;
};

/// In the order of cubeFaces(), with about as many pixels an angle as `panorama`.
std::vector<Camera> depthFaces(const Camera& panorama);

/// Their width and height, px, of a panorama of this width.
int depthFaceSize(int panoramaWidth);

/// The map of `panorama`: a pixel is the nearest one of the face that looks its way. Inverse depth along a face's axis
/// becomes inverse distance along the ray. `faces`: of depthFaces(), at any
/// sizes.
MatchedDepth onSphere(const Camera& panorama, std::span<const MatchedDepth> faces);

}  // namespace ibr
