// SPDX-License-Identifier: Apache-2.0
// A harmonised model ([H]) as plain data: a mesh, its cameras, and the cameras that see each vertex. Offsets say where
// each camera's picture is read so that all pictures agree.
//
// [H] writes v̂_v^{i←j} for the point of picture i that shows the same as picture j at vertex v. Stored is the
// texture-coordinate complement v̂_v^{i←j} − o_v^i, where o_v^i is the vertex projected into camera i. It is 0 where
// mesh and cameras are exact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/conventions.h"
#include "ibr/export.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// A set of cameras of a model: bit i is camera i.
using CameraSet = std::uint64_t;
inline constexpr std::size_t kMaxHtmCameraCount = 64;  // maximum number of cameras of a model

/// A triangle mesh.
struct TriangleMesh {
  std::vector<glm::dvec3> positions;  // vertices, world
  std::vector<glm::uvec3> triangles;  // indices of corners, < positions.size(); counter-clockwise seen from outside

  bool operator==(const TriangleMesh&) const = default;
};

/// A camera of a harmonised model, with the files of its picture.
struct HtmCamera {
  std::string name;                 // unique in a model; the picture's file name
  Camera camera;                    // a pinhole; intrinsics are those of the undistorted picture at its stored size
  std::filesystem::path imageFile;  // JPEG or PNG, relative to the model's folder
  /// Grey PNG of the picture's size, relative to the model's folder: confidence that a pixel shows the mesh, from 0
  /// (background) to 255. It drops at edges where the mesh occludes itself. Empty: 255 everywhere.
  std::filesystem::path visibilityFile;
  /// The camera before its adjustment to the others, of the same size, for comparison methods; none: not adjusted.
  std::optional<Camera> given = std::nullopt;
};

/// A mesh, and for each vertex the cameras that contribute to its colour: they see a face at it and agree on the
/// colour.
struct HtmSurface {
  TriangleMesh mesh;               // n_v vertices
  std::vector<CameraSet> members;  // n_v: contributing cameras of each vertex
};

/// A harmonised model: n_c cameras, n_v vertices.
struct HtmModel {
  std::filesystem::path folder;        // base of the cameras' relative paths; empty for a model made in code
  std::vector<HtmCamera> cameras;      // n_c: 1 to kMaxHtmCameraCount
  HtmSurface surface;                  // the optimised mesh ([H] §3.1), n_v vertices
  std::vector<glm::vec2> complements;  // px of picture i, at [complementIndex(i, j, v)]; 0 where i = j; empty: all 0
  std::optional<HtmSurface> source;    // the mesh before optimisation, for comparison methods
  std::string settings;                // the settings that the model was made with, as JSON text; "" if none

  std::size_t vertexCount() const { return surface.mesh.positions.size(); }  // n_v
  /// Returns the index of v̂_v^{i←j} in `complements`: pictures i and j, vertex v.
  std::size_t complementIndex(std::size_t i, std::size_t j, std::size_t v) const {
    return (i * cameras.size() + j) * vertexCount() + v;
  }
};

/// A camera's photograph and its visibility.
struct HtmImage {
  Image8 photograph;  // 3 or 4 channels (alpha is not used), of the camera's size
  Image8 visibility;  // 1 channel, same size, as HtmCamera::visibilityFile; empty: 255 everywhere
  /// Mip levels by prepareHtmImage (ibr/htm.h), shared by copies; with them the other fields are empty.
  std::shared_ptr<const std::vector<Image8>> levels = {};
};
/// Loads the picture of a camera, given by its index into HtmModel::cameras. May throw.
using HtmImageSource = std::function<HtmImage(const HtmModel& model, std::size_t camera)>;

/// Faults of a model's data, in order, at most `limit`. Empty if all preconditions of HtmRenderer hold: numbers of
/// cameras, vertices and complements match, indices are in range, cameras are pinholes with different names, values are
/// finite, members are cameras of the model. Does not check files.
IBR_API std::vector<Fault> validate(const HtmModel& model, std::size_t limit = 100);

/// Reads MODEL/model.gltf, or the .gltf itself (extension IBR_harmonised_texture), and its buffers, but no pictures.
/// Throws Error{io}, or Error{invalidInput} with file and JSON pointer.
IBR_API HtmModel loadHtmModel(const std::filesystem::path& path);

/// Writes FOLDER/model.gltf and FOLDER/meshes/*.bin; the caller stores the pictures. Positions are rounded to a grid of
/// 2⁻²³ of the mesh's extent (rounded up to a power of two); other numbers are stored exactly. Removes buffers of an
/// earlier model in the folder. Throws Error{invalidInput} where validate() finds a fault, a mesh has no triangle or a
/// text is not UTF-8; Error{io}.
IBR_API void saveHtmModel(const HtmModel& model, const std::filesystem::path& folder);

/// Faults of a model's files, at most `limit`; `field` is a JSON pointer.
IBR_API std::vector<Fault> validateHtmModelFiles(const std::filesystem::path& path, std::size_t limit = 100);

}  // namespace ibr
