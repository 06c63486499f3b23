// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/build.h"

#include <atomic>

#include "author/author_enums.h"
#include "author/bind.h"
#include "ibr/error.h"
#include "support/calls.h"
#include "support/record.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

// A build sets OpenCV's number of threads for the whole process, so only one may run.
class OnlyBuild {
 public:
  OnlyBuild() {
    if (runs_.exchange(true))
      throw Error(ErrorCode::unsupported, "this process already builds: one build runs at a time");
  }
  OnlyBuild(const OnlyBuild&) = delete;
  OnlyBuild& operator=(const OnlyBuild&) = delete;
  ~OnlyBuild() { runs_ = false; }

 private:
  static inline std::atomic<bool> runs_ = false;
};

BuildReport built(BuildOptions options, const py::object& progress, const py::object& onPrediction) {
  LongCall call(progress);
  if (!onPrediction.is_none())
    options.onPrediction = [&](const BuildPrediction& prediction) {
      return call.ask([&] { return goesOn(onPrediction(prediction)); });
    };
  return call.run([&](const ProgressCallback& report) {
    const OnlyBuild only;
    return build(options, report, logToPython());
  });
}

RefinedModel refined(const BuildOptions& options, const py::object& progress) {
  LongCall call(progress);
  return call.run([&](const ProgressCallback& report) {
    const OnlyBuild only;
    return refineModelPoses(options, report, logToPython());
  });
}

void bindOptions(py::module_& module) {
  using O = BuildOptions;
  Record<O>(module, "BuildOptions", "Options of a build. Without a model, the program COLMAP estimates the poses.")
      .field("photographs", &O::photographs, "Folder that the model's image names are relative to")
      .field("output", &O::output, "Scene folder, created if missing")
      .field("model", &O::model, "Poses, for read_pose_file(), or None")
      .field("colmap", &O::colmap, "Program that estimates missing poses")
      .field("exclude", &O::exclude, "Names of images to leave out")
      .field("skip_missing", &O::skipMissing, "Images of the model without a photograph are left out")
      .field("orientation", &O::orientation, "Orientation")
      .field("tracks", &O::tracks, "TrackSource")
      .field("masks", &O::masks, "Folder of masks; pixels with mask 0 are neither matched nor shown")
      .field("match_exposures", &O::matchExposures, "Photographs get gains, measured where they overlap")
      .field("fit_vignetting", &O::fitVignetting, "Vignetting is measured and removed")
      .field("refine_poses", &O::refinePoses, "RefinePoses")
      .field("mask_moving_objects", &O::maskMovingObjects,
             "Moving objects are masked where another photograph shows more")
      .field("strip_metadata", &O::stripMetadata, "Stored photographs keep only their colour profile and orientation")
      .field("keep_border", &O::keepBorder, "Undistorted photographs keep all photographed pixels")
      .field("dimension", &O::dimension, "Of the cells at most: 1 lines, 2 triangles, 3 tetrahedra; 0: as cameras span")
      .field("max_size", &O::maxSize, "Longest side of stored photographs, px; 0: unchanged")
      .field("texture", &O::texture, "TextureFormat of stored textures")
      .field("theta_degrees", &O::thetaDegrees, "Maximum angle between viewing axes in a cell, degrees; 0: automatic")
      .field("backdrops", &O::backdrops, "Photographs get depth meshes and textures, which the gather needs")
      .field("depth", &O::depth, "DepthSearch")
      .field("draft", &O::draft, "Preview without cells")
      .field("backdrop_spacing", &O::backdropSpacing, "Minimum distance of a backdrop's vertices: 2, 4, 8, 16 or 32 px")
      .field("cache_folder", &O::cacheFolder, "Folder that caches work for later builds; None: .build in the output")
      .field("matcher", &O::matcher, "MatchMethod")
      .field("triangle_filter", &O::triangleFilter, "TriangleFilter")
      .field("threads", &O::threads, "0: all cores")
      .field("memory", &O::memory, "Bytes that the build may take; 0: half of the process's limit")
      .field("seed", &O::seed, "Same input, options and seed: same scene")
      .constructible();
}

void bindPrediction(py::module_& module) {
  using P = BuildPrediction;
  Record<P::Stage>(module, "BuildStage", "A stage of a build.")
      .field("name", &P::Stage::name, "Name")
      .field("seconds", &P::Stage::seconds, "Elapsed time, s")
      .field("cpu_seconds", &P::Stage::cpuSeconds, "Processor time of all threads, s");
  Record<P>(module, "BuildPrediction", "Predicted cost of a build.")
      .field("photographs", &P::photographs, "Number")
      .field("cells", &P::cells, "Number")
      .field("backdrops", &P::backdrops, "Number")
      .field("poses_known", &P::posesKnown, "False: poses are estimated first, which is not included")
      .field("cell_count_known", &P::cellCountKnown, "False: the number of cells is a guess")
      .field("megapixels", &P::megapixels, "Of all photographs at their stored size")
      .field("threads", &P::threads, "Threads that match cells in parallel")
      .field("stages", &P::stages, "Tuple of BuildStage")
      .field("seconds", &P::seconds, "Elapsed time, s")
      .field("cpu_seconds", &P::cpuSeconds, "Processor time, s")
      .field("memory", &P::memory, "Peak, bytes")
      .field("memory_limit_bytes", &P::memoryLimitBytes, "BuildOptions.memory in effect")
      .field("disk", &P::disk, "Size of the scene's folder during the build, bytes")
      .field("disk_free_bytes", &P::diskFreeBytes, "Free space, bytes");
}

void bindReport(py::module_& module) {
  using R = BuildReport;
  Record<R::CellReport>(module, "CellReport", "A cell that was built.")
      .field("members", &R::CellReport::members, "Tuple of names of photographs")
      .field("points", &R::CellReport::points, "Number of vertices")
      .field("triangles", &R::CellReport::triangles, "Number of triangles")
      .field("tier0", &R::CellReport::tier0, "Number of triangles of tier 0")
      .field("quality", &R::CellReport::quality, "CellQuality")
      .field("seconds", &R::CellReport::seconds, "s")
      .field("cpu_seconds", &R::CellReport::cpuSeconds, "s")
      .field("cached", &R::CellReport::cached, "Read from the cache")
      .field("matcher", &R::CellReport::matcher, "MatchMethod that was used")
      .field("homogeneous", &R::CellReport::homogeneous, "Share of tier 0 on one plane each; NaN without planes");
  Record<R::BackdropReport>(module, "BackdropReport", "A depth mesh of a photograph.")
      .field("photograph", &R::BackdropReport::photograph, "Name")
      .field("points", &R::BackdropReport::points, "Number of vertices")
      .field("triangles", &R::BackdropReport::triangles, "Number of triangles")
      .field("matched_share", &R::BackdropReport::matchedShare, "Share of the photograph whose depth was matched")
      .field("seconds", &R::BackdropReport::seconds, "s")
      .field("cached", &R::BackdropReport::cached, "Read from the cache");
  Record<R::RejectedCell>(module, "RejectedCell", "A cell that was dropped.")
      .field("cell", &R::RejectedCell::cell, "By its members' names")
      .field("reason", &R::RejectedCell::reason, "Text for people");
  Record<R::MaskReport>(module, "MaskReport", "A photograph with masked pixels.")
      .field("photograph", &R::MaskReport::photograph, "Name")
      .field("given_share", &R::MaskReport::givenShare, "Share under the given mask")
      .field("moving_share", &R::MaskReport::movingShare, "Further share that was masked as moving");
  Record<R::ExposureSummary>(module, "ExposureSummary", "Measured exposures.")
      .field("measured", &R::ExposureSummary::measured, "Photographs that were compared with others")
      .field("parts", &R::ExposureSummary::parts, "Groups that no match connects")
      .field("alike", &R::ExposureSummary::alike, "All gains are within 1 % of 1")
      .field("text", &R::ExposureSummary::text, "Text for people")
      .field("vignetting", &R::ExposureSummary::vignetting, "Text for people");
  Record<R>(module, "BuildReport", "Result of a build.")
      .field("poses", &R::poses, "File or folder that the poses were read from")
      .field("exposures", &R::exposures, "ExposureSummary")
      .field("refinement", &R::refinement, "PoseRefinement")
      .field("masks", &R::masks, "Tuple of MaskReport")
      .field("cells", &R::cells, "Tuple of CellReport")
      .field("backdrops", &R::backdrops, "Tuple of BackdropReport")
      .field("dropped", &R::dropped, "Tuple of RejectedCell")
      .field("unused_photographs", &R::unusedPhotographs, "Tuple of UnusedPhotograph")
      .field("prediction", &R::prediction, "BuildPrediction")
      .field("seconds", &R::seconds, "s")
      .field("cpu_seconds", &R::cpuSeconds, "s")
      .field("memory", &R::memory, "Peak of the process, bytes");
}

}  // namespace

void bindBuild(py::module_& module) {
  bindOptions(module);
  bindPrediction(module);
  bindReport(module);
  Record<RefinedModel>(module, "RefinedModel", "Result of refine_model_poses().")
      .field("model", &RefinedModel::model, "PosedModel")
      .field("refinement", &RefinedModel::refinement, "PoseRefinement");
  module.def(
      "build", &built, py::arg("options"), py::kw_only(), py::arg("progress") = py::none(),
      py::arg("on_prediction") = py::none(),
      "Builds a scene folder and returns a BuildReport. A build that was stopped resumes when it is called again "
      "with the same options. on_prediction: called with a BuildPrediction before the work; its result False ends "
      "the build. One build runs at a time in a process.");
  module.def("refine_model_poses", &refined, py::arg("options"), py::kw_only(), py::arg("progress") = py::none(),
             "Refines the poses of a model by the matches of its cells; returns a RefinedModel. Builds no scene.");
  module.def(
      "read_poses", [](const BuildOptions& options) { return readPoses(options, logToPython()); }, py::arg("options"),
      py::call_guard<py::gil_scoped_release>(), "Reads the poses that the options name, as a PosedModel.");
}

}  // namespace ibr::python
