// SPDX-License-Identifier: Apache-2.0
// Held-out photographs and their poses, for `ibr eval`.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ibr/author/lens.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

class Truth {
 public:
  /// `folder` holds images/ (or the images themselves) and a COLMAP model in sparse/, sparse/0 or beside the images.
  /// `names` selects views; empty: all views with an image. Throws Error, also for an unknown name.
  Truth(const std::filesystem::path& folder, const std::vector<std::string>& names, const LogCallback& log);

  const std::vector<View>& views() const { return views_; }

  /// Returns the photograph, undistorted if its camera distorts. Throws Error{invalidInput} if the image does not have
  /// the camera's size: images are not resampled otherwise.
  Image8 picture(const View& view) const;

 private:
  std::filesystem::path images_;
  std::vector<View> views_;
  std::map<std::string, Lens> lenses_;  // by view name; distorted cameras only
};

/// Reads a view's exact depth: FOLDER/NAME.png of 16 bits, in steps of `unit` world units along the axis at pixel
/// centres; 0 is the sky. Throws Error (io, invalidInput) that names the file.
ImageF truthDepth(const std::filesystem::path& folder, const std::string& view, double unit);

}  // namespace ibr::app
