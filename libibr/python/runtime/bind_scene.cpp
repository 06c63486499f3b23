// SPDX-License-Identifier: Apache-2.0
#include "ibr/scene.h"

#include <limits>
#include <memory>

#include "ibr/asset.h"
#include "ibr/memory_demand.h"
#include "runtime/bind.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"
#include "support/sequence.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {
namespace {

// A vector of the mesh as a read-only array that keeps the mesh alive.
template <class T>
void meshArray(py::class_<MorphMesh>& type, const char* name, std::vector<T> MorphMesh::*values, const char* doc) {
  type.def_property_readonly(
      name, [values](const py::object& self) { return viewOf(self.cast<const MorphMesh&>().*values, self); }, doc);
}

// As meshArray; None where the mesh lacks the values.
template <class T>
void optionalArray(py::class_<MorphMesh>& type, const char* name, std::vector<T> MorphMesh::*values, const char* doc) {
  type.def_property_readonly(
      name,
      [values](const py::object& self) -> py::object {
        const std::vector<T>& all = self.cast<const MorphMesh&>().*values;
        if (all.empty()) return py::none();
        return viewOf(all, self);
      },
      doc);
}

template <class T>
void meshArrays(py::class_<MorphMesh>& type, const char* name, std::vector<std::vector<T>> MorphMesh::*values,
                const char* doc) {
  type.def_property_readonly(
      name, [values](const py::object& self) { return viewsOf(self.cast<const MorphMesh&>().*values, self); }, doc);
}

void bindMesh(py::module_& module) {
  py::class_<MorphMesh> mesh(module, "MorphMesh",
                             "A morphing mesh of d members, n vertices and m triangles. Arrays are read-only and not "
                             "copied. Member i sees vertex p in the direction of match[i][p] at the distance "
                             "ratio[i][p] / inverse_distance[p].");
  meshArrays(mesh, "match", &MorphMesh::match, "d arrays (n, 2), float32: px in the member's photograph");
  meshArrays(mesh, "ratio", &MorphMesh::ratio, "d arrays (n,), float32, > 0");
  meshArray(mesh, "inverse_distance", &MorphMesh::inverseDistance,
            "(n,), float32, >= 0, 1 / world unit; 0: at infinity");
  meshArray(mesh, "uncertainty", &MorphMesh::uncertainty, "(n,), float32: standard deviation of inverse_distance");
  optionalArray(mesh, "confirmations", &MorphMesh::confirmations,
                "(n,), uint8: number of photographs that confirm the depth; None: unknown");
  optionalArray(mesh, "consensus", &MorphMesh::consensus,
                "(n,), float32, 0 to 1: share of the photographs that confirm the depth; None: unknown");
  meshArray(mesh, "triangles", &MorphMesh::triangles, "(m, 3), uint32: indices of vertices; tier 0 first");
  meshArray(mesh, "tier", &MorphMesh::tier, "(m,), uint8: 0 consistent, 1 rejected");
  meshArray(mesh, "ecc", &MorphMesh::ecc, "(m,), float32, -1 to 1: lowest correlation of two members");
  optionalArray(mesh, "planes", &MorphMesh::planes,
                "(n, 4), uint16: planes of a vertex, from 1, filled up with 0; None: none");
  mesh.def_property_readonly("tier0_count", &MorphMesh::tier0Count, "Number of triangles of tier 0");
}

void bindNode(py::module_& module) {
  Record<CaptureMetadata>(module, "CaptureMetadata",
                          "Capture settings that a camera recorded (EXIF); 0 or empty: none.")
      .field("exposure_time", &CaptureMetadata::exposureTime, "s")
      .field("f_number", &CaptureMetadata::fNumber, "Focal length over aperture")
      .field("iso", &CaptureMetadata::iso, "Sensitivity, linear")
      .field("focal_length", &CaptureMetadata::focalLength, "mm")
      .field("focal_length_35", &CaptureMetadata::focalLength35, "mm, 35 mm equivalent")
      .field("maker", &CaptureMetadata::maker, "Maker of the camera")
      .field("model", &CaptureMetadata::model, "Model of the camera")
      .field("lens", &CaptureMetadata::lens, "Lens");
  Record<Node>(module, "Node", "A photograph of a scene. Paths are relative to the scene's folder; None: no such file.")
      .field("name", &Node::name, "The photograph's file name, unique in a scene")
      .field("camera", &Node::camera, "Camera of the undistorted photograph at its stored size")
      .field("image_file", &Node::imageFile, "JPEG or PNG")
      .field("texture_file", &Node::textureFile, "Baked KTX2 texture")
      .field("capture", &Node::capture, "CaptureMetadata")
      .field("gain", &Node::gain, "Factors of linear red, green, blue that match the other photographs' exposure")
      .field("mask_file", &Node::maskFile, "Grey PNG, 0 where the photograph must not be shown")
      .field("depth_file", &Node::depthFile, "Depth texture")
      .field("depth_scale", &Node::depthScale, "Inverse depth of a red of 1 in depth_file, 1 / world unit");
}

void bindCell(py::module_& module) {
  Record<CellQuality>(module, "CellQuality", "Quality of a cell, measured when it was built. NaN: not measured.")
      .field("coverage", &CellQuality::coverage, "Share of the members' mean image under triangles of tier 0, 0 to 1")
      .field("ecc", &CellQuality::ecc, "Mean correlation over tier 0, -1 to 1")
      .field("residual_px", &CellQuality::residualPx, "Median distance between match and projected point, px")
      .field("score", &CellQuality::score, "0 to 1");
  Record<Cell> cell(module, "Cell", "Two to four photographs joined by a mesh; a backdrop has one.");
  cell.field("members", &Cell::members, "Indices into Scene.nodes").field("quality", &Cell::quality, "CellQuality");
  cell.type().def_property_readonly(
      "mesh", [](const Cell& self) -> const MorphMesh& { return self.mesh; },
      py::return_value_policy::reference_internal, "MorphMesh");
}

// Positions of a cell's vertices; NaN at infinity.
py::array vertexPositions(const Scene& scene, std::size_t index) {
  if (index >= scene.cells.size()) throw py::index_error("cell: the scene has fewer cells");
  const Cell& cell = scene.cells[index];
  const auto count = py::ssize_t(cell.mesh.vertexCount());
  py::array_t<double> positions(std::vector<py::ssize_t>{count, 3});
  for (py::ssize_t p = 0; p < count; ++p) {
    const auto position = vertexPosition(scene, cell, std::size_t(p));
    for (glm::length_t c = 0; c < 3; ++c)
      positions.mutable_at(p, c) = position ? (*position)[c] : std::numeric_limits<double>::quiet_NaN();
  }
  return positions;
}

template <class T>
auto sequenceOf(std::vector<T> Scene::*elements) {
  return [elements](const py::object& self) { return Sequence<T>{&(self.cast<const Scene&>().*elements), self}; };
}

MemoryDemand memoryOf(const Scene& scene) {
  return memoryDemand(scene, textureFormats(scene), depthTextureBytes(scene));
}

}  // namespace

void bindScene(py::module_& module) {
  const auto released = py::call_guard<py::gil_scoped_release>();
  bindMesh(module);
  bindNode(module);
  bindCell(module);
  Record<UnusedPhotograph>(module, "UnusedPhotograph", "A photograph that no cell shows.")
      .field("name", &UnusedPhotograph::name, "Name of a node, or of a file without a pose")
      .field("reason", &UnusedPhotograph::reason, "Text for people");
  Record<Fault>(module, "Fault", "A fault of a scene or model.")
      .field("field", &Fault::field, "Field, or JSON pointer of a file")
      .field("message", &Fault::message, "The problem, with the value");
  Record<GeographicOrigin>(module, "GeographicOrigin", "Position of the world's origin on the Earth.")
      .field("latitude_degrees", &GeographicOrigin::latitudeDegrees, "degrees")
      .field("longitude_degrees", &GeographicOrigin::longitudeDegrees, "degrees")
      .field("height_metres", &GeographicOrigin::heightMetres, "m");
  Record<MemoryDemand>(module, "MemoryDemand", "Device memory of a scene, bytes.")
      .field("positions", &MemoryDemand::positions, "Vertices")
      .field("indices", &MemoryDemand::indices, "Triangles")
      .field("textures", &MemoryDemand::textures, "Photographs")
      .field("depth", &MemoryDemand::depth, "Depth textures")
      .type()
      .def_property_readonly("sum", &MemoryDemand::sum, "Total");
  defineSequence<Node>(module, "NodeSequence", "Sequence of Node.");
  defineSequence<Cell>(module, "CellSequence", "Sequence of Cell.");

  py::class_<Scene, std::shared_ptr<Scene>>(module, "Scene",
                                            "The image graph: photographs with poses, and cells that join them. "
                                            "Immutable; load_scene() reads one.")
      .def_property_readonly("nodes", sequenceOf(&Scene::nodes), "Sequence of Node: the photographs")
      .def_property_readonly("cells", sequenceOf(&Scene::cells), "Sequence of Cell")
      .def_property_readonly("backdrops", sequenceOf(&Scene::backdrops),
                             "Sequence of Cell with one member: depth meshes of single photographs")
      .def_property_readonly(
          "folder", [](const Scene& self) { return toPython(self.folder); }, "Base of the nodes' relative paths")
      .def_property_readonly(
          "unused_photographs", [](const Scene& self) { return toPython(self.unusedPhotographs); },
          "Tuple of UnusedPhotograph")
      .def_readonly("acquisition", &Scene::acquisition, "'ordered', 'unordered', 'synthetic', 'panoramic' or ''")
      .def_readonly("settings", &Scene::settings, "Settings of the build as JSON text; '' if none")
      .def_property_readonly(
          "origin", [](const Scene& self) { return toPython(self.origin); }, "GeographicOrigin or None")
      .def("vertex_positions", &vertexPositions, py::arg("cell"),
           "World positions of a cell's vertices: (n, 3), float64; NaN where a vertex is at infinity.")
      .def("__repr__", [](const Scene& self) {
        return fmt::format("<Scene of {} nodes, {} cells, {} backdrops>", self.nodes.size(), self.cells.size(),
                           self.backdrops.size());
      });

  module.def(
      "load_scene", [](const fs::path& path) { return std::make_shared<Scene>(loadScene(path)); }, py::arg("path"),
      released, "Reads a scene from its folder or its scene.gltf; opens no photographs and textures.");
  module.def(
      "copy_scene", [](const Scene& scene, const fs::path& folder) { saveSceneWithLinks(scene, folder); },
      py::arg("scene"), py::arg("folder"), released,
      "Writes a scene to another folder. Photographs, masks and textures become hard links, or copies where the file "
      "system has no links.");
  module.def(
      "validate",
      [](const Scene& scene, std::size_t limit) { return toPython(unlocked([&] { return validate(scene, limit); })); },
      py::arg("scene"), py::arg("limit") = 100, "Faults of a scene's data, as a tuple; opens no files.");
  module.def(
      "validate_scene_files",
      [](const fs::path& path, std::size_t limit) {
        return toPython(unlocked([&] { return validateSceneFiles(path, limit); }));
      },
      py::arg("path"), py::arg("limit") = 100,
      "Faults of a scene's files, as a tuple: also photographs, masks and textures that are missing or do not match.");
  module.def("memory_demand", &memoryOf, py::arg("scene"), released,
             "Device memory that a scene takes; reads the headers of its textures.");
  module.def("asset_kind", &assetKind, py::arg("path"),
             "AssetKind of a folder or file; None: no such kind, or not readable.");
}

}  // namespace ibr::python
