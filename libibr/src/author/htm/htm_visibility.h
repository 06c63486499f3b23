// SPDX-License-Identifier: Apache-2.0
// Visibility of a mesh's faces in the cameras by the mesh's own depth, and a soft weight of each image's pixels.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_views.h"

namespace ibr {

struct FaceVisibility {
  CameraSet seen = 0;    // cameras that see at least a quarter of the face from its front
  CameraSet partly = 0;  // subset of `seen`: part of the face lies behind other faces
};

/// One entry per face. `views`: at full size.
std::vector<FaceVisibility> faceVisibility(const TriangleMesh& mesh, std::span<const ProjectedMesh> views, int threads);

/// Returns for each vertex the cameras that see a face at the vertex.
std::vector<CameraSet> vertexVisibility(const TriangleMesh& mesh, std::span<const FaceVisibility> faces);

/// Returns 255 inside the object, falling to 1 over `softPx` towards the background and towards edges where the mesh
/// hides itself. The background is outside the mask or, without a mask, outside the mesh. Only the background is 0.
Image8 softVisibility(const ProjectedMesh& view, double softPx);

}  // namespace ibr
