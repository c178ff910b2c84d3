#include "protocol/state/layout.hpp"

#include <string_view>

#include "solver/bytes.hpp"
#include "solver/visit.hpp"

namespace cycloid::protocol {

static constexpr std::size_t kWordBytes = 4;

/// Where the words of a named field begin, and how many they are.
struct FieldWords {
  std::string_view name;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// Lists the words of a record in the order of `visit`.
template <class R>
static std::vector<FieldWords> list_words(std::vector<WordKind>& words) {
  std::vector<FieldWords> fields;
  R record{};
  solver::visit(record, [&](const char* name, auto& field) {
    const auto first = static_cast<std::uint32_t>(words.size());
    auto add = [&](auto& word) {
      const bool real = std::is_floating_point_v<std::remove_cvref_t<decltype(word)>>;
      words.insert(words.end(), sizeof word / kWordBytes,
                   real ? WordKind::kFloat : WordKind::kInteger);
    };
    solver::WordWalk<decltype(add)>{add}.walk(field);
    fields.push_back({name, first, static_cast<std::uint32_t>(words.size()) - first});
  });
  return fields;
}

static FieldWords find_words(const std::vector<FieldWords>& fields, std::string_view name) {
  for (const FieldWords& field : fields)
    if (field.name == name) return field;
  return {};
}

static ArrayLayout::Motion motion_of(const std::vector<FieldWords>& fields) {
  const FieldWords position = find_words(fields, "position");
  const FieldWords velocity = find_words(fields, "velocity");
  const FieldWords rotation = find_words(fields, "rotation");
  const FieldWords spin = find_words(fields, "spin");
  if (position.count == 0 || velocity.count != position.count) return {};
  ArrayLayout::Motion motion{position.first, velocity.first, rotation.first, spin.first,
                             position.count, rotation.count, spin.count};
  if (spin.count == 0) motion.rotation_words = 0;
  return motion;
}

template <int D>
static StateLayout make_layout() {
  StateLayout layout;
  layout.dimension = D;
  layout.header.assign(2, WordKind::kInteger);
  const auto fields = list_words<solver::WorldHeader<D>>(layout.header);
  layout.tick = find_words(fields, "tick").first;
  layout.tick_s = find_words(fields, "tick_s").first;
  std::size_t at = 0;
  const solver::WorldState<D> state;
  solver::visit_arrays(state, [&](const char* name, const auto& array) {
    using Element = std::remove_cvref_t<decltype(array[0])>;
    ArrayLayout& into = layout.arrays[at++];
    into.name = name;
    if constexpr (solver::kIsWord<Element>) {
      into.words.assign(1, WordKind::kInteger);
    } else {
      static_assert(solver::visited_bytes<Element>() <= kRecordWordsMax * kWordBytes);
      into.motion = motion_of(list_words<Element>(into.words));
    }
    into.by_key = into.name == "contact";
  });
  return layout;
}

const StateLayout& state_layout(std::uint32_t dimension) {
  static const StateLayout kPlanar = make_layout<2>();
  static const StateLayout kSpatial = make_layout<3>();
  return dimension == 2 ? kPlanar : kSpatial;
}

std::uint32_t CutState::count(std::size_t array) const {
  return static_cast<std::uint32_t>(arrays[array].size() /
                                    (layout->arrays[array].words.size() * kWordBytes));
}

std::optional<CutState> cut_state(std::span<const std::byte> encoding) {
  if (encoding.size() < 2 * kWordBytes) return std::nullopt;
  const auto dimension = solver::load_little<std::uint32_t>(encoding.data() + kWordBytes);
  if (dimension != 2 && dimension != 3) return std::nullopt;
  CutState cut;
  cut.layout = &state_layout(dimension);
  const std::size_t header_bytes = cut.layout->header.size() * kWordBytes;
  if (encoding.size() < header_bytes) return std::nullopt;
  cut.header = encoding.first(header_bytes);
  encoding = encoding.subspan(header_bytes);
  for (std::size_t i = 0; i < StateLayout::kArrays; ++i) {
    if (encoding.size() < kWordBytes) return std::nullopt;
    const auto count = solver::load_little<std::uint32_t>(encoding.data());
    encoding = encoding.subspan(kWordBytes);
    const std::size_t record_bytes = cut.layout->arrays[i].words.size() * kWordBytes;
    if (count > encoding.size() / record_bytes) return std::nullopt;
    cut.arrays[i] = encoding.first(count * record_bytes);
    encoding = encoding.subspan(count * record_bytes);
  }
  if (!encoding.empty()) return std::nullopt;
  return cut;
}

}  // namespace cycloid::protocol
