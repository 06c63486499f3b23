// SPDX-License-Identifier: Apache-2.0
// Signs that a phone tracked the poses while it photographed. Such poses are less accurate than adjusted ones.
#pragma once

#include <filesystem>
#include <string_view>

namespace ibr {

/// True for a maker of phones, as EXIF's Make writes it, in any case of letters.
bool isPhoneMaker(std::string_view maker);

/// True for a transforms.json with depth maps of a sensor, as NeRFCapture writes it: integer_depth_scale, or depth_path
/// in the first frame. No key names the app. False for other files, and for those that cannot be read.
bool isPhoneAppFile(const std::filesystem::path& poses);

}  // namespace ibr
