// SPDX-License-Identifier: Apache-2.0
// What a picture was made from, inside its PNG file: a text "ibr", which holds
//   {"version":1,"libibr":"0.1.0","view":{"position":[x,y,z],"rotation":[x,y,z,w],"intrinsics":{"model","width","height",
//    "fx","fy","cx","cy"},"time":s},"settings":{…}}
// with the effective settings under the names of their options, and "time" of 3D video only. What was drawn is not
// told: the same picture is the same file wherever its scene lies. That of a path's frame may also depend on the frames
// before it, and that of one eye on the other; this is not told either.
#pragma once

#include <filesystem>
#include <optional>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "shared/camera/json_field.h"

namespace ibr::app {

struct PictureRecord {
  Camera camera;
  std::optional<double> time;       // s, of 3D video
  nlohmann::ordered_json settings;  // an object
};

/// A PNG file with the record inside: the same picture and record give the same bytes. Throws Error (writeImage).
void writePicture(const std::filesystem::path& file, const Image8& image, const PictureRecord& record);

/// nullopt where there is none: a picture of another program, or of another format. Throws Error (io, invalidInput)
/// that names file and field.
std::optional<PictureRecord> readRecord(const std::filesystem::path& file);

}  // namespace ibr::app
