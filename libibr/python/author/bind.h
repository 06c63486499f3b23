// SPDX-License-Identifier: Apache-2.0
// Parts of the module ibr.author._author, each for a group of public headers.
#pragma once

#include <pybind11/pybind11.h>

namespace ibr::python {

void bindPoses(pybind11::module_& module);        // author/poses.h, pose_refinement.h
void bindPhotographs(pybind11::module_& module);  // author/photographs.h, panorama.h
void bindBuild(pybind11::module_& module);        // author/build.h
void bindOptimise(pybind11::module_& module);     // author/optimise_scene.h
void bindHtmBuild(pybind11::module_& module);     // author/htm.h

}  // namespace ibr::python
