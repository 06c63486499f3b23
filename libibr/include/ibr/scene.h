// SPDX-License-Identifier: Apache-2.0
// The image graph ([T] §2.4) as plain data, and its file: a glTF 2.0 asset with the extension IBR_image_graph.
//
// A node is a photograph with its pose; a cell joins 2 to 4 nodes (line, triangle, tetrahedron) by one morphing mesh.
// Loading and saving may be called from several threads on different scenes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/capture.h"
#include "ibr/conventions.h"

namespace ibr {

struct Node {
  std::string name;                   // unique in a scene; the photograph's file name
  Camera camera;                      // intrinsics are those of the undistorted photograph at its stored size
  std::filesystem::path imageFile;    // JPEG or PNG, relative to the scene's folder
  std::filesystem::path textureFile;  // baked KTX2, relative to the scene's folder; same size as the photograph
  CaptureFacts capture = {};          // as the camera wrote it down
  /// Red, green, blue: the photograph times this, in linear light, is as bright and as white as the others are
  /// (author/exposure/exposure.h). 1 where it is not known; 1 / kLargestGain to kLargestGain.
  glm::dvec3 gain{1.0};
  /// Grey PNG of the photograph's size, 0 where it is not to be shown: people who passed by. Relative to the scene's
  /// folder; empty: all of it is. It is also the texture's alpha, which is what renders: not of TextureFormat::bc1.
  std::filesystem::path maskFile = {};
  /// Depth texture (KTX2, TextureFormat::rg16f), relative to the scene's folder; empty: none. It covers the photograph,
  /// at about a quarter of its sides. Red: ρ / depthScale, the largest of the texel's block; green: the consensus a
  /// (MorphMesh::consensus). ρ is the inverse depth along the axis of a pinhole, and the inverse distance of a
  /// panorama.
  std::filesystem::path depthFile = {};
  double depthScale = 0;  // 1 / world unit, > 0 where there is a depthFile: ρ of a red of 1
};
inline constexpr double kLargestGain = 4096;

/// What is known of a triangle, or of a pixel.
enum Tier : std::uint8_t {
  kTierAgrees = 0,     // agrees in all members: blended as [T] says; of a gathered pixel: its depth is confirmed
  kTierRejected = 1,   // rejected by a filter: kept in the mesh, not drawn
  kTierCompleted = 2,  // of a gathered pixel: no second photograph confirms its depth, which was completed
  kTierFilled = 3,     // nothing was drawn: filled from around
};

/// A morphing mesh over d members and n points.
///
/// The scene point of vertex p, seen from member i, lies in direction r_i = unproject(match[i][p]), rotated to world.
/// With s_i the distance to it along r_i, ratio[i][p] is a_i = s_i·ρ and inverseDistance[p] is ρ >= 0. ρ = 0 puts the
/// point at infinity, where every a_i is 1. Only the products matter: (a_i, ρ) may be scaled per point by any positive
/// number; by convention ρ is the inverse of the mean of s_i, so that the mean of a_i is 1.
/// [T] eq. 4 is the case a_i = 1, ρ = 0.
struct MorphMesh {
  std::vector<std::vector<glm::vec2>> match;  // d × n, px in the member's photograph
  std::vector<std::vector<float>> ratio;      // d × n, a_i > 0
  std::vector<float> inverseDistance;         // n, ρ >= 0, 1 / world unit
  std::vector<float> uncertainty;             // n, one standard deviation of ρ, >= 0
  std::vector<std::uint8_t> confirmations;    // n, or none: c, photographs whose depth is the same there; 0 also where
                                              // depth was completed
  std::vector<float> consensus;               // n, or none, with confirmations: a = (c + .25) / (c + v + .5), v
                                              // photographs that see past it; .1 where depth was completed
  std::vector<glm::uvec3> triangles;          // m, indices < n; all of tier 0 first, then tier 1
  std::vector<std::uint8_t> tier;             // m, a Tier each
  std::vector<float> ecc;  // m, worst pair's enhanced correlation coefficient, label only, in [-1, 1]
  /// n, or none: which planes of the matched scene a point lies on, counted from 1, ascending, then 0. Label only: a
  /// triangle whose points share a plane is explained by one homography between each two members.
  std::vector<glm::u16vec4> planes;

  std::size_t memberCount() const { return match.size(); }
  std::size_t pointCount() const { return inverseDistance.size(); }
  std::size_t tier0Count() const;  // triangles of tier 0
};

/// How good a cell is, measured when it was built. NaN: not measured. A backdrop's coverage is the share of its
/// photograph whose depth was matched.
struct CellQuality {
  double coverage;    // 0 to 1: share of the members' mean picture under tier-0 triangles
  double ecc;         // -1 to 1: area-weighted mean of MorphMesh::ecc over tier 0
  double residualPx;  // >= 0: median distance between a match and the projection of its triangulated point
  double score;  // 0 to 1: shape × covisible share × little disparity × coverage × ecc (author/graph/choose_cells.h)
  CellQuality();
};

struct Cell {
  std::vector<std::uint32_t> members;  // 2 to 4 different node indices; 1 for a backdrop
  MorphMesh mesh;
  CellQuality quality;
};

/// Where the world's origin lies on the Earth, if known. Kept for export; never part of a pose.
struct GeographicOrigin {
  double latitudeDegrees = 0, longitudeDegrees = 0, heightMetres = 0;
};

/// UnusedPhotograph::reason where nothing else is known to be wrong than that the poses do not know it: taken again,
/// nearer to the others, they may.
inline constexpr const char* kNotRegistered = "not registered: the model has no pose for it";
/// A photograph that no cell shows.
struct UnusedPhotograph {
  std::string name;    // a node's, or that of a file which the poses do not know
  std::string reason;  // for people
};

struct Scene {
  std::filesystem::path folder;  // what relative paths of the nodes start from; empty for a scene made in code
  std::vector<Node> nodes;
  std::vector<Cell> cells;
  std::vector<Cell> backdrops;  // meshes of photographs' depth, which vote (Composition::gathered): at most one a node
  std::vector<UnusedPhotograph> unused;
  std::string acquisition;  // "ordered", "unordered", "synthetic", "panoramic" or ""
  std::string settings;     // the effective settings it was built with, as JSON text; "" if none
  std::optional<GeographicOrigin> origin;
};

struct Fault {
  std::string field;    // "cells[3].mesh.ratio[1][17]", or a JSON pointer when it comes from a file
  std::string message;  // what is wrong, with the value
};

/// Every fault of a scene's data, in order, at most `limit`; empty when all preconditions of the renderer hold:
/// indices in range, members different, sizes equal, values finite and in range, rotations of unit length (1e-3).
/// Files are not looked at.
std::vector<Fault> validate(const Scene& scene, std::size_t limit = 100);

/// Whether a member's photograph has a mask.
bool isMasked(const Scene& scene, const Cell& cell);

/// The scene point of a vertex: mean over members of c_i + (a_i / ρ) r_i. nullopt where ρ = 0 or the mean is not
/// finite.
std::optional<glm::dvec3> vertexPosition(const Scene& scene, const Cell& cell, std::size_t point);

/// Reads `path`: a scene's folder, or its scene.gltf. Throws Error (io, invalidInput; file and JSON pointer named).
/// Files outside the scene's folder are refused.
Scene loadScene(const std::filesystem::path& path);

/// Every fault of a scene's files, as loadScene would find them, plus textures that are missing or do not match.
std::vector<Fault> validateSceneFiles(const std::filesystem::path& path, std::size_t limit = 100);

/// Writes folder/scene.gltf and folder/cells/*.bin (photographs and textures are not touched). Each file is written
/// beside its final name and renamed. Precondition: validate(scene) is empty, else Error{invalidInput}.
void saveScene(const Scene& scene, const std::filesystem::path& folder);

}  // namespace ibr
