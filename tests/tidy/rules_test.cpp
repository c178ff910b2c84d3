#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// A pattern that may not stand in the code of the solver, and what to write instead.
struct Rule {
  const char* pattern;  ///< Searched in code without comments and quoted text.
  const char* instead;
  std::vector<const char*> bad;  ///< Lines that break it, so that the rule itself is tested.
  const char* good;              ///< And one that does not.
  bool in_scenes = false;        ///< Also in scenes/, which compute the first state.
  const char* except = nullptr;  ///< The one file that may.
};

static const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = {
      {R"(std::(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p)?|pow|hypot|cbrt|fmod)f?\b)",
       "libm rounds differently on every platform: sin_cos and atan2 of solver/trig.hpp",
       {"x = std::cos(a);", "x = std::atan2(y, x);", "x = std::pow(a, 2.0f);"},
       "x = sine.of(a);",
       true},
      {R"(\b(a?(sin|cos|tan)h?|atan2|exp|log|pow|hypot|cbrt|fmod|fma)f\s*\()",
       "libm rounds differently on every platform: sin_cos and atan2 of solver/trig.hpp",
       {"x = sinf(a);", "x = powf(a, b);", "x = fmaf(a, b, c);"},
       "x = self(a);",
       true},
      {R"(\b(exp|log|pow|hypot|cbrt|a?(sin|cos|tan)h?|fmod)\s*\()",
       "libm rounds differently on every platform: sin_cos and atan2 of solver/trig.hpp",
       {"x = pow(a, b);", "x = exp(a);", "x = sin(a);", "x = atan(y / x);"},
       "x = atan2(y, x); sin_cos(a, s, c);",
       true},
      {R"(std::(fma|fmin|fmax|hash|reduce|transform_reduce|execution|shuffle)\b)",
       "unspecified order or rounding: a * b + c, selects, ids, sums in a written order",
       {"x = std::fma(a, b, c);", "std::hash<int>{}(3)", "std::reduce(a, b)"},
       "x = a * b + c;",
       true},
      {R"(\bunordered_|std::random|std::rand\b|\b(rand|srand|time|clock)\s*\(|_clock\b)",
       "hash order, chance and clocks are not in the state: sorted vectors, ids, the tick",
       {"std::unordered_map<int, int> m;", "x = rand();", "t = time(nullptr);",
        "steady_clock::now()"},
       "operand(x); runtime(y);",
       true},
      {R"(_mm\d*_(rcp|rsqrt|f[n]?m(add|sub))|\b(v?rsqrte?|v?recpe?|rcp)\w*\s*\(|__builtin_fma)",
       "estimates and fused operations differ between processors: 1 / x, sqrt, Lanes<W>",
       {"_mm_rcp_ps(x)", "_mm256_rsqrt_ps(x)", "_mm_fmadd_ps(a, b, c)", "rsqrt(x)"},
       "_mm_add_ps(a, b)",
       true},
      {R"(std::(floor|ceil|l{0,2}r(ound|int)|trunc|nearbyint|remainder|remquo|fdim|ldexp|scalbl?n|)"
       R"(frexp|modf|i?logb|next(after|toward)|erfc?|[lt]gamma|lerp)f?\b)",
       "no libm but the square root: integers, casts within bounds, and selects of "
       "solver/lanes.hpp",
       {"x = std::floor(a);", "i = std::lround(a);", "x = std::ldexp(a, 2);"},
       "x = std::midpoint(a, b); clog(a);",
       true},
      // Moving lanes, cutting them to whole numbers, counting zeros and asking for instructions are
      // exact, and to ask for memory changes nothing. (Units of one instruction set may not share
      // std::countr_zero with others.)
      {R"(__builtin_(?!(sqrtf|shufflevector|convertvector|ctz|cpu_supports|prefetch)\b)\w+|)"
       R"(__sync_\w+|__atomic_\w+)",
       "a compiler's own function differs between compilers: C++, or Lanes<W> for wide arithmetic",
       {"x = __builtin_sinf(a);", "x = __builtin_sqrt(a);", "__builtin_trap();",
        "n = __builtin_ctzl(bits);"},
       "x = __builtin_sqrtf(a);",
       true},
      // To yield says nothing of who runs.
      {R"(\bthis_thread\b(?!::yield\(\))|\bthread::id\b|\bget_id\s*\(|)"
       R"(\bhardware_concurrency\b|\bpthread_|std::(async|jthread|future|promise)\b)",
       "nothing may depend on which thread runs it, or on how many: ranges of solver/workers.hpp",
       {"auto i = std::this_thread::get_id();", "std::thread::id id;",
        "n = std::thread::hardware_concurrency();"},
       "const BodyId id = body_id(i); std::this_thread::yield();",
       true},
      {R"(\b(secure_)?getenv\s*\(|\bset(env|locale)\s*\(|std::locale\b|\b(sysconf|getpid)\s*\()",
       "a world is a function of its own calls, not of the machine: a field of WorldDef or Tuning",
       {"x = std::getenv(name);", "setlocale(0, name);", "std::locale::global(l);"},
       "x = environment(a);",
       true},
      {R"(\b_?[Pp]ragma\b(?!\s+once)|\b__pragma\b)",
       "arithmetic is the same in every line: flags stand in solver/CMakeLists.txt, for all files",
       {"#pragma omp parallel for", "#pragma STDC FP_CONTRACT ON", "  #  pragma GCC optimize 3",
        "_Pragma(x)"},
       "#pragma once",
       true},
      {R"((\bgnu::|__attribute__\s*\(\(.*\b)(_*optimize|_*target(_clones)?)_*\b)",
       "arithmetic is the same in every function: no optimize, no target, no clones",
       {"[[gnu::optimize(3)]] void f();", "__attribute__((target(x))) void f();",
        "__attribute__((cold, __target_clones__(x))) void f();"},
       "[[gnu::always_inline]] bool optimize(Target target);",
       true},
      {R"(\blong\s+double\b|\b_*[Ff]loat(16|32|64|80|128)_*[xt]?\b|\b__(fp|bf)16\b|)"
       R"(std::complex\b)",
       "a number that every processor has in the same form: float",
       {"long double x;", "_Float16 x;", "__float128 x;"},
       "float x32; my_float16x4 y;",
       true},
      {R"(^\s*(const\s+)?((un)?signed\s+|std::)?(bool|char|short|int|long|unsigned|)"
       R"(u?int\d+_t|[A-Z]\w*))"
       R"(\s+\w+\s*:\s*\d+\s*[;=,{])",
       "compilers lay out bit-fields otherwise: a whole std::uint8_t, or masks and shifts",
       {"  std::uint32_t kind : 3;", "unsigned a : 1, b : 2;", "  bool asleep : 1 = false;"},
       "  case kBall: x = a ? b : 3;",
       true},
      {R"(std::(multi)?(set|map)\s*<\s*(const\s+)?[\w:]+(<[^<>]*>)?(\s*const)?\s*\*|)"
       R"(std::(less|greater)(_equal)?\s*<[^<>]*\*\s*>|\bowner_(less|before|hash)\b|)"
       R"(&\w[\w.\[\]]*\s*[<>]=?\s*&\w)",
       "addresses differ from run to run: a sorted vector of ids",
       {"std::set<Body*> bodies;", "std::map<const Shape<D>*, int> m;", "std::less<Body*>{}(a, b)",
        "if (&a < &bodies[1]) swap(a, b);"},
       "std::set<std::string> names; f(&a, b < c, &d);",
       true},
      {R"(<<\s*(&\w|static_cast<\s*(const\s+)?void\s*\*)|std::(addressof|to_address)\b)",
       "addresses differ from run to run: say the id",
       {"out << &body;", "out << static_cast<const void*>(p);", "x = std::addressof(a);"},
       "x = 1u << body; f(&a);",
       true},
      {R"(std::(partition|nth_element|make_heap|push_heap|pop_heap|sort_heap|priority_queue|)"
       R"(is_permutation|sample|random_shuffle)\b)",
       "where elements are equal, libraries order them otherwise: std::stable_partition, or "
       "std::sort by a total order",
       {"std::partition(a, b, f);", "std::priority_queue<int> q;"},
       "std::stable_partition(a, b, f);",
       true},
      {R"(\bdouble\b)",
       "the state is float, and double rounds twice: float",
       {"double x;", "long double x;", "std::vector<double> v;"},
       "redouble(x);",
       false,
       "solver/direct/wide.hpp"},
      {R"(\bvolatile\b)",
       "it orders nothing: std::atomic in solver/workers.*",
       {"volatile int x;"},
       "int x;"},
      {R"(\breinterpret_cast\b|\buintptr_t\b|\bintptr_t\b)",
       "order is by id, never by address, and bytes are values: std::bit_cast, memcpy, ids",
       {"reinterpret_cast<char*>(p)", "std::uintptr_t p;"},
       "std::bit_cast<int>(x)"},
      {R"(\b(throw|try|catch)\b)",
       "errors are values: Result<T>, Error",
       {"throw 1;", "try {", "} catch (...) {"},
       "int tries;"},
      // A variable ends with = or ; and has no parenthesis before; a function has one.
      {R"(^(static|inline|thread_local)\b(?!.*\bconst(expr)?\b)[^()]*(=.*|\{.*\}|\w);)",
       "a world is a function of its own calls: state in WorldState, scratch in StepScratch",
       {"static int counter = 0;", "static int counter;", "inline std::vector<int> cache;",
        "thread_local int depth{1};"},
       "static int count(int x);"},
      {R"(^\s+(static|thread_local)\s(?!.*\b(const|constexpr)\b)[^()]*(=.*|\{.*\}|\w);)",
       "a world is a function of its own calls: state in WorldState, scratch in StepScratch",
       {"  static int counter = 0;", "  thread_local int depth;"},
       "  static constexpr int kRows = 1;"},
      {R"(\bD\s*[=!]=\s*[23]\b|\b[23]\s*[=!]=\s*D\b)",
       "a quantity of Dim<D> or an overload; what differs between 2 and 3 lives in solver/dim.hpp",
       {"if constexpr (D == 3) {", "return D==2 ? 1 : 3;", "if (2 != D)"},
       "if (kSpin == 3)",
       false,
       "solver/dim.hpp"},
  };
  return kRules;
}

static Complaints against_rule(const Rule& rule, const Source& source) {
  Complaints complaints;
  const bool in_scenes = rule.in_scenes && source.path.starts_with("scenes/");
  if (!source.path.starts_with("solver/") && !in_scenes) return complaints;
  if (rule.except != nullptr && source.path == rule.except) return complaints;
  static std::map<std::string, std::regex> compiled;
  const std::regex& pattern = compiled.try_emplace(rule.pattern, rule.pattern).first->second;
  for (std::size_t i = 0; i < source.code.size(); ++i)
    if (std::regex_search(source.code[i], pattern))
      complaints.push_back(source.at(i) + source.lines[i] + "\n  " + rule.instead);
  return complaints;
}

TEST(Rules, HoldInSolverAndScenes) {
  for (const Rule& rule : rules())
    for (const Source& source : sources())
      EXPECT_THAT(against_rule(rule, source), testing::IsEmpty());
}

TEST(Rules, EachSeesTheLinesThatBreakItAndNoOther) {
  for (const Rule& rule : rules()) {
    for (const char* bad : rule.bad)
      EXPECT_EQ(against_rule(rule, make_source("solver/x.cpp", bad)).size(), 1u) << bad;
    EXPECT_THAT(against_rule(rule, make_source("solver/x.cpp", rule.good)), testing::IsEmpty());
    EXPECT_THAT(against_rule(rule, make_source("cli/x.cpp", rule.bad[0])), testing::IsEmpty());
    EXPECT_EQ(against_rule(rule, make_source("scenes/x.cpp", rule.bad[0])).size(), rule.in_scenes);
  }
}

TEST(Rules, ReadCodeAndNotWhatIsQuotedOrSaidInComments) {
  EXPECT_EQ(code_of("a = \"std::cos(\"; // std::sin("), "a = ; ");
  EXPECT_EQ(code_of("a = '\"'; b = '\\''; c"), "a = ; b = ; c");
  EXPECT_EQ(code_of("a /* throw\nthrow */ b"), "a \n b");
  EXPECT_EQ(code_of("a = R\"(\"throw\")\"; b"), "a = ; b");
  EXPECT_EQ(code_of("x = 1'000'000; y"), "x = 1'000'000; y");
}

/// Equal elements end up in any order, which differs between libraries.
static Complaints against_sorts(const Source& source) {
  static const std::regex kSort(R"(\b(std::|ranges::)(sort|partial_sort(_copy)?)\b)");
  Complaints complaints;
  if (!source.path.starts_with("solver/") && !source.path.starts_with("scenes/")) return complaints;
  for (std::size_t i = 0; i < source.code.size(); ++i) {
    if (!std::regex_search(source.code[i], kSort)) continue;
    std::string near = source.lines[i];
    for (std::size_t back = 1; back <= 2 && back <= i; ++back) near += source.lines[i - back];
    if (near.find("otal order") == std::string::npos)
      complaints.push_back(source.at(i) +
                           "equal elements end up in any order: write std::"
                           "stable_sort, or say in a comment above why this is a total order");
  }
  return complaints;
}

TEST(Sorts, InSolverAndScenesNameTheirTotalOrder) {
  for (const Source& source : sources()) EXPECT_THAT(against_sorts(source), testing::IsEmpty());
}

TEST(Sorts, WithoutTheirOrderAreSeen) {
  EXPECT_EQ(against_sorts(make_source("solver/x.cpp", "\n\n  std::sort(a, b);\n")).size(), 1u);
  EXPECT_EQ(against_sorts(make_source("scenes/x.cpp", "std::ranges::sort(a);")).size(), 1u);
  EXPECT_EQ(against_sorts(make_source("solver/x.cpp", "std::partial_sort(a, b, c);")).size(), 1u);
  EXPECT_THAT(against_sorts(make_source("solver/x.cpp", "// Total order: ids.\nstd::sort(a, b);")),
              testing::IsEmpty());
}

}  // namespace cycloid::tidy
