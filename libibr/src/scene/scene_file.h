// SPDX-License-Identifier: Apache-2.0
// File format of a scene; names that reader and writer share.
//
//   scene.gltf   nodes     one per photograph (camera and pose), one per cell (mesh, at the members' mean position)
//                meshes    one per cell: a primitive per tier that is not empty; POINTS for a cell without triangles
//                extensions.IBR_image_graph   data beyond glTF (schema: IBR_image_graph.schema.json)
//   cells/*.bin  one buffer per cell (scene/mesh_buffer.h); the name ends in a hash of the contents, so that a file is
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
inline constexpr int kSceneVersion = 2;  // version 1 had no depth of photographs and is not supported

/// Members of a photograph's "capture"; each is optional.
inline constexpr std::array kCaptureNumbers{
    std::pair{"exposureTime", &CaptureMetadata::exposureTime}, std::pair{"fNumber", &CaptureMetadata::fNumber},
    std::pair{"iso", &CaptureMetadata::iso}, std::pair{"focalLength", &CaptureMetadata::focalLength},
    std::pair{"focalLength35", &CaptureMetadata::focalLength35}};
inline constexpr std::array kCaptureTexts{std::pair{"maker", &CaptureMetadata::maker},
                                          std::pair{"model", &CaptureMetadata::model},
                                          std::pair{"lens", &CaptureMetadata::lens}};

/// Convert relative paths to URIs (RFC 3986) and back. decodeUri returns "" for a URI that is absolute, has a scheme or
/// is malformed.
std::string encodeUri(const std::filesystem::path& relative);
std::string decodeUri(std::string_view uri);

}  // namespace ibr
