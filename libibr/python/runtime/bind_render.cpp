// SPDX-License-Identifier: Apache-2.0
#include "ibr/renderer.h"

#include "runtime/bind.h"
#include "runtime/scene_renderer.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

// Arrays of a frame's buffers; channels as in BufferTargets.
struct BufferArrays {
  py::array surface, weights, confidence;
};

auto channel(py::array BufferArrays::*array, int index) {
  return [array, index](const BufferArrays& self) {
    return py::object((self.*array).attr("__getitem__")(py::make_tuple(py::ellipsis(), index)));
  };
}

// The plan, or that of a camera alone. `alone` holds the latter.
const ScenePlan& planOf(const SceneRenderer& renderer, const py::object& view, std::optional<ScenePlan>& alone) {
  if (py::isinstance<ScenePlan>(view)) return view.cast<const ScenePlan&>();
  std::vector<Camera> cameras = camerasOf(view);
  return alone.emplace(
      unlocked([&] { return renderer.planner().plan(std::move(cameras), renderer.settings(), 0, nullptr); }));
}

void checkViews(const ScenePlan& plan, std::size_t count, const char* other) {
  if (plan.plan.views.size() != count)
    throw py::value_error(fmt::format("{} views: call {}", plan.plan.views.size(), other));
}

py::array renderedView(SceneRenderer& self, const py::object& view) {
  std::optional<ScenePlan> alone;
  const ScenePlan& plan = planOf(self, view, alone);
  checkViews(plan, 1, "render_stereo");
  return toArray(std::move(self.images(plan).front()));
}

py::tuple renderedPair(SceneRenderer& self, const py::object& views) {
  std::optional<ScenePlan> alone;
  const ScenePlan& plan = planOf(self, views, alone);
  checkViews(plan, 2, "render");
  std::vector<Image8> images = self.images(plan);
  return py::make_tuple(toArray(std::move(images[0])), toArray(std::move(images[1])));
}

BufferArrays buffersOf(SceneRenderer& self, const py::object& view, std::size_t index) {
  std::optional<ScenePlan> alone;
  FrameBuffers buffers = self.frameBuffers(planOf(self, view, alone), index);
  return {toArray(std::move(buffers.surface)), toArray(std::move(buffers.weights)),
          toArray(std::move(buffers.confidence))};
}

void bindBuffers(py::module_& module) {
  py::class_<BufferArrays>(module, "FrameBuffers",
                           "Per-pixel data of a frame, float32. The named arrays are views of `surface`, `weights` and "
                           "`confidence`.")
      .def_readonly("surface", &BufferArrays::surface, "(height, width, 4): depth, tier, rank, extrapolation")
      .def_readonly("weights", &BufferArrays::weights,
                    "(height, width, 4): weights of the members' colours, in the order of Cell.members; sum 1, or 0 "
                    "where nothing is drawn")
      .def_readonly("confidence", &BufferArrays::confidence, "(height, width, 2): spread, uncertainty")
      .def_property_readonly("depth", channel(&BufferArrays::surface, 0),
                             "Along the viewing axis, world units; infinity where unknown or nothing is drawn")
      .def_property_readonly("tier", channel(&BufferArrays::surface, 1),
                             "0 confirmed, 2 completed, 3 filled; -1 where nothing is drawn")
      .def_property_readonly("rank", channel(&BufferArrays::surface, 2),
                             "Of the cell in FramePlan.cells; -1 where the pixel is gathered or nothing is drawn")
      .def_property_readonly("extrapolation", channel(&BufferArrays::surface, 3),
                             "Distance of the view from the cell, world units")
      .def_property_readonly("spread", channel(&BufferArrays::confidence, 0),
                             "Standard deviation of the members' colours, 0 to 1")
      .def_property_readonly(
          "uncertainty", channel(&BufferArrays::confidence, 1),
          "Standard deviation of the inverse depth, 1 / world unit; infinity where nothing is drawn");
}

std::unique_ptr<SceneRenderer> makeRenderer(const std::shared_ptr<Scene>& scene, const std::pair<int, int>& size,
                                            const std::optional<RenderSettings>& settings, bool stereo, bool buffers,
                                            const DeviceChoice& device, std::uint64_t budgetBytes, TextureFilter filter,
                                            BlockTextureMode blocks) {
  if (size.first < 1 || size.second < 1) throw py::value_error("size: both sides must be at least 1 px");
  SceneRendererOptions options{.maxExtent = {std::uint32_t(size.first), std::uint32_t(size.second)},
                               .settings = settings,
                               .stereo = stereo,
                               .buffers = buffers,
                               .gpuScene = {.budgetBytes = budgetBytes, .blocks = blocks, .filter = filter}};
  return std::make_unique<SceneRenderer>(scene, device, options);
}

}  // namespace

void bindRender(py::module_& module) {
  bindBuffers(module);
  py::class_<SceneRenderer>(
      module, "Renderer",
      "A scene on a device, and its pictures as arrays. `size` is the largest width and height of a picture, px. "
      "Pictures of other settings than `settings` are possible as far as the renderer was made for them. `device` is a "
      "Device or its selector. budget_bytes limits the scene's device memory (0: no limit); what does not fit is "
      "streamed. Thread-safe; calls release the interpreter's lock. Arrays own their memory.")
      .def(py::init(&makeRenderer), py::arg("scene").none(false), py::arg("size"), py::arg("settings") = py::none(),
           py::kw_only(), py::arg("stereo") = false, py::arg("buffers") = false, py::arg("device") = "",
           py::arg("budget_bytes") = 0, py::arg("texture_filter") = TextureFilter::automatic,
           py::arg("block_textures") = BlockTextureMode::automatic)
      .def_property_readonly("settings", &SceneRenderer::settings,
                             "RenderSettings of cameras; by default Preset.BALANCED of the device's kind")
      .def_property_readonly("device", &SceneRenderer::device, "Device")
      .def_property_readonly("device_bytes", &SceneRenderer::deviceBytes, "Device memory of the scene")
      .def(
          "plan",
          [](const SceneRenderer& self, const py::object& views, const std::optional<RenderSettings>& settings,
             double dtSeconds, const ScenePlan* previous) {
            std::vector<Camera> cameras = camerasOf(views);
            return unlocked([&] {
              return self.planner().plan(std::move(cameras), settings.value_or(self.settings()), dtSeconds, previous);
            });
          },
          py::arg("views"), py::arg("settings") = py::none(), py::kw_only(), py::arg("dt_seconds") = 0.0,
          py::arg("previous") = py::none(), "Planner.plan() of the renderer's scene and settings.")
      .def("render", &renderedView, py::arg("view"),
           "Picture of a Camera, or of a FramePlan of one view: (height, width, 4), uint8, display-encoded RGBA. A "
           "camera is planned alone, without a frame before.")
      .def("render_stereo", &renderedPair, py::arg("views"),
           "Pictures of two cameras, or of a FramePlan of two views; as render(). Both share the draw order and the "
           "colours.")
      .def("buffers", &buffersOf, py::arg("view"), py::arg("index") = 0,
           "FrameBuffers of a view: a Camera, or view `index` of a FramePlan. Needs buffers=True.");
}

}  // namespace ibr::python
