// SPDX-License-Identifier: Apache-2.0
// Builds a harmonised model ([H] §3.1) from a mesh, cameras and their photographs. Needs ibr::author (OpenCV, CGAL).
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ibr/htm_model.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "ibr/template_search.h"

namespace ibr {

/// Options of harmonise(). Differences are D_f of [H] eq. 4, in 8-bit levels.
struct HtmOptions {
  // Alg. 1
  std::size_t faces = 5000;            // target of the reduction by shape, which defines the mean face; 0: no reduction
  double inconsistentSize = 4;         // maximum area of collapsed inconsistent faces, in mean faces; 0: no collapses
  double inconsistentDifference = 12;  // D_f above which a face is inconsistent
  double inconsistentShare = 0.1;      // maximum number of collapses, as a share of the faces
  // Beyond [H]: after the reduction by shape, cameras and vertices are adjusted to the matches of all cameras.
  int adjustRounds = 4;  // number of rounds of the adjustment; 0: cameras and vertices are not adjusted, as in [H]
  double adjustSmoothness = 100;  // inverse variance of offset differences between neighbouring vertices, 1 / px²
  bool reshape = true;            // vertices move along their normals; false: only cameras are adjusted
  double shapeSmoothness = 1;     // the same of displacements along normals, 1 / px²
  // Algs 3 to 5
  TemplateMeasure measure = TemplateMeasure::absoluteDifferences;  // dissimilarity that matches minimise
  double radius = 16;                                              // search radius around a vertex, px
  double laterRadius = 6;     // the same once all cameras are adjusted, or after the first round
  double minTexture = 2;      // minimum gradient, 8-bit levels per px: nothing is displaced in directions with less
  double smoothness = 10;     // as adjustSmoothness, of complements, 1 / px²; 0: matches are not smoothed
  double complementPx = 0.5;  // expected length of complements: standard deviation of the prior; 0: no prior
  double outlierPx = 2;       // residual at which a match has a quarter of its weight (Geman and McClure 1987)
  double alpha = 0.3, gamma1 = 10;  // alpha: α of [H] eqs 2 and 3; gamma1: γ₁ of the same
  // Algs 2, 6 and 7
  int rounds = 2;                // number of rounds of matching, at least 1; each after the first is on a refined mesh
  double meanDifference = 1;     // mean D_f up to which no face is divided for its D_f
  double faceDifference = 4;     // D_f above which a face is divided
  bool selfOccluded = true;      // partly hidden faces are divided as well
  double minFacePx = 250;        // faces smaller than this in all cameras are not divided, px²
  std::size_t maxFaces = 20000;  // a mesh with so many faces gets no further round
  // Rejection of cameras
  bool reject = true;              // cameras that disagree with the others at a vertex are rejected there
  double rejectDifference = 45;    // maximum difference of agreeing cameras ([H] eq. 1), 8-bit levels
  double rejectCorrelation = 0.2;  // correlation of colours from which cameras agree at any difference
  double softPx = 4;               // width of the falloff of visibility at edges, px
  bool keepSource = true;          // stores the given mesh as HtmModel::source, for comparisons
  TemplateSearchFactory search;    // template matcher; empty: cpuTemplateSearch
  int threads = 0;                 // threads of the CPU; 0: all cores
};

/// Returns true if the photographs had masks according to HtmModel::settings, or if the settings do not say so.
bool htmHasMasks(const std::string& settings);

/// Reads options from HtmModel::settings; missing options, and all options of empty settings, have their defaults.
/// Throws Error{invalidInput} for settings that are no JSON object, and for a value of a wrong type or an unknown
/// measure. harmonise() checks ranges.
HtmOptions htmOptionsFromJson(const std::string& settings);

/// A camera with its photograph.
struct HtmPhotograph {
  HtmCamera camera;  // name and camera; file names may be empty
  Image8 picture;    // photograph, RGB, of the camera's size
  Image8 mask;       // mask of 1 channel, of the same size, >= 128: the object; empty: none
};

/// Report of harmonise().
struct HtmReport {
  /// Time of a stage.
  struct Stage {
    std::string name;    // name, for people
    double seconds = 0;  // elapsed time, sum over all rounds
  };
  /// A round of matching and refinement.
  struct Round {
    std::size_t vertices = 0, faces = 0;  // number in the round's mesh
    // unharmonisedDifference: mean D_f without complements; harmonisedDifference: mean D_f with complements
    double unharmonisedDifference = 0, harmonisedDifference = 0;
    double matchedShare = 0;          // share of the matches between two cameras at a vertex that found texture
    std::size_t divided = 0;          // number of faces divided for the next round
    std::size_t dividedAsHidden = 0;  // number of divided faces that are partly hidden, but not different
  };
  /// A round of the adjustment of cameras and vertices.
  struct Adjustment {
    double beforePx = 0, afterPx = 0;  // RMS offset of vertices from the cameras' consensus, mean over cameras
    double meanDisplacement = 0;       // mean displacement of vertices, world units
  };
  std::vector<Stage> stages;            // in order of their first use
  std::vector<Adjustment> adjustments;  // by round
  // Number of faces. sourceFaces: of the given mesh; reducedFaces: after the reduction by shape
  std::size_t sourceFaces = 0, reducedFaces = 0;
  double reducedMean = 0, reducedMax = 0;    // distance from source to reduced mesh, mean and maximum, world units
  double restoredMean = 0, restoredMax = 0;  // distance from reduced mesh to source, mean and maximum, world units
  std::size_t collapses = 0;                 // number of collapses of inconsistent faces
  // mean D_f without complements. reducedDifference: before collapses; collapsedDifference: after collapses
  double reducedDifference = 0, collapsedDifference = 0;
  std::vector<Round> rounds;        // by round of matching
  double camerasPerVertex = 0;      // mean number of cameras that see a vertex
  double rejected = 0;              // share of these cameras that are rejected at their vertex
  std::size_t complementBytes = 0;  // bytes of HtmModel::complements
};

/// Result of harmonise().
struct HtmResult {
  HtmModel model;                  // model with adjusted cameras; HtmCamera::given has the given ones
  std::vector<Image8> visibility;  // images for HtmCamera::visibilityFile, by camera
  HtmReport report;                // times and numbers
  /// Mesh of [H] fig. 9: "original", "reduced by shape" (and adjusted with the cameras), "reduced by texture" (missing
  /// if faces are never collapsed), "refined". D_f of the original is computed with the given cameras.
  struct Stage {
    std::string name;                // one of these names
    TriangleMesh mesh;               // mesh of the stage
    std::vector<double> difference;  // D_f of each face, 8-bit levels
  };
  std::vector<Stage> stages;  // meshes, in order
};

/// Computes a harmonised model. Deterministic. Throws Error{cancelled}, and what HtmOptions::search throws. Throws
/// Error{invalidInput} for options out of range, and for cameras that validate() rejects in a model. Images must fit
/// their camera and have at most 32767 px a side. The mesh must be finite, have indices in range, and be seen by a
/// camera. Otherwise, Error{invalidInput} is thrown as well.
HtmResult harmonise(const TriangleMesh& mesh, std::span<const HtmPhotograph> photographs, const HtmOptions& options,
                    const ProgressCallback& progress = {});

/// Options of buildHtm().
struct HtmBuildOptions {
  std::filesystem::path mesh;        // mesh as PLY, OBJ or glTF, in the model's world
  std::filesystem::path model;       // poses, for readPoseFile
  std::filesystem::path images;      // folder that the poses' image names are relative to
  std::filesystem::path masks;       // folder with a mask for each image (of a.jpg: a.jpg.png or a.png); empty: none
  std::filesystem::path output;      // folder of the harmonised model; created if missing
  std::vector<std::string> exclude;  // names of images to leave out
  int maxSize = 0;                   // longest side of stored photographs, px; 0: unchanged
  HtmOptions optimise;               // options of harmonise()
};

/// Returns the options that change the model, as JSON text: HtmModel::settings.
std::string htmOptionsToJson(const HtmBuildOptions& options);

/// Reads the mesh, photographs and masks. Distorted photographs are undistorted, with their cameras and masks. A mask's
/// file must have the size of its photograph's file. Throws Error (io, invalidInput, unsupported) that names the file.
std::pair<TriangleMesh, std::vector<HtmPhotograph>> readHtmInput(const HtmBuildOptions& options,
                                                                 const LogCallback& log = {});

/// Builds a model's folder: readHtmInput, harmonise, saveHtmModel. Throws Error, also where the output would overwrite
/// an input. The folder is untouched until the model is computed. If writing fails (Error{io}), the folder may have new
/// photographs and the previous model.
HtmResult buildHtm(const HtmBuildOptions& options, const ProgressCallback& progress = {}, const LogCallback& log = {});

/// Reads PLY (text and binary, both byte orders), OBJ, or the triangles of a glTF document (.gltf, .glb) placed by its
/// nodes; the extension decides. Polygons become fans around their first corner. Positions keep the file's axes and
/// unit. Throws Error{io} if the file cannot be read, Error{unsupported} for another extension, and
/// Error{invalidInput} that names the file and the fault: truncated, no face, a face index without a vertex, a
/// coordinate that is not finite.
TriangleMesh readTriangleMesh(const std::filesystem::path& path);

/// Display-encoded colours: one per vertex or per face, or none.
struct MeshColours {
  std::vector<glm::u8vec3> vertices, faces;  // R, G, B by vertex or face, or empty
};

/// Writes binary little-endian PLY with positions as doubles, which reads back bit-identical. Throws Error{io}, or
/// Error{invalidInput} if the number of colours does not match.
void writePly(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshColours& colours = {});

}  // namespace ibr
