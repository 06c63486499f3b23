// SPDX-License-Identifier: Apache-2.0
#include "author/author_enums.h"
#include "author/bind.h"
#include "ibr/author/htm.h"
#include "support/calls.h"
#include "support/record.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

void bindOptions(py::module_& module) {
  using O = HtmOptions;
  Record<O>(module, "HtmOptions", "Options of the harmonisation. Differences are in 8-bit levels.")
      .field("faces", &O::faces, "Target of the reduction by shape; 0: no reduction")
      .field("inconsistent_size", &O::inconsistentSize, "Maximum area of collapsed faces, in mean faces; 0: none")
      .field("inconsistent_difference", &O::inconsistentDifference, "Difference above which a face is inconsistent")
      .field("inconsistent_share", &O::inconsistentShare, "Maximum number of collapses, share of the faces")
      .field("adjust_rounds", &O::adjustRounds, "Of cameras and vertices; 0: not adjusted")
      .field("adjust_smoothness", &O::adjustSmoothness, "1 / px^2")
      .field("reshape", &O::reshape, "Vertices move along their normals")
      .field("shape_smoothness", &O::shapeSmoothness, "1 / px^2")
      .field("measure", &O::measure, "TemplateMeasure")
      .field("radius", &O::radius, "Search radius around a vertex, px")
      .field("later_radius", &O::laterRadius, "The same once all cameras are adjusted, px")
      .field("min_texture", &O::minTexture, "Minimum gradient, 8-bit levels per px")
      .field("smoothness", &O::smoothness, "1 / px^2; 0: matches are not smoothed")
      .field("complement_px", &O::complementPx, "Expected length of complements, px; 0: no prior")
      .field("outlier_px", &O::outlierPx, "Residual at which a match has a quarter of its weight, px")
      .field("alpha", &O::alpha, "Of eqs 2 and 3 of the paper")
      .field("gamma1", &O::gamma1, "Of eqs 2 and 3 of the paper")
      .field("rounds", &O::rounds, "Of matching, at least 1")
      .field("mean_difference", &O::meanDifference, "Mean difference up to which no face is divided")
      .field("face_difference", &O::faceDifference, "Difference above which a face is divided")
      .field("self_occluded", &O::selfOccluded, "Partly hidden faces are divided as well")
      .field("min_face_px", &O::minFacePx, "Smaller faces are not divided, px^2")
      .field("max_faces", &O::maxFaces, "A mesh with so many faces gets no further round")
      .field("reject", &O::reject, "Cameras that disagree at a vertex are rejected there")
      .field("reject_difference", &O::rejectDifference, "Maximum difference of agreeing cameras")
      .field("reject_correlation", &O::rejectCorrelation, "Correlation from which cameras agree at any difference")
      .field("soft_px", &O::softPx, "Width of the falloff of visibility at edges, px")
      .field("keep_source", &O::keepSource, "The model keeps the given mesh, for comparisons")
      .field("threads", &O::threads, "0: all cores")
      .constructible();
  using B = HtmBuildOptions;
  Record<B>(module, "HtmBuildOptions", "Input and output of build_htm().")
      .field("mesh", &B::mesh, "PLY, OBJ or glTF, in the model's world")
      .field("model", &B::model, "COLMAP model folder")
      .field("images", &B::images, "Folder that the model's image names are relative to")
      .field("output", &B::output, "Folder of the harmonised model; created if missing")
      .field("masks", &B::masks, "Folder of masks, or None")
      .field("exclude", &B::exclude, "Names of images to leave out")
      .field("max_size", &B::maxSize, "Longest side of stored photographs, px; 0: unchanged")
      .field("optimise", &B::optimise, "HtmOptions")
      .constructible();
}

void bindReport(py::module_& module) {
  using R = HtmReport;
  Record<R::Stage>(module, "HtmStage", "A stage of build_htm().")
      .field("name", &R::Stage::name, "Name")
      .field("seconds", &R::Stage::seconds, "s");
  Record<R::Round>(module, "HtmRound", "A round of matching.")
      .field("vertices", &R::Round::vertices, "Number")
      .field("faces", &R::Round::faces, "Number")
      .field("unharmonised_difference", &R::Round::unharmonisedDifference, "Mean difference without complements")
      .field("harmonised_difference", &R::Round::harmonisedDifference, "Mean difference with complements")
      .field("matched_share", &R::Round::matchedShare, "Share of the matches that found texture")
      .field("divided", &R::Round::divided, "Faces divided for the next round")
      .field("divided_as_hidden", &R::Round::dividedAsHidden, "Of these: partly hidden, but not different");
  Record<R::Adjustment>(module, "HtmAdjustment", "An adjustment of cameras and vertices.")
      .field("before_px", &R::Adjustment::beforePx, "RMS offset from the cameras' consensus, px")
      .field("after_px", &R::Adjustment::afterPx, "RMS offset from the cameras' consensus, px")
      .field("mean_displacement", &R::Adjustment::meanDisplacement, "Of vertices, world units");
  Record<R>(module, "HtmReport", "Result of build_htm().")
      .field("stages", &R::stages, "Tuple of HtmStage")
      .field("adjustments", &R::adjustments, "Tuple of HtmAdjustment")
      .field("source_faces", &R::sourceFaces, "Number")
      .field("reduced_faces", &R::reducedFaces, "Number")
      .field("collapses", &R::collapses, "Of inconsistent faces")
      .field("rounds", &R::rounds, "Tuple of HtmRound")
      .field("cameras_per_vertex", &R::camerasPerVertex, "Mean number of cameras that see a vertex")
      .field("rejected", &R::rejected, "Share of the rejected cameras among these")
      .field("complement_bytes", &R::complementBytes, "Bytes");
}

}  // namespace

void bindHtmBuild(py::module_& module) {
  bindOptions(module);
  bindReport(module);
  module.def(
      "build_htm",
      [](const HtmBuildOptions& options, const py::object& progress) {
        LongCall call(progress);
        return call.run(
            [&](const ProgressCallback& report) { return buildHtm(options, report, logToPython()).report; });
      },
      py::arg("options"), py::kw_only(), py::arg("progress") = py::none(),
      "Builds the folder of a harmonised model from a mesh, cameras and photographs; returns an HtmReport. The folder "
      "is "
      "untouched until the model is computed.");
}

}  // namespace ibr::python
