#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace cycloid::solver {

enum class Code : std::uint8_t {
  kOk,
  kInvalid,    ///< A value is out of its range, not finite, or contradicts another.
  kCapacity,   ///< A stated limit would be exceeded.
  kUnknownId,  ///< The id was never given out, or what it named is gone.
  kFaulted,    ///< The world is in its fault state and does not step.
  kCorrupt,    ///< Snapshot bytes are not a snapshot of such a world.
};

const char* code_name(Code code);

/// Why a call was refused. A refused call has changed nothing.
struct [[nodiscard]] Error {
  Code code = Code::kOk;
  const char* field = "";  ///< Name of the offending field, static storage; "" when kOk.
  int index = -1;          ///< Which shape, point or element of the argument, or -1.

  bool ok() const { return code == Code::kOk; }
};

/// A value, or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT: a value is a result.
  Result(Error error) : error_(error) {}         // NOLINT: an error is a result.

  bool ok() const { return value_.has_value(); }
  const Error& error() const { return error_; }
  /// @pre ok().
  T& value() { return *value_; }
  const T& value() const { return *value_; }

 private:
  std::optional<T> value_;
  Error error_;
};

}  // namespace cycloid::solver
