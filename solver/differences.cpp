#include <charconv>

#include "solver/bytes.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// "0.5 (0x3f000000)": the shortest decimal that reads back as the same number, and its bits.
template <class T>
static std::string value_text(T value) {
  char text[64];
  char* end = text;
  if constexpr (std::is_enum_v<T>) {
    end = std::to_chars(text, text + sizeof text, static_cast<std::uint32_t>(value)).ptr;
  } else {
    end = std::to_chars(text, text + sizeof text, value).ptr;
  }
  std::string result(text, end);
  end = std::to_chars(text, text + sizeof text, bits_of(value), 16).ptr;
  const std::string bits(text, end);
  return result + " (0x" + std::string(2 * sizeof(T) - bits.size(), '0') + bits + ")";
}

/// Collects the named numbers of a record, so that two records compare number by number.
struct NamedWord {
  std::string name;
  std::string text;
  std::uint64_t bits;
};

struct NameWalk {
  std::vector<NamedWord>& words;
  std::string prefix;

  template <class T>
  void operator()(const char* name, const T& field) {
    std::vector<NamedWord> found;
    if constexpr (requires { visit_fields(field, *this, static_cast<const T*>(nullptr)); }) {
      visit(field, *this);  // A record within a record: its fields carry full names.
    } else if constexpr (requires { field[0].feature; }) {
      for (std::size_t i = 0; i < field.size(); ++i) {
        NameWalk inner{words, prefix + name + "[" + std::to_string(i) + "]."};
        visit(field[i], inner);
      }
    } else {
      std::size_t count = 0;
      visit_words(field, [&](const auto& value) {
        found.push_back({prefix + name + "[" + std::to_string(count++) + "]", value_text(value),
                         bits_of(value)});
      });
      if (count == 1) found.front().name = prefix + name;
      words.insert(words.end(), found.begin(), found.end());
    }
  }
};

template <class R>
static std::vector<NamedWord> words_of(const R& record) {
  std::vector<NamedWord> words;
  NameWalk walk{words, ""};
  if constexpr (kIsWord<R>) {
    words.push_back({"value", value_text(record), bits_of(record)});
  } else {
    visit(record, walk);
  }
  return words;
}

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

template <class R>
static void compare_arrays(const char* name, const std::vector<R>& a, const std::vector<R>& b,
                           std::size_t limit, std::vector<Difference>& into) {
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
  compare_arrays("material", a.materials, b.materials, limit, found);
  compare_arrays("body", a.bodies, b.bodies, limit, found);
  compare_arrays("free body", a.free_bodies, b.free_bodies, limit, found);
  compare_arrays("shape", a.shapes, b.shapes, limit, found);
  compare_arrays("free shape", a.free_shapes, b.free_shapes, limit, found);
  compare_arrays("joint", a.joints, b.joints, limit, found);
  compare_arrays("free joint", a.free_joints, b.free_joints, limit, found);
  compare_arrays("contact", a.contacts, b.contacts, limit, found);
  compare_arrays("register", a.registers, b.registers, limit, found);
  compare_arrays("particle", a.particles, b.particles, limit, found);
  compare_arrays("free particle", a.free_particles, b.free_particles, limit, found);
  compare_arrays("link", a.links, b.links, limit, found);
  compare_arrays("free link", a.free_links, b.free_links, limit, found);
  compare_arrays("pin", a.pins, b.pins, limit, found);
  compare_arrays("free pin", a.free_pins, b.free_pins, limit, found);
  return found;
}

template std::vector<Difference> differences<2>(const WorldState<2>&, const WorldState<2>&,
                                                std::size_t);
template std::vector<Difference> differences<3>(const WorldState<3>&, const WorldState<3>&,
                                                std::size_t);

}  // namespace cycloid::solver
