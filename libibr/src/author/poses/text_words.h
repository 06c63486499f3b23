// SPDX-License-Identifier: Apache-2.0
// Words of a text file, with checked numbers: Bundler, NVM.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace ibr {

/// Getters throw Error{invalidInput} with file, line and field, also where the text ends. The text must outlive it.
class TextWords {
 public:
  TextWords(const std::filesystem::path& file, std::string_view text) : file_(&file), text_(text) {}

  bool atEnd();                              // only blanks are left
  std::string_view word(const char* field);  // up to the next blank or line break
  std::string_view restOfLine();             // trimmed; empty at its end
  double real(const char* field);            // finite
  std::int64_t integer(const char* field, std::int64_t low, std::int64_t high);
  std::string where() const;                                  // "…/bundle.out:12", of the last word
  [[noreturn]] void fault(const std::string& message) const;  // "…/bundle.out:12: `message`"

 private:
  void skipBlanks(bool lineBreaks);

  const std::filesystem::path* file_;
  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

}  // namespace ibr
