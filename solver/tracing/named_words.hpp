#pragma once

#include <charconv>
#include <string>
#include <vector>

#include "solver/bytes.hpp"
#include "solver/visit.hpp"

namespace cycloid::solver {

/// "0.5 (0x3f000000)": the shortest decimal that reads back as the same number, and its bits.
template <class T>
std::string value_text(T value) {
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
    } else if constexpr (requires { visit_fields(field[0], *this, &field[0]); }) {
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
std::vector<NamedWord> words_of(const R& record) {
  std::vector<NamedWord> words;
  NameWalk walk{words, ""};
  if constexpr (kIsWord<R>) {
    words.push_back({"value", value_text(record), bits_of(record)});
  } else {
    visit(record, walk);
  }
  return words;
}

}  // namespace cycloid::solver
