#include "solver/tracing/compare_encodings.hpp"

#include <algorithm>
#include <string_view>

#include "solver/encoding.hpp"
#include "solver/tracing/named_words.hpp"

namespace cycloid::solver {
namespace {

/// "7", or "none" for kNone.
std::string index_text(std::uint32_t index) {
  return index == kNone ? "none" : std::to_string(index);
}

template <int D>
std::string about(const WorldState<D>&, const Joint<D>& joint) {
  return "bodies " + index_text(joint.body_a) + " and " + index_text(joint.body_b);
}
template <int D>
std::string about(const WorldState<D>& state, const Contact<D>& contact) {
  const auto body_of = [&](std::uint32_t shape) {
    return shape < state.shapes.size() ? index_text(state.shapes[shape].body) : "none";
  };
  return "bodies " + body_of(contact.shape_a) + " and " + body_of(contact.shape_b) + ", shapes " +
         index_text(contact.shape_a) + " and " + index_text(contact.shape_b);
}
template <int D, class R>
std::string about(const WorldState<D>&, const R&) {
  return "";
}

template <class R>
std::uint32_t generation_of(const R& record) {
  if constexpr (requires { record.generation; }) return record.generation;
  return 0;
}

template <int D>
class Comparison {
 public:
  Comparison(const WorldState<D>& a, const WorldState<D>& b, std::size_t limit)
      : a_(a), b_(b), limit_(limit) {}

  EncodingsCompared run() {
    // Where a difference of the first tick comes from stands before where it went.
    static constexpr std::string_view kCauses[] = {"register", "joint", "contact", "body",
                                                   "particle"};
    records("world", 0, a_.header, b_.header);
    for (const std::string_view kind : kCauses) arrays([&](auto name) { return kind == name; });
    arrays([&](auto name) { return std::ranges::find(kCauses, name) == std::end(kCauses); });
    return std::move(compared_);
  }

 private:
  /// Compares the arrays whose name is wanted.
  template <class Wanted>
  void arrays(const Wanted& wanted) {
    visit_arrays(a_, [&](const char* name, const auto& array_a) {
      if (!wanted(std::string_view(name))) return;
      visit_arrays(b_, [&](const char* other, const auto& array_b) {
        using Same = std::is_same<decltype(array_a), decltype(array_b)>;
        if constexpr (Same::value)
          if (std::string_view(name) == other) array(name, array_a, array_b);
      });
    });
  }

  template <class Array>
  void array(const char* kind, const Array& a, const Array& b) {
    const std::size_t common = std::min(a.size(), b.size());
    for (std::size_t i = 0; i < common; ++i) records(kind, i, a[i], b[i]);
    for (std::size_t i = common; i < a.size(); ++i) only(kind, i, a_, a[i]);
    for (std::size_t i = common; i < b.size(); ++i) only(kind, i, b_, b[i]);
  }

  /// A contact more or less moves all behind it, so they are matched by their shapes, in whose
  /// order they are listed. A list in another order comes from no world, and ends up as absent.
  void array(const char* kind, const std::vector<Contact<D>>& a, const std::vector<Contact<D>>& b) {
    const auto before = [](const Contact<D>& x, const Contact<D>& y) {
      return x.shape_a != y.shape_a ? x.shape_a < y.shape_a : x.shape_b < y.shape_b;
    };
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() || j < b.size()) {
      if (j == b.size() || (i < a.size() && before(a[i], b[j]))) {
        only(kind, i, a_, a[i]);
        ++i;
      } else if (i == a.size() || before(b[j], a[i])) {
        only(kind, j, b_, b[j]);
        ++j;
      } else {
        records(kind, i, a[i], b[j]);
        ++i;
        ++j;
      }
    }
  }

  template <class R>
  void records(const char* kind, std::size_t slot, const R& a, const R& b) {
    words_.clear();
    visit_words(a, [&](const auto& value) { words_.push_back(canonical_bits_of(value)); });
    places_.clear();
    std::size_t at = 0;
    visit_words(b, [&](const auto& value) {
      if (words_[at] != canonical_bits_of(value)) places_.push_back(at);
      ++at;
    });
    if (places_.empty()) return;
    compared_.count += places_.size();
    ++compared_.objects;
    if (compared_.first.size() >= limit_) return;
    const std::vector<NamedWord> named_a = words_of(a);
    const std::vector<NamedWord> named_b = words_of(b);
    for (const std::size_t place : places_) {
      if (compared_.first.size() >= limit_) return;
      compared_.first.push_back({kind, static_cast<std::uint32_t>(slot), generation_of(a),
                                 about(a_, a), named_a[place].name, named_a[place].text,
                                 named_b[place].text, named_a[place].bits, named_b[place].bits});
    }
  }

  template <class R>
  void only(const char* kind, std::size_t slot, const WorldState<D>& whose, const R& record) {
    const bool has_a = &whose == &a_;
    ++compared_.count;
    ++compared_.objects;
    if (compared_.first.size() >= limit_) return;
    compared_.first.push_back({kind, static_cast<std::uint32_t>(slot), generation_of(record),
                               about(whose, record), "", has_a ? "present" : "absent",
                               has_a ? "absent" : "present", 0, 0});
  }

  const WorldState<D>& a_;
  const WorldState<D>& b_;
  std::size_t limit_;
  EncodingsCompared compared_;
  std::vector<std::uint64_t> words_;
  std::vector<std::size_t> places_;
};

template <int D>
Result<EncodingsCompared> compare(std::span<const std::byte> a, std::span<const std::byte> b,
                                  std::size_t limit) {
  WorldState<D> state_a;
  WorldState<D> state_b;
  if (!read_state(a, state_a) || !read_state(b, state_b)) return Error{Code::kCorrupt, "bytes"};
  return Comparison<D>(state_a, state_b, limit).run();
}

}  // namespace

Result<EncodingsCompared> compare_encodings(std::span<const std::byte> a,
                                            std::span<const std::byte> b, std::size_t limit) {
  const int dimension = encoded_dimension(a);
  if (dimension == 0 || encoded_dimension(b) == 0) return Error{Code::kCorrupt, "bytes"};
  if (dimension != encoded_dimension(b)) return Error{Code::kInvalid, "dimension"};
  return dimension == 2 ? compare<2>(a, b, limit) : compare<3>(a, b, limit);
}

}  // namespace cycloid::solver
