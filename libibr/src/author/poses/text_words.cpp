// SPDX-License-Identifier: Apache-2.0
#include "author/poses/text_words.h"

#include <algorithm>

#include "base/check.h"
#include "base/parse.h"

namespace ibr {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

}  // namespace

void TextWords::skipBlanks(bool lineBreaks) {
  for (; at_ < text_.size() && kBlanks.find(text_[at_]) != kBlanks.npos; ++at_) {
    if (text_[at_] != '\n') continue;
    if (!lineBreaks) return;
    ++line_;
  }
}

bool TextWords::atEnd() {
  skipBlanks(true);
  return at_ >= text_.size();
}

std::string_view TextWords::word(const char* field) {
  if (atEnd()) fault(std::string("the file ends before ") + field);
  const std::size_t end = std::min(text_.find_first_of(kBlanks, at_), text_.size());
  const std::string_view word = text_.substr(at_, end - at_);
  at_ = end;
  return word;
}

std::string_view TextWords::restOfLine() {
  skipBlanks(false);
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  const std::string_view rest = text_.substr(at_, end - at_);
  at_ = end;
  const std::size_t last = rest.find_last_not_of(kBlanks);
  return last == rest.npos ? std::string_view() : rest.substr(0, last + 1);
}

double TextWords::real(const char* field) {
  const std::string_view text = word(field);
  const auto value = parseDouble(text);
  if (!value) fault(fmt::format("{} \"{}\" is not a finite number", field, text.substr(0, 40)));
  return *value;
}

std::int64_t TextWords::integer(const char* field, std::int64_t low, std::int64_t high) {
  const std::string_view text = word(field);
  const auto value = parseInt(text);
  if (!value || *value < low || *value > high)
    fault(fmt::format("{} \"{}\" is not a whole number from {} to {}", field, text.substr(0, 40), low, high));
  return *value;
}

std::string TextWords::where() const {
  return fmt::format("{}:{}", file_->string(), line_);
}

void TextWords::fault(const std::string& message) const {
  fail(ErrorCode::invalidInput, "{}: {}", where(), message);
}

}  // namespace ibr
