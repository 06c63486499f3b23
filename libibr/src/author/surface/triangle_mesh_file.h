// SPDX-License-Identifier: Apache-2.0
// Readers of triangle meshes, by file format, for readTriangleMesh.
//
// Readers trust no input: counts are checked against the file's size before any allocation. Own readers replace CGAL's,
// which report only failure, take a missing coordinate for 0 and misread faces with tabs.
#pragma once

#include <filesystem>

#include "ibr/author/htm.h"

namespace ibr {

/// Readers of the three formats, for readTriangleMesh, which checks indices and values.
TriangleMesh readPly(const std::filesystem::path& path);
TriangleMesh readObj(const std::filesystem::path& path);
TriangleMesh readGltfTriangles(const std::filesystem::path& path);

}  // namespace ibr
