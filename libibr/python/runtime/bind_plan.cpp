// SPDX-License-Identifier: Apache-2.0
#include "ibr/frame_plan.h"

#include "runtime/bind.h"
#include "runtime/planner.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

// The weights of a cell's members in the view: (d,), sums to 1.
py::array blendOf(const PlannedCell& cell, std::size_t view) {
  if (view > 1) throw py::index_error("view: must be 0 or 1");
  const std::array<double, 4>& blend = cell.view[view].blend;
  return readOnly(py::array_t<double>(py::ssize_t(blend.size()), blend.data()));
}

template <class M>
auto planField(M FramePlan::*member) {
  return [member](const ScenePlan& self) { return toPython<M>(self.plan.*member); };
}

}  // namespace

void bindPlan(py::module_& module) {
  Record<PlannedCell> cell(module, "PlannedCell", "A cell that a frame draws.");
  cell.field("cell", &PlannedCell::cell, "Index into Scene.cells")
      .field("extrapolation_distance", &PlannedCell::extrapolationDistance, "World units; 0 inside the cell")
      .field("rotational_distance", &PlannedCell::rotationalDistance, "radians")
      .field("photograph_distance", &PlannedCell::photographDistance, "RMS distance of the photographs, world units")
      .field("opacity", &PlannedCell::opacity, "Below 1 near the extrapolation limit and during fades")
      .field("hidden", &PlannedCell::hidden, "Better cells certainly cover the cell");
  cell.type().def("blend", &blendOf, py::arg("view") = 0,
                  "Weights of the members' colours in a view of the plan: (4,), 0 beyond the members, sum 1.");

  Record<PlannedPhotograph>(module, "PlannedPhotograph", "A photograph that votes and that colours are gathered from.")
      .field("node", &PlannedPhotograph::node, "Index into Scene.nodes")
      .field("backdrop", &PlannedPhotograph::backdrop, "Index into Scene.backdrops")
      .field("weight", &PlannedPhotograph::weight, "0 to 1")
      .field("distance", &PlannedPhotograph::distance, "From the views, world units")
      .field("share", &PlannedPhotograph::share, "Of the views' colours; the shares sum to 1");

  py::class_<ScenePlan>(module, "FramePlan",
                        "One frame, decided: which cells it draws, and which photographs it gathers from.")
      .def_property_readonly("views", planField(&FramePlan::views), "Tuple of one or two Camera")
      .def_property_readonly("settings", planField(&FramePlan::settings), "RenderSettings")
      .def_property_readonly("cells", planField(&FramePlan::cells), "Tuple of PlannedCell, best first")
      .def_property_readonly("photographs", planField(&FramePlan::photographs),
                             "Tuple of PlannedPhotograph, best first; empty with Composition.CELLS")
      .def_property_readonly("exposure", planField(&FramePlan::exposure),
                             "Red, green, blue factors of linear light, beside each photograph's gain")
      .def_property_readonly("near_distance", planField(&FramePlan::nearDistance),
                             "World units; nearer surfaces are drawn at this depth")
      .def_property_readonly("culled_by_frustum", planField(&FramePlan::culledByFrustum), "Number of cells out of view")
      .def_property_readonly("culled_by_distance", planField(&FramePlan::culledByDistance),
                             "Number of cells too far away")
      .def_property_readonly("culled_by_count", planField(&FramePlan::culledByCount),
                             "Number of cells beyond max_cells, or without a gain in coverage")
      .def_property_readonly("culled_by_muting", planField(&FramePlan::culledByMuting), "Number of muted cells");

  py::class_<Planner>(module, "Planner", "Plans the frames of a scene, without a device. Thread-safe.")
      .def(py::init([](const std::shared_ptr<Scene>& scene) {
             return unlocked([&] { return std::make_unique<Planner>(scene); });
           }),
           py::arg("scene").none(false))
      .def(
          "plan",
          [](const Planner& self, const py::object& views, const RenderSettings& settings, double dtSeconds,
             const ScenePlan* previous) {
            std::vector<Camera> cameras = camerasOf(views);
            return unlocked([&] { return self.plan(std::move(cameras), settings, dtSeconds, previous); });
          },
          py::arg("views"), py::arg("settings"), py::kw_only(), py::arg("dt_seconds") = 0.0,
          py::arg("previous") = py::none(),
          "Plans a frame of one view, or of two for stereo: pinholes. `previous` is the plan of the frame before, "
          "dt_seconds the time since. The first frame has no `previous`.");
}

}  // namespace ibr::python
