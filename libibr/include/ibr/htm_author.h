// SPDX-License-Identifier: Apache-2.0
// From a mesh, cameras and their pictures to a harmonised model ([H] §3.1). Needs ibr::author (OpenCV, CGAL).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ibr/htm_model.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "ibr/template_search.h"

namespace ibr {

/// How a mesh becomes a harmonised model. Differences are D_f of [H] eq. 4, levels.
struct HtmOptions {
  // Alg. 1
  std::size_t faces = 5000;     // shape is reduced to so many, which sets the size of the mean face; 0: not
  double inconsistentSize = 4;  // times the mean face: inconsistent faces are collapsed until they are so large; 0: not
  double inconsistentDifference = 12;  // of faces that are inconsistent
  double inconsistentShare = 0.1;      // of the faces: at most so many collapses
  // Beyond [H]: cameras first settle on what they agree on (author/htm/htm_consensus.h, author/htm/htm_adjust.h), …
  int adjustRounds = 4;           // 0: cameras and shape are taken as they are, as [H] does
  double adjustSmoothness = 100;  // 1 / px², of offsets between neighbours
  bool reshape = true;            // … and vertices move there, too (author/htm/htm_shape.h)
  double shapeSmoothness = 1;     // 1 / px²
  // Algs 3 to 5
  TemplateMeasure measure = TemplateMeasure::absoluteDifferences;
  double radius = 16;       // px that are searched around each vertex, …
  double laterRadius = 6;   // … and where cameras are adjusted or an earlier round has said where
  double leastTexture = 2;  // levels per px: less in a direction, and nothing is displaced in it
  double smoothness = 10;   // 1 / px², of complements between neighbours (author/htm/htm_complements.h); 0: as matched
  double complementPx = 0.5;  // how long complements are expected to be (author/htm/htm_complements.h); 0: anything
  double outlierPx = 2;
  double alpha = 0.3, gamma1 = 10;  // of eqs 2 and 3
  // Algs 2, 6 and 7
  int rounds = 2;                 // of matching, each after the first on a refined mesh; at least 1
  double meanDifference = 1;      // at which no further round is needed
  double faceDifference = 4;      // a face beyond it is divided
  bool selfOccluded = true;       // and so are those that are partly hidden
  double leastFacePx = 250;       // px² in its best camera: smaller faces are not divided
  std::size_t mostFaces = 20000;  // no further round begins beyond it
  // Cameras that do not agree on a vertex have no part in it (author/htm/htm_reject.h).
  bool reject = true;
  double rejectDifference = 45;    // levels, [H] eq. 1
  double rejectCorrelation = 0.2;  // below it
  double softPx = 4;               // over which visibility falls at edges
  bool keepSource = true;          // the mesh as it was given, for methods to compare with
  MakeTemplateSearch search;       // who matches templates; none: the processor
  int threads = 0;                 // 0 = all cores
};

/// Whether a model's `settings` tell that its photographs came with masks; true where they say nothing.
bool htmHasMasks(const std::string& settings);

/// The options that a model's `settings` tell; those it does not tell are the defaults. Throws Error{invalidInput}
/// where one has another type or is no such number.
HtmOptions htmOptionsOf(const std::string& settings);

/// A camera with what it took.
struct HtmPhotograph {
  HtmCamera camera;  // files may be empty
  Image8 picture;    // RGB, of the camera's size
  Image8 mask;       // of the same size, 1 channel, >= 128: the object; or empty
};

struct HtmReport {
  struct Stage {
    std::string name;
    double seconds = 0;
  };
  struct Round {
    std::size_t vertices = 0, faces = 0;
    double before = 0, after = 0;  // mean D_f without and with complements
    double measured = 0;           // share of the pairs of cameras that see a vertex whose match says something
    std::size_t divided = 0;       // faces that the next round divides, …
    std::size_t divideHidden = 0;  // … of these for being partly hidden alone
  };
  struct Adjustment {
    double beforePx = 0, afterPx = 0;  // RMS distance of vertices from where the pictures agree, mean over cameras
    double moved = 0;                  // mean distance by which vertices moved, world units
  };
  std::vector<Stage> stages;
  std::vector<Adjustment> adjustments;
  std::size_t sourceFaces = 0, reducedFaces = 0;
  double reducedMean = 0, reducedMost = 0;                // distance from the source to the reduced mesh, world units
  double restoredMean = 0, restoredMost = 0;              // and back
  std::size_t collapses = 0;                              // of inconsistent faces
  double reducedDifference = 0, collapsedDifference = 0;  // mean D_f before and after these, without complements
  std::vector<Round> rounds;
  double camerasPerVertex = 0;  // that see it
  double rejected = 0;          // share of these that do not agree
  std::size_t complementBytes = 0;
};

struct HtmResult {
  HtmModel model;                  // cameras as they were given, but for what was adjusted
  std::vector<Image8> visibility;  // one a camera, for HtmCamera::visibilityFile
  HtmReport report;
  /// The meshes of [H] fig. 9: original, reduced by shape (and settled with the cameras, where these are adjusted),
  /// reduced by texture, refined; each face with its D_f. D_f of the original is that of the cameras as given.
  struct Stage {
    std::string name;
    TriangleMesh mesh;
    std::vector<double> difference;
  };
  std::vector<Stage> stages;
};

/// Deterministic. Throws Error: invalidInput (cameras that no model may hold, sizes that differ, options out of range,
/// pictures of more than 32767 px a side, a mesh that no camera sees or that is not finite or whose indices are out of
/// range), cancelled, and what the search throws.
HtmResult harmonise(const TriangleMesh& mesh, std::span<const HtmPhotograph> photographs, const HtmOptions& options,
                    const ProgressCallback& progress = {});

struct HtmBuildOptions {
  std::filesystem::path mesh;        // PLY, OBJ or glTF, in the model's world
  std::filesystem::path model;       // COLMAP model folder
  std::filesystem::path images;      // folder that its image names are relative to
  std::filesystem::path masks;       // NAME.png or NAME without its extension and .png, for each; or empty
  std::filesystem::path output;      // model folder; made if missing
  std::vector<std::string> exclude;  // image names left out
  int maxSize = 0;                   // longest side of stored pictures in px; 0 = as they are
  HtmOptions optimise;
};

/// Reads the input. Cameras that distort are those of the undistorted pictures. Masks are as large as the files of
/// their photographs. Throws Error (io, invalidInput) that names the file.
std::pair<TriangleMesh, std::vector<HtmPhotograph>> readHtmInput(const HtmBuildOptions& options,
                                                                 const LogCallback& log = {});

/// Builds a model's folder: readHtmInput, harmonise, saved. Throws Error. The folder is untouched until the model is
/// computed; where writing it fails (Error{io}), pictures may be new and the model still the one before.
HtmResult buildHtm(const HtmBuildOptions& options, const ProgressCallback& progress = {}, const LogCallback& log = {});

}  // namespace ibr
