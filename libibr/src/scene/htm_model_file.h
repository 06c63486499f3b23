// SPDX-License-Identifier: Apache-2.0
// File format of a harmonised model; names that reader and writer share.
//
//   model.gltf     nodes     one per camera (pose), one per surface (mesh, at the middle of its extent)
//                  meshes    the optimised surface and, if stored, the original one: POSITION relative to the node,
//                            _MEMBERS the set of cameras as four numbers of 16 bits, the lowest first
//                  extensions.IBR_harmonised_texture   the rest (schema: IBR_harmonised_texture.schema.json)
//   meshes/*.bin   one buffer per surface and one for the complements, an accessor VEC2 in the order of
//                  HtmModel::complementIndex; names end in a hash of the contents
#pragma once

#include <filesystem>

namespace ibr {

inline constexpr const char* kHtmModelFileName = "model.gltf";
inline constexpr const char* kHtmModelExtension = "IBR_harmonised_texture";
inline constexpr const char* kHtmModelBuffers = "meshes";
inline constexpr int kHtmModelVersion = 1;

}  // namespace ibr
