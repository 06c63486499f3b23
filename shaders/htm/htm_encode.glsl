// SPDX-License-Identifier: Apache-2.0
// What a target's format makes of display-encoded values.

layout(constant_id = 0) const bool kEncodedByTarget = false;  // an SRGB format

vec3 htmEncode(vec3 encoded) {  // IEC 61966-2-1, undone
  if (!kEncodedByTarget) return encoded;
  return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}
