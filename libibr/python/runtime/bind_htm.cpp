// SPDX-License-Identifier: Apache-2.0
#include "ibr/htm.h"

#include "ibr/htm_model.h"
#include "ibr/htm_sequence.h"
#include "runtime/bind.h"
#include "runtime/model_renderer.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"
#include "support/sequence.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {
namespace {

// (cameras, cameras, vertices, 2) over the model's memory; None where all are 0.
py::object complementsOf(const py::object& self) {
  const auto& model = self.cast<const HtmModel&>();
  if (model.complements.empty()) return py::none();
  const auto cameras = py::ssize_t(model.cameras.size()), vertices = py::ssize_t(model.vertexCount());
  return viewOf(model.complements, self).reshape({cameras, cameras, vertices, py::ssize_t(2)});
}

// Photograph, or photograph and visibility, as the Python function returned them.
HtmImage imageOfCamera(const py::object& made) {
  if (!py::isinstance<py::tuple>(made)) return {.photograph = colourOf(arrayOf(made, "photograph"), "photograph")};
  const auto pair = made.cast<py::tuple>();
  if (pair.size() != 2) throw py::value_error("pictures: must return a photograph, or (photograph, visibility)");
  return {.photograph = colourOf(arrayOf(pair[0], "photograph"), "photograph"),
          .visibility = maskOf(pair[1], "visibility")};
}

std::unique_ptr<ModelRenderer> makeRenderer(const std::shared_ptr<HtmModel>& model, const py::function& pictures,
                                            const DeviceChoice& device, std::optional<bool> trilinear) {
  const py::object given = py::cast(model);
  const HtmImageSource source = [&](const HtmModel&, std::size_t camera) {
    const py::gil_scoped_acquire locked;
    return imageOfCamera(pictures(given, camera));
  };
  return std::make_unique<ModelRenderer>(model, device, source, trilinear);
}

void bindModel(py::module_& module) {
  Record<HtmCamera>(module, "HtmCamera", "A camera of a harmonised model. Paths are relative to the model's folder.")
      .field("name", &HtmCamera::name, "Unique in a model")
      .field("camera", &HtmCamera::camera, "Camera of the undistorted picture at its stored size")
      .field("image_file", &HtmCamera::imageFile, "JPEG or PNG")
      .field("visibility_file", &HtmCamera::visibilityFile, "Grey PNG: 0 background to 255; None: 255 everywhere")
      .field("given", &HtmCamera::given, "The camera before its adjustment to the others; None: not adjusted");
  defineSequence<HtmCamera>(module, "HtmCameraSequence", "Sequence of HtmCamera.");

  py::class_<TriangleMesh>(module, "TriangleMesh", "A mesh. Arrays are read-only and not copied.")
      .def_property_readonly(
          "positions", [](const py::object& self) { return viewOf(self.cast<const TriangleMesh&>().positions, self); },
          "(n, 3), float64, world")
      .def_property_readonly(
          "triangles", [](const py::object& self) { return viewOf(self.cast<const TriangleMesh&>().triangles, self); },
          "(m, 3), uint32, counter-clockwise seen from outside");

  py::class_<HtmModel, std::shared_ptr<HtmModel>>(module, "HtmModel",
                                                  "A harmonised model: a mesh and its photographs. Immutable; "
                                                  "load_htm_model() reads one.")
      .def_property_readonly(
          "folder", [](const HtmModel& self) { return toPython(self.folder); }, "Base of the cameras' relative paths")
      .def_property_readonly(
          "cameras",
          [](const py::object& self) {
            return Sequence<HtmCamera>{&self.cast<const HtmModel&>().cameras, self};
          },
          "Sequence of HtmCamera")
      .def_property_readonly(
          "mesh", [](const HtmModel& self) -> const TriangleMesh& { return self.surface.mesh; },
          py::return_value_policy::reference_internal, "TriangleMesh: the optimised mesh")
      .def_property_readonly(
          "members", [](const py::object& self) { return viewOf(self.cast<const HtmModel&>().surface.members, self); },
          "(n,), uint64: bit i is set where camera i shows the vertex")
      .def_property_readonly("complements", &complementsOf,
                             "(cameras, cameras, vertices, 2), float32, px of the first camera's picture: offset of a "
                             "vertex there so that it shows what the second camera's picture shows; None: all 0")
      .def_property_readonly(
          "source_mesh", [](const HtmModel& self) { return self.source ? &self.source->mesh : nullptr; },
          py::return_value_policy::reference_internal, "TriangleMesh before optimisation, or None")
      .def_readonly("settings", &HtmModel::settings, "Settings of the build as JSON text; '' if none")
      .def("__repr__", [](const HtmModel& self) {
        return fmt::format("<HtmModel of {} cameras, {} vertices>", self.cameras.size(), self.vertexCount());
      });

  Record<HtmSequenceIndex>(module, "HtmSequenceIndex", "Index of a 3D video: load_htm_sequence().")
      .field("fps", &HtmSequenceIndex::fps, "Frames a second")
      .field("frames", &HtmSequenceIndex::frames, "Tuple of folders of models, relative to the index's folder");

  const auto released = py::call_guard<py::gil_scoped_release>();
  module.def(
      "load_htm_model", [](const fs::path& path) { return std::make_shared<HtmModel>(loadHtmModel(path)); },
      py::arg("path"), released, "Reads a harmonised model from its folder or its model.gltf; opens no pictures.");
  module.def("load_htm_sequence", &loadHtmSequence, py::arg("path"), released,
             "Reads the index of a 3D video from its folder or its sequence.json.");
  module.def(
      "unoptimised_htm_model",
      [](const HtmModel& model) { return std::make_shared<HtmModel>(unoptimisedModel(model)); }, py::arg("model"),
      released, "The model before optimisation, to compare with: the source mesh, no complements.");
  module.def(
      "validate_htm_model",
      [](const HtmModel& model, std::size_t limit) {
        return toPython(unlocked([&] { return validate(model, limit); }));
      },
      py::arg("model"), py::arg("limit") = 100, "Faults of a model's data, as a tuple; opens no files.");
  module.def(
      "validate_htm_model_files",
      [](const fs::path& path, std::size_t limit) {
        return toPython(unlocked([&] { return validateHtmModelFiles(path, limit); }));
      },
      py::arg("path"), py::arg("limit") = 100, "Faults of a model's files, as a tuple.");
}

}  // namespace

void bindHtm(py::module_& module) {
  bindModel(module);
  using S = HtmSettings;
  Record<S>(module, "HtmSettings", "How a harmonised model is drawn.")
      .field("gamma", &S::gamma, "Preference for cameras that look in the view's direction, 1 to 1000")
      .field("method", &S::method, "HtmMethod")
      .field("direction", &S::direction, "HtmDirection")
      .field("weight_cut", &S::weightCut, "Share of the weights below which the remaining cameras are left out")
      .field("depth_tolerance", &S::depthTolerance, "Of the mesh's radius, > 0")
      .field("smoothing_seconds", &S::smoothingSeconds, "Time constant with which weights follow the view, s")
      .field("exclude", &S::exclude, "Bit i is set: camera i is not used")
      .field("background", &S::background, "Display-encoded red, green, blue, 0 to 1, where nothing is drawn")
      .constructible();
  Record<PlannedHtmCamera>(module, "PlannedHtmCamera", "A camera that a frame uses.")
      .field("camera", &PlannedHtmCamera::camera, "Index into HtmModel.cameras")
      .field("log_weight", &PlannedHtmCamera::logWeight, "Natural logarithm of its weight over the best camera's")
      .field("log_remaining_weight", &PlannedHtmCamera::logRemainingWeight, "Likewise, of all later cameras together");
  py::class_<ModelPlan>(module, "HtmFramePlan", "One frame of a harmonised model: HtmRenderer.plan().")
      .def_property_readonly(
          "view", [](const ModelPlan& self) { return self.plan.view; }, "Camera")
      .def_property_readonly(
          "settings", [](const ModelPlan& self) { return self.plan.settings; }, "HtmSettings")
      .def_property_readonly(
          "cameras", [](const ModelPlan& self) { return toPython(self.plan.cameras); },
          "Tuple of PlannedHtmCamera, best first");

  py::class_<ModelRenderer>(
      module, "HtmRenderer",
      "A harmonised model on a device, and its pictures as arrays. `pictures` is a function of (model, index) that "
      "returns a camera's photograph, or (photograph, visibility): (height, width, 3 or 4) and (height, width), uint8; "
      "ibr.author.read_htm_picture reads the model's files. Otherwise as Renderer.")
      .def(py::init(&makeRenderer), py::arg("model").none(false), py::arg("pictures"), py::kw_only(),
           py::arg("device") = "", py::arg("trilinear") = py::none())
      .def_property_readonly("device", &ModelRenderer::device, "Device")
      .def("plan", &ModelRenderer::plan, py::arg("view"), py::arg("settings") = HtmSettings(), py::kw_only(),
           py::arg("dt_seconds") = 0.0, py::arg("previous") = py::none(),
           "Plans a frame of a pinhole. `previous` is the plan of the frame before, dt_seconds the time since.")
      .def(
          "render", [](ModelRenderer& self, const ModelPlan& plan) { return toArray(self.image(plan)); },
          py::arg("view"))
      .def(
          "render",
          [](ModelRenderer& self, const Camera& view) {
            return toArray(self.image(self.plan(view, HtmSettings(), 0, nullptr)));
          },
          py::arg("view"),
          "Picture of a Camera with the default settings, or of an HtmFramePlan: (height, width, 4), uint8; alpha 0 "
          "where nothing is drawn.");
}

}  // namespace ibr::python
