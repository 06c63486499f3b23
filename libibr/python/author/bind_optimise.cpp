// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/optimise_scene.h"

#include "author/author_enums.h"
#include "author/bind.h"
#include "ibr/device.h"
#include "support/calls.h"
#include "support/record.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {
namespace {

OptimiseSceneReport optimised(const fs::path& scene, const fs::path& output, const AlignmentOptions& alignment,
                              const std::vector<std::size_t>& cells, int threads, const std::string& device,
                              const py::object& progress) {
  OptimiseSceneOptions options{.scene = scene, .output = output};
  options.cells.alignment = alignment;
  options.cells.cells = cells;
  options.cells.threads = threads;
  LongCall call(progress);
  return call.run([&](const ProgressCallback& report) {
    std::optional<Device> used;  // of this module's library, which the runtime's devices do not belong to
    if (alignment.method == AlignmentMethod::raster || alignment.method == AlignmentMethod::compute)
      used = Device::create({.device = device, .log = logToPython()});
    const Aligner aligner = [&](Alignment& cell, const AlignmentOptions& chosen, const ProgressCallback& inner) {
      return align(cell, chosen, used ? &*used : nullptr, inner);
    };
    return optimiseScene(options, aligner, report, logToPython());
  });
}

}  // namespace

void bindOptimise(py::module_& module) {
  using C = OptimisedCell;
  Record<C>(module, "OptimisedCell", "A cell that was optimised.")
      .field("cell", &C::cell, "Index into Scene.cells")
      .field("members", &C::members, "Tuple of names of photographs")
      .field("width", &C::width, "Of the first photograph, px")
      .field("height", &C::height, "Of the first photograph, px")
      .field("points", &C::points, "Number of points, without inserted ones")
      .field("evaluated", &C::evaluated, "Triangles whose ECC is optimised")
      .field("fixed", &C::fixed, "Points that must not move")
      .field("moved", &C::moved, "Points that moved")
      .field("flipped", &C::flipped, "Triangles with other corners")
      .field("inserted", &C::inserted, "Points that were inserted")
      .field("reverted", &C::reverted, "Points that were moved back")
      .field("summary", &C::summary, "AlignmentSummary")
      .field("seconds", &C::seconds, "s")
      .field("cached", &C::cached, "Read from the cache of a stopped run");
  Record<OptimiseSceneReport>(module, "OptimiseSceneReport", "Result of optimise_scene().")
      .field("cells", &OptimiseSceneReport::cells, "Tuple of OptimisedCell")
      .field("seconds", &OptimiseSceneReport::seconds, "s");
  module.def(
      "optimise_scene", &optimised, py::arg("scene"), py::arg("output"),
      py::arg("alignment") = AlignmentOptions{.method = AlignmentMethod::gradient}, py::kw_only(),
      py::arg("cells") = std::vector<std::size_t>(), py::arg("threads") = 0, py::arg("device") = "",
      py::arg("progress") = py::none(),
      "Aligns the photographs in the cells of a scene, and writes the scene to another folder. cells: indices; "
      "empty: all. device: selector, for AlignmentMethod.RASTER and COMPUTE. A run that was stopped resumes when "
      "it is called again. Returns an OptimiseSceneReport.");
}

}  // namespace ibr::python
