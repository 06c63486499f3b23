// SPDX-License-Identifier: Apache-2.0
// The image graph ([T] §2.4) as plain data, and its file: a glTF 2.0 asset with the extension IBR_image_graph.
//
// A node is a photograph with its pose. A cell joins 2 to 4 nodes (line, triangle, tetrahedron) by one morphing mesh.
// Threading: several threads may load and save at the same time, each a different scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/capture.h"
#include "ibr/conventions.h"
#include "ibr/export.h"

namespace ibr {

/// A photograph with its pose.
struct Node {
  std::string name;                   // unique in a scene; the photograph's file name
  Camera camera;                      // pose, and intrinsics of the undistorted photograph at its stored size
  std::filesystem::path imageFile;    // JPEG or PNG, relative to the scene's folder
  std::filesystem::path textureFile;  // baked KTX2, relative to the scene's folder; same size as the photograph
  CaptureMetadata capture = {};       // capture settings as the camera recorded them
  /// Red, green, blue: factors of the photograph's linear light that match its exposure and white balance to those of
  /// the other photographs. 1 where unknown; 1 / kMaxGain to kMaxGain.
  glm::dvec3 gain{1.0};
  /// Mask: grey PNG of the photograph's size, 0 where the photograph must not be shown (moving objects). Relative to
  /// the scene's folder; empty: no mask. Renderers read the mask from the texture's alpha, so the texture is never bc1.
  std::filesystem::path maskFile = {};
  /// Depth texture (KTX2, TextureFormat::rg16f), relative to the scene's folder; empty: none. Covers the photograph at
  /// about a quarter of its sides. Red: ρ / depthScale, ρ the largest of the texel's block. Green: the consensus a
  /// (MorphMesh::consensus). A pinhole's ρ is the inverse depth along its axis, a panorama's the inverse distance.
  std::filesystem::path depthFile = {};
  double depthScale = 0;  // ρ of the depth texture's red at 1, 1 / world unit; > 0 with a depthFile, 0 without
};
inline constexpr double kMaxGain = 4096;  // maximum of Node::gain; the minimum is its inverse

/// Evidence for a triangle or a pixel.
enum Tier : std::uint8_t {
  kTierConsistent = 0,  // triangle in which all members agree, blended as in [T]; gathered pixel of confirmed depth
  kTierRejected = 1,    // triangle that a filter rejected: kept in the mesh, not drawn
  kTierCompleted = 2,   // gathered pixel of completed depth, which no second photograph confirms
  kTierFilled = 3,      // pixel on which nothing was drawn, filled from the pixels around it
};

/// A morphing mesh with d members, n vertices and m triangles.
///
/// Member i sees the scene point of vertex p in direction r_i = unproject(match[i][p]), rotated to world axes, at the
/// distance s_i. inverseDistance[p] is ρ >= 0, and ratio[i][p] is a_i = s_i·ρ. ρ = 0 puts the point at infinity, where
/// every a_i is 1. The values (a_i, ρ) of a vertex are homogeneous: multiplying all of them by one positive number
/// changes nothing. By convention ρ is the inverse of the mean of s_i, so that the mean of a_i is 1.
/// [T] eq. 4 is the case a_i = 1, ρ = 0.
struct MorphMesh {
  std::vector<std::vector<glm::vec2>> match;  // d × n, position in the member's photograph, px
  std::vector<std::vector<float>> ratio;      // d × n, a_i > 0: distance s_i from the member times ρ
  std::vector<float> inverseDistance;         // n, ρ >= 0, 1 / world unit; 0: at infinity
  std::vector<float> uncertainty;             // n, one standard deviation of ρ, >= 0, 1 / world unit
  std::vector<std::uint8_t> confirmations;    // n, or empty: c, number of photographs that confirm the vertex's depth;
                                              // 0 also where depth was completed
  std::vector<float> consensus;               // n, or empty, as confirmations: a = (c + .25) / (c + v + .5), v counts
                                              // photographs that see past the vertex; .1 where depth was completed
  std::vector<glm::uvec3> triangles;          // m, indices of vertices < n; all triangles of tier 0 first, then tier 1
  std::vector<std::uint8_t> tier;             // m, tier of each triangle: kTierConsistent or kTierRejected
  std::vector<float> ecc;  // m, lowest enhanced correlation coefficient of two members, -1 to 1; label only
  /// n, or empty: numbers of the scene planes that a vertex lies on, from 1, ascending, filled up with 0. Label only: a
  /// triangle whose vertices share a plane is mapped between any two members by one homography.
  std::vector<glm::u16vec4> planes;

  std::size_t memberCount() const { return match.size(); }            // d, number of members
  std::size_t vertexCount() const { return inverseDistance.size(); }  // n, number of vertices
  IBR_API std::size_t tier0Count() const;                             // number of triangles of tier 0
};

/// Quality of a cell, measured when the cell was built. NaN: not measured. A backdrop's coverage is the share of its
/// photograph whose depth was matched.
struct CellQuality {
  double coverage;    // 0 to 1: share of the members' mean image (panoramas: of the sphere) under tier-0 triangles
  double ecc;         // -1 to 1: area-weighted mean of MorphMesh::ecc over tier 0
  double residualPx;  // >= 0: median distance between a match and the projection of its triangulated point, px
  double score;       // 0 to 1: shape of the simplex × lowest share of common points of two members × min(1, 0.15 /
                      // largest disparity spread of two members, in image widths) × coverage × max(ecc, 0)
  IBR_API CellQuality();  // all NaN
};

/// 2 to 4 nodes with a morphing mesh, or the backdrop of a single node.
struct Cell {
  std::vector<std::uint32_t> members;  // 2 to 4 different node indices; 1 for a backdrop
  MorphMesh mesh;                      // mesh over the members, in their order
  CellQuality quality;                 // measured when the cell was built
};

/// Position of the world's origin on the Earth, kept for export and never part of a pose.
struct GeographicOrigin {
  // latitudeDegrees: north of the equator; longitudeDegrees: east of Greenwich; heightMetres: height
  double latitudeDegrees = 0, longitudeDegrees = 0, heightMetres = 0;
};

/// UnusedPhotograph::reason of a readable photograph without a pose. Retaken nearer to the others, the photograph may
/// get one.
inline constexpr const char* kNotRegistered = "not registered: the model has no pose for it";
/// A photograph that no cell shows.
struct UnusedPhotograph {
  std::string name;    // name of a node, or of a photograph's file without a pose
  std::string reason;  // why no cell shows it, for people
};

/// An image graph: photographs, cells and backdrops.
struct Scene {
  std::filesystem::path folder;  // base of the nodes' relative paths; empty for a scene made in code
  std::vector<Node> nodes;       // photographs; other fields refer to them by index
  std::vector<Cell> cells;       // lines, triangles and tetrahedra of nodes
  std::vector<Cell> backdrops;   // depth meshes of single photographs, which vote (Composition::gathered, hybrid): at
                                 // most one a node
  std::vector<UnusedPhotograph> unusedPhotographs;  // photographs that no cell shows
  std::string acquisition;  // how photographs were taken: "ordered", "unordered", "synthetic", "panoramic" or ""
  std::string settings;     // effective settings of the build, as JSON text; "" if none
  std::optional<GeographicOrigin> origin;  // position of the world's origin on the Earth; nullopt: unknown
};

/// A fault of data or of a file.
struct Fault {
  std::string field;    // field with the fault: "cells[3].mesh.ratio[1][17]", or a JSON pointer for a fault of a file
  std::string message;  // the problem, with the value
};

/// Returns the faults of a scene's data, in order, at most `limit`. Empty: all preconditions of the renderer hold
/// (unique names, different members, indices in range, consistent sizes, values finite and in range, rotations of unit
/// length ± 1e-3). Opens no files.
IBR_API std::vector<Fault> validate(const Scene& scene, std::size_t limit = 100);

/// Returns true if any member's photograph has a mask.
IBR_API bool isMasked(const Scene& scene, const Cell& cell);

/// Returns the scene point of a vertex: mean over members of c_i + (a_i / ρ) r_i, c_i the member's centre. nullopt
/// where ρ = 0 or the mean is not finite.
IBR_API std::optional<glm::dvec3> vertexPosition(const Scene& scene, const Cell& cell, std::size_t point);

/// Reads a scene from its folder or its scene.gltf; opens no photographs and textures. Throws Error (io, invalidInput)
/// that names file and JSON pointer. A reference to a file outside the scene's folder is invalidInput. A requested stop
/// throws Error{cancelled} before the next mesh or photograph is read, or while scene.gltf is parsed; freeing a large
/// document then takes about as long as parsing it has taken.
IBR_API Scene loadScene(const std::filesystem::path& path, const std::stop_token& stop = {});

/// Returns the faults of a scene's files, at most `limit`: those that loadScene throws, and photographs, masks and
/// textures that are missing or do not match. A file that cannot be read is a fault, not an exception.
IBR_API std::vector<Fault> validateSceneFiles(const std::filesystem::path& path, std::size_t limit = 100);

/// Writes folder/scene.gltf and folder/cells/*.bin, each to a temporary file that is then renamed, and removes buffers
/// of previous saves from folder/cells. Does not write photographs and textures. Throws Error{io}, and
/// Error{invalidInput} unless validate(scene) is empty, texts are UTF-8, settings are JSON, and paths stay inside the
/// folder.
IBR_API void saveScene(const Scene& scene, const std::filesystem::path& folder);

/// Writes a scene to another folder than its own. Photographs, masks and textures become hard links, or copies if the
/// file system has no links. Throws Error, as saveScene and Error{io} that names the file.
IBR_API void saveSceneWithLinks(const Scene& scene, const std::filesystem::path& folder);

}  // namespace ibr
