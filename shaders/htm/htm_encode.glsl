// SPDX-License-Identifier: Apache-2.0
// Converts display-encoded values to the output that the target's format and encoding expect.

layout(constant_id = 0) const bool kLinear = false;  // the target takes linear light, also to encode it itself

vec3 htmEncode(vec3 encoded) {  // inverse of IEC 61966-2-1
  if (!kLinear) return encoded;
  return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}
