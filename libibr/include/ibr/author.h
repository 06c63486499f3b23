// SPDX-License-Identifier: Apache-2.0
// From posed photographs to a scene folder ([T] §2.4). Needs ibr::author (OpenCV, CGAL).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/lens.h"
#include "ibr/log.h"
#include "ibr/pose_refinement.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

/// Poses and sparse points from a pose estimator, in libibr's conventions (conventions.h). Sizes are those of the
/// model.
struct PosedImage {
  std::string name;                         // as the model has it, with '/' for folders
  Camera camera;                            // of the undistorted photograph; the tracks' pixels are in it too
  std::optional<Lens> lens = std::nullopt;  // that took the photograph as it is in its file, where that is distorted
};
struct TrackObservation {
  std::uint32_t image;  // index into PosedModel::images
  glm::dvec2 pixel;
};
struct Track {
  glm::dvec3 position;  // world
  std::vector<TrackObservation> observations;
};
struct PosedModel {
  std::vector<PosedImage> images;  // registered images only, sorted by name
  std::vector<Track> tracks;
};

/// Reads a COLMAP model (cameras, images, points3D as .txt or .bin) from a folder. All camera models of COLMAP 3.8 and
/// EQUIRECTANGULAR (number 17 in binary files; with parameters width and height, or with none in text files); other
/// models throw Error{unsupported} that names the camera. Cameras that distort become the pinholes of the undistorted
/// photographs, and observations move along; those that are not in them are left out. Images without a pose are skipped
/// with a message, as are observations of points that are not there, and the rigs and frames of COLMAP 3.12 and later:
/// images carry their own pose. Throws Error (io, invalidInput) with file and line, or byte.
PosedModel readColmapModel(const std::filesystem::path& folder, const LogCallback& log = {},
                           Border border = Border::crop);

/// Writes cameras.txt, images.txt and points3D.txt; the folder is made where it is missing. Images with the same
/// intrinsics share a camera; points are grey. Read again, poses are the same to rounding and all else exactly. Throws
/// Error: io, or invalidInput for a name that a line of text cannot hold and for an observation of an image that is
/// not there; then nothing is written.
void writeColmapModel(const PosedModel& model, const std::filesystem::path& folder);

/// Reads equirectangular panoramas with their poses from a JSON file:
///   {"width": px, "height": px, "panoramas": [{"name": file, "position": [x, y, z],
///    "R_world_to_camera": [[3], [3], [3]]}, …], "triangles": [[i, j, k], …]}
/// Camera axes are COLMAP's (x right, y down, z forward, in the middle of the picture); the matrix is given row by row.
/// "q_world_to_camera_wxyz" may stand for the matrix, "t_world_to_camera" for the position; where both are given they
/// must agree. "triangles" may be missing; they are checked and otherwise not used. There are no tracks. Throws Error
/// (io, invalidInput) with the JSON pointer of the fault.
PosedModel readPanoramas(const std::filesystem::path& file);

/// Reads transforms.json of nerfstudio or instant-ngp: frames with file_path and transform_matrix (camera to world, x
/// right, y up, looking along −z), and w, h, fl_x, fl_y, cx, cy, camera_angle_x, camera_angle_y, camera_model (OPENCV,
/// the default; OPENCV_FISHEYE, PINHOLE, EQUIRECTANGULAR), k1 … k4, p1, p2 in the frame or for all. Names are those of
/// the pictures below `photographs`: file_path is taken from there or from the file's folder, with or without
/// extension, and w and h may be missing; with no folder given, they are file_path itself. Cameras that distort become
/// pinholes, as in readColmapModel. There are no tracks. Throws Error (io, invalidInput) with the JSON pointer of the
/// fault; a matrix that scales or shears by more than 1e-3 is one, and a picture that is not there.
PosedModel readTransforms(const std::filesystem::path& file, const std::filesystem::path& photographs = {},
                          Border border = Border::crop);

/// How photographs lie in their files, in relation to the model's cameras.
enum class Orientation : std::uint8_t {
  automatic,  // as their shapes say; where both fit (half turns, squares), as the other photographs of the set
  stored,     // the cameras are those of the pictures as stored, whatever EXIF says: COLMAP's way
  exif,       // the cameras are those of the pictures turned upright as EXIF says
};

/// Poses by the program COLMAP (3.8 or later), which does its work on the processor.
struct PoseOptions {
  std::filesystem::path photographs;      // folder; pictures below it are taken, too
  std::filesystem::path folder;           // for what COLMAP makes; made if missing, and kept; holds nothing else
  std::string program = "colmap";         // looked for along PATH, unless it names a folder
  int threads = 0;                        // 0 = all cores
  std::filesystem::path without;          // pictures below this folder are not meant; may be empty
  std::vector<std::string> exclude = {};  // names that are not meant either
  Orientation orientation = Orientation::automatic;  // turned upright, as EXIF says, unless it is `stored`
  std::filesystem::path masks =
      {};  // folder of masks (author/photographs/masks.h): no features are looked for under them
};
struct PoseReport {
  std::filesystem::path model;  // folder of the model, the largest where there are several
  std::size_t photographs = 0;  // that there are
  std::size_t registered = 0;   // that have a pose
  std::size_t points = 0;
};

/// Finds features, matches them (all pairs of up to 60 photographs, else neighbours in the order of their names) and
/// estimates poses, of upright pictures. Photographs that are all of one size are taken for those of one lens. A step
/// that is finished is not done again while the photographs stay as they are; one that is cancelled ends the program.
/// Where a few photographs were added since to a model of most others, they are registered in it, and its poses and
/// points stay as they are.
/// Throws Error: io where the program is missing or fails (with its last lines), invalidInput where it finds no poses
/// or photographs cannot be read (all of them are named, before the program is run), cancelled.
PoseReport estimatePoses(const PoseOptions& options, const ProgressCallback& progress = {},
                         const LogCallback& log = {});

/// Where points come from that two or more photographs see.
enum class TrackSource : std::uint8_t {
  automatic,  // the model's, and our own for pairs that share few of these
  model,
  own,  // SIFT guided by the poses
};

/// How the members of a cell are matched.
enum class MatchMethod : std::uint8_t {
  automatic,    // sweep where the poses are usable (1 px of reprojection, median over a cell's tracks), else flow
  sweep,        // the members' depth (DepthSearch), the poses being known; planes through space at all depths where
                // poses are refined first
  homographic,  // planes of the scene found among sparse features ([T]'s reference 25)
  flow,         // optical flow from the map that sparse features say; needs no poses
};
constexpr const char* methodName(MatchMethod matcher) {
  constexpr const char* kNames[] = {"auto", "sweep", "homographic", "flow"};
  return kNames[std::size_t(matcher)];
}

/// How the depth of each photograph is found; times and accuracy: docs/quality.md.
enum class DepthSearch : std::uint8_t {
  fast,     // against up to ten others, in levels, in pictures of a quarter of the matched photographs' sides
  swept,    // the same in pictures of half of them
  refined,  // then by slanted planes, to a part of a level
  fine,     // that in twice the sides
};
constexpr const char* depthSearchName(DepthSearch search) {
  constexpr const char* kNames[] = {"fast", "swept", "refined", "fine"};
  return kNames[std::size_t(search)];
}

/// Which triangles are taken to agree in all members.
enum class TriangleFilter : std::uint8_t {
  consistency,  // those that look alike and lie where the dense match does
  homogeneous,  // of these, in cells with planes (MorphMesh::planes), those whose corners share one
};

/// What is done to a scene when it is whole and not yet written; its photographs stand in its folder. Cells' meshes and
/// qualities may change. What a stopped build need not do again may be kept in `finished` (optimiseCells does).
using SceneFinisher = std::function<void(Scene& scene, const std::filesystem::path& finished,
                                         const ProgressCallback& progress, const LogCallback& log)>;

/// What a build will take, as far as it can be said before it begins. Bytes, s.
struct BuildPrediction {
  struct Stage {
    std::string name;
    double seconds = 0, processorSeconds = 0;  // that pass; of all threads
  };
  std::size_t photographs = 0, cells = 0, backdrops = 0;
  bool posesKnown = true;  // without: poses are estimated first, which takes time that is not in here
  bool cellsKnown = true;  // without: of a model without tracks the number of cells is a guess
  double megapixels = 0;   // of all photographs, as they are stored
  int threads = 0;         // that match cells side by side
  std::vector<Stage> stages;
  double seconds = 0, processorSeconds = 0;
  double memory = 0, memoryAllowed = 0;  // at most; allowed by BuildOptions::memory
  double disk = 0, diskFree = 0;  // below the scene's folder, while it is made; free, or held by this scene already
};

struct BuildOptions {
  std::filesystem::path photographs;  // folder that image names of the model are relative to
  std::filesystem::path model;        // COLMAP model folder; or
  std::filesystem::path transforms;   // file that readTransforms reads, instead of a model; or
  std::filesystem::path panoramas;    // file that readPanoramas reads; where none is given, estimatePoses is asked
  std::string colmap = "colmap";      // the program that it runs
  std::filesystem::path output;       // scene folder; made if missing
  std::vector<std::string>
      exclude;  // image names left out (held out for evaluation); files the model lacks may be there
  Orientation orientation = Orientation::automatic;
  TrackSource tracks = TrackSource::automatic;
  std::filesystem::path
      masks;  // folder of masks (author/photographs/masks.h): what is 0 there is neither matched nor shown
  bool matchExposures = true;  // photographs get gains (Node::gain), measured by what they show of the same places
  bool fitVignetting = false;  // what lenses take from corners is measured as well, and stored photographs are without
  bool refinePoses = false;    // mended where points confirm it (ibr/pose_refinement.h); ".refined" has the model then
  bool removeMovers = false;   // who moved is masked where another photograph shows the place without him
  bool keepBorder = false;  // undistorted photographs keep all that was photographed (Border::keep); meshes end there
  int dimension = 0;        // 0 = what the rig spans; 1, 2, 3: lines, triangles, tetrahedra at most
  int maxSize = 0;          // longest side of stored photographs in px; 0 = as they are
  TextureFormat texture = TextureFormat::rgba8;  // of stored textures (ibr/texture.h)
  double thetaDegrees = 0;  // largest angle between axes in a cell; 0 = half the smaller field of view
  bool backdrops = true;    // whether photographs get backdrops and depth textures, so that views can be gathered
  DepthSearch depth = DepthSearch::refined;
  bool draft = false;  // a first look: depth found fast, no cells; poses, movers and vignetting stay as they are, no
                       // finisher. What other builds of the folder kept stays
  int backdropSpacing = 2;  // px of its picture at 512 px, least between a backdrop's vertices: 2, 4, 8, 16, 32
  std::filesystem::path finishedCells;  // folder in which finished cells, depth and meshes are kept for further builds,
                                        // whose results they never change; empty: ".build" in the output, where only
                                        // what its last build used stays
  MatchMethod matcher = MatchMethod::automatic;  // of cells of pinholes; those of panoramas are always swept
  TriangleFilter triangleFilter = TriangleFilter::consistency;
  SceneFinisher finish;                                   // none: nothing
  std::function<bool(const BuildPrediction&)> predicted;  // told before work begins, again once poses are estimated;
                                                          // false: the build ends there and nothing is written
  int threads = 0;                                        // 0 = all cores
  double memory = 0;       // bytes that the work may take; 0 = half of what this process may have (memoryBudget)
  std::uint64_t seed = 1;  // same input, options and seed: same bytes
};

struct BuildReport {
  struct CellLine {
    std::vector<std::string> members;
    std::size_t points = 0, triangles = 0, tier0 = 0;
    CellQuality quality;
    double seconds = 0, processorSeconds = 0;
    bool resumed = false;                      // taken from an interrupted build
    MatchMethod matcher = MatchMethod::sweep;  // that was chosen
    double homogeneous = 0;  // share of the triangles of tier 0 whose corners share a plane; NaN without planes
  };
  struct BackdropLine {
    std::string photograph;
    std::size_t points = 0, triangles = 0;
    double known = 0;  // share of the photograph whose depth was matched; the rest is completed
    double seconds = 0;
    bool resumed = false;
  };
  struct Dropped {
    std::string what;    // a cell, by its members' names
    std::string reason;  // for people
  };
  struct MaskLine {
    std::string photograph;
    double given = 0;  // share of it that its mask takes away
    double moved = 0;  // and that was found to have moved
  };
  struct ExposureSummary {
    std::size_t measured = 0;      // photographs that show places of others, with which they were compared
    std::size_t parts = 0;         // of these, that nothing joins to each other: each is as bright as it is in the mean
    bool alike = false;            // so nearly that no gain is kept
    std::string text, vignetting;  // for people; empty where it was not asked for
  };
  std::filesystem::path poses;  // file or folder that they were read from
  ExposureSummary exposures;
  PoseRefinement refinement;    // where it was asked for; no photograph moved: they are as they were read
  std::vector<MaskLine> masks;  // of photographs of which something is masked
  std::vector<CellLine> cells;
  std::vector<BackdropLine> backdrops;
  std::vector<Dropped> dropped;          // cells that were refused, or failed when they were matched
  std::vector<UnusedPhotograph> unused;  // as the scene has them
  BuildPrediction prediction;            // the last one that was told
  double seconds = 0, processorSeconds = 0;
  double memory = 0;  // that the process had at most, bytes
};

/// Builds a scene folder. Depths, cells and meshes are finished one by one and kept, so that an interrupted or
/// cancelled build goes on where it stopped when it is called again with the same options, and a build with more
/// photographs finds again only the depth and cells of those whose neighbours changed. Panoramas and pinholes of
/// one model are never in one cell. Throws Error.
BuildReport build(const BuildOptions& options, const ProgressCallback& progress = {}, const LogCallback& log = {});

/// The photographs of a build as it stores them, without building: at their stored size.
class PosedPhotographs {
 public:
  /// As build: reads the model, looks at the files. Throws Error.
  explicit PosedPhotographs(const BuildOptions& options, const LogCallback& log = {});
  PosedPhotographs(PosedPhotographs&&) noexcept;
  ~PosedPhotographs();

  /// Sorted by name; without those that the options exclude.
  const std::vector<PosedImage>& images() const noexcept;

  /// RGB, of the camera's size. Throws Error.
  Image8 picture(std::size_t image) const;

  /// Its mask where BuildOptions::masks has one: one channel, 0 or 255; else empty. Throws Error.
  Image8 mask(std::size_t image) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
