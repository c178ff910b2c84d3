#pragma once

#include <cstdint>
#include <cstring>

#include "solver/lanes.hpp"

namespace cycloid::solver {

/// Records of floats into lanes and back, four floats (a quad) of each record at a time: loads and
/// shuffles, where float by float each lane would pass through memory. Nothing here computes.

/// The body or contact in each lane. A plain array, because kernels of one instruction set may not
/// share a function with those of another, not even operator[].
template <int W>
using LaneIndices = std::uint32_t[kLaneCount<W>];

/// A bit for each lane.
using LaneBits = std::uint32_t;
template <int W>
inline constexpr LaneBits kAllLanes = (LaneBits{1} << kLaneCount<W>)-1;

using Quad = RawLanes<4>::Float;
using QuadPair = RawLanes<8>::Float;
using QuadFour = RawLanes<16>::Float;

/// Four rows of four become four columns.
[[gnu::always_inline]] inline void transpose(Quad (&q)[4]) {
  const Quad low_01 = __builtin_shufflevector(q[0], q[1], 0, 4, 1, 5);
  const Quad high_01 = __builtin_shufflevector(q[0], q[1], 2, 6, 3, 7);
  const Quad low_23 = __builtin_shufflevector(q[2], q[3], 0, 4, 1, 5);
  const Quad high_23 = __builtin_shufflevector(q[2], q[3], 2, 6, 3, 7);
  q[0] = __builtin_shufflevector(low_01, low_23, 0, 1, 4, 5);
  q[1] = __builtin_shufflevector(low_01, low_23, 2, 3, 6, 7);
  q[2] = __builtin_shufflevector(high_01, high_23, 0, 1, 4, 5);
  q[3] = __builtin_shufflevector(high_01, high_23, 2, 3, 6, 7);
}
/// The same in both halves.
[[gnu::always_inline]] inline void transpose(QuadPair (&q)[4]) {
  const QuadPair low_01 = __builtin_shufflevector(q[0], q[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const QuadPair high_01 = __builtin_shufflevector(q[0], q[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const QuadPair low_23 = __builtin_shufflevector(q[2], q[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const QuadPair high_23 = __builtin_shufflevector(q[2], q[3], 2, 10, 3, 11, 6, 14, 7, 15);
  q[0] = __builtin_shufflevector(low_01, low_23, 0, 1, 8, 9, 4, 5, 12, 13);
  q[1] = __builtin_shufflevector(low_01, low_23, 2, 3, 10, 11, 6, 7, 14, 15);
  q[2] = __builtin_shufflevector(high_01, high_23, 0, 1, 8, 9, 4, 5, 12, 13);
  q[3] = __builtin_shufflevector(high_01, high_23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// And in all four quarters.
[[gnu::always_inline]] inline void transpose(QuadFour (&q)[4]) {
  const QuadFour low_01 =
      __builtin_shufflevector(q[0], q[1], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  const QuadFour high_01 = __builtin_shufflevector(q[0], q[1], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26,
                                                   11, 27, 14, 30, 15, 31);
  const QuadFour low_23 =
      __builtin_shufflevector(q[2], q[3], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  const QuadFour high_23 = __builtin_shufflevector(q[2], q[3], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26,
                                                   11, 27, 14, 30, 15, 31);
  q[0] = __builtin_shufflevector(low_01, low_23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13,
                                 28, 29);
  q[1] = __builtin_shufflevector(low_01, low_23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15,
                                 30, 31);
  q[2] = __builtin_shufflevector(high_01, high_23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13,
                                 28, 29);
  q[3] = __builtin_shufflevector(high_01, high_23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14,
                                 15, 30, 31);
}

template <class Value, class Record>
[[gnu::always_inline]] inline Value load_quad_as(const Record& record, int first) {
  Value loaded;
  static_assert(sizeof loaded == sizeof(Quad));
  const void* bytes = &record;
  std::memcpy(&loaded, static_cast<const char*>(bytes) + sizeof(float) * first, sizeof loaded);
  return loaded;
}
/// Which of the floats of a record its member begins with.
template <class Record, class Member>
[[gnu::always_inline]] inline int float_at(const Record& record, const Member& member) {
  const void* begin = &record;
  const void* at = &member;
  const auto bytes = static_cast<const char*>(at) - static_cast<const char*>(begin);
  return static_cast<int>(bytes) / static_cast<int>(sizeof(float));
}
/// Floats [first, first + 4) of a record.
template <class Record>
[[gnu::always_inline]] inline Quad load_floats(const Record& record, int first) {
  return load_quad_as<Quad>(record, first);
}
template <class Record>
[[gnu::always_inline]] inline Quad load_quad(const Record& record, int quad) {
  return load_floats(record, 4 * quad);
}
template <class Record>
[[gnu::always_inline]] inline void store_floats(const Quad& from, int first, Record& record) {
  void* bytes = &record;
  std::memcpy(static_cast<char*>(bytes) + sizeof(float) * first, &from, sizeof from);
}
template <class Record>
[[gnu::always_inline]] inline void store_quad(const Quad& from, int quad, Record& record) {
  store_floats(from, 4 * quad, record);
}

/// Four floats each, side by side. GCC 12 joins vectors of floats by two copies and a shuffle, and
/// whole numbers straight from memory.
#if defined(__SIZEOF_INT128__) && !defined(__clang__)
__extension__ typedef __int128 WholeQuad;
typedef WholeQuad WholePair __attribute__((vector_size(32)));
typedef WholeQuad WholeFour __attribute__((vector_size(64)));
[[gnu::always_inline]] inline QuadPair join(const WholeQuad& a, const WholeQuad& b) {
  const WholePair numbers = {a, b};
  QuadPair joined;
  std::memcpy(&joined, &numbers, sizeof joined);
  return joined;
}
[[gnu::always_inline]] inline QuadFour join(const WholeQuad& a, const WholeQuad& b,
                                            const WholeQuad& c, const WholeQuad& d) {
  const WholeFour numbers = {a, b, c, d};
  QuadFour joined;
  std::memcpy(&joined, &numbers, sizeof joined);
  return joined;
}
#else
using WholeQuad = Quad;
[[gnu::always_inline]] inline QuadPair join(const Quad& a, const Quad& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[gnu::always_inline]] inline QuadFour join(const Quad& a, const Quad& b, const Quad& c,
                                            const Quad& d) {
  return __builtin_shufflevector(join(a, b), join(c, d), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
                                 13, 14, 15);
}
#endif

/// Floats [first, first + 4) of the records that the lanes name.
template <int W, class Record>
[[gnu::always_inline]] inline void gather_floats(const Record* records, const LaneIndices<W>& index,
                                                 int first, Lanes<W> (&columns)[4]) {
  const auto quad_of = [&](int lane) __attribute__((always_inline)) {
    return load_quad_as<WholeQuad>(records[index[lane]], first);
  };
  if constexpr (W == 1) {
    struct Row {
      float value[4];
    };
    const Row row = load_quad_as<Row>(records[index[0]], first);
    for (int i = 0; i < 4; ++i) columns[i] = Lanes<W>::load(&row.value[i]);
  } else if constexpr (W == kAvx2Lanes) {
    QuadPair rows[4];
    for (int r = 0; r < 4; ++r) rows[r] = join(quad_of(r), quad_of(r + 4));
    transpose(rows);
    for (int i = 0; i < 4; ++i) columns[i].raw = rows[i];
  } else if constexpr (W == kAvx512Lanes) {
    QuadFour rows[4];
    for (int r = 0; r < 4; ++r)
      rows[r] = join(quad_of(r), quad_of(r + 4), quad_of(r + 8), quad_of(r + 12));
    transpose(rows);
    for (int i = 0; i < 4; ++i) columns[i].raw = rows[i];
  } else {
    float column[4][W];
    for (int at = 0; at < W; at += 4) {
      Quad rows[4];
      for (int r = 0; r < 4; ++r) rows[r] = load_floats(records[index[at + r]], first);
      transpose(rows);
      for (int i = 0; i < 4; ++i) std::memcpy(&column[i][at], &rows[i], sizeof rows[i]);
    }
    for (int i = 0; i < 4; ++i) std::memcpy(&columns[i].raw, column[i], sizeof columns[i].raw);
  }
}

/// Floats [4 quad, 4 quad + 4) of the records that the lanes name.
template <int W, class Record>
[[gnu::always_inline]] inline void gather_columns(const Record* records,
                                                  const LaneIndices<W>& index, int quad,
                                                  Lanes<W> (&columns)[4]) {
  gather_floats<W>(records, index, 4 * quad, columns);
}

/// Into floats [first, first + 4) of the records of the lanes in `wanted`.
template <int W, class Record>
[[gnu::always_inline]] inline void scatter_floats(const Lanes<W> (&columns)[4], LaneBits wanted,
                                                  int first, const LaneIndices<W>& index,
                                                  Record* records) {
  Quad rows[kLaneCount<W>];
  if constexpr (W == 1) {
    for (int i = 0; i < 4; ++i) rows[0][i] = columns[i].raw[0];
  } else if constexpr (W == kAvx2Lanes) {
    QuadPair pairs[4] = {columns[0].raw, columns[1].raw, columns[2].raw, columns[3].raw};
    transpose(pairs);
    for (int r = 0; r < 4; ++r) {
      rows[r] = __builtin_shufflevector(pairs[r], pairs[r], 0, 1, 2, 3);
      rows[r + 4] = __builtin_shufflevector(pairs[r], pairs[r], 4, 5, 6, 7);
    }
  } else if constexpr (W == kAvx512Lanes) {
    QuadFour fours[4] = {columns[0].raw, columns[1].raw, columns[2].raw, columns[3].raw};
    transpose(fours);
    for (int r = 0; r < 4; ++r) {
      rows[r] = __builtin_shufflevector(fours[r], fours[r], 0, 1, 2, 3);
      rows[r + 4] = __builtin_shufflevector(fours[r], fours[r], 4, 5, 6, 7);
      rows[r + 8] = __builtin_shufflevector(fours[r], fours[r], 8, 9, 10, 11);
      rows[r + 12] = __builtin_shufflevector(fours[r], fours[r], 12, 13, 14, 15);
    }
  } else {
    float column[4][W];
    for (int i = 0; i < 4; ++i) std::memcpy(column[i], &columns[i].raw, sizeof columns[i].raw);
    for (int at = 0; at < W; at += 4) {
      Quad quads[4];
      for (int i = 0; i < 4; ++i) std::memcpy(&quads[i], &column[i][at], sizeof quads[i]);
      transpose(quads);
      for (int r = 0; r < 4; ++r) rows[at + r] = quads[r];
    }
  }
  if (wanted == kAllLanes<W>) {
    for (int lane = 0; lane < kLaneCount<W>; ++lane)
      store_floats(rows[lane], first, records[index[lane]]);
    return;
  }
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    if ((wanted >> lane & 1u) != 0) store_floats(rows[lane], first, records[index[lane]]);
}

/// Into floats [4 quad, 4 quad + 4).
template <int W, class Record>
[[gnu::always_inline]] inline void scatter_columns(const Lanes<W> (&columns)[4], LaneBits wanted,
                                                   int quad, const LaneIndices<W>& index,
                                                   Record* records) {
  scatter_floats<W>(columns, wanted, 4 * quad, index, records);
}

}  // namespace cycloid::solver
