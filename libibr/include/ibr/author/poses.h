// SPDX-License-Identifier: Apache-2.0
// Camera poses and sparse points: read from the files of many programs, or estimated by the program COLMAP. Needs
// ibr::author.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ibr/author/lens.h"
#include "ibr/camera.h"
#include "ibr/log.h"

namespace ibr {

/// Image of a pose estimator's model, in libibr's conventions (conventions.h). Sizes are those of the model.
struct PosedImage {
  std::string name;                         // name in the model, with '/' after folders
  Camera camera;                            // camera of the undistorted photograph
  std::optional<Lens> lens = std::nullopt;  // lens of the photograph in its file; nullopt: not distorted
};
/// Pixel of an image at which a track's point is seen.
struct TrackObservation {
  std::uint32_t image;  // index into PosedModel::images
  glm::dvec2 pixel;     // position in the image of PosedImage::camera, px
};
/// A point and the images that see it.
struct Track {
  glm::dvec3 position;                         // the point, world
  std::vector<TrackObservation> observations;  // pixels that show the point
};
/// Images with poses, and points.
struct PosedModel {
  std::vector<PosedImage> images;  // registered images only, sorted by name
  std::vector<Track> tracks;       // points; may be empty
};

/// Formats of poses, recognised by content. Conventions and supported lenses of each: docs/poses.md.
enum class PoseFormat : std::uint8_t {
  colmap,      // folder for readColmapModel
  transforms,  // file for readTransforms
  panoramas,   // file for readPanoramas
  bundler,     // bundle.out, with the names in list.txt beside it
  nvm,         // NVM_V3 of VisualSFM
  openMvg,     // sfm_data.json
  openSfm,     // reconstruction.json of OpenSfM and ODM, with tracks.csv beside it
  metashape,   // cameras as XML
  realityCsv,  // "Internal/External camera parameters" of RealityScan and RealityCapture
  realityXmp,  // folder of their XMP sidecars
};
/// Returns the format's name, for people.
const char* poseFormatName(PoseFormat format);

/// Returns the format of a file or folder; nullopt if it is in none. Throws Error{io} if it cannot be read.
std::optional<PoseFormat> poseFormatOf(const std::filesystem::path& path);

/// Reads poses in any PoseFormat. Names become those of the photographs in the folder `photographs`: the longest end of
/// the file's path that exists there, with or without extension; else the only photograph with the path's file name, or
/// with its stem. Images without a photograph keep their name in the file. Bundler, NVM and RealityScan files hold no
/// sizes: their photographs are required, in `photographs` or else in the file's folder. Distorted cameras become
/// pinholes, as in readColmapModel; a term that no LensModel has exactly throws Error{unsupported}. Throws Error (io,
/// invalidInput) that names file and field.
PosedModel readPoseFile(const std::filesystem::path& path, const std::filesystem::path& photographs = {},
                        const LogCallback& log = {}, Border border = Border::crop);

/// Reads a COLMAP model (cameras, images, points3D as .txt or .bin) from a folder. Supports all camera models of COLMAP
/// 3.8, and EQUIRECTANGULAR (number 17 in binary files; parameters width and height, optional in text files). Other
/// models throw Error{unsupported} that names the camera. A distorted camera becomes the pinhole of its undistorted
/// photograph. Its observations are undistorted too; those outside the undistorted image are left out. Images without a
/// pose and observations of missing points are skipped with a message. So are the rigs and frames of COLMAP 3.12 and
/// later, since images carry their own pose. Throws Error (io, invalidInput) with file and line, or byte.
PosedModel readColmapModel(const std::filesystem::path& folder, const LogCallback& log = {},
                           Border border = Border::crop);

/// Writes cameras.txt, images.txt and points3D.txt; creates the folder if missing. Images with equal intrinsics share a
/// camera; points are grey. readColmapModel restores poses, and pixels of distorted photographs, up to rounding, and
/// all else exactly. Throws Error{io}. Before writing, throws Error{invalidInput} for a name that does not fit into a
/// line of text, an observation of a missing image, and a pixel that the lens does not see.
void writeColmapModel(const PosedModel& model, const std::filesystem::path& folder);

/// Reads equirectangular panoramas with their poses from a JSON file:
///   {"width": px, "height": px, "panoramas": [{"name": file, "position": [x, y, z],
///    "R_world_to_camera": [[3], [3], [3]]}, …], "triangles": [[i, j, k], …]}
/// Camera axes are COLMAP's (x right, y down, z forward, towards the image's centre); the matrix is given by rows.
/// "q_world_to_camera_wxyz" may replace the matrix, and "t_world_to_camera" the position; if both are given, they must
/// agree. "triangles" is optional, and is checked but not used. There are no tracks. Throws Error (io, invalidInput)
/// with the JSON pointer of the fault.
PosedModel readPanoramas(const std::filesystem::path& file);

/// Reads transforms.json of nerfstudio or instant-ngp: frames with file_path and transform_matrix (camera to world; x
/// right, y up, looking along −z). Intrinsics are in the frame or, for all frames, at the top level: w, h, fl_x, fl_y,
/// cx, cy, camera_angle_x, camera_angle_y, k1 … k4, p1, p2, camera_model (OPENCV, the default; OPENCV_FISHEYE, PINHOLE,
/// EQUIRECTANGULAR). Names are those of readPoseFile. w and h are optional if the photograph is in `photographs`.
/// Distorted cameras become pinholes, as in readColmapModel. There are no tracks. Throws Error (io, invalidInput) with
/// the JSON pointer of the fault. Faults include matrices that scale or shear by more than 1e-3.
PosedModel readTransforms(const std::filesystem::path& file, const std::filesystem::path& photographs = {},
                          Border border = Border::crop);

/// Orientation of the photographs in their files, relative to the model's cameras.
enum class Orientation : std::uint8_t {
  automatic,  // as the aspect ratio requires; if both fit (half turns, squares), as for the other photographs
  stored,     // cameras belong to the images as stored, and EXIF is ignored: COLMAP's convention
  exif,       // cameras belong to the images turned upright by EXIF
};

/// Options of estimatePoses(), which runs the program COLMAP (3.8 or later) on the CPU.
struct PoseOptions {
  std::filesystem::path photographs;                 // folder of the photographs, searched with its subfolders
  std::filesystem::path folder;                      // folder for COLMAP's files only; created if missing, and kept
  std::string program = "colmap";                    // program COLMAP, looked up in PATH unless it contains a folder
  int threads = 0;                                   // threads of the CPU; 0: all cores
  std::filesystem::path excludedFolder;              // photographs below this folder are left out; may be empty
  std::vector<std::string> exclude = {};             // names of further photographs to leave out
  Orientation orientation = Orientation::automatic;  // photographs are turned upright by EXIF unless this is `stored`
  std::filesystem::path masks = {};  // folder of 8-bit masks (of a.jpg: a.jpg.png or a.png): pixels with mask 0 get no
                                     // features; empty: none
};
/// Report of estimatePoses().
struct PoseReport {
  std::filesystem::path model;  // folder of the model, of the largest one if there are several
  std::size_t photographs = 0;  // number of photographs used
  std::size_t registered = 0;   // number of photographs with a pose
  std::size_t points = 0;       // number of sparse points
};

/// Finds features, matches them and estimates poses, on upright images. Matches all pairs of up to 60 photographs, else
/// neighbours in the order of their names. Photographs of one common size are assumed to share a lens. Finished steps
/// are cached in `folder`, and repeated only when photographs change. Cancelling ends the COLMAP process. A few new
/// photographs are registered in the existing, nearly complete model; its poses and points do not change.
///
/// Throws Error: io if the program is missing or fails (with its last lines); invalidInput if it finds no poses,
/// `folder` has other files, or photographs cannot be read (all are named, before the program runs); cancelled.
PoseReport estimatePoses(const PoseOptions& options, const ProgressCallback& progress = {},
                         const LogCallback& log = {});

/// Returns the camera of the photograph `name` of `given` that best fits its observations of the tracks of `given` that
/// `others` see, too. Cameras of `others` are fixed. If one of them has the photograph's lens in `given`, the result
/// has its intrinsics. nullopt for panoramas, and for fewer than 20 shared points. Precondition: `given` contains the
/// photograph.
std::optional<Camera> resected(const PosedModel& given, const std::string& name, const PosedModel& others);

/// Returns the world point with the least sum of squared reprojection errors, px; nullopt if behind a camera or at
/// infinity.
std::optional<glm::dvec3> triangulate(std::span<const Camera> cameras, std::span<const glm::dvec2> pixels);

/// Maps x to scale · rotation · x + shift.
struct SimilarityTransform {
  double scale = 1;                         // factor, > 0
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit
  glm::dvec3 shift{0.0};                    // in the unit of the result

  /// Maps a point.
  glm::dvec3 operator()(const glm::dvec3& point) const { return scale * (rotation * point) + shift; }
  /// Maps a pose: its position as a point, its axes by the rotation.
  Pose operator()(const Pose& pose) const { return {(*this)(pose.position), glm::normalize(rotation * pose.rotation)}; }
};

/// Returns the transform that maps poses to as many others: least squares of positions (Umeyama 1991) and rotations
/// together, each weighted by its residual, so that the more accurate one counts more. Collinear positions take the
/// rotation from the rotations; coincident positions keep scale 1. No poses: identity.
SimilarityTransform estimateSimilarity(std::span<const Pose> from, std::span<const Pose> to);

}  // namespace ibr
