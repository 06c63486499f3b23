// SPDX-License-Identifier: Apache-2.0
// Parts of the module ibr._runtime, each for a group of public headers.
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "ibr/camera.h"

namespace ibr::python {

void bindEnums(pybind11::module_& module);
void bindCamera(pybind11::module_& module);     // camera.h
void bindScene(pybind11::module_& module);      // scene.h, capture.h, asset.h, memory_demand.h
void bindAdvice(pybind11::module_& module);     // advice.h
void bindSettings(pybind11::module_& module);   // render_settings.h
void bindPlan(pybind11::module_& module);       // frame_plan.h
void bindDevice(pybind11::module_& module);     // device.h
void bindRender(pybind11::module_& module);     // renderer.h, gpu_scene.h, offscreen.h
void bindMetrics(pybind11::module_& module);    // metrics.h, view_scores.h
void bindHtm(pybind11::module_& module);        // htm_model.h, htm.h, htm_sequence.h
void bindOptimiser(pybind11::module_& module);  // optimiser.h

/// A camera, or a sequence of cameras. Throws TypeError for anything else.
std::vector<Camera> camerasOf(pybind11::handle views);

}  // namespace ibr::python
