// SPDX-License-Identifier: Apache-2.0
// The image graph as a drawing (SVG 1.1).
#pragma once

#include <string>

#include "ibr/advice.h"

namespace ibr::app {

/// Draws the scene in the projection of graphView. Cameras are small frusta, panoramas circles. Cells are lines,
/// triangles and tetrahedra coloured by their score. Photographs without a cell are grey, with the reasons beside.
/// Photographs to add are numbered. Dashed lines join neighbours that are too far apart or not connected. Photographs
/// with a problem of their own are circled. Names appear when the pointer is over a camera. The XML is valid for any
/// text in the scene. Accepts any scene, an empty one too.
std::string graphSvg(const Scene& scene, const CaptureAdvice& advice = {});

}  // namespace ibr::app
