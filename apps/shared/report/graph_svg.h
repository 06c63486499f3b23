// SPDX-License-Identifier: Apache-2.0
// The image graph as a drawing (SVG 1.1).
#pragma once

#include <string>

#include "ibr/advice.h"

namespace ibr::app {

/// Seen as graphView says: cameras as small frusta (panoramas as circles), cells as lines, triangles and tetrahedra
/// coloured by their score, photographs that no cell shows in grey with the reasons beside, a legend and a scale.
/// Photographs to add are numbered, neighbours that are too far apart or not joined have a dashed line between them,
/// and photographs with a trouble of their own by a circle. Names appear where one points at a camera. Valid XML
/// whatever the scene's texts are. Of any scene, an empty one too.
std::string graphSvg(const Scene& scene, const CaptureAdvice& advice = {});

}  // namespace ibr::app
