// SPDX-License-Identifier: Apache-2.0
#include "author/poses/phone_poses.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/file.h"
#include "ibr/error.h"
#include "scene/json_check.h"

namespace ibr {
namespace {

// Lower case. Makers of phones and of other cameras (Sony, Panasonic) are left out.
constexpr std::array<std::string_view, 17> kPhoneMakers{
    "apple", "samsung", "google",  "xiaomi",   "redmi", "huawei",         "honor",      "oneplus",  "oppo",
    "vivo",  "realme",  "nothing", "motorola", "lge",   "lg electronics", "hmd global", "fairphone"};

}  // namespace

bool isPhoneMaker(std::string_view maker) {
  std::string lower(maker);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return std::ranges::any_of(kPhoneMakers, [&](std::string_view phone) {  // "samsung Electronics", but not "Applebee"
    return lower.starts_with(phone) && (lower.size() == phone.size() || lower[phone.size()] == ' ');
  });
}

bool isPhoneAppFile(const std::filesystem::path& poses) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(poses, ignored)) return false;
  try {
    const std::string text = readTextFile(poses);
    const std::size_t start = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    if (start == text.npos || text[start] != '{') return false;
    const nlohmann::json json = parseJson(std::string_view(text).substr(start));
    const auto frames = json.find("frames");
    if (frames == json.end() || !frames->is_array() || frames->empty()) return false;
    return json.contains("integer_depth_scale") ||
           (frames->front().is_object() && frames->front().contains("depth_path"));
  } catch (const Error&) {
    return false;
  } catch (const JsonFault&) {
    return false;
  }
}

}  // namespace ibr
