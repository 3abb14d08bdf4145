#include "plugins/plant/equations/expression.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <regex>

namespace dynoproof {
namespace {

using One = double (*)(double);
using Two = double (*)(double, double);

// sin, exp and their kin are those of the program (libm.cmake), and not those that the library was linked with.
const std::pair<const char*, One> kOfOne[] = {
    {"sin", [](double x) { return std::sin(x); }},
    {"cos", [](double x) { return std::cos(x); }},
    {"tan", [](double x) { return std::tan(x); }},
    {"asin", [](double x) { return std::asin(x); }},
    {"acos", [](double x) { return std::acos(x); }},
    {"atan", [](double x) { return std::atan(x); }},
    {"sinh", [](double x) { return std::sinh(x); }},
    {"cosh", [](double x) { return std::cosh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }},
    {"exp", [](double x) { return std::exp(x); }},
    {"log", [](double x) { return std::log(x); }},
    {"sqrt", [](double x) { return std::sqrt(x); }},
    {"abs", [](double x) { return std::abs(x); }},
    {"floor", [](double x) { return std::floor(x); }},
    {"sign", [](double x) { return static_cast<double>(x > 0.0) - static_cast<double>(x < 0.0); }},
};
const std::pair<const char*, Two> kOfTwo[] = {
    {"atan2", [](double y, double x) { return std::atan2(y, x); }},
    {"hypot", [](double x, double y) { return std::hypot(x, y); }},
    {"pow", [](double x, double y) { return std::pow(x, y); }},
    {"min", [](double x, double y) { return std::min(x, y); }},
    {"max", [](double x, double y) { return std::max(x, y); }},
};

constexpr double kPi = 3.14159265358979323846;

/// A parser that knows the functions and pi, and nothing else. Throws where the text is too long for it.
std::unique_ptr<mu::Parser> ParserOf(const std::string& text) {
  auto parser = std::make_unique<mu::Parser>();
  parser->ClearFun();
  parser->ClearConst();
  for (const auto& [name, function] : kOfOne) parser->DefineFun(name, function);
  for (const auto& [name, function] : kOfTwo) parser->DefineFun(name, function);
  parser->DefineConst("pi", kPi);
  parser->SetExpr(text);
  return parser;
}

/// Whether a text assigns: muParser would write to the name on the left.
bool Assigns(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;
    } else if (i == 0 || std::string("<>!").find(text[i - 1]) == std::string::npos) {
      return true;
    }
  }
  return false;
}

std::string Told(const mu::Parser::exception_type& fault, const std::string& text) {
  std::string message = fault.GetMsg();
  while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
  const int at = fault.GetPos();
  constexpr std::size_t kMost = 60;  // that a message shows
  const auto end = static_cast<std::size_t>(std::max(0, at));
  if (end == 0 || end >= text.size()) return message.substr(0, 3 * kMost);
  return fmt::format("{} (behind \"{}\")", message, text.substr(end - std::min(end, kMost), std::min(end, kMost)));
}

}  // namespace

Expression::Expression() = default;
Expression::~Expression() = default;

const std::vector<std::string>& Expression::Functions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, function] : kOfOne) all.emplace_back(name);
    for (const auto& [name, function] : kOfTwo) all.emplace_back(name);
    return all;
  }();
  return names;
}

std::set<std::string> Expression::NamesIn(const std::string& text) {
  std::set<std::string> names;
  try {
    const std::unique_ptr<mu::Parser> parser = ParserOf(text);
    for (const auto& [name, value] : parser->GetUsedVar()) names.insert(name);
  } catch (const mu::Parser::exception_type&) {
    // Of() says what is wrong.
  }
  return names;
}

std::set<std::string> Expression::CalledIn(const std::string& text) {
  static const std::regex call("([A-Za-z_][A-Za-z0-9_]*)\\s*\\(");
  std::set<std::string> names;
  for (std::sregex_iterator one(text.begin(), text.end(), call), end; one != end; ++one) names.insert((*one)[1]);
  return names;
}

Result<std::unique_ptr<Expression>> Expression::Of(const std::string& text,
                                                   const std::map<std::string, double*>& numbers,
                                                   const std::map<std::string, double>& constants) {
  if (Assigns(text)) return Failure{"an expression assigns nothing; equal is =="};
  std::unique_ptr<Expression> expression(new Expression());
  try {
    expression->parser_ = ParserOf(text);
    for (const auto& [name, value] : numbers) expression->parser_->DefineVar(name, value);
    for (const auto& [name, value] : constants) expression->parser_->DefineConst(name, value);
    (void)expression->parser_->Eval();  // compiles it
    if (expression->parser_->GetNumResults() != 1) return Failure{"one number is wanted, and there are several"};
  } catch (const mu::Parser::exception_type& fault) {
    return Failure{Told(fault, text)};
  }
  return expression;
}

double Expression::operator()() const { return parser_->Eval(); }

}  // namespace dynoproof
