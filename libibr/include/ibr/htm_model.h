// SPDX-License-Identifier: Apache-2.0
// A harmonised model ([H]) as plain data: a mesh, the cameras that photographed it, who sees what, and where each
// camera's picture must be read so that all of them agree.
//
// [H] writes v̂_v^{i←j} for the point of picture i that shows what picture j shows at vertex v. Here it is kept as the
// texture-coordinate complement v̂_v^{i←j} − o_v^i, o_v^i the vertex projected into camera i: 0 where mesh and cameras
// are exact.
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
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// A set of cameras of a model, bit i the i-th.
using CameraSet = std::uint64_t;
inline constexpr std::size_t kLargestHtmCameraCount = 64;

struct TriangleMesh {
  std::vector<glm::dvec3> positions;  // world
  std::vector<glm::uvec3> triangles;  // indices < positions.size(); counter-clockwise seen from outside

  bool operator==(const TriangleMesh&) const = default;
};

struct HtmCamera {
  std::string name;                 // unique in a model; the picture's file name
  Camera camera;                    // a pinhole; intrinsics are those of the undistorted picture at its stored size
  std::filesystem::path imageFile;  // JPEG or PNG, relative to the model's folder
  /// Grey PNG of the picture's size, relative to the model's folder: how much each pixel may be trusted to show the
  /// mesh, 0 (background) to 255, least at edges at which the mesh hides itself. Empty: all of it.
  std::filesystem::path visibilityFile;
  /// The camera before it was adjusted to the others, of the same size, for methods to compare with; none: as it is.
  std::optional<Camera> given = std::nullopt;
};

/// A mesh, and for each vertex the cameras that take part in its colour: a face at it is seen by them, and they agree.
struct HtmSurface {
  TriangleMesh mesh;
  std::vector<CameraSet> members;  // n_v
};

struct HtmModel {
  std::filesystem::path folder;        // what relative paths of the cameras start from; empty for a model made in code
  std::vector<HtmCamera> cameras;      // n_c, 1 to kLargestHtmCameraCount
  HtmSurface surface;                  // the optimised mesh ([H] §3.1), n_v vertices
  std::vector<glm::vec2> complements;  // px of picture i, at [complementIndex(i, j, v)]; 0 where i = j; empty: all 0
  std::optional<HtmSurface> source;    // the mesh that was optimised, for methods to compare with
  std::string settings;                // the effective settings it was made with, as JSON text; "" if none

  std::size_t vertexCount() const { return surface.mesh.positions.size(); }
  std::size_t complementIndex(std::size_t i, std::size_t j, std::size_t v) const {
    return (i * cameras.size() + j) * vertexCount() + v;
  }
};

/// What was photographed by one camera.
struct HtmPicture {
  Image8 photograph;  // 3 or 4 channels (alpha is not used), of the camera's size
  Image8 visibility;  // 1 channel of the same size as HtmCamera::visibilityFile says; empty: 255 everywhere
  // Of preparedHtmPicture (ibr/htm.h): then the others are empty. Copies of a picture share them.
  std::shared_ptr<const std::vector<Image8>> levels = {};
};
using HtmPictureSource = std::function<HtmPicture(const HtmModel& model, std::size_t camera)>;

/// Every fault of a model's data, in order, at most `limit`; empty when all preconditions of HtmRenderer hold: numbers
/// of cameras, vertices and complements fit, indices in range, cameras pinholes with different names, values finite,
/// members among the cameras. Files are not looked at.
std::vector<Fault> validate(const HtmModel& model, std::size_t limit = 100);

/// Reads MODEL/model.gltf, or the .gltf itself (extension IBR_harmonised_texture), and the buffers beside it; pictures
/// are not read. Throws Error{io}, or Error{invalidInput} with file and JSON pointer.
HtmModel loadHtmModel(const std::filesystem::path& path);

/// Writes FOLDER/model.gltf and FOLDER/meshes/*.bin; pictures must be put there by the caller. Positions are rounded to
/// a grid of 2⁻²³ of the mesh's extent, everything else comes back bit by bit. Buffers of an earlier model there are
/// removed. Throws Error{invalidInput} where validate() finds a fault, a mesh has no triangle or a text is not UTF-8;
/// Error{io}.
void saveHtmModel(const HtmModel& model, const std::filesystem::path& folder);

/// Every fault of a model's files, at most `limit`; `field` is a JSON pointer.
std::vector<Fault> validateHtmModelFiles(const std::filesystem::path& path, std::size_t limit = 100);

}  // namespace ibr
