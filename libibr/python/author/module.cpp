// SPDX-License-Identifier: Apache-2.0
// The Python module ibr.author._author.
#include "author/author_enums.h"
#include "author/bind.h"
#include "support/errors.h"

PYBIND11_MODULE(_author, module) {
  using namespace ibr::python;
  pybind11::module_::import("ibr._runtime");  // registers the types that both modules use
  module.doc() = "The author of libibr; import it as ibr.author.";
  translateErrors();
  defineEnum<ibr::TrackSource>(
      module,
      "Source of points that photographs share. AUTOMATIC: the model, and own features where the "
      "model has few points.");
  defineEnum<ibr::RefinePoses>(module,
                               "Refinement of poses. AUTOMATIC: ON for poses without tracks that come from a phone.");
  defineEnum<ibr::MatchMethod>(
      module, "Method that matches a cell. AUTOMATIC: SWEEP where poses reproject within 1 px, else FLOW.");
  defineEnum<ibr::DepthSearch>(module, "Depth search in photographs, from the fastest to the most accurate.");
  defineEnum<ibr::TriangleFilter>(module, "Filter that selects a cell's triangles of tier 0.");
  defineEnum<ibr::Orientation>(module, "Orientation of photographs in their files, relative to the model's cameras.");
  defineEnum<ibr::ImageFileFormat>(module, "Format of image files. AS_SOURCE: JPEG for a JPEG, else PNG.");
  defineEnum<ibr::TemplateMeasure>(module, "Dissimilarity of a template and a picture.");
  bindPoses(module);
  bindPhotographs(module);
  bindBuild(module);
  bindOptimise(module);
  bindHtmBuild(module);
}
