// SPDX-License-Identifier: Apache-2.0
// The photographs whose poses COLMAP estimates, and the files that COLMAP reads of them: upright images and masks.
// Functions take indices into ColmapPhotographs::names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ibr/author/poses.h"
#include "ibr/log.h"
#include "io/image_file.h"

namespace ibr {

struct ColmapPhotographs {
  std::vector<std::string> names;    // relative to PoseOptions::photographs, with '/', sorted
  std::vector<ImageFileInfo> infos;  // one per name
};

/// Lists the photographs of options.photographs without the excluded ones, and reads their sizes and orientations.
/// Throws Error: invalidInput if there are too few, or if some cannot be read (all are named); io.
ColmapPhotographs colmapPhotographs(const PoseOptions& options);

/// Returns one line for the options that change results, then one line per photograph with its size, time and mask.
std::vector<std::string> colmapKeyLines(const PoseOptions& options, const ColmapPhotographs& photographs);

/// Returns the folder from which COLMAP reads the photographs: "upright" below options.folder if some are rotated by
/// EXIF or of a format that COLMAP does not read, else options.photographs.
std::filesystem::path colmapImageFolder(const PoseOptions& options, const ColmapPhotographs& photographs);

/// Decodes the photographs, which finds damaged files before hours of work, and fills the folder "upright" if
/// colmapImageFolder returns it. Throws Error: invalidInput that names all unreadable files; cancelled; io.
void checkColmapPhotographs(const PoseOptions& options, const ColmapPhotographs& photographs,
                            std::span<const std::size_t> indices, const ProgressCallback& progress);

/// Writes the masks of all photographs, oriented as the photographs that COLMAP reads, to the folder "masks" below
/// options.folder, under the names that COLMAP expects. Returns false if there are none. Throws Error: io; invalidInput
/// or unsupported for a mask that cannot be decoded.
bool writeColmapMasks(const PoseOptions& options, const ColmapPhotographs& photographs);

/// True if all these photographs, once upright, have the same size.
bool haveOneSize(const PoseOptions& options, const ColmapPhotographs& photographs,
                 std::span<const std::size_t> indices);

/// True if the photographs of each folder have one size, and not all photographs: each folder may be of one lens.
bool foldersHaveOneSize(const PoseOptions& options, const ColmapPhotographs& photographs,
                        std::span<const std::size_t> indices);

}  // namespace ibr
