// SPDX-License-Identifier: Apache-2.0
// Builds a scene folder from posed photographs ([T] §2.4). Needs ibr::author (OpenCV, CGAL).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ibr/author/pose_refinement.h"
#include "ibr/author/poses.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

/// Source of the tracks: points that two or more photographs share.
enum class TrackSource : std::uint8_t {
  automatic,  // the model's tracks, and own tracks for pairs of photographs that share few of the model's
  model,      // the model's tracks
  own,        // SIFT features, matched along the epipolar lines of the poses
};

/// Refinement of poses before a build (PoseRefinement).
enum class RefinePoses : std::uint8_t {
  automatic,  // `on` for poses without tracks that a phone app wrote, or whose photographs are mostly a phone's by EXIF
  on,         // poses are refined where points confirm it
  off,        // poses are used as they are
};

/// Method that matches the members of a cell.
enum class MatchMethod : std::uint8_t {
  automatic,    // `sweep` where the cell's tracks reproject within 1 px (median), else `flow`
  sweep,        // depth maps of the members (DepthSearch); cells that only refine poses: plane sweep over all depths
  homographic,  // planes of the scene, found among sparse features ([T]'s reference 25)
  flow,         // optical flow, initialised with sparse matches; needs no poses
};
/// Returns "auto", "sweep", "homographic" or "flow".
constexpr const char* matchMethodName(MatchMethod matcher) {
  constexpr const char* kNames[] = {"auto", "sweep", "homographic", "flow"};
  return kNames[std::size_t(matcher)];
}

/// Depth search in a photograph, or in the cube faces of a panorama, against up to ten others. The matched image is the
/// photograph scaled down to at most 2 megapixels. Times and accuracy: libibr/docs/quality.md.
enum class DepthSearch : std::uint8_t {
  fast,     // plane sweep at half of the sides of `swept`
  swept,    // plane sweep at half of the matched image's sides, at most 512 px
  refined,  // swept, then refined by slanted planes to a fraction of a depth level
  fine,     // refined, in a depth map of twice the sides
};
/// Returns the enumerator's name: "fast", "swept", "refined" or "fine".
constexpr const char* depthSearchName(DepthSearch search) {
  constexpr const char* kNames[] = {"fast", "swept", "refined", "fine"};
  return kNames[std::size_t(search)];
}

/// Filter that selects a cell's triangles of tier 0.
enum class TriangleFilter : std::uint8_t {
  consistency,  // triangles that look alike in all members and lie where the dense match does
  homogeneous,  // as consistency; in cells with MorphMesh::planes, only triangles whose corners share a plane
};

/// Post-processing hook, called after all cells and backdrops are built and before the scene is saved. The photographs
/// are already in the scene's folder. The hook may change meshes and qualities of the cells, not their number. Results
/// cached in the folder `cacheFolder` let a stopped build resume (optimiseCells does so).
using ScenePostProcess = std::function<void(Scene& scene, const std::filesystem::path& cacheFolder,
                                            const ProgressCallback& progress, const LogCallback& log)>;

/// Predicted cost of a build.
struct BuildPrediction {
  /// Predicted time of a stage of the build.
  struct Stage {
    std::string name;                    // name, for people
    double seconds = 0, cpuSeconds = 0;  // seconds: elapsed time; cpuSeconds: processor time of all threads
  };
  std::size_t photographs = 0, cells = 0, backdrops = 0;  // number in the scene
  bool posesKnown = true;              // false: poses must be estimated first; the time for this is not included
  bool cellCountKnown = true;          // false: there are no tracks yet, so the number of cells is a guess
  double megapixels = 0;               // size of all photographs together, as stored
  int threads = 0;                     // threads that match cells in parallel
  std::vector<Stage> stages;           // in the order of the build
  double seconds = 0, cpuSeconds = 0;  // sums over the stages
  // memory: peak of the process, bytes; memoryLimitBytes: limit of BuildOptions::memory
  double memory = 0, memoryLimitBytes = 0;
  // disk: maximum size of the scene's folder during the build, bytes; diskFreeBytes: free space, plus what the scene's
  // earlier build takes
  double disk = 0, diskFreeBytes = 0;
};

/// Options of build().
struct BuildOptions {
  std::filesystem::path photographs;  // folder that the model's image names are relative to
  std::filesystem::path model;        // poses, for readPoseFile; empty: estimatePoses provides them
  std::string colmap = "colmap";      // program that estimatePoses runs
  std::filesystem::path output;       // scene folder, created if missing
  std::vector<std::string> exclude;   // names of images to leave out, e.g. held out for evaluation; may include
                                      // photographs that the model lacks
  bool skipMissing = false;  // images of the model without a photograph are left out, such as frames of a video that
                             // were not chosen; false: they are an error
  Orientation orientation = Orientation::automatic;  // orientation of the photographs' files
  TrackSource tracks = TrackSource::automatic;       // source of the points that photographs share
  std::filesystem::path masks;  // folder of 8-bit masks of the photographs' size (of a.jpg: a.jpg.png or a.png): pixels
                                // with mask 0 are neither matched nor shown; empty: none
  bool matchExposures = true;   // photographs get gains (Node::gain), measured where photographs overlap
  bool fitVignetting = false;   // vignetting is measured as well, and removed from the stored photographs
  RefinePoses refinePoses = RefinePoses::automatic;  // refined poses are written to ".refined" in the output
  bool maskMovingObjects = false;  // moving objects are masked where another photograph shows the background
  bool stripMetadata = false;  // stored photographs keep only their colour profile and orientation, and the scene no
                               // capture metadata
  bool keepBorder = false;  // undistorted photographs keep all photographed pixels (Border::keep); meshes leave out the
                            // black border
  int dimension = 0;        // maximum dimension of cells: 1 lines, 2 triangles, 3 tetrahedra; 0: what the cameras span
  int maxSize = 0;          // longest side of stored photographs, px; 0: unchanged
  TextureFormat texture = TextureFormat::rgba8;  // format of stored textures
  double thetaDegrees = 0;  // maximum angle between the viewing axes in a cell; 0: half the smaller field of view
  bool backdrops = true;    // photographs get backdrops and depth textures, which Composition::gathered needs
  DepthSearch depth = DepthSearch::refined;  // accuracy of depth maps
  bool draft = false;  // preview without cells: uses DepthSearch::fast, and ignores refinePoses, maskMovingObjects,
                       // fitVignetting and postProcess; keeps the cache of other builds; needs backdrops
  int backdropSpacing = 2;  // minimum distance of a backdrop's vertices: 2, 4, 8, 16 or 32 px of the photograph scaled
                            // down to 512 px (panoramas: 2048 px)
  std::filesystem::path cacheFolder;  // folder where cells, depth and meshes are cached for later builds, whose results
                                      // do not change by it; empty: ".build" in the output, which keeps only what its
                                      // last build used
  MatchMethod matcher = MatchMethod::automatic;  // method for cells of pinholes; cells of panoramas are always swept
  TriangleFilter triangleFilter = TriangleFilter::consistency;  // filter for tier 0
  ScenePostProcess postProcess;                                 // hook before the scene is saved; may be empty
  std::function<bool(const BuildPrediction&)> onPrediction;     // called before the work, and again after poses were
                                                                // estimated; false ends the build: only poses are
                                                                // written
  int threads = 0;                                              // threads of the CPU; 0: all cores
  double memory = 0;       // memory that the build may take, bytes; 0: half of the memory that the process may have
  std::uint64_t seed = 1;  // same input, options and seed: same bytes
};

/// Report of a build.
struct BuildReport {
  /// A cell of the scene.
  struct CellReport {
    std::vector<std::string> members;  // names of the photographs
    // points: number of the mesh's vertices; triangles: number of triangles; tier0: number of triangles of tier 0
    std::size_t points = 0, triangles = 0, tier0 = 0;
    CellQuality quality;                       // as Cell::quality, before BuildOptions::postProcess
    double seconds = 0, cpuSeconds = 0;        // seconds: elapsed time; cpuSeconds: processor time
    bool cached = false;                       // true: read from the cache
    MatchMethod matcher = MatchMethod::sweep;  // method used, never automatic
    double homogeneous = 0;  // share of the tier-0 triangles whose corners share a plane; NaN without planes
  };
  /// A backdrop of the scene.
  struct BackdropReport {
    std::string photograph;                 // name of the photograph
    std::size_t points = 0, triangles = 0;  // points: number of the mesh's vertices; triangles: number of triangles
    double matchedShare = 0;                // share of the photograph whose depth was matched; the rest is completed
    double seconds = 0;                     // elapsed time
    bool cached = false;                    // true: read from the cache
  };
  /// A cell that the scene does not have.
  struct RejectedCell {
    std::string cell;    // names of the members, for people
    std::string reason;  // reason of the rejection, for people
  };
  /// Masked areas of a photograph.
  struct MaskReport {
    std::string photograph;  // name of the photograph
    double givenShare = 0;   // share of the photograph under its given mask
    double movingShare = 0;  // further share that was masked as moving
  };
  /// Exposures and vignetting of the photographs. Texts are for people, and empty if not requested.
  struct ExposureSummary {
    std::size_t measured = 0;      // number of photographs that were compared with overlapping ones
    std::size_t parts = 0;         // number of measured groups that no match connects; each keeps its mean brightness
    bool alike = false;            // true: all gains are within 1 % of 1, and none is stored
    std::string text, vignetting;  // text: exposures; vignetting: vignetting
  };
  std::filesystem::path poses;    // file or folder that the poses were read from
  ExposureSummary exposures;      // measured exposures
  PoseRefinement refinement;      // refinement of poses, if requested; `poseChanges` is empty if poses are unchanged
  std::vector<MaskReport> masks;  // photographs with masked pixels
  std::vector<CellReport> cells;  // in the order of Scene::cells
  std::vector<BackdropReport> backdrops;            // in the order of Scene::backdrops
  std::vector<RejectedCell> dropped;                // cells that were refused, or whose members did not match
  std::vector<UnusedPhotograph> unusedPhotographs;  // as Scene::unusedPhotographs
  BuildPrediction prediction;                       // prediction last passed to BuildOptions::onPrediction
  double seconds = 0, cpuSeconds = 0;               // seconds: elapsed time; cpuSeconds: processor time of all threads
  double memory = 0;                                // peak memory of the process, bytes
};

/// Reads the poses of BuildOptions::model with readPoseFile. Throws Error.
PosedModel readPoses(const BuildOptions& options, const LogCallback& log);

/// Builds a scene folder. Each depth map, cell and mesh is cached once finished: a stopped build that is called again
/// with the same options resumes. A build with more photographs recomputes depth and cells only for photographs with
/// changed neighbours. No cell has both panoramas and pinholes. While a build runs, OpenCV uses one thread in the whole
/// process, so only one build may run at a time. Throws Error.
BuildReport build(const BuildOptions& options, const ProgressCallback& progress = {}, const LogCallback& log = {});

/// Result of refineModelPoses().
struct RefinedModel {
  PosedModel model;           // refined model, with the tracks of the build, own ones included
  PoseRefinement refinement;  // report; `poseChanges` is empty if the model's poses are unchanged
};

/// Matches the cells of a build with these options, and refines estimated poses by the matches. Poses are unchanged if
/// the model's points reproject exactly, or if refined poses do not fit held-out points better. To build with the
/// refined poses, write the model (writeColmapModel) and set BuildOptions::model. Writes only estimated poses and the
/// cache, which is removed at the end unless cacheFolder is set. Threading and errors as build.
RefinedModel refineModelPoses(const BuildOptions& options, const ProgressCallback& progress = {},
                              const LogCallback& log = {});

/// The photographs that a build would store, at their stored size. Builds nothing. Const functions are thread-safe.
class PosedPhotographs {
 public:
  /// Reads the model and checks the files, as build does. The options must name poses. Throws Error.
  explicit PosedPhotographs(const BuildOptions& options, const LogCallback& log = {});
  PosedPhotographs(PosedPhotographs&&) noexcept;
  ~PosedPhotographs();  // frees host memory

  /// Returns the photographs' poses, sorted by name, without BuildOptions::exclude.
  const std::vector<PosedImage>& images() const noexcept;

  /// Reads a photograph, by its index in images(): RGB, of the camera's size. Throws Error.
  Image8 photograph(std::size_t image) const;

  /// Reads a photograph's mask from BuildOptions::masks: one channel, 0 or 255; empty if it has none. Throws Error.
  Image8 mask(std::size_t image) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
