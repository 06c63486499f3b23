// SPDX-License-Identifier: Apache-2.0
#include "ibr/optimiser.h"

#include "runtime/bind.h"
#include "runtime/shared_device.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

struct AlignedMesh {
  Alignment alignment;
  AlignmentSummary summary;
};

template <class T>
std::vector<std::vector<T>> listsOf(const std::vector<py::array>& arrays, const std::string& name) {
  std::vector<std::vector<T>> lists;
  for (const py::array& array : arrays) lists.push_back(vectorsOf<T>(array, name));
  return lists;
}

std::unique_ptr<AlignedMesh> alignedOf(const std::vector<py::array>& pictures, const std::vector<py::array>& positions,
                                       const py::array& triangles, const AlignmentOptions& options,
                                       const std::optional<py::array>& unevaluated,
                                       const std::optional<py::array>& fixed,
                                       const std::optional<std::vector<py::array>>& epipolar,
                                       const std::shared_ptr<SharedDevice>& device, const py::object& progress) {
  std::vector<Image8> images;
  for (const py::array& picture : pictures) images.push_back(imageOf(picture, "pictures", {3}));
  Alignment alignment;
  for (const Image8& image : images) alignment.pictures.push_back(&image);
  alignment.position = listsOf<glm::ivec2>(positions, "positions");
  alignment.triangles = vectorsOf<glm::uvec3>(triangles, "triangles");
  if (unevaluated) alignment.unevaluated = vectorsOf<glm::uvec3>(*unevaluated, "unevaluated");
  if (fixed) alignment.fixed = vectorsOf<std::uint8_t>(*fixed, "fixed");
  if (epipolar) alignment.epipolar = listsOf<glm::vec2>(*epipolar, "epipolar");
  LongCall call(progress);
  const AlignmentSummary summary = call.run([&](const ProgressCallback& report) {
    if (!device) return align(alignment, options, nullptr, report);
    const std::lock_guard locked(device->mutex);
    return align(alignment, options, &device->device, report);
  });
  alignment.pictures.clear();  // the images end with this call
  return std::make_unique<AlignedMesh>(AlignedMesh{std::move(alignment), summary});
}

}  // namespace

void bindOptimiser(py::module_& module) {
  module.attr("ALIGNMENT_UNITS_PER_PIXEL") = kAlignmentUnitsPerPixel;
  using O = AlignmentOptions;
  Record<O>(module, "AlignmentOptions", "Options of the optimiser.")
      .field("method", &O::method, "AlignmentMethod")
      .field("definition", &O::definition, "EccDefinition")
      .field("instances", &O::instances, "Candidates per point, 2 to 256")
      .field("radius_px", &O::radiusPx, "Maximum displacement of a candidate in the first cycle, px, > 0, at most 64")
      .field("decay", &O::decay, "Factor of the radius from cycle to cycle, > 0, at most 1")
      .field("threshold", &O::threshold, "Relative gain at or below which a cycle is the last, >= 0")
      .field("max_cycles", &O::maxCycles, ">= 1")
      .field("variance_floor", &O::varianceFloor, "grey^2, 0 to 1000")
      .field("rigidity", &O::rigidity, "Penalty for a match at 1 px from its start, grey^2 / px^2, 0 to 10000")
      .field("prune", &O::prune, "COMPUTE, CPU: all candidates on every 8th row first, then the best 8 in full")
      .field("scaled_instances", &O::scaledInstances, "Fewer candidates where a point can move less")
      .field("levels", &O::levels, "GRADIENT: levels of the scale space, 1 to 8")
      .field("escape", &O::escape, "GRADIENT: random candidates before a step, 0 to 256")
      .field("epipolar_weight", &O::epipolarWeight, "GRADIENT: penalty for the distance from the epipolar line")
      .field("flip_edges", &O::flipEdges, "Edges are flipped where the triangles then agree better")
      .field("flip_gain", &O::flipGain, "Minimum gain in ECC of a flip, 0 to 1")
      .field("insert_points", &O::insertPoints, "Points are inserted where agreement then improves")
      .field("insert_below", &O::insertBelow, "ECC of a triangle below which a point may be inserted, -1 to 1")
      .field("insert_gain", &O::insertGain, "Minimum gain in ECC of an insertion, 0 to 1")
      .field("insert_share", &O::insertShare, "Inserted points at most, share of the initial points, 0 to 4")
      .field("seed", &O::seed, "Same input, options and seed: same mesh")
      .field("threads", &O::threads, "Of the processor; 0: all cores")
      .constructible();

  using C = AlignmentCycle;
  Record<C>(module, "AlignmentCycle", "A cycle of the optimiser.")
      .field("radius_px", &C::radiusPx, "px")
      .field("ecc", &C::ecc, "Mean over points and pictures after the cycle")
      .field("mutations", &C::mutations, "Evaluated candidates")
      .field("pixels", &C::pixels, "Pairs of samples compared for these candidates")
      .field("moved", &C::moved, "Moves; a point counts once per picture")
      .field("refused", &C::refused, "Moves that were refused")
      .field("seconds", &C::seconds, "s")
      .field("flipped", &C::flipped, "Edges")
      .field("inserted", &C::inserted, "Points");
  using S = AlignmentSummary;
  Record<S>(module, "AlignmentSummary", "Result of the optimiser. Mean ECCs are over all points and pictures.")
      .field("initial_ecc", &S::initialEcc, "Per channel and target")
      .field("final_ecc", &S::finalEcc, "Per channel and target")
      .field("initial_ecc_paper", &S::initialEccPaper, "One mean over all, as in the paper")
      .field("final_ecc_paper", &S::finalEccPaper, "One mean over all, as in the paper")
      .field("initial_star_ecc", &S::initialStarEcc, "(n,), float32, by point; NaN: no triangle")
      .field("final_star_ecc", &S::finalStarEcc, "(n,), float32, by point; NaN: no triangle")
      .field("cycles", &S::cycles, "Tuple of AlignmentCycle")
      .field("best_cycle", &S::bestCycle, "Cycle whose mesh is returned; 0: the initial mesh")
      .field("flips", &S::flips, "Of edges, up to best_cycle")
      .field("insertions", &S::insertions, "Of points, up to best_cycle")
      .field("seconds", &S::seconds, "s");

  py::class_<AlignedMesh>(module, "AlignedMesh", "Result of align(). Arrays are read-only and not copied.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) { return viewsOf(self.cast<const AlignedMesh&>().alignment.position, self); },
          "d arrays (n, 2), int32, 1/128 px")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) { return viewOf(self.cast<const AlignedMesh&>().alignment.triangles, self); },
          "(m, 3), uint32")
      .def_property_readonly(
          "summary", [](const AlignedMesh& self) { return self.summary; }, "AlignmentSummary");

  module.def(
      "align", &alignedOf, py::arg("pictures"), py::arg("positions"), py::arg("triangles"),
      py::arg("options") = AlignmentOptions{.method = AlignmentMethod::gradient}, py::kw_only(),
      py::arg("unevaluated") = py::none(), py::arg("fixed") = py::none(), py::arg("epipolar") = py::none(),
      py::arg("device") = py::none(), py::arg("progress") = py::none(),
      "Moves the points of a mesh until its pictures agree best. pictures: d arrays (height, width, 3), uint8; "
      "positions: d arrays (n, 2) of integers, 1/128 px from the picture's top-left corner; triangles, and "
      "unevaluated ones: (m, 3). fixed: (n,), nonzero where a point must not move. epipolar: d arrays (n, 2), unit "
      "directions along which matches slide. RASTER and COMPUTE need a device. By default GRADIENT. Returns an "
      "AlignedMesh.");
}

}  // namespace ibr::python
