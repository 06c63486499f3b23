// SPDX-License-Identifier: Apache-2.0
// Which cameras see which faces of a mesh, by the mesh's own depth, and how far a picture's pixels may be trusted.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_views.h"

namespace ibr {

struct FaceVisibility {
  CameraSet seen = 0;    // cameras that see at least a quarter of the face, from its front
  CameraSet partly = 0;  // of these: some of it lies behind other faces
};

/// One a face. `views`: at full size.
std::vector<FaceVisibility> faceVisibility(const TriangleMesh& mesh, std::span<const ProjectedMesh> views, int threads);

/// For each vertex the cameras that see a face at it.
std::vector<CameraSet> vertexVisibility(const TriangleMesh& mesh, std::span<const FaceVisibility> faces);

/// 255 inside the object, falling to 1 over `softPx` towards the background (outside the mask, or where there is no
/// mask, outside the mesh) and towards edges at which the mesh hides itself; 0
/// is the background alone.
Image8 softVisibility(const ProjectedMesh& view, double softPx);

}  // namespace ibr
