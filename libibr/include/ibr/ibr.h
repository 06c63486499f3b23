// SPDX-License-Identifier: Apache-2.0
// Includes the runtime library, without memory_demand.h, template_search.h and template_search_pass.h.
#pragma once

#include "ibr/advice.h"
#include "ibr/asset.h"
#include "ibr/camera.h"
#include "ibr/capture.h"
#include "ibr/conventions.h"
#include "ibr/device.h"
#include "ibr/device_memory.h"
#include "ibr/ecc_pass.h"
#include "ibr/error.h"
#include "ibr/export.h"
#include "ibr/gpu_scene.h"
#include "ibr/graph_overlay.h"
#include "ibr/htm.h"
#include "ibr/htm_model.h"
#include "ibr/htm_sequence.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "ibr/metrics.h"
#include "ibr/offscreen.h"
#include "ibr/optimiser.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "ibr/scene.h"
#include "ibr/shader_reload.h"
#include "ibr/target.h"
#include "ibr/texture.h"
#include "ibr/uploads.h"
#include "ibr/version.h"
#include "ibr/view_scores.h"

/// @namespace ibr
/// Image-based rendering: builds scenes from posed photographs, and renders new views of them.
///
/// A Scene is a graph of photographs. planFrame() plans a view, and a Renderer records the plan into a Vulkan command
/// buffer. build() makes a scene from photographs and poses. harmonise() makes an HtmModel from photographs and a mesh;
/// planHtmFrame() and HtmRenderer show the model. Axes, pixels and colours: ibr/conventions.h.
