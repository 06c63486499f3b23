// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/poses.h"

#include "author/author_enums.h"
#include "author/bind.h"
#include "ibr/author/pose_refinement.h"
#include "support/calls.h"
#include "support/record.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {
namespace {

py::array trackPositions(const PosedModel& model) {
  py::array_t<double> positions(std::vector<py::ssize_t>{py::ssize_t(model.tracks.size()), 3});
  for (std::size_t i = 0; i < model.tracks.size(); ++i)
    for (glm::length_t c = 0; c < 3; ++c) positions.mutable_at(i, c) = model.tracks[i].position[c];
  return positions;
}

void bindRefinement(py::module_& module) {
  using R = PoseRefinement;
  Record<R::Errors>(module, "ReprojectionErrors", "Reprojection errors of held-out points, px.")
      .field("median_px", &R::Errors::medianPx, "Median")
      .field("p90_px", &R::Errors::p90Px, "90 % quantile");
  Record<R::PoseChange>(module, "PoseChange", "Change of a photograph's camera.")
      .field("photograph", &R::PoseChange::photograph, "Name")
      .field("rotation_px", &R::PoseChange::rotationPx, "Angle of rotation times focal length, px")
      .field("shift", &R::PoseChange::shift, "Of the position, world units")
      .field("focal_factor", &R::PoseChange::focalFactor, "New focal length over the old one");
  Record<R::Step>(module, "RefinementStep", "A step of a refinement, compared with the last step accepted.")
      .field("description", &R::Step::description, "Text for people")
      .field("cells_gain_sigmas", &R::Step::cellsGainSigmas, "Better fit of the cells' points, standard errors")
      .field("model_gain_sigmas", &R::Step::modelGainSigmas, "Better fit of the model's points, standard errors")
      .field("accepted", &R::Step::accepted, "The step was accepted");
  Record<R>(module, "PoseRefinement", "Report of a pose refinement.")
      .field("cell_tracks", &R::cellTracks, "Points of the cells")
      .field("model_tracks", &R::modelTracks, "Points of the model")
      .field("steps", &R::steps, "Tuple of RefinementStep")
      .field("initial_errors", &R::initialErrors, "ReprojectionErrors")
      .field("final_errors", &R::finalErrors, "ReprojectionErrors")
      .field("pose_changes", &R::poseChanges, "Tuple of PoseChange; empty: poses are unchanged");
}

}  // namespace

void bindPoses(py::module_& module) {
  bindRefinement(module);
  Record<PosedImage> image(module, "PosedImage", "An image of a pose estimator's model.");
  image.field("name", &PosedImage::name, "As in the model, with '/' after folders")
      .field("camera", &PosedImage::camera, "Camera of the undistorted photograph")
      .constructible();
  image.type().def_property_readonly(
      "distorted", [](const PosedImage& self) { return self.lens.has_value(); },
      "The photograph's file has lens distortion");
  py::class_<PosedModel>(module, "PosedModel", "Posed images, sorted by name, and the points that they share.")
      .def(py::init([](const std::vector<PosedImage>& images) {
             return PosedModel{images, {}};
           }),
           py::arg("images"))
      .def_property_readonly(
          "images", [](const PosedModel& self) { return toPython(self.images); }, "Tuple of PosedImage")
      .def_property_readonly("track_positions", &trackPositions,
                             "World positions of the shared points: (n, 3), float64");

  const auto released = py::call_guard<py::gil_scoped_release>();
  module.def(
      "read_pose_file",
      [](const fs::path& path, const std::optional<fs::path>& photographs) {
        return readPoseFile(path, photographs.value_or(fs::path()), logToPython());
      },
      py::arg("path"), py::arg("photographs") = py::none(), released,
      "Reads poses in any format, recognised by content. Names are paths below `photographs`, else the file's.");
  module.def(
      "read_colmap_model", [](const fs::path& folder) { return readColmapModel(folder, logToPython()); },
      py::arg("folder"), released, "Reads a COLMAP model (text or binary) from a folder.");
  module.def(
      "read_transforms",
      [](const fs::path& file, const std::optional<fs::path>& photographs) {
        return readTransforms(file, photographs.value_or(fs::path()));
      },
      py::arg("file"), py::arg("photographs") = py::none(), released,
      "Reads transforms.json of nerfstudio or instant-ngp. Names are paths below `photographs`, else file_path.");
  module.def("read_panoramas", &readPanoramas, py::arg("file"), released,
             "Reads the poses of equirectangular panoramas from a JSON file.");
  module.def("write_colmap_model", &writeColmapModel, py::arg("model"), py::arg("folder"), released,
             "Writes a COLMAP text model; creates the folder if missing.");
}

}  // namespace ibr::python
