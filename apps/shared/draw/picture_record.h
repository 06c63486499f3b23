// SPDX-License-Identifier: Apache-2.0
// Record of an image's view and settings inside its PNG file. The text chunk "ibr" holds
//   {"version":1,"libibr":"0.1.0","view":{"position":[x,y,z],"rotation":[x,y,z,w],
//    "intrinsics":{"model","width","height","fx","fy","cx","cy"},"time":s},"settings":{…}}
// with the effective settings under the names of their options; "time" for 3D video only. The scene's path is left out,
// so the same image gives the same file wherever the scene lies. An image of a path may depend on the frames before it,
// and an image of one eye on the other eye; the record leaves both out.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "shared/json/json_field.h"

namespace ibr::app {

struct PictureRecord {
  Camera camera;
  std::optional<double> time;       // s, for 3D video
  nlohmann::ordered_json settings;  // an object
};

/// Writes a PNG file with the record; the same image and record give the same bytes. Throws Error (writeImage).
void writePicture(const std::filesystem::path& file, const Image8& image, const PictureRecord& record);

/// Reads the record; nullopt for files without one, of other programs or formats. Throws Error (io, invalidInput) that
/// names file and field.
std::optional<PictureRecord> readRecord(const std::filesystem::path& file);

}  // namespace ibr::app
