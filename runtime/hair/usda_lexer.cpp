#include "pelage/hair/usda_lexer.h"

#include <algorithm>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

constexpr std::string_view kSpace = " \t\r\n,";  // commas separate like space: nothing that is read depends on them
constexpr std::string_view kWordEnd = " \t\r\n,()[]{}=;\"'@<>#";

}  // namespace

UsdaLexer::UsdaLexer(std::string_view text, const std::string& where) : text_(text), where_(where) {
  ahead_ = cut();
}

void UsdaLexer::refuse(const std::string& what) const {
  throw InputError(where_, "USD text, line " + std::to_string(std::max<std::size_t>(last_.line, 1)) + ": " + what +
                               ": truncated or damaged; export it again");
}

UsdaToken UsdaLexer::next() {
  last_ = ahead_;
  ahead_ = cut();
  return last_;
}

UsdaToken UsdaLexer::next_inside() {
  if (ahead_.kind == UsdaToken::end) refuse("ends in the middle");
  return next();
}

void UsdaLexer::skip_value() {
  if (next_inside().opens()) skip_to_close();
}

void UsdaLexer::skip_value_and_metadata() {
  if (peek().is('=')) {
    next();
    skip_value();
  }
  if (peek().is('(')) skip_value();
}

void UsdaLexer::skip_to_close() {
  for (std::size_t depth = 1; depth > 0;) {
    const UsdaToken token = next_inside();
    depth += token.opens() ? 1U : 0U;
    depth -= token.closes() ? 1U : 0U;
  }
}

void UsdaLexer::read_numbers(std::vector<float>& values) {
  read_array(
      [&](std::string_view word) {
        const std::optional<float> value = parse_float(word);
        if (!value) refuse("\"" + std::string(word.substr(0, 40)) + "\" is no number");
        values.push_back(*value);
      },
      [&] { values.clear(); });
}

/// Past white space and comments.
void UsdaLexer::skip_space() noexcept {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (kSpace.find(c) != std::string_view::npos) {
      line_ += c == '\n' ? 1U : 0U;
      ++at_;
    } else {
      return;
    }
  }
}

UsdaToken UsdaLexer::token(UsdaToken::Kind kind, std::size_t begin, std::size_t end, std::size_t after) noexcept {
  const UsdaToken result{kind, text_.substr(begin, end - begin), line_};
  at_ = after;
  line_ += static_cast<std::size_t>(std::count(result.text.begin(), result.text.end(), '\n'));
  return result;
}

/// "...", '...', or in three quotes; assets @...@ and @@@...@@@ alike. A backslash takes the next character along.
UsdaToken UsdaLexer::cut_quoted(UsdaToken::Kind kind, char quote) {
  const std::string three(3, quote);
  const std::size_t width = text_.substr(at_).starts_with(three) ? 3 : 1;
  const std::size_t begin = at_ + width;
  for (std::size_t k = begin; k < text_.size(); ++k) {
    if (text_[k] == '\\') {
      ++k;
    } else if (text_[k] == quote && (width == 1 || text_.substr(k).starts_with(three))) {
      return token(kind, begin, k, k + width);
    }
  }
  refuse("a text in quotes without its end");
}

UsdaToken UsdaLexer::cut() {
  skip_space();
  if (at_ >= text_.size()) return {UsdaToken::end, {}, line_};
  const char c = text_[at_];
  if (c == '"' || c == '\'') return cut_quoted(UsdaToken::string, c);
  if (c == '@') return cut_quoted(UsdaToken::asset, c);
  if (c == '<') {
    const std::size_t end = text_.find('>', at_);
    if (end == std::string_view::npos) refuse("a path without its end");
    return token(UsdaToken::path, at_ + 1, end, end + 1);
  }
  if (std::string_view("()[]{}=;>").find(c) != std::string_view::npos) {
    return token(UsdaToken::mark, at_, at_ + 1, at_ + 1);
  }
  const std::size_t end = std::min(text_.find_first_of(kWordEnd, at_), text_.size());
  return token(UsdaToken::word, at_, end, end);
}

}  // namespace pelage::hair
