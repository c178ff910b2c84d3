#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// A call that changes something, as far as its name tells: GCC makes the calls of an argument list
/// in another order than Clang does, and on ARM in another than on x86.
static const std::regex kChanges(
    R"(\b(read|take|next|pop|create|Create|append|add|draw|insert|allocate|consume|emplace|push))"
    R"((_\w+|[A-Z]\w*)?(<[^<>()]*>)?\()");

/// How many of the arguments between [begin, end) hold a call that changes something. What stands
/// in braces is evaluated from left to right, so a list in braces is one argument.
static int changing_arguments(const std::string& code, std::size_t begin, std::size_t end) {
  int changing = 0;
  int depth = 0;
  std::size_t start = begin;
  for (std::size_t i = begin; i <= end; ++i) {
    const char c = i < end ? code[i] : ',';
    depth += c == '(' || c == '{' || c == '[';
    depth -= c == ')' || c == '}' || c == ']';
    if (c != ',' || depth != 0) continue;
    const std::string argument = code.substr(start, i - start);
    // The body of a lambda is not evaluated here.
    const bool lambda = argument.find_first_not_of(" \n") != std::string::npos &&
                        argument[argument.find_first_not_of(" \n")] == '[';
    changing += !lambda && std::regex_search(argument, kChanges);
    start = i + 1;
  }
  return changing;
}

static std::size_t closing(const std::string& code, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < code.size(); ++i) {
    depth += code[i] == '(';
    depth -= code[i] == ')';
    if (depth == 0) return i;
  }
  return code.size();
}

/// Argument lists with two calls that change something. Best effort: it goes by names, and knows no
/// operators.
static Complaints against_argument_order(const Source& source) {
  Complaints complaints;
  std::string code;
  std::vector<std::size_t> starts;
  for (const std::string& line : source.code) {
    starts.push_back(code.size());
    code += line + "\n";
  }
  for (std::size_t open = code.find('('); open != std::string::npos;
       open = code.find('(', open + 1)) {
    if (open == 0 || (std::isalnum(static_cast<unsigned char>(code[open - 1])) == 0 &&
                      code[open - 1] != '_' && code[open - 1] != '>'))
      continue;
    if (changing_arguments(code, open + 1, closing(code, open)) < 2) continue;
    const auto line = std::upper_bound(starts.begin(), starts.end(), open) - starts.begin() - 1;
    complaints.push_back(source.at(static_cast<std::size_t>(line)) +
                         "two calls that change something in one argument list, whose order is the "
                         "compiler's: give each a name in a line of its own, or write braces");
  }
  return complaints;
}

static bool computes_state(const std::string& path) {
  return path.starts_with("solver/") || path.starts_with("scenes/") ||
         path.starts_with("protocol/");
}

TEST(ArgumentOrder, IsNotReliedOn) {
  for (const Source& source : sources())
    if (computes_state(source.path)) {
      EXPECT_THAT(against_argument_order(source), testing::IsEmpty());
    }
}

TEST(ArgumentOrder, TwoCallsThatChangeSomethingAreSeen) {
  const auto complaints = [](const char* text) {
    return against_argument_order(make_source("solver/x.cpp", text)).size();
  };
  EXPECT_EQ(complaints("f(read_u32(bytes), read_u32(bytes));"), 1u);
  EXPECT_EQ(complaints("f(reader.next(),\n  g(reader.next_float()));"), 1u);
  EXPECT_EQ(complaints("CreateBody(b, b.CreateString(n), b.CreateVector<float>(v));"), 1u);
  EXPECT_EQ(complaints("f(g(pop(a), pop(a)), 1);"), 1u);
  EXPECT_EQ(complaints("Vec2 v{random.next(), random.next()};"), 0u);
  EXPECT_EQ(complaints("f({read_u32(b), read_u32(b)});"), 0u);
  EXPECT_EQ(complaints("f(read_u32(b), v.begin(), v.end());"), 0u);
  EXPECT_EQ(complaints("f([&] { add(a); }, [&] { add(b); });"), 0u);
  EXPECT_EQ(complaints("const int a = read(b);\nconst int c = read(b);\nf(a, c);"), 0u);
}

}  // namespace cycloid::tidy
