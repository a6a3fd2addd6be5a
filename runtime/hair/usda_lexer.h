// Private to this box: USD text cut into tokens. One token of look-ahead; brackets are counted, never recursed into.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pelage::hair {

struct UsdaToken {
  enum Kind { end, word, string, asset, path, mark } kind = end;  // word: names, numbers, with : and . in them
  std::string_view text{};                                        // without quotes
  std::size_t line = 0;

  bool is(char c) const noexcept { return kind == mark && text.front() == c; }
  bool is_word(std::string_view w) const noexcept { return kind == word && text == w; }
  bool opens() const noexcept { return is('(') || is('[') || is('{'); }
  bool closes() const noexcept { return is(')') || is(']') || is('}'); }
};

class UsdaLexer {
 public:
  /// `text` and `where` must outlive it.
  UsdaLexer(std::string_view text, const std::string& where);

  const UsdaToken& peek() const noexcept { return ahead_; }
  const UsdaToken& last() const noexcept { return last_; }
  UsdaToken next();
  /// The next token, where the text may not end. @throws InputError
  UsdaToken next_inside();

  /// Past a value: a single token, or a bracket with all that is in it.
  void skip_value();
  /// Past `= value` and `( metadata )`, each if it is there.
  void skip_value_and_metadata();
  /// Past the bracket that closes the one that is open now.
  void skip_to_close();

  /// Past `[ ... ]`: each word in it, however deep in tuples, to `take`. An array replaces an earlier one: `restart`.
  template <class Take, class Restart>
  void read_array(const Take& take, const Restart& restart) {
    restart();
    next();
    for (std::size_t depth = 1; depth > 0;) {
      const UsdaToken token = next_inside();
      depth += token.opens() ? 1U : 0U;
      depth -= token.closes() ? 1U : 0U;
      if (token.kind == UsdaToken::word) take(token.text);
    }
  }
  void read_numbers(std::vector<float>& values);

  [[noreturn]] void refuse(const std::string& what) const;

 private:
  UsdaToken cut();
  void skip_space() noexcept;
  UsdaToken cut_quoted(UsdaToken::Kind kind, char quote);
  UsdaToken token(UsdaToken::Kind kind, std::size_t begin, std::size_t end, std::size_t after) noexcept;

  std::string_view text_;
  const std::string& where_;
  std::size_t at_ = 0, line_ = 1;
  UsdaToken ahead_, last_;
};

}  // namespace pelage::hair
