// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "scene/scene_file.h"

namespace ibr {
namespace {

bool plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~/").find(c) != std::string_view::npos;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::string encodeUri(const std::filesystem::path& relative) {
  std::string uri;
  for (const char c : relative.generic_string())
    uri += plain(c) ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return uri;
}

std::string decodeUri(std::string_view uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == ':' || uri[i] == '\\') return {};  // a scheme or a drive
    if (uri[i] != '%') {
      path += uri[i];
      continue;
    }
    const int high = i + 2 < uri.size() ? hexDigit(uri[i + 1]) : -1, low = high >= 0 ? hexDigit(uri[i + 2]) : -1;
    if (low < 0 || (high == 0 && low == 0)) return {};
    path += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return path.starts_with('/') ? std::string() : path;
}

}  // namespace ibr
