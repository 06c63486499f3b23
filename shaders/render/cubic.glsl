// SPDX-License-Identifier: Apache-2.0

// Weights of four neighbouring texels at `t` beyond the second: Catmull-Rom, Keys 1981 with a = −1/2.
vec4 cubicWeights(float t) {
  return 0.5 * vec4(t * (t * (2.0 - t) - 1.0), t * t * (3.0 * t - 5.0) + 2.0, t * (t * (4.0 - 3.0 * t) + 1.0),
                    t * t * (t - 1.0));
}
