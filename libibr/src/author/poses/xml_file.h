// SPDX-License-Identifier: Apache-2.0
// An XML file with checked access: faults name the line and the elements above.
#pragma once

#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "ibr/error.h"

namespace ibr {

class XmlFile {
 public:
  /// Throws Error{invalidInput} with the line of a syntax error. No entities of a DTD are expanded.
  XmlFile(std::filesystem::path path, const std::string& text);

  pugi::xml_node root() const { return document_.document_element(); }

  /// The first child of this name; a missing one is a fault.
  pugi::xml_node child(pugi::xml_node parent, const char* name) const;
  std::string_view attribute(pugi::xml_node node, const char* name) const;
  /// Finite number of an attribute or of an element's text.
  double number(pugi::xml_node node, const char* attribute) const;
  double number(pugi::xml_node node) const;
  double numberOr(pugi::xml_node parent, const char* child, double otherwise) const;
  std::vector<double> numbers(pugi::xml_node node, std::string_view text, std::size_t count) const;
  int integer(pugi::xml_node node, const char* attribute, int low, int high) const;

  /// Throws Error with file, line, the node's path, and the message.
  [[noreturn]] void fault(pugi::xml_node node, const std::string& message,
                          ErrorCode code = ErrorCode::invalidInput) const;

 private:
  std::size_t lineOf(std::ptrdiff_t offset) const;

  std::filesystem::path path_;
  std::string text_;
  pugi::xml_document document_;
};

}  // namespace ibr
