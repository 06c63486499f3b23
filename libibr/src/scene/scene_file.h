// SPDX-License-Identifier: Apache-2.0
// The scene's file: names that reader and writer share. The form is that of INTERFACE §2:
//
//   scene.gltf   nodes     one a photograph (camera and pose), one a cell (mesh, at the members' mean position)
//                meshes    one a cell: a primitive a tier that is not empty; POINTS where no triangle is
//                extensions.IBR_image_graph   what glTF has no words for (schema: IBR_image_graph.schema.json)
//   cells/*.bin  a buffer a cell (scene/mesh_buffer.h); the name ends in a hash of the contents, so that a file is
//                never overwritten by other contents
//   depth/*.ktx2 a photograph's inverse depth and consensus (image/depth_texture.h), written by the author
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "ibr/capture.h"

namespace ibr {

inline constexpr const char* kSceneFileName = "scene.gltf";
inline constexpr const char* kSceneExtension = "IBR_image_graph";
inline constexpr int kSceneVersion = 2;  // version 1 had no depth of photographs, and is not read

/// Members of a photograph's "capture"; each may be missing.
inline constexpr std::array kCaptureNumbers{
    std::pair{"exposureTime", &CaptureFacts::exposureTime}, std::pair{"fNumber", &CaptureFacts::fNumber},
    std::pair{"iso", &CaptureFacts::iso}, std::pair{"focalLength", &CaptureFacts::focalLength},
    std::pair{"focalLength35", &CaptureFacts::focalLength35}};
inline constexpr std::array kCaptureTexts{std::pair{"maker", &CaptureFacts::maker},
                                          std::pair{"model", &CaptureFacts::model},
                                          std::pair{"lens", &CaptureFacts::lens}};

/// Relative paths as URIs (RFC 3986) and back. decodeUri gives "" for one that is absolute, has a scheme or is
/// malformed.
std::string encodeUri(const std::filesystem::path& relative);
std::string decodeUri(std::string_view uri);

}  // namespace ibr
