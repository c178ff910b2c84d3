#include <string_view>
#include <type_traits>

#include "solver/tracing/named_words.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <class R>
static void compare(const std::string& object, const R& a, const R& b, std::size_t limit,
                    std::vector<Difference>& into) {
  const std::vector<NamedWord> words_a = words_of(a);
  const std::vector<NamedWord> words_b = words_of(b);
  for (std::size_t i = 0; i < words_a.size() && into.size() < limit; ++i) {
    if (words_a[i].bits == words_b[i].bits) continue;
    into.push_back({object, words_a[i].name, words_a[i].text, words_b[i].text});
  }
}

template <class R>
static bool same_words(const R& a, const R& b) {
  std::vector<std::uint64_t> words;
  visit_words(a, [&](const auto& value) { words.push_back(bits_of(value)); });
  std::size_t at = 0;
  bool same = true;
  visit_words(b, [&](const auto& value) { same = same && words[at++] == bits_of(value); });
  return same;
}

template <class Array>
static void compare_arrays(const char* name, const Array& a, const Array& b, std::size_t limit,
                           std::vector<Difference>& into) {
  const std::size_t common = a.size() < b.size() ? a.size() : b.size();
  for (std::size_t i = 0; i < common && into.size() < limit; ++i) {
    if (same_words(a[i], b[i])) continue;
    compare(std::string(name) + " " + std::to_string(i), a[i], b[i], limit, into);
  }
  if (a.size() != b.size() && into.size() < limit)
    into.push_back({"world", std::string(name) + " count", std::to_string(a.size()),
                    std::to_string(b.size())});
}

template <int D>
std::vector<Difference> differences(const WorldState<D>& a, const WorldState<D>& b,
                                    std::size_t limit) {
  std::vector<Difference> found;
  compare("world", a.header, b.header, limit, found);
  visit_arrays(a, [&](const char* name, const auto& of_a) {
    visit_arrays(b, [&](const char* other, const auto& of_b) {
      if constexpr (std::is_same_v<decltype(of_a), decltype(of_b)>) {
        if (std::string_view(name) == other) compare_arrays(name, of_a, of_b, limit, found);
      }
    });
  });
  return found;
}

template std::vector<Difference> differences<2>(const WorldState<2>&, const WorldState<2>&,
                                                std::size_t);
template std::vector<Difference> differences<3>(const WorldState<3>&, const WorldState<3>&,
                                                std::size_t);

}  // namespace cycloid::solver
