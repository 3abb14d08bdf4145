// An arithmetic expression of named numbers, read by muParser: + - * / ^, comparisons, && ||, a ? b : c, pi, and the
// functions that `Expression::Functions()` lists.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/status.h"

namespace mu {
class Parser;
}

namespace dynoproof {

class Expression {
 public:
  /// `numbers`: where the value of each name stands, which has to outlive the expression; `constants`: values for good. Fails where
  /// the text is no expression; the message says what is wrong, and behind which characters.
  static Result<std::unique_ptr<Expression>> Of(const std::string& text, const std::map<std::string, double*>& numbers,
                                                const std::map<std::string, double>& constants);
  /// All names that a text mentions beside functions and pi, known or not; of a text that is no expression what is found before
  /// its fault.
  static std::set<std::string> NamesIn(const std::string& text);
  /// All names that a text calls as functions, known or not.
  static std::set<std::string> CalledIn(const std::string& text);
  static const std::vector<std::string>& Functions();

  ~Expression();
  /// Its value for what the numbers are now. Allocates nothing.
  double operator()() const;

 private:
  Expression();
  std::unique_ptr<mu::Parser> parser_;
};

}  // namespace dynoproof
