// SPDX-License-Identifier: Apache-2.0
#include "author/poses/xml_file.h"

#include <algorithm>

#include "base/check.h"
#include "base/parse.h"

namespace ibr {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

XmlFile::XmlFile(std::filesystem::path path, const std::string& text) : path_(std::move(path)), text_(text) {
  const pugi::xml_parse_result result =
      document_.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
  check(bool(result), ErrorCode::invalidInput, "{}:{}: is not valid XML: {}", path_.string(), lineOf(result.offset),
        result.description());
}

std::size_t XmlFile::lineOf(std::ptrdiff_t offset) const {
  const auto end = text_.begin() + std::clamp(offset, std::ptrdiff_t(0), std::ptrdiff_t(text_.size()));
  return std::size_t(std::count(text_.begin(), end, '\n')) + 1;
}

pugi::xml_node XmlFile::child(pugi::xml_node parent, const char* name) const {
  const pugi::xml_node found = parent.child(name);
  if (!found) fault(parent, fmt::format("has no <{}>", name));
  return found;
}

std::string_view XmlFile::attribute(pugi::xml_node node, const char* name) const {
  const pugi::xml_attribute found = node.attribute(name);
  if (!found) fault(node, fmt::format("has no attribute {}", name));
  return found.value();
}

std::vector<double> XmlFile::numbers(pugi::xml_node node, std::string_view text, std::size_t count) const {
  std::vector<double> values;
  for (std::string_view rest = trimmed(text); !rest.empty();) {
    const std::size_t end = std::min(rest.find_first_of(kBlanks), rest.size());
    const auto value = parseDouble(rest.substr(0, end));
    if (!value)
      fault(node, fmt::format("\"{}\" is not a finite number", rest.substr(0, std::min(end, std::size_t(40)))));
    if (values.size() == count) fault(node, fmt::format("has more than {} numbers", count));
    values.push_back(*value);
    rest = trimmed(rest.substr(end));
  }
  if (values.size() != count) fault(node, fmt::format("has {} numbers, not {}", values.size(), count));
  return values;
}

double XmlFile::number(pugi::xml_node node, const char* name) const {
  const auto value = parseDouble(trimmed(attribute(node, name)));
  if (!value)
    fault(node, fmt::format("attribute {} \"{}\" is not a finite number", name, attribute(node, name).substr(0, 40)));
  return *value;
}

double XmlFile::number(pugi::xml_node node) const {
  return numbers(node, node.child_value(), 1)[0];
}

double XmlFile::numberOr(pugi::xml_node parent, const char* name, double otherwise) const {
  const pugi::xml_node found = parent.child(name);
  return found ? number(found) : otherwise;
}

int XmlFile::integer(pugi::xml_node node, const char* name, int low, int high) const {
  const auto value = parseInt(trimmed(attribute(node, name)));
  if (!value || *value < low || *value > high)
    fault(node, fmt::format("attribute {} \"{}\" is not a whole number from {} to {}", name,
                            attribute(node, name).substr(0, 40), low, high));
  return int(*value);
}

void XmlFile::fault(pugi::xml_node node, const std::string& message, ErrorCode code) const {
  std::string where = node.name();
  for (pugi::xml_node up = node.parent(); up && *up.name(); up = up.parent())
    where = std::string(up.name()) + "/" + where;
  fail(code, "{}:{}: {}: {}", path_.string(), lineOf(node.offset_debug()), where, message);
}

}  // namespace ibr
