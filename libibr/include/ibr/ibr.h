// SPDX-License-Identifier: Apache-2.0
// Everything of the runtime library. Authoring is in ibr/author.h.
#pragma once

#include "ibr/asset.h"
#include "ibr/camera.h"
#include "ibr/conventions.h"
#include "ibr/device.h"
#include "ibr/ecc_pass.h"
#include "ibr/error.h"
#include "ibr/gpu_scene.h"
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
#include "ibr/target.h"
#include "ibr/texture.h"
