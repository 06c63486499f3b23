// SPDX-License-Identifier: Apache-2.0
// Held-out photographs and their poses, for `ibr eval`.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "ibr/lens.h"
#include "ibr/log.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

class Truth {
 public:
  /// `folder` holds images/ (or the images themselves) and a COLMAP model in sparse/, sparse/0 or beside the images.
  /// `names` chooses views; empty: all whose image is there. Throws Error, also for a name that is not there.
  Truth(const std::filesystem::path& folder, const std::vector<std::string>& names, const LogCallback& log);

  const std::vector<View>& views() const { return views_; }

  /// The photograph, undistorted where its camera distorts. Throws Error{invalidInput} where the picture has not its
  /// camera's size: nothing else is resampled.
  Image8 picture(const View& view) const;

 private:
  std::filesystem::path images_;
  std::vector<View> views_;
  std::map<std::string, Lens> lenses_;  // by the views' names; of those that distort
};

/// Exact depth of a view: FOLDER/NAME.png of 16 bits, in steps of `unit` world units along the axis at pixel centres;
/// 0 stands for the sky. Throws Error (io, invalidInput) that names the file.
ImageF truthDepth(const std::filesystem::path& folder, const std::string& view, double unit);

}  // namespace ibr::app
