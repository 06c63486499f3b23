// SPDX-License-Identifier: Apache-2.0
#include "ibr/advice.h"

#include "runtime/bind.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {

void bindAdvice(py::module_& module) {
  Record<Advice>(module, "Advice", "A fault of a capture, and what to do.")
      .field("kind", &Advice::kind, "AdviceKind")
      .field("severity", &Advice::severity, "Severity")
      .field("problem", &Advice::problem, "Text for people")
      .field("remedy", &Advice::remedy, "Text for people")
      .field("nodes", &Advice::nodes, "Photographs concerned, indices into Scene.nodes")
      .field("value", &Advice::value, "Measure of the fault, by kind; NaN: none");
  Record<NextView>(module, "NextView", "A photograph to take.")
      .field("camera", &NextView::camera, "Camera")
      .field("reference_nodes", &NextView::referenceNodes, "Photographs that `where` refers to")
      .field("gain", &NextView::gain, "What the view adds to the share shown over a walk, > 0")
      .field("where", &NextView::where, "Text for people");
  Record<CaptureAdvice>(module, "CaptureAdvice", "Advice on a scene: advise_capture().")
      .field("advice", &CaptureAdvice::advice, "Tuple of Advice, most severe first")
      .field("views", &CaptureAdvice::views, "Tuple of NextView, best first")
      .field("coverage", &CaptureAdvice::coverage, "Mean share of an image that photographs show well, over a walk")
      .field("coverage_with_views", &CaptureAdvice::coverageWithViews, "The same, once `views` are photographed");
  module.def(
      "advise_capture",
      [](const Scene& scene, std::size_t views, bool readTextures) {
        return adviseCapture(scene, {.views = views, .readTextures = readTextures});
      },
      py::arg("scene"), py::kw_only(), py::arg("views") = 10, py::arg("read_textures") = true,
      py::call_guard<py::gil_scoped_release>(),
      "Faults of a capture, and the views to photograph next: at most `views`. read_textures: also finds blurred "
      "photographs.");
}

}  // namespace ibr::python
