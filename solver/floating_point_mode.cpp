#include "solver/floating_point_mode.hpp"

namespace cycloid::solver {

bool floating_point_mode_is_ieee() {
  const float one = opaque(1.0f);
  const float small = opaque(0x1.8p-25f);
  const float minus_one = opaque(-1.0f);
  const bool not_up = opaque(one + small) == one;
  const bool not_down = opaque(minus_one - small) == minus_one;
  const bool not_to_zero = opaque(one - opaque(0x1p-26f)) == one;
  const bool keeps_subnormals = opaque(opaque(0x1p-126f) * opaque(0.25f)) != 0.0f;
  const bool reads_subnormals = opaque(opaque(0x1p-140f) * opaque(0x1p20f)) != 0.0f;
  return not_up && not_down && not_to_zero && keeps_subnormals && reads_subnormals;
}

Error check_arithmetic(bool caller_rounds_as_written) {
  if (!floating_point_mode_is_ieee()) return {Code::kInvalid, "floating_point_mode"};
  if (!caller_rounds_as_written || !rounds_as_written())
    return {Code::kInvalid, "floating_point_flags"};
  return {};
}

}  // namespace cycloid::solver
