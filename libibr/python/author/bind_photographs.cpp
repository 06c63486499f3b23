// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/photographs.h"

#include "author/author_enums.h"
#include "author/bind.h"
#include "ibr/author/build.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {
namespace {

std::size_t indexOf(const PosedPhotographs& photographs, std::size_t image) {
  if (image >= photographs.images().size()) throw py::index_error("image: there are fewer photographs");
  return image;
}

void bindPanoramas(py::module_& module) {
  using O = SplitOptions;
  Record<O>(module, "SplitOptions", "Options of split_panoramas().")
      .field("input", &O::input, "A panorama at the origin; with model: folder of its images")
      .field("model", &O::model, "Poses, for read_pose_file(), or None")
      .field("output", &O::output, "Created if missing; gets images/ and sparse/")
      .field("views", &O::views, "Number of views around the horizon; 0: cube faces")
      .field("poles", &O::poles, "Adds the faces up and down to views around the horizon")
      .field("fov_degrees", &O::fovDegrees, "Field of view of a face, degrees")
      .field("size", &O::size, "Of a face, px; 0: the panorama's resolution")
      .field("format", &O::format, "ImageFileFormat")
      .field("threads", &O::threads, "0: all cores")
      .constructible();
  using R = SplitReport;
  Record<R>(module, "SplitReport", "Result of split_panoramas().")
      .field("panoramas", &R::panoramas, "Number of panoramas")
      .field("pictures", &R::pictures, "Number of faces written")
      .field("observations", &R::observations, "Of tracks, in the faces")
      .field("skipped", &R::skipped, "Tuple of the model's images that are no panoramas")
      .field("size", &R::size, "Of the last panorama's faces, px")
      .field("seconds", &R::seconds, "s");
  module.def(
      "split_panoramas",
      [](const SplitOptions& options, const py::object& progress) {
        LongCall call(progress);
        return call.run([&](const ProgressCallback& report) { return splitPanoramas(options, report, logToPython()); });
      },
      py::arg("options"), py::kw_only(), py::arg("progress") = py::none(),
      "Writes pinhole images of panoramas, and their cameras as a COLMAP model.");
}

}  // namespace

void bindPhotographs(py::module_& module) {
  bindPanoramas(module);
  using F = PhotographFolder;
  Record<F::UnreadableFile>(module, "UnreadableFile", "A photograph that cannot be read.")
      .field("name", &F::UnreadableFile::name, "Relative to the folder")
      .field("reason", &F::UnreadableFile::reason, "The fault, and what to do");
  Record<F>(module, "PhotographFolder", "Photographs in a folder: scan_photograph_folder().")
      .field("pictures", &F::pictures, "Tuple of names, relative to the folder, sorted")
      .field("unreadable", &F::unreadable, "Tuple of UnreadableFile")
      .field("videos", &F::videos, "Tuple of names, without videos beside a photograph of the same name")
      .field("doubles", &F::doubles, "Number of files left out beside photographs of the same name")
      .field("others", &F::others, "Number of files of other kinds");

  py::class_<PosedPhotographs>(
      module, "PosedPhotographs",
      "The photographs that build(options) would store, at their stored size: undistorted, with "
      "their cameras. The options must name poses; nothing is written. Thread-safe.")
      .def(py::init([](const BuildOptions& options) {
             return unlocked([&] { return std::make_unique<PosedPhotographs>(options, logToPython()); });
           }),
           py::arg("options"))
      .def_property_readonly(
          "images", [](const PosedPhotographs& self) { return toPython(self.images()); },
          "Tuple of PosedImage, sorted by name")
      .def(
          "photograph",
          [](const PosedPhotographs& self, std::size_t image) {
            return toArray(unlocked([&, i = indexOf(self, image)] { return self.photograph(i); }));
          },
          py::arg("image"), "(height, width, 3), uint8, of the camera's size.")
      .def(
          "mask",
          [](const PosedPhotographs& self, std::size_t image) -> py::object {
            Image8 mask = unlocked([&, i = indexOf(self, image)] { return self.mask(i); });
            if (mask.empty()) return py::none();
            return toArray(std::move(mask));
          },
          py::arg("image"), "(height, width), uint8, 0 or 255; None: no mask.");

  module.def("scan_photograph_folder", &scanPhotographFolder, py::arg("folder"),
             py::call_guard<py::gil_scoped_release>(), "Finds the photographs of a folder and its subfolders.");
  module.def(
      "read_picture", [](const fs::path& file) { return toArray(unlocked([&] { return readPicture(file); })); },
      py::arg("file"),
      "Reads a photograph as stored: (height, width, 3), uint8, sRGB. EXIF's orientation is not applied.");
}

}  // namespace ibr::python
