// SPDX-License-Identifier: Apache-2.0
// Template matching by exhaustive search over displacements ([H] Alg. 3): data of shader and caller, for GLSL and C++.
#ifndef IBR_SHARED_TEMPLATE_SEARCH_H
#define IBR_SHARED_TEMPLATE_SEARCH_H

#include "shared/glsl.h"

#ifdef __cplusplus
namespace ibr::shader {
using glm::ivec2;
}
#endif

IBR_SHARED_BEGIN

IBR_CONSTANT uint kTemplateGroup = 32u;  // lanes per task; each tries every 32nd displacement

IBR_CONSTANT uint kMeasureDifferences = 0u;
IBR_CONSTANT uint kMeasureCorrelation = 1u;

// Storage buffers.
IBR_CONSTANT int kBindingTemplateTexels = 0;    // uint: red, green, blue from the lowest bits; image by image
IBR_CONSTANT int kBindingTemplatePictures = 1;  // SearchPicture
IBR_CONSTANT int kBindingTemplateTasks = 2;     // SearchTask
IBR_CONSTANT int kBindingTemplateSamples = 3;   // uvec2: column and row, 16 bits each, signed; colour as a texel
IBR_CONSTANT int kBindingTemplateFound = 4;     // SearchFound, one per task
IBR_CONSTANT int kTemplateBindings = 5;

struct SearchPicture {
  ivec2 size;       // px
  uint firstTexel;  // row by row
};

struct SearchTask {
  uint picture;
  uint first, count;  // samples
  ivec2 start;        // px
};

struct SearchFound {
  uint cost;          // sum of absolute differences, or the bits of 1 − correlation
  uint displacement;  // row by row, of (2 radius + 1)²
};

struct SearchStep {  // push constants
  int radius;        // px
  uint measure;
};

IBR_SHARED_END

#endif
