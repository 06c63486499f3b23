// SPDX-License-Identifier: Apache-2.0
// Parameters of a view, for all stages of the gather.
#include "shared/gather.h"

layout(set = kSetGatherView, binding = kBindingGatherViews, scalar) readonly buffer Views { GatherView views[]; };
layout(push_constant, scalar) uniform Constants { GatherConstants c; };
