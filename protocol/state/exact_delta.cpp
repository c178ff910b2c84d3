#include "protocol/state/exact_delta.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "protocol/little_endian.hpp"
#include "protocol/state/record_coder.hpp"
#include "solver/tracing/digest_writer.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::size_t kWordBytes = 4;
constexpr std::size_t kHeadBytes = 5;
constexpr std::uint8_t kFormat = 1;  ///< Raise it with any change of what a delta says.

using Words = std::array<std::uint32_t, kRecordWordsMax>;

/// First byte: the format, whether there is a baseline, the dimension.
std::uint8_t head_of(bool with_baseline, std::uint32_t dimension) {
  return static_cast<std::uint8_t>(kFormat << 4 | (with_baseline ? 8u : 0u) | dimension);
}

std::uint32_t check_of(std::span<const std::byte> encoding) {
  return static_cast<std::uint32_t>(XXH3_64bits(encoding.data(), encoding.size()));
}

void load_words(std::span<const std::byte> bytes, std::span<std::uint32_t> words) {
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = solver::load_little<std::uint32_t>(bytes.data() + i * kWordBytes);
}

/// The arrays of the baseline; all of them empty where there is none.
struct Baseline {
  const StateLayout& layout;
  std::vector<std::uint32_t> header;
  CutState cut;

  Baseline(const StateLayout& of, const std::optional<CutState>& state) : layout(of) {
    header.assign(layout.header.size(), 0);
    cut.layout = &layout;
    if (!state) return;
    cut = *state;
    load_words(cut.header, header);
  }
};

/// A count or a word of the header, as its distance from the one before.
template <class Coder>
std::uint32_t code_number(Coder& coder, AdaptiveBit& changed, DistanceModel& model,
                          std::uint32_t guess, std::uint32_t value) {
  if (!coder.bit(changed, value != guess)) return guess;
  return guess + code_distance(coder, model, value - guess);
}

/// Codes the records of one array. `Byte` is const where the records are said, not heard.
template <class Coder>
class ArrayWalk {
 public:
  using Byte = std::conditional_t<Coder::kReads, std::byte, const std::byte>;

  ArrayWalk(Coder& coder, const ArrayLayout& layout, float elapsed_s)
      : coder_(coder), layout_(layout), records_(layout), elapsed_s_(elapsed_s) {
    before_.fill(0);
  }

  void walk(std::span<const std::byte> base, std::span<Byte> current) {
    const bool same_size = base.size() == current.size();
    if (same_size && coder_.bit(same_, same(base, current))) {
      if constexpr (Coder::kReads) std::copy(base.begin(), base.end(), current.begin());
      return;
    }
    if (layout_.by_key)
      walk_by_key(base, current);
    else
      walk_by_place(base, current);
  }

 private:
  std::size_t record_bytes() const { return layout_.words.size() * kWordBytes; }

  static bool same(std::span<const std::byte> base, std::span<Byte> current) {
    if constexpr (Coder::kReads) return false;
    return base.empty() || std::memcmp(base.data(), current.data(), base.size()) == 0;
  }

  void walk_by_place(std::span<const std::byte> base, std::span<Byte> current) {
    for (std::size_t at = 0; at < current.size(); at += record_bytes()) {
      const auto record = current.subspan(at, record_bytes());
      if (at < base.size())
        code_known(base.subspan(at, record_bytes()), record);
      else
        code_new(record);
    }
  }

  /// Both are sorted by key, so that one pass finds what has gone, stayed and come. Bytes that are
  /// not sorted come back as they were, too; they only cost more.
  void walk_by_key(std::span<const std::byte> base, std::span<Byte> current) {
    while (!current.empty()) {
      const auto record = current.first(record_bytes());
      bool stays = false;
      while (!base.empty() && !stays) {
        const auto known = base.first(record_bytes());
        const int order = order_of(known, record);
        const bool comes = coder_.bit(comes_[came_ ? 1 : 0], order > 0);
        came_ = comes;
        if (comes) break;
        stays = !coder_.bit(goes_, order < 0);
        base = base.subspan(record_bytes());
        if (stays) code_known(known, record);
      }
      if (!stays) code_new(record);
      current = current.subspan(record_bytes());
    }
  }

  /// Of the keys: < 0, 0, > 0. What is heard decides for a reader, which knows no key yet.
  static int order_of(std::span<const std::byte> known, std::span<Byte> record) {
    if constexpr (Coder::kReads) return 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto a = solver::load_little<std::uint32_t>(known.data() + i * kWordBytes);
      const auto b = solver::load_little<std::uint32_t>(record.data() + i * kWordBytes);
      if (a != b) return a < b ? -1 : 1;
    }
    return 0;
  }

  void code_known(std::span<const std::byte> base, std::span<Byte> record) {
    const bool changed = coder_.bit(records_.changed(), !same(base, record));
    records_.remember(changed);
    if (changed) {
      load_words(base, std::span(base_).first(layout_.words.size()));
      code(base_, elapsed_s_, record);
    } else {
      if constexpr (Coder::kReads) std::copy(base.begin(), base.end(), record.begin());
      load_words(base, std::span(before_).first(layout_.words.size()));
    }
  }

  /// One that the baseline does not have is guessed from the one before it.
  void code_new(std::span<Byte> record) {
    base_ = before_;
    code(base_, 0.0f, record);
  }

  void code(const Words& base, float elapsed_s, std::span<Byte> record) {
    const std::size_t count = layout_.words.size();
    if constexpr (!Coder::kReads) load_words(record, std::span(before_).first(count));
    records_.code(coder_, std::span(base).first(count), elapsed_s, std::span(before_).first(count));
    if constexpr (Coder::kReads)
      for (std::size_t i = 0; i < count; ++i)
        solver::store_little(before_[i], record.data() + i * kWordBytes);
  }

  Coder& coder_;
  const ArrayLayout& layout_;
  RecordCoder records_;
  float elapsed_s_;
  Words base_;
  Words before_;  ///< The record coded last.
  AdaptiveBit same_;
  AdaptiveBit goes_;
  std::array<AdaptiveBit, 2> comes_;
  bool came_ = false;
};

/// Codes the header and returns the time that has passed since the baseline; 0 where there is none.
template <class Coder>
float code_header(Coder& coder, const StateLayout& layout, std::span<const std::uint32_t> base,
                  std::span<std::uint32_t> header) {
  AdaptiveBit changed;
  DistanceModel distance;
  for (std::size_t i = 0; i < header.size(); ++i)
    header[i] = code_number(coder, changed, distance, base[i], header[i]);
  if (base[0] == 0) return 0.0f;
  const std::uint32_t ticks = header[layout.tick] - base[layout.tick];
  const float elapsed_s = static_cast<float>(ticks) * std::bit_cast<float>(header[layout.tick_s]);
  // Farther away a body's velocity says nothing of its pose; and no bits make it infinite.
  constexpr float kElapsedMax_s = 2.0f;
  return elapsed_s >= 0.0f && elapsed_s <= kElapsedMax_s ? elapsed_s : 0.0f;
}

void say_delta(const Baseline& baseline, const CutState& current, SayingCoder& coder) {
  const StateLayout& layout = baseline.layout;
  AdaptiveBit changed;
  DistanceModel distance;
  for (std::size_t i = 0; i < StateLayout::kArrays; ++i)
    code_number(coder, changed, distance, baseline.cut.count(i), current.count(i));
  std::vector<std::uint32_t> header(layout.header.size());
  load_words(current.header, header);
  const float elapsed_s = code_header(coder, layout, baseline.header, header);
  for (std::size_t i = 0; i < StateLayout::kArrays; ++i)
    if (!current.arrays[i].empty())
      ArrayWalk<SayingCoder>(coder, layout.arrays[i], elapsed_s)
          .walk(baseline.cut.arrays[i], current.arrays[i]);
  coder.finish();
}

/// Hears the counts first, so that the size is known before anything is allocated.
std::optional<std::vector<std::byte>> hear_delta(const Baseline& baseline, std::size_t bytes_max,
                                                 HearingCoder& coder) {
  const StateLayout& layout = baseline.layout;
  AdaptiveBit changed;
  DistanceModel distance;
  std::array<std::uint32_t, StateLayout::kArrays> counts;
  std::uint64_t bytes = layout.header.size() * kWordBytes;
  for (std::size_t i = 0; i < StateLayout::kArrays; ++i) {
    counts[i] = code_number(coder, changed, distance, baseline.cut.count(i), 0);
    bytes += kWordBytes + counts[i] * std::uint64_t{layout.arrays[i].words.size() * kWordBytes};
  }
  if (bytes > bytes_max) return std::nullopt;
  std::vector<std::byte> state(static_cast<std::size_t>(bytes));
  std::vector<std::uint32_t> header = baseline.header;
  const float elapsed_s = code_header(coder, layout, baseline.header, header);
  std::span<std::byte> to = state;
  auto put = [&](std::uint32_t word) {
    solver::store_little(word, to.data());
    to = to.subspan(kWordBytes);
  };
  for (const std::uint32_t word : header) put(word);
  for (std::size_t i = 0; i < StateLayout::kArrays; ++i) {
    put(counts[i]);
    const std::span<std::byte> array =
        to.first(counts[i] * layout.arrays[i].words.size() * kWordBytes);
    to = to.subspan(array.size());
    if (!array.empty())
      ArrayWalk<HearingCoder>(coder, layout.arrays[i], elapsed_s)
          .walk(baseline.cut.arrays[i], array);
  }
  return state;
}

}  // namespace

bool encode_exact_delta(std::span<const std::byte> baseline, std::span<const std::byte> current,
                        std::vector<std::byte>& into) {
  into.clear();
  const std::optional<CutState> now = cut_state(current);
  const std::optional<CutState> before = cut_state(baseline);
  if (!now || (!baseline.empty() && !before)) return false;
  if (before && before->layout != now->layout) return false;
  into.push_back(static_cast<std::byte>(head_of(before.has_value(), now->layout->dimension)));
  append_little(check_of(current), into);
  SayingCoder coder(into);
  say_delta(Baseline(*now->layout, before), *now, coder);
  return true;
}

std::optional<std::vector<std::byte>> decode_exact_delta(std::span<const std::byte> baseline,
                                                         std::span<const std::byte> delta,
                                                         std::size_t bytes_max) {
  if (delta.size() < kHeadBytes) return std::nullopt;
  const auto head = static_cast<std::uint8_t>(delta[0]);
  const std::uint32_t dimension = head & 7u;
  const std::optional<CutState> before = cut_state(baseline);
  if ((dimension != 2 && dimension != 3) || head != head_of(before.has_value(), dimension))
    return std::nullopt;
  if (!baseline.empty() && (!before || before->layout->dimension != dimension)) return std::nullopt;
  HearingCoder coder(delta.subspan(kHeadBytes));
  auto state = hear_delta(Baseline(state_layout(dimension), before), bytes_max, coder);
  if (!state || coder.has_more()) return std::nullopt;
  if (check_of(*state) != solver::load_little<std::uint32_t>(delta.data() + 1)) return std::nullopt;
  // Who counts the check himself can say any header, and this state is the next one's baseline.
  const std::optional<CutState> now = cut_state(*state);
  if (!now || now->layout->dimension != dimension) return std::nullopt;
  return state;
}

}  // namespace cycloid::protocol
