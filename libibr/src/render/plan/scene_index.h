// SPDX-License-Identifier: Apache-2.0
// Trees over a scene's cells and photographs, in which planning looks up those near a view; made by sceneBounds.
#pragma once

#include "render/photographs/photograph_index.h"
#include "render/plan/cell_index.h"

namespace ibr {

struct SceneBounds::Index {
  CellIndex cells;
  PhotographIndex photographs;
  bool masked = false;  // any photograph has a mask
};

}  // namespace ibr
